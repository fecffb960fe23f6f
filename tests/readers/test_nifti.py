"""NIfTI-1, NIfTI-2 and Analyze: headers that say much, little, or nonsense."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import nibabel as nib
import numpy as np
import pytest
from scans import AFFINE, patched, ramp, save

from isocore.errors import FieldError, InputError, IsocoreError
from isocore.readers import ReadOptions, count_volumes, read
from isocore.volume import Volume

DATATYPE, BITPIX, DIM, PIXDIM, VOX_OFFSET, SLOPE, UNITS, QFORM, SFORM, SROW, MAGIC = (
    70, 72, 40, 76, 108, 112, 123, 252, 254, 280, 344,
)  # fmt: skip


def volume_of(path: Path, options: ReadOptions | None = None) -> Volume:
    """The volume in `path`."""
    field = read(path, options)
    assert isinstance(field, Volume)
    return field


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A NIfTI-1 file, to be patched."""
    return save(tmp_path / "scan.nii", ramp())


@pytest.mark.parametrize("endian", "<>")
@pytest.mark.parametrize("image", [nib.Nifti1Image, nib.Nifti2Image, nib.Nifti1Pair, nib.Nifti2Pair])
def test_each_header_is_read_in_both_byte_orders(tmp_path: Path, image: Any, endian: str) -> None:
    """348 or 540 bytes, one file or two: the same volume."""
    header = image.header_class(endianness=endian)
    header.set_data_dtype(f"{endian}f4")
    header.set_xyzt_units("mm")
    path = tmp_path / ("scan.hdr" if "Pair" in image.__name__ else "scan.nii")
    image(ramp(dtype="f4"), AFFINE, header).to_filename(path)
    volume = volume_of(path)
    assert np.array_equal(volume.samples, ramp())
    assert np.allclose(volume.affine, AFFINE) and (volume.space, volume.unit) == ("ras", "mm")
    assert not volume.warnings


def test_the_sform_goes_before_the_qform(scan: Path) -> None:
    """And the qform before the bare spacing."""
    image = nib.load(scan)
    image.header.set_qform(np.diag([-3.0, 4.0, 5.0, 1.0]), 1)
    nib.Nifti1Image(ramp(), None, image.header).to_filename(scan)
    assert np.allclose(volume_of(scan).affine, AFFINE)
    patched(scan, SFORM, b"\0\0")
    assert np.allclose(volume_of(scan).affine, np.diag([-3.0, 4.0, 5.0, 1.0]))
    patched(scan, QFORM, b"\0\0")
    volume = volume_of(scan)
    assert np.allclose(volume.affine, np.diag([3.0, 4.0, 5.0, 1.0]))
    assert "states no orientation" in volume.warnings[0]


def test_any_rotation_comes_out_of_the_qform(tmp_path: Path) -> None:
    """As nibabel reads it, also with mirrors and with a scalar part of zero."""
    generator = np.random.default_rng(3)
    for number in range(60):
        rotation, _ = np.linalg.qr(generator.normal(size=(3, 3)))
        if number < 24:
            rotation = np.eye(3)[generator.permutation(3)] * generator.choice([-1, 1], 3)
        header = nib.Nifti1Header()
        header.set_qform(nib.affines.from_matvec(rotation @ np.diag([1.0, 2.0, 3.0]), [7, 8, 9]), 1)
        image = nib.Nifti1Image(ramp(dtype="u1"), None, header)
        image.header["sform_code"] = 0
        image.to_filename(tmp_path / "scan.nii")
        assert np.allclose(volume_of(tmp_path / "scan.nii").affine, image.header.get_qform(), atol=2e-6)


@pytest.mark.parametrize("image", [nib.Nifti1Image, nib.Nifti2Image])
def test_a_quaternion_too_long_is_a_half_turn(tmp_path: Path, image: Any) -> None:
    """As nifti1.h has it; nibabel refuses it, and a mirror that is neither 1 nor -1."""
    written = image(ramp(), None)
    written.header.set_qform(np.diag([-2.0, -3.0, 4.0, 1.0]), 1)
    written.header["sform_code"] = 0
    written.header["quatern_d"] = 1.001
    written.header["pixdim"][0] = 0
    with pytest.raises(ValueError, match="w2 should be positive"):
        written.header.get_qform()
    header = written.header.binaryblock
    (tmp_path / "scan.nii").write_bytes(header + bytes(written.header.single_vox_offset - len(header)))
    with (tmp_path / "scan.nii").open("ab") as file:
        file.write(ramp().tobytes(order="F"))
    volume = volume_of(tmp_path / "scan.nii")
    assert np.allclose(volume.affine, np.diag([-2.0, -3.0, 4.0, 1.0])) and not volume.warnings


