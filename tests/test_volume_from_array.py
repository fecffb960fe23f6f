"""Arrays as people hold them become volumes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

import isocore
from isocore.errors import FieldError, OptionError
from isocore.volume import SAMPLE_TYPES, Volume

RAMP = np.arange(2 * 3 * 4).reshape(2, 3, 4)


@pytest.mark.parametrize("dtype", [*SAMPLE_TYPES, "bool"])
def test_an_array_in_fortran_order_is_not_copied(dtype: str) -> None:
    """The volume looks at its memory, which stays writeable for its owner."""
    array = np.asfortranarray(RAMP.astype(dtype))
    volume = Volume.from_array(array)
    assert np.shares_memory(array, volume.samples) and volume.samples.flags.f_contiguous
    assert array.flags.writeable and not volume.samples.flags.writeable
    assert volume.samples.dtype == ("uint8" if dtype == "bool" else dtype)


def test_an_array_in_c_order_is_copied_and_a_transposed_one_is_not() -> None:
    """Index [i, j, k] is [x, y, z] in both."""
    volume = Volume.from_array(RAMP.astype(np.int16))
    assert volume.shape == (2, 3, 4) and np.array_equal(volume.samples, RAMP)
    array = RAMP.astype(np.int16)
    assert np.shares_memory(Volume.from_array(array.T).samples, array)
    assert Volume.from_array(array.T).shape == (4, 3, 2)


@pytest.mark.parametrize(
    ("array", "dtype"),
    [
        (RAMP.astype(np.int64), "int32"),
        (RAMP.astype(np.uint64) + 2**31, "uint32"),
        (RAMP.astype(np.int64) + 2**40, "float64"),
        (RAMP.astype(np.float16), "float32"),
        (RAMP.astype(np.longdouble), "float64"),
        (RAMP.astype(">i2"), "int16"),
        (RAMP.astype(">f8"), "float64"),
        (RAMP.tolist(), "int32"),
        (RAMP.astype(np.uint8)[::-1, ::-1, ::-1], "uint8"),
    ],
)
def test_a_type_that_makes_sense_is_taken(array: npt.ArrayLike, dtype: str) -> None:
    """In as few bits as hold the values, which stay what they are."""
    volume = Volume.from_array(array)
    assert volume.samples.dtype == dtype and volume.samples.dtype.isnative and volume.samples.flags.f_contiguous
    assert np.array_equal(volume.samples, np.asarray(array).astype(np.float64))


def test_whole_numbers_beyond_two_to_the_53rd_are_warned_about() -> None:
    """No other type holds them."""
    volume = Volume.from_array(RAMP.astype(np.int64) + 2**60)
    assert "2^53" in volume.warnings[0]


@pytest.mark.parametrize("dtype", ["uint8", "int32", "float32", "float64"])
def test_what_a_mask_masks_is_outside(dtype: str) -> None:
    """As NaN is; a mask that masks nothing costs nothing."""
    array = np.ma.masked_array(RAMP.astype(dtype), mask=RAMP > 20)
    samples = Volume.from_array(array).samples
    assert np.array_equal(np.isnan(samples), RAMP > 20) and np.array_equal(samples[RAMP <= 20], RAMP[RAMP <= 20])
    assert Volume.from_array(np.ma.masked_array(RAMP.astype(dtype))).samples.dtype == dtype


def test_spacing_and_origin_place_the_centres_of_samples() -> None:
    """One step for all axes or one for each."""
    volume = Volume.from_array(RAMP, spacing=(0.5, 1, 2), origin=(10, 20, 30), space="RAS", unit="mm")
    assert np.array_equal(volume.affine @ [1, 1, 1, 1], [10.5, 21, 32, 1])
    assert (volume.spacing, volume.space, volume.unit) == ((0.5, 1, 2), "ras", "mm")
    assert Volume.from_array(RAMP, spacing=0.25).spacing == (0.25, 0.25, 0.25)


def test_an_affine_is_taken_as_it_is() -> None:
    """Also as lists."""
    affine = [[0, -2, 0, 5], [1, 0, 0, 6], [0, 0, 3, 7], [0, 0, 0, 1]]
    assert np.array_equal(Volume.from_array(RAMP, affine=affine).affine, affine)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"samples": np.zeros((2, 2))}, "samples"),
        ({"samples": np.zeros((2, 2, 2, 5))}, "samples"),
        ({"samples": np.zeros((2, 2, 2), complex)}, "samples"),
        ({"samples": np.zeros((2, 2, 2), "U3")}, "samples"),
        ({"samples": [[[None, 1]]]}, "samples"),
        ({"spacing": (1, 0, 1)}, "spacing"),
        ({"spacing": (1, 1)}, "spacing"),
        ({"spacing": "wide"}, "spacing"),
        ({"spacing": np.nan}, "spacing"),
        ({"origin": 5}, "origin"),
        ({"origin": (1, 2, np.inf)}, "origin"),
        ({"affine": np.eye(3)}, "affine"),
        ({"affine": "none"}, "affine"),
        ({"affine": np.eye(4), "spacing": 2}, "affine"),
        ({"space": "scanner"}, "space"),
        ({"unit": "mm\n"}, "unit"),
    ],
)
def test_an_error_names_the_argument(arguments: dict[str, object], name: str) -> None:
    """First thing in its message, which is one line."""
    with pytest.raises((FieldError, OptionError)) as caught:
        Volume.from_array(**{"samples": RAMP, **arguments})  # type: ignore[arg-type]
    assert str(caught.value).startswith(f"{name}: ") and "\n" not in str(caught.value)


def test_a_volume_is_shown_on_one_short_line() -> None:
    """And so are a mesh and a surface."""
    volume = Volume.from_array(RAMP.astype(np.int16), spacing=(0.5, 0.5, 2), space="ras", unit="mm")
    assert repr(volume) == "Volume(2x3x4 int16, 0.5 x 0.5 x 2 mm, ras)"
    assert repr(isocore.Volume(np.asfortranarray(RAMP.astype(np.int16)), 2.0, -1024.0)) == (
        "Volume(2x3x4 int16, x 2 + -1024, 1 x 1 x 1, native)"
    )
    assert repr(isocore.extract(volume, 11.5, normals=True)).startswith("Surface(")
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)
    cells = np.array([[0, 1, 2, 3]], np.int32), np.empty((0, 8), np.int32)
    mesh = isocore.CellMesh(points, *cells, np.arange(4.0), field_name="T")
    assert repr(mesh) == "CellMesh(4 points, 1 tets, T float64)"
