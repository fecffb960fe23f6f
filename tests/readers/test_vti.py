"""Images of VTK are volumes: samples at points or in the middles of cells, in one file or in several."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from vtu_files import Encoding

from isocore import extract, measure
from isocore.errors import InputError, IsocoreError, OptionError
from isocore.readers import ReadOptions, count_volumes, files_of, read
from isocore.readers.vti import vti_fields
from isocore.volume import Volume

NAMES = {"f": "Float", "i": "Int", "u": "UInt"}
SHAPE = (5, 4, 3)
TURN = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def ramp(shape: tuple[int, ...] = SHAPE, dtype: Any = np.float32) -> Any:
    """Samples that tell their index, i fastest."""
    i, j, k = np.indices(shape)
    return (i + 10 * j + 100 * k).astype(dtype)


def array(name: str, values: Any, encoding: Encoding) -> str:
    """Flat values, or (n, components)."""
    kind = f"{NAMES[values.dtype.kind]}{8 * values.dtype.itemsize}"
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    if encoding.format == "ascii":
        text = " ".join(map(repr, values.ravel().tolist()))
    else:
        text = encoding.block(values, base64_text=True).decode()
    return f'<DataArray type="{kind}" Name="{name}"{components} format="{encoding.format}">{text}</DataArray>'


def piece(extent: str, points: dict[str, Any], cells: dict[str, Any], encoding: Encoding) -> str:
    of_points = "".join(array(name, values, encoding) for name, values in points.items())
    of_cells = "".join(array(name, values, encoding) for name, values in cells.items())
    return (
        f'<Piece Extent="{extent}"><PointData>{of_points}</PointData><CellData>{of_cells}</CellData></Piece>'
    )


def write_vti(
    path: Path, extent: str, pieces: list[str], place: str = "", encoding: Encoding = Encoding()  # noqa: B008
) -> Path:
    compressor = ' compressor="vtkZLibDataCompressor"' if encoding.compressor else ""
    path.write_text(
        f'<?xml version="1.0"?><VTKFile type="ImageData" version="1.0" byte_order="{encoding.byte_order}"'
        f' header_type="{encoding.header}"{compressor}>'
        f'<ImageData WholeExtent="{extent}" {place}>{"".join(pieces)}</ImageData></VTKFile>'
    )
    return path


def image(
    folder: Path, points: dict[str, Any], cells: dict[str, Any] | None = None, *, place: str = "", **coding: Any
) -> Path:
    """One piece of SHAPE."""
    encoding = Encoding(**coding)
    parts = [piece("0 4 0 3 0 2", points, cells or {}, encoding)]
    return write_vti(folder / "a.vti", "0 4 0 3 0 2", parts, place, encoding)


def flat(values: Any) -> Any:
    return values.ravel(order="F")


@pytest.mark.parametrize(
    "coding",
    [
        {},
        {"format": "binary"},
        {"format": "binary", "compressor": "zlib", "header": "UInt64"},
        {"format": "binary", "byte_order": "BigEndian"},
    ],
    ids=str,
)
@pytest.mark.parametrize("dtype", ["u1", "i2", "i4", "f4", "f8"])
def test_samples_keep_their_type_and_place(dtype, coding, tmp_path):
    """In every encoding; i is fastest in the file as in memory."""
    volume = read(image(tmp_path, {"r": flat(ramp(dtype=dtype))}, **coding))
    assert isinstance(volume, Volume) and volume.samples.dtype == np.dtype(dtype)
    np.testing.assert_array_equal(volume.samples, ramp(dtype=dtype))
    assert volume.samples.flags.f_contiguous and volume.field_name == "r" and count_volumes(tmp_path / "a.vti") == 1


def test_the_world_is_origin_spacing_and_direction(tmp_path):
    """As VTK's own TransformIndexToPhysicalPoint, also where the extent does not begin at 0."""
    turned = f'Origin="1 2 3" Spacing="0.5 2 4" Direction="{" ".join(map(str, TURN))}"'
    part = piece("2 6 0 3 -1 1", {"r": flat(ramp())}, {}, Encoding())
    volume = read(write_vti(tmp_path / "a.vti", "2 6 0 3 -1 1", [part], turned))
    np.testing.assert_allclose(volume.affine @ (0, 0, 0, 1), (1, 3, -1, 1))
    np.testing.assert_allclose(volume.affine @ (1, 1, 1, 1), (-1, 3.5, 3, 1))
    assert volume.spacing == (0.5, 2, 4) and volume.space == "native" and volume.unit == ""