@pytest.mark.parametrize("quaternion", [(np.nan, 0, 0), (np.inf, 0, 0)])
def test_a_quaternion_that_is_no_number_is_passed_over(scan: Path, quaternion: tuple[float, ...]) -> None:
    """In favour of the spacing alone."""
    patched(scan, SFORM - 2, struct.pack("<2h3f", 1, 0, *quaternion))
    volume = volume_of(scan)
    assert np.allclose(volume.spacing, (1.5, 2.0, 3.0))
    assert "qform is singular" in volume.warnings[0]


@pytest.mark.parametrize(
    ("code", "factor", "unit"), [(1, 1000.0, "mm"), (2, 1.0, "mm"), (3, 0.001, "mm"), (0, 1.0, ""), (5, 1.0, "")]
)
def test_lengths_come_in_millimetres(scan: Path, code: int, factor: float, unit: str) -> None:
    """Whatever the file counts in, beside whatever unit of time."""
    for time in (8, 248):
        volume = volume_of(patched(scan, UNITS, bytes([code | time])))
        assert np.allclose(volume.affine[:3], AFFINE[:3] * factor) and volume.unit == unit


@pytest.mark.parametrize(
    ("stored", "scale"),
    [
        ((2.5, -7.0), (2.5, -7.0)),
        ((0.0, 9.0), (1.0, 0.0)),
        ((np.nan, 9.0), (1.0, 0.0)),
        ((np.inf, 9.0), (1.0, 0.0)),
        ((-2.0, np.nan), (-2.0, 0.0)),
    ],
)
def test_the_scale_stays_beside_the_samples(
    scan: Path, stored: tuple[float, float], scale: tuple[float, float]
) -> None:
    """A slope that cannot scale means that there is none."""
    volume = volume_of(patched(scan, SLOPE, struct.pack("<2f", *stored)))
    assert (volume.slope, volume.intercept) == scale and volume.samples.dtype == np.int16


@pytest.mark.parametrize(
    ("code", "name"),
    [
        (1, "single bits"),
        (32, "complex64"),
        (128, "RGB"),
        (1792, "complex128"),
        (2048, "complex256"),
        (2304, "RGBA"),
    ],
)
def test_samples_without_an_order_are_refused_by_name(scan: Path, code: int, name: str) -> None:
    """A colour is not more or less than another."""
    with pytest.raises(FieldError, match=f"samples are {name}"):
        read(patched(scan, DATATYPE, struct.pack("<h", code)))


@pytest.mark.parametrize(
    ("at", "value", "error", "said"),
    [
        (DATATYPE, struct.pack("<h", 999), InputError, "the sample type 999"),
        (DIM, struct.pack("<h", 0), InputError, "counts 0 axes"),
        (DIM, struct.pack("<h", 8), InputError, "counts 8 axes"),
        (DIM + 2, struct.pack("<h", 0), FieldError, "holds 0x5x6 samples"),
        (DIM + 4, struct.pack("<h", -5), InputError, "gives an axis -5 samples"),
        (
            DIM,
            struct.pack("<4h", 3, 10000, 10000, 10000),
            InputError,
            "ends early (592 of 2,000,000,000,352 bytes)",
        ),
        (DIM, struct.pack("<2h", 1, 4), FieldError, "holds 4x1x1 samples"),
        (VOX_OFFSET, struct.pack("<f", 100), InputError, "samples at byte 100"),
        (VOX_OFFSET, struct.pack("<f", np.nan), InputError, "samples at byte nan"),
        (VOX_OFFSET, struct.pack("<f", 360), InputError, "ends early (592 of 600 bytes)"),
        (MAGIC, b"n+3\0", InputError, "no magic"),
        (MAGIC, b"ni1\0", InputError, "no magic"),
        (0, struct.pack("<i", 349), InputError, "no known size"),
    ],
)
def test_a_lying_header_is_found_out(scan: Path, at: int, value: bytes, error: type[IsocoreError], said: str) -> None:
    """Each lie in one line."""
    with pytest.raises(error) as caught:
        read(patched(scan, at, value))
    assert said in str(caught.value) and str(caught.value).startswith(f"{scan}: ")


