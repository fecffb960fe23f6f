"""MetaImage: every spelling of its header, every place of its samples, as ITK reads them."""

from __future__ import annotations

import gzip
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest
from scans import AFFINE, METAIMAGE, REAL_DATA, ramp, save

from isocore.errors import IsocoreError
from isocore.readers import ReadOptions, count_volumes, files_of, read
from isocore.volume import Volume

SAMPLES = ramp((2, 3, 4), "<i2")
#: A row of the matrix is the direction of an axis: i runs along y, j along z, k along x.
TURNED = np.array([[0, 0, 3, 1], [1, 0, 0, 2], [0, 2, 0, 3], [0, 0, 0, 1]], dtype=np.float64)


def made(path: Path, *fields: str, content: bytes | None = None, **changed: str) -> Path:
    """A file of three axes; changed: fields that are not as usual; fields: further lines of the header."""
    usual = {"NDims": "3", "DimSize": "2 3 4", "ElementType": "MET_SHORT", "ElementDataFile": "LOCAL"} | changed
    last = usual.pop("ElementDataFile")
    lines = ["ObjectType = Image", *(f"{name} = {text}" for name, text in usual.items()), *fields]
    head = "\n".join([*lines, f"ElementDataFile = {last}", ""])
    path.write_bytes(head.encode() + (SAMPLES.tobytes(order="F") if content is None else content))
    return path


def volume(path: Path, **options: int) -> Volume:
    found = read(path, ReadOptions(**options))  # type: ignore[arg-type]
    assert isinstance(found, Volume)
    return found


