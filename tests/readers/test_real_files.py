"""Every scan of the real data is read as other libraries read it, or refused for a reason that is true."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import nibabel as nib
import nrrd
import numpy as np
import numpy.typing as npt
import pytest
from scans import REAL_DATA

from isocore.errors import FieldError, InputError, IsocoreError, OptionError
from isocore.readers import ReadOptions, count_volumes, read, suffix_of
from isocore.volume import Volume

pytestmark = pytest.mark.skipif(not REAL_DATA.is_dir(), reason=f"no real data at {REAL_DATA}")

WITH_HEADER = (".nii", ".nii.gz", ".hdr", ".hdr.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".mgz", ".mgh")
FOUND = [path.relative_to(REAL_DATA) for path in REAL_DATA.rglob("*") if suffix_of(path) in WITH_HEADER]
SCANS = sorted(path.as_posix() for path in FOUND)

#: What is refused even with a volume chosen: the error, and what the message says, which was checked by hand.
REFUSED: dict[str, tuple[type[IsocoreError], str]] = {
    "broken/empty.nii.gz": (InputError, "is empty"),
    "broken/nifti-rs-fuzz/crash-1.nii": (InputError, "no known size"),
    "broken/nifti-rs-fuzz/crash-ed7d46344d7efb3b9f0c374d66d2e02f66cc447d.nii": (InputError, "no known size"),
    "broken/not-nifti.nii": (InputError, "no known size"),
    "cases/07-pointer-files/annex.nii.gz": (InputError, "is a git-annex pointer"),
    "cases/07-pointer-files/lfs.nii.gz": (InputError, "is a git-lfs pointer"),
    "cases/07-pointer-files/lfs.nrrd": (InputError, "is a git-lfs pointer"),
    "cases/fuzz-12-small-files-much-work/axes.nrrd": (InputError, "counts 18,000 axes"),
    "cases/fuzz-12-small-files-much-work/bz_more.nrrd": (InputError, "of bzip2 hold at most"),
    "cases/fuzz-12-small-files-much-work/bz_skip.nrrd": (InputError, "check its byte skip"),
    "cases/fuzz-12-small-files-much-work/num.nhdr": (InputError, "no x1.raw beside it"),
    "volumes/nibabel/analyze.hdr": (InputError, "no analyze.img beside it"),
    "volumes/nibabel/nifti1.hdr": (InputError, "no nifti1.img beside it"),
    "volumes/nibabel/nifti2.hdr": (InputError, "no nifti2.img beside it"),
    "volumes/nibabel/row_major.dconn.nii": (FieldError, "holds 1x1x1 samples"),
    "volumes/nifti-reader-js/5D_small.nii": (FieldError, "holds 1x2x3 samples"),
    "volumes/nifti-reader-js/not-nifti.nii": (InputError, "no known size"),
    "volumes/nifti-rs/avg152T1_LR_nifti.hdr.gz": (InputError, "no avg152T1_LR_nifti.img.gz beside it"),
    "volumes/nifti-rs/complex/complex32.nii": (FieldError, "samples are complex64"),
    "volumes/nifti-rs/complex/complex64.nii": (FieldError, "samples are complex128"),
    "volumes/nifti-rs/minimal_extended_hdr.nii": (FieldError, "holds 8x8x1 samples"),
    "volumes/nifti-rs/rgb/3D.nii": (FieldError, "samples are RGB colours"),
    "volumes/nifti-rs/rgb/4D.nii": (FieldError, "samples are RGB colours"),
    "volumes/nifti-rs/rgba/4D.nii": (FieldError, "samples are RGBA colours"),
    "volumes/nrrd.jl/headers/test2d_spu_spacing_labels.nhdr": (FieldError, "holds 5x6 samples"),
    "volumes/nrrd.jl/headers/test2dfloat.nhdr": (FieldError, "holds 5x6 samples"),
    "volumes/nrrd.jl/headers/test2drgb.nhdr": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/headers/test2drgb_last.nhdr": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/headers/test2drgb_spu_sd.nhdr": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/headers/test2drgb_spu_spacing.nhdr": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/headers/test2drgb_spu_spacing_labels.nhdr": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/headers/test2duchar.nhdr": (FieldError, "holds 5x6 samples"),
    "volumes/nrrd.jl/headers/test2dushort.nhdr": (FieldError, "holds 5x6 samples"),
    "volumes/nrrd.jl/headers/test3d_time.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/headers/test3d_time_labels.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/headers/test3d_time_labels_units.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/headers/test3d_time_labels_units_s.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/headers/test3d_units_range_axes.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/headers/test3dlist_origin.nhdr": (InputError, "no dummy.raw beside it"),
    "volumes/nrrd.jl/io/bswap.nrrd": (FieldError, "holds 2x2 samples"),
    "volumes/nrrd.jl/io/eltype_gray_u12.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/nrrd.jl/io/eltype_gray_u12_hex.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/nrrd.jl/io/eltype_gray_u16.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/nrrd.jl/io/eltype_gray_u8.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/nrrd.jl/io/eltype_rgb_u8.nrrd": (FieldError, "samples are RGB colours"),
    "volumes/nrrd.jl/io/eltype_u8.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/nrrd.jl/io/eltype_uint8.nrrd": (FieldError, "holds 3x5 samples"),
    "volumes/odd/complex_image.nii.gz": (FieldError, "samples are complex64"),
    "volumes/pynrrd/BallBinary30x30x30_byteskip_minus_five.nhdr": (InputError, "skips 0 lines and -5 bytes"),
    "volumes/pynrrd/test1d_ascii.nrrd": (FieldError, "holds 27 samples"),
    "volumes/pynrrd/test2d_ascii.nrrd": (FieldError, "holds 3x9 samples"),
    "volumes/pynrrd/test_customFields.nrrd": (FieldError, "holds 27 samples"),
    "volumes/pynrrd/test_simple4d_raw.nrrd": (FieldError, "holds 1x1x1 samples"),
}
READ = [scan for scan in SCANS if scan not in REFUSED]

#: Its pixdim and its sform contradict each other, and the sform goes first.
OWN_WAY = ("cases/fuzz-04-huge-spacing-html/b_huge.nii",)

#: Files of several volumes, and which axis tells them apart.
SEVERAL = {
    "volumes/nibabel/example4d.nii.gz": (2, 3),
    "volumes/nibabel/example_nifti2.nii.gz": (2, 3),
    "volumes/nibabel/functional.nii": (20, 3),
    "volumes/nibabel/test.mgz": (2, 3),
    "volumes/nifti-reader-js/5D_zeros.nii.gz": (3, 4),
    "volumes/nrrd.jl/io/small_time.nrrd": (5, 3),
    "volumes/nrrd.jl/io/test_helix.nrrd": (7, 0),
}


@pytest.mark.parametrize("scan", SCANS)
def test_a_scan_is_read_or_refused_by_one_line(scan: str) -> None:
    """Neither more nor fewer are refused than the table says, nor for another reason."""
    path = REAL_DATA / scan
    if scan in SEVERAL:
        with pytest.raises(OptionError, match=f"^{path}: holds {SEVERAL[scan][0]} volumes"):
            read(path)
    try:
        read(path, ReadOptions(volume=0))
    except IsocoreError as error:
        assert scan in REFUSED, str(error)
        assert type(error) is REFUSED[scan][0] and REFUSED[scan][1] in str(error)
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error)
    else:
        assert scan not in REFUSED


@pytest.mark.parametrize("scan", [scan for scan in READ if ".nii" in scan or ".hdr" in scan])
def test_nifti_is_read_as_nibabel_reads_it(scan: str) -> None:
    """Values, scale and place; where no orientation is stated, nibabel guesses one and we do not."""
    image: Any = _loaded(REAL_DATA / scan)
    stored = image.dataobj.get_unscaled()
    for volume, field in _volumes(scan):
        expected = stored.reshape((*stored.shape[:3], -1), order="F")[..., volume]
        assert np.array_equal(field.samples, expected, equal_nan=True)
        assert (field.slope, field.intercept) == (image.dataobj.slope, image.dataobj.inter)
        factor = {1: 1000.0, 3: 0.001}.get(int(image.header["xyzt_units"]) & 7, 1.0)
        if not any("no orientation" in warning for warning in field.warnings):
            assert np.allclose(field.affine[:3], image.affine[:3] * factor, rtol=1e-6, atol=2e-6)
        if scan not in OWN_WAY:
            assert np.allclose(field.spacing, np.array(image.header.get_zooms()[:3]) * factor, rtol=1e-4)


@pytest.mark.parametrize(
    "scan", [scan for scan in READ if "nii" not in scan and "hdr.gz" not in scan and "nrrd" in scan]
)
def test_nrrd_is_read_as_pynrrd_reads_it(scan: str) -> None:
    """Values and place; where pynrrd refuses a surplus of bytes, we warn of it."""
    head = nrrd.read_header(str(REAL_DATA / scan))
    for volume, field in _volumes(scan):
        if scan.endswith("30_nifti.nhdr"):
            assert "has 352 bytes more" in field.warnings[0]
            continue
        stored = nrrd.read(str(REAL_DATA / scan), index_order="F")[0]
        if scan in SEVERAL:
            stored = np.take(stored, volume, axis=SEVERAL[scan][1])
        assert np.array_equal(field.samples, stored, equal_nan=True) and not field.warnings
        factor = {"microns": 0.001, "m": 1000.0}.get((head.get("space units") or [""])[0], 1.0)
        assert np.allclose(field.affine[:3, :3], _directions(head) * factor)
        assert np.allclose(field.affine[:3, 3], head.get("space origin", np.zeros(3)) * factor)
        named = {"left-posterior-superior": "lps", "right-anterior-superior": "ras"}
        assert field.space == named.get(head.get("space", ""), "native")


def test_one_scan_in_two_formats_is_one_scan() -> None:
    """FLAIR as NIfTI (RAS) and as NRRD (LPS): the same samples, the same place."""
    first, second = (
        read(REAL_DATA / "volumes/stroke/FLAIR.nii.gz"),
        read(REAL_DATA / "volumes/stroke/FLAIR.nrrd"),
    )
    assert isinstance(first, Volume) and isinstance(second, Volume)
    assert np.array_equal(first.samples, second.samples)
    turned = np.diag([-1.0, -1.0, 1.0, 1.0]) @ second.affine
    assert (first.space, second.space) == ("ras", "lps") and np.allclose(first.affine, turned, atol=1e-4)


@pytest.mark.parametrize("fuzzed", sorted(path.name for path in (REAL_DATA / "broken/nifti-rs-fuzz").glob("*")))
def test_fuzzed_files_are_refused_under_any_name(tmp_path: Path, fuzzed: str) -> None:
    """They once crashed another reader."""
    for suffix in WITH_HEADER:
        path = tmp_path / f"scan{suffix}"
        shutil.copyfile(REAL_DATA / "broken/nifti-rs-fuzz" / fuzzed, path)
        with pytest.raises(IsocoreError, match=f"^{path}: "):
            read(path)
        path.unlink()


@pytest.mark.parametrize(
    ("name", "shape", "dtype"),
    [
        ("volumes/raw/Head_U16_X128_Y128_Z64.binary", (128, 128, 64), "uint16"),
        ("volumes/raw/Molecule_U8_X100_Y100_Z120.binary", (100, 100, 120), "uint8"),
    ],
)
def test_raw_samples_are_read_as_described(tmp_path: Path, name: str, shape: tuple[int, ...], dtype: str) -> None:
    """Without one byte too few or too many."""
    path = tmp_path / "scan.raw"
    shutil.copyfile(REAL_DATA / name, path)
    field = read(path, ReadOptions(shape=shape, dtype=dtype))
    assert isinstance(field, Volume) and not field.warnings
    assert np.array_equal(field.samples.ravel(order="F"), np.fromfile(path, dtype))


def _volumes(scan: str) -> list[tuple[int, Volume]]:
    """The first two volumes of a scan, numbered."""
    path, fields = REAL_DATA / scan, []
    for volume in range(min(2, count_volumes(path))):
        field = read(path, ReadOptions(volume=volume))
        assert isinstance(field, Volume)
        fields.append((volume, field))
    return fields


def _loaded(path: Path) -> Any:
    """By nibabel, which does not look for a packed image beside a plain header."""
    if path.name == "minimal2.hdr":
        path = path.with_name("minimal.hdr")
    return nib.load(path)


def _directions(head: dict[str, Any]) -> npt.NDArray[np.float64]:
    stated = head.get("space directions")
    if stated is None:
        return np.diag(head.get("spacings", np.ones(3))[:3])
    return np.array([row for row in stated if not np.isnan(row).any()]).T