def test_a_field_of_cells_lies_in_their_middles(tmp_path):
    """One sample fewer along each axis, half a step on."""
    cells = {"c": flat(ramp((4, 3, 2)))}
    volume = read(image(tmp_path, {}, cells, place='Origin="0 0 0" Spacing="1 2 3"'))
    np.testing.assert_array_equal(volume.samples, ramp((4, 3, 2)))
    np.testing.assert_allclose(volume.affine[:3, 3], (0.5, 1, 1.5))


def test_fields_and_components_are_chosen_as_in_meshes(tmp_path):
    """By name, by component, or their magnitude."""
    vector = np.stack([flat(ramp()), 2 * flat(ramp()), 0 * flat(ramp())], axis=1)
    path = image(tmp_path, {"v": vector, "r": flat(ramp())}, {"c": flat(ramp((4, 3, 2)))})
    assert [(field.name, field.of) for field in vti_fields(path)] == [
        ("v", "points"),
        ("r", "points"),
        ("c", "cells"),
    ]
    with pytest.raises(OptionError, match="holds 2 point fields"):
        read(path)
    second = read(path, ReadOptions(field="v", component="1"))
    np.testing.assert_array_equal(second.samples, 2 * ramp())
    whole = read(path, ReadOptions(field="v", component="magnitude"))
    np.testing.assert_allclose(whole.samples, np.sqrt(5) * ramp(), rtol=1e-6)


def test_eight_byte_integers_are_narrowed(tmp_path):
    """As in every other format."""
    assert read(image(tmp_path, {"r": flat(ramp(dtype="i8"))})).samples.dtype == np.int32


@pytest.mark.parametrize("dtype, kept", [("u1", "f4"), ("i4", "f8"), ("f4", "f4"), ("f8", "f8")])
def test_hidden_samples_are_outside(dtype, kept, tmp_path):
    """They become NaN, in the fewest bits that keep the others, and a warning counts them."""
    marks = np.zeros(60, np.uint8)
    marks[[0, 7]] = 2
    volume = read(image(tmp_path, {"r": flat(ramp(dtype=dtype)), "vtkGhostType": marks}))
    assert volume.samples.dtype == np.dtype(kept) and np.flatnonzero(np.isnan(flat(volume.samples))).tolist() == [0, 7]
    assert volume.warnings == ("2 samples are marked as hidden; they count as outside, as NaN does",)


def halves(values: Any) -> list[str]:
    """Two pieces that share a layer of points."""
    return [
        piece("0 2 0 3 0 2", {"r": flat(values[:3])}, {}, Encoding()),
        piece("2 4 0 3 0 2", {"r": flat(values[2:])}, {}, Encoding()),
    ]


def test_pieces_are_put_together(tmp_path):
    """In one file, and in several that a .pvti lists."""
    one = read(write_vti(tmp_path / "a.vti", "0 4 0 3 0 2", halves(ramp())))
    np.testing.assert_array_equal(one.samples, ramp())
    for n, part in enumerate(halves(ramp())):
        extent = ("0 2 0 3 0 2", "2 4 0 3 0 2")[n]
        write_vti(tmp_path / f"{n}.vti", extent, [part])
    path = tmp_path / "all.pvti"
    path.write_text(
        '<VTKFile type="PImageData"><PImageData WholeExtent="0 4 0 3 0 2" Origin="1 1 1" Spacing="2 2 2">'
        '<Piece Extent="0 2 0 3 0 2" Source="0.vti"/><Piece Extent="2 4 0 3 0 2" Source="1.vti"/>'
        "</PImageData></VTKFile>"
    )
    several = read(path)
    np.testing.assert_array_equal(several.samples, ramp())
    assert several.spacing == (2, 2, 2) and files_of(path)[1:] == (tmp_path / "0.vti", tmp_path / "1.vti")
    (tmp_path / "1.vti").unlink()
    with pytest.raises(InputError, match=r"one of its 2 pieces is missing, .*1\.vti; copy it there"):
        read(path)