def refusal(path: Path) -> str:
    with pytest.raises(IsocoreError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ") and "\n" not in str(caught.value)
    return str(caught.value).removeprefix(f"{path}: ")


@pytest.mark.parametrize("suffix", [".mha", ".mhd"])
def test_the_world_is_lps_in_millimetres(tmp_path: Path, suffix: str) -> None:
    """The same place as in any other format."""
    found = volume(save(tmp_path / f"scan{suffix}", ramp()))
    assert (found.space, found.unit) == ("lps", "mm")
    assert np.allclose(found.in_space("ras").affine, AFFINE, atol=1e-12)


@pytest.mark.parametrize("place", ["Offset", "Origin", "Position"])
@pytest.mark.parametrize("direction", ["TransformMatrix", "Rotation", "Orientation"])
def test_a_row_of_the_matrix_is_an_axis(tmp_path: Path, place: str, direction: str) -> None:
    """Under every name that the fields have; the axes' anatomical names and the centre of rotation move nothing."""
    fields = (f"{place} = 1 2 3", f"{direction} = 0 1 0 0 0 1 1 0 0", "ElementSpacing = 1 2 3")
    more = ("AnatomicalOrientation = RAS", "CenterOfRotation = 7 7 7")
    found = volume(made(tmp_path / "a.mha", *fields, *more))
    assert np.array_equal(found.affine, TURNED) and np.array_equal(found.samples, SAMPLES)


@pytest.mark.parametrize(
    ("fields", "spacing"),
    [
        (("ElementSize = 2 3 4",), (2, 3, 4)),
        (("ElementSize = 2 3 4", "ElementSpacing = 1 1 2"), (1, 1, 2)),
        (("ElementSpacing = 4.0e+000 4 4",), (4, 4, 4)),
        (("elementspacing=1 2 3",), (1, 2, 3)),
        (("ElementSpacing = 1 2 3", "DistanceUnits = cm"), (10, 20, 30)),
        ((), (1, 1, 1)),
    ],
)
def test_the_spacing_is_what_the_header_says(
    tmp_path: Path, fields: tuple[str, ...], spacing: tuple[float, ...]
) -> None:
    """The size of a voxel where it has no other; names in any case, with blanks or without."""
    assert volume(made(tmp_path / "a.mha", *fields)).spacing == spacing


@pytest.mark.parametrize("name", ["BinaryDataByteOrderMSB", "ElementByteOrderMSB"])
def test_big_endian_samples_are_swapped(tmp_path: Path, name: str) -> None:
    """Whichever field says so."""
    path = made(tmp_path / "a.mha", f"{name} = True", content=SAMPLES.astype(">i2").tobytes(order="F"))
    assert np.array_equal(volume(path).samples, SAMPLES)


@pytest.mark.parametrize("pack", [zlib.compress, gzip.compress])
@pytest.mark.parametrize("local", [True, False])
def test_packed_samples_are_unpacked(tmp_path: Path, pack: object, local: bool) -> None:
    """By zlib and by gzip, behind the header and beside it; a stream that is cut or damaged is no volume."""
    packed: bytes = pack(SAMPLES.tobytes(order="F"))  # type: ignore[operator]
    where, content = ("LOCAL", packed) if local else ("a.zraw", b"")
    (tmp_path / "a.zraw").write_bytes(packed)
    path = made(tmp_path / "a.mhd", "CompressedData = True", content=content, ElementDataFile=where)
    assert np.array_equal(volume(path).samples, SAMPLES)
    file = path if local else tmp_path / "a.zraw"
    whole = file.read_bytes()
    file.write_bytes(whole[:-9])
    assert "ends early" in refusal(path)
    file.write_bytes(whole[:-20] + bytes(20))
    assert "damaged" in refusal(path) or "ends early" in refusal(path)


def test_samples_may_be_text(tmp_path: Path) -> None:
    """Numbers with blanks between them."""
    text = " ".join(map(str, SAMPLES.ravel(order="F"))).encode()
    assert np.array_equal(volume(made(tmp_path / "a.mha", "BinaryData = False", content=text)).samples, SAMPLES)
    assert "is no list of int16" in refusal(made(tmp_path / "b.mha", "BinaryData = False", content=b"1 2 three"))
    assert "ends early" in refusal(made(tmp_path / "c.mha", "BinaryData = False", content=b"1 2 3"))


def test_samples_may_lie_in_a_list_of_files(tmp_path: Path) -> None:
    """Listed, or numbered; all of them belong to the header."""
    for k in range(4):
        (tmp_path / f"s{k + 1:03}.raw").write_bytes(SAMPLES[..., k].tobytes(order="F"))
    names = "\n".join(f"s{k + 1:03}.raw" for k in range(4))
    listed = made(tmp_path / "a.mhd", ElementDataFile="LIST", content=names.encode())
    numbered = made(tmp_path / "b.mhd", ElementDataFile="s%03d.raw 1 4 1", content=b"")
    for path in (listed, numbered):
        assert np.array_equal(volume(path).samples, SAMPLES)
        assert [file.name for file in files_of(path)[1:]] == names.splitlines()
    (tmp_path / "s002.raw").unlink()
    assert "no s002.raw beside it" in refusal(listed) and "no s002.raw beside it" in refusal(numbered)


@pytest.mark.parametrize("size", [4, -1])
def test_what_stands_before_the_samples_is_skipped(tmp_path: Path, size: int) -> None:
    """So many bytes, or as many as there are."""
    (tmp_path / "a.raw").write_bytes(b"HEAD" + SAMPLES.tobytes(order="F"))
    path = made(tmp_path / "a.mhd", f"HeaderSize = {size}", ElementDataFile="a.raw", content=b"")
    assert np.array_equal(volume(path).samples, SAMPLES) and not volume(path).warnings


@pytest.mark.parametrize("code", METAIMAGE)
def test_every_type_has_its_name(tmp_path: Path, code: str) -> None:
    """Eight-byte integers are narrowed as everywhere; MET_LONG has four bytes."""
    kind = f"MET_{METAIMAGE[code]}"
    path = made(tmp_path / "a.mha", ElementType=kind, content=SAMPLES.astype(code).tobytes(order="F"))
    assert np.array_equal(volume(path).samples, SAMPLES) and not volume(path).warnings
    path = made(tmp_path / "b.mha", ElementType="MET_LONG", content=SAMPLES.astype("<i4").tobytes(order="F"))
    assert volume(path).samples.dtype == np.int32


def test_values_of_several_channels_are_volumes(tmp_path: Path) -> None:
    """The channels of a voxel lie side by side; so a fourth axis is volumes one after the other."""
    content = ramp((3, 2, 3, 4), "<i2")
    for kind in ("MET_SHORT", "MET_SHORT_ARRAY"):
        path = made(
            tmp_path / "a.mha", "ElementNumberOfChannels = 3", ElementType=kind, content=content.tobytes(order="F")
        )
        assert count_volumes(path) == 3 and np.array_equal(volume(path, volume=1).samples, content[1])
    times = ramp((2, 3, 4, 2), "<i2")
    fields = ("TransformMatrix = 0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1", "Offset = 1 2 3 9", "ElementSpacing = 1 2 3 4")
    path = made(tmp_path / "b.mha", *fields, NDims="4", DimSize="2 3 4 2", content=times.tobytes(order="F"))
    assert count_volumes(path) == 2 and np.array_equal(volume(path, volume=1).samples, times[..., 1])
    assert np.array_equal(volume(path, volume=0).affine, TURNED)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"NDims": "2", "DimSize": "2 3"}, "holds 2x3x1 samples"),
        ({"NDims": "99"}, "header has 99 axes"),
        ({"DimSize": "2 3"}, "no 3 numbers as DimSize"),
        ({"DimSize": "2 3 -4"}, "an axis of -4 samples"),
        ({"DimSize": "2 3 4.5"}, "no whole numbers"),
        ({"DimSize": "2 3 1e300"}, "no whole numbers"),
        ({"HeaderSize": "1e9"}, "ends early, before byte"),
        ({"ElementSpacing": "1e308 1e308 1e308"}, "the affine"),
        ({"DimSize": "2 3 nan"}, "no 3 numbers as DimSize"),
        ({"DimSize": "2000 3000 4000"}, "ends early (48 of 48,000,000,000 bytes)"),
        ({"ElementType": "MET_STRING"}, "samples are of type MET_STRING"),
        ({"ElementDataFile": "none.raw"}, "no none.raw beside it"),
        ({"ElementDataFile": "a.mha"}, "names itself"),
        ({"ElementDataFile": "LIST"}, "unevenly over 0 files"),
        ({"HeaderSize": "-2"}, "skips -2 bytes"),
        ({"ElementNumberOfChannels": "0"}, "0 values a voxel"),
        ({"ElementSpacing": "1 0 1"}, "affine is singular"),
    ],
)
def test_a_damaged_header_is_refused_by_one_line(tmp_path: Path, changed: dict[str, str], said: str) -> None:
    """It says what is wrong."""
    content = b"" if changed.get("ElementDataFile") == "LIST" else None
    assert said in refusal(made(tmp_path / "a.mha", content=content, **changed))