@pytest.mark.parametrize(
    ("image", "at", "form", "start"), [(nib.Nifti1Image, 108, "<f", 352), (nib.Nifti2Image, 168, "<q", 544)]
)
def test_samples_that_start_nowhere_start_behind_the_header(
    tmp_path: Path, image: Any, at: int, form: str, start: int
) -> None:
    """A stated start inside the header is refused."""
    path = tmp_path / "scan.nii"
    image(ramp(), AFFINE).to_filename(path)
    assert np.array_equal(volume_of(patched(path, at, struct.pack(form, 0))).samples, ramp())
    with pytest.raises(InputError, match=f"samples at byte {start - 1}, inside itself"):
        read(patched(path, at, struct.pack(form, start - 1)))


def test_a_promise_of_a_million_millions_costs_nothing(tmp_path: Path) -> None:
    """Packed, and by NIfTI-2, whose sizes have eight bytes."""
    image = nib.Nifti2Image(ramp(), AFFINE)
    image.to_filename(tmp_path / "scan.nii")
    patched(tmp_path / "scan.nii", 24, struct.pack("<3q", 10**4, 10**4, 10**4))
    import gzip

    packed = tmp_path / "scan.nii.gz"
    packed.write_bytes(gzip.compress((tmp_path / "scan.nii").read_bytes()))
    for path in (tmp_path / "scan.nii", packed):
        with pytest.raises(InputError, match=r"2,000,000,000,\d\d\d"):
            read(path)


def test_a_singular_sform_is_passed_over(scan: Path) -> None:
    """In favour of what the header says otherwise, with a warning."""
    volume = volume_of(patched(scan, SROW, bytes(48)))
    assert np.allclose(volume.spacing, (1.5, 2.0, 3.0))
    assert "sform is singular" in volume.warnings[0]


def test_an_axis_without_spacing_gets_one(scan: Path) -> None:
    """Zero and NaN are no lengths; a negative one is turned."""
    patched(scan, SFORM, bytes(2))
    volume = volume_of(patched(scan, PIXDIM + 4, struct.pack("<3f", 0, np.nan, -3)))
    assert volume.spacing == (1.0, 1.0, 3.0) and "without a spacing" in volume.warnings[0]


def test_more_than_four_axes_are_volumes_too(tmp_path: Path) -> None:
    """Counted with the fourth fastest."""
    samples = ramp((3, 3, 3, 2, 2))
    nib.Nifti1Image(samples, np.eye(4)).to_filename(tmp_path / "scan.nii.gz")
    assert count_volumes(tmp_path / "scan.nii.gz") == 4
    assert np.array_equal(volume_of(tmp_path / "scan.nii.gz", ReadOptions(volume=2)).samples, samples[..., 0, 1])


def test_extensions_are_stepped_over(tmp_path: Path) -> None:
    """Samples start where the header says, not where it ends."""
    image = nib.Nifti1Image(ramp(), AFFINE)
    image.header.extensions.append(nib.nifti1.Nifti1Extension("comment", b"a long remark" * 99))
    image.to_filename(tmp_path / "scan.nii")
    assert np.array_equal(volume_of(tmp_path / "scan.nii").samples, ramp())


def test_analyze_has_no_orientation(tmp_path: Path) -> None:
    """Its spacing is kept, its axes are its own, and the user is told."""
    image = nib.AnalyzeImage(ramp(), np.diag([-2.0, 3.0, 4.0, 1.0]))
    image.to_filename(tmp_path / "scan.img")
    volume = volume_of(tmp_path / "scan.hdr")
    assert np.array_equal(volume.samples, ramp())
    assert np.allclose(volume.affine, np.diag([2.0, 3.0, 4.0, 1.0])) and volume.space == "native"
    assert "state no orientation" in volume.warnings[0]


@pytest.mark.parametrize(
    ("fields", "scale"),
    [
        ({}, (1.0, 0.0)),
        ({"scl_slope": 2.5, "scl_inter": -7}, (2.5, -7.0)),
        ({"scl_slope": 2.5, "scl_inter": np.nan}, (2.5, 0.0)),
        ({"cal_max": 50, "cal_min": 10, "glmax": 100, "glmin": 20}, (0.5, 0.0)),
        ({"cal_max": np.inf, "cal_min": 10, "glmax": 100, "glmin": 20}, (1.0, 0.0)),
        ({"cal_max": 3e38, "cal_min": -3e38, "glmax": 2**31 - 1, "glmin": -(2**31)}, (1.0, 0.0)),
    ],
)
def test_analyze_is_scaled_as_spm_did(tmp_path: Path, fields: dict[str, float], scale: tuple[float, float]) -> None:
    """By slope and intercept, else by the calibrated range; nibabel's choice where it reads such a file."""
    image = nib.AnalyzeImage(ramp(), np.eye(4))
    image.to_filename(tmp_path / "scan.img")
    header = nib.Spm2AnalyzeHeader(image.header.binaryblock)
    for name, value in {"scl_slope": 0, **fields}.items():
        header[name] = value
    (tmp_path / "scan.hdr").write_bytes(header.binaryblock)
    volume = volume_of(tmp_path / "scan.hdr")
    assert (volume.slope, volume.intercept) == pytest.approx(scale, abs=1e-6)