@pytest.mark.parametrize(
    "extent, parts, message",
    [
        ("0 4 0 3 0 2", lambda: halves(ramp())[:1], "its pieces leave samples out"),
        ("0 4 0 3 0 2", lambda: [halves(ramp())[0]] * 2, "its pieces leave 24 samples out"),
        ("0 3 0 3 0 2", lambda: halves(ramp()), "a piece reaches beyond the whole extent"),
        ("0 4 0 3 0 0", lambda: [piece("0 4 0 3 0 0", {"r": flat(ramp((5, 4, 1)))}, {}, Encoding())], "holds 5x4x1"),
        ("0 4 0 3", list, "has the extent '0 4 0 3', not three pairs"),
        ("4 0 0 3 0 2", list, "not three pairs"),
        ("0 4 0 3 0 2", list, "holds no samples"),
        ("0 99999999 0 99999999 0 99999999", lambda: halves(ramp()), "its pieces leave samples out"),
        (
            "0 4 0 3 0 2",
            lambda: [piece("0 4 0 3 0 2", {"r": flat(ramp())[:-1]}, {}, Encoding())],
            "holds 59 numbers where its piece promises 60",
        ),
    ],
)
def test_extents_that_make_no_sense_are_refused(extent, parts, message, tmp_path):
    """In one line, before anything is reserved for them."""
    path = write_vti(tmp_path / "a.vti", extent, parts())
    with pytest.raises(IsocoreError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ") and message in str(caught.value)


@pytest.mark.parametrize("place", ['Spacing="0 1 1"', 'Spacing="nan 1 1"', 'Origin="a b c"', 'Direction="1 0 0"'])
def test_a_place_that_makes_no_sense_is_refused(place, tmp_path):
    """Zero steps, words and matrices of three numbers."""
    with pytest.raises(InputError, match="write it again"):
        read(image(tmp_path, {"r": flat(ramp())}, place=place))


def test_the_surface_of_an_image_is_that_of_its_samples(tmp_path):
    """A ball, closed, where the image lies."""
    i, j, k = np.indices((12, 12, 12))
    ball = np.sqrt((i - 5.5) ** 2 + (j - 5.5) ** 2 + (k - 5.5) ** 2)
    part = piece("0 11 0 11 0 11", {"r": flat(ball)}, {}, Encoding("binary"))
    path = write_vti(tmp_path / "a.vti", "0 11 0 11 0 11", [part], 'Spacing="2 2 2"')
    measured = measure(extract(read(path), 4.0, backend="mc"))
    assert measured.watertight and abs(measured.bounds[0][0] - 3) < 0.2


def test_a_spacing_beyond_all_reckoning_is_refused(tmp_path):
    """In the volume's words, and without a warning of Python's."""
    turned = " ".join(["1e300"] * 9)
    path = image(tmp_path, {"u": ramp().ravel()}, place=f'Spacing="1e300 1 1" Direction="{turned}"')
    with pytest.raises(IsocoreError, match=r"a\.vti: its origin, spacing or direction is too large"):
        read(path)


@pytest.mark.parametrize("step", ["1e-320", "1e300"])
def test_steps_beyond_all_reckoning_are_refused_in_words(step, tmp_path):
    """Neither a warning of a library nor a place that is infinite."""
    place = f'Origin="1e308 0 0" Spacing="{step} {step} {step}"'
    with pytest.raises(IsocoreError) as caught:
        read(image(tmp_path, {"r": flat(ramp())}, place=place))
    assert "encountered" not in str(caught.value)