def test_a_header_without_its_end_is_refused(tmp_path: Path) -> None:
    """Also one that never ends."""
    for name, content in (("a.mha", b"ObjectType = Image\nNDims = 3\n"), ("b.mhd", b"\n" * (3 << 20))):
        (tmp_path / name).write_bytes(content)
        assert "ElementDataFile" in refusal(tmp_path / name)


def test_more_samples_than_the_header_says_are_warned_about(tmp_path: Path) -> None:
    """And so is a scale, which ITK leaves out too."""
    path = made(tmp_path / "a.mha", content=SAMPLES.tobytes() + b"more")
    assert "has 4 bytes more" in volume(path).warnings[0]
    path = made(tmp_path / "a.mha", "ElementToIntensityFunctionSlope = 2")
    assert "would multiply its samples by 2" in volume(path).warnings[0] and volume(path).slope == 1


@pytest.mark.skipif(not REAL_DATA.is_dir(), reason=f"no real data at {REAL_DATA}")
def test_real_files_are_read_as_itk_reads_them() -> None:
    """Samples, and the world's place of three voxels to 1e-5."""
    sitk = pytest.importorskip("SimpleITK")
    paths = [path for path in REAL_DATA.rglob("*.mh[ad]") if path.is_file()]
    assert len(paths) >= 14
    for path in paths:
        image, found = sitk.ReadImage(str(path)), volume(path)
        assert np.array_equal(sitk.GetArrayFromImage(image).T, found.samples)
        for index in ((0, 0, 0), (5, 0, 3), (1, 7, 2)):
            expected = image.TransformIndexToPhysicalPoint(index)
            assert np.allclose((found.affine @ [*index, 1])[:3], expected, atol=1e-5)


def test_numbered_files_are_looked_for_one_at_a_time(tmp_path: Path) -> None:
    """A header of a few bytes that names billions of them reserves nothing for their names."""
    path = made(tmp_path / "a.mhd", ElementDataFile="s%d.raw 1 4294967295", content=b"")
    tracemalloc.start()
    try:
        assert "no s1.raw beside it" in refusal(path)
        assert tracemalloc.get_traced_memory()[1] < 4_000_000
    finally:
        tracemalloc.stop()