def test_either_file_of_a_pair_may_be_missing(tmp_path: Path) -> None:
    """The message names the file that was asked for and the one that is not there."""
    path = save(tmp_path / "scan.hdr", ramp())
    (tmp_path / "scan.img").rename(tmp_path / "else.img")
    with pytest.raises(InputError, match=rf"^{path}: its samples are missing: no scan.img"):
        read(path)
    with pytest.raises(InputError, match=r"^.*else.img: its header is missing: no else.hdr"):
        read(tmp_path / "else.img")


def test_a_short_image_is_named(tmp_path: Path) -> None:
    """The header is whole, so the message says which file ends early."""
    path = save(tmp_path / "scan.hdr", ramp())
    (tmp_path / "scan.img").write_bytes(bytes(100))
    with pytest.raises(InputError, match=rf"^{path}: scan.img ends early \(100 of 240 bytes\)"):
        read(path)


def _binary128(value: float) -> bytes:
    mantissa, exponent = np.frexp(abs(value))
    fraction = int(mantissa * 2**53) * 2**60 - 2**112
    return ((int(value < 0) << 127) | (int(exponent) - 1 + 16383) << 112 | fraction).to_bytes(16, "little")


def test_quadruple_precision_becomes_double(tmp_path: Path) -> None:
    """IEEE binary128 in both byte orders, and what a PC calls long double."""
    values = np.array([1.0, -2.5, 1 / 3, 1e300, -1e-300, 7.0, 123456.789, 3.0])
    special = {
        bytes(16): 0.0,
        (0x7FFF << 112).to_bytes(16, "little"): np.inf,
        (0xFFFF << 112).to_bytes(16, "little"): -np.inf,
    }
    written = b"".join([_binary128(float(one)) for one in values] + list(special) * 8)[: 27 * 16]
    expected = np.concatenate([values, [*special.values()] * 8])[:27].reshape(3, 3, 3, order="F")
    for endian, content in (("<", written), (">", np.frombuffer(written, "V16").tobytes())):
        if endian == ">":
            content = b"".join(written[at : at + 16][::-1] for at in range(0, len(written), 16))
        assert np.array_equal(_read_float128(tmp_path, content, endian).samples, expected)
    if np.finfo(np.longdouble).nmant == 63:
        extended = expected.astype(np.longdouble).ravel(order="F")
        assert np.array_equal(_read_float128(tmp_path, extended.tobytes(), "<").samples, expected)


def _read_float128(folder: Path, content: bytes, endian: str) -> Volume:
    header = nib.Nifti1Header(endianness=endian)
    header["datatype"], header["bitpix"], header["dim"][:4], header["vox_offset"] = (
        1536,
        128,
        [3, 3, 3, 3],
        352,
    )
    header["magic"], header["sform_code"], header["srow_x"][0], header["srow_y"][1], header["srow_z"][2] = (
        b"n+1",
        1,
        1,
        1,
        1,
    )
    (folder / "quad.nii").write_bytes(header.binaryblock + bytes(4) + content)
    volume = volume_of(folder / "quad.nii")
    assert "float128" in volume.warnings[0] and volume.samples.dtype == np.float64
    return volume


@pytest.mark.parametrize(
    ("dtype", "low", "high", "becomes", "said"),
    [
        ("i8", -5, 2**31 - 1, "int32", ""),
        ("i8", 0, 2**32 - 1, "uint32", ""),
        ("i8", -1, 2**32, "float64", "every one is kept exactly"),
        ("u8", 0, 2**63, "float64", "rounded"),
    ],
)
def test_long_integers_go_where_they_fit(
    tmp_path: Path, dtype: str, low: int, high: int, becomes: str, said: str
) -> None:
    """Into four bytes, else into doubles with a warning."""
    samples = ramp(dtype=dtype)
    samples[0, 0, 0], samples[3, 4, 5] = low, high
    volume = volume_of(save(tmp_path / "scan.nii", samples))
    assert volume.samples.dtype == becomes and np.array_equal(volume.samples, samples.astype(becomes))
    assert said in "".join(volume.warnings) and bool(said) == bool(volume.warnings)
