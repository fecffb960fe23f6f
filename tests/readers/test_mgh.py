"""FreeSurfer's volumes, as nibabel reads them."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
from scans import AFFINE, REAL_DATA, patched, ramp, save

from isocore.errors import IsocoreError
from isocore.readers import ReadOptions, count_volumes, read
from isocore.volume import Volume


def volume(path: Path, frame: int | None = None) -> Volume:
    found = read(path, ReadOptions(volume=frame))
    assert isinstance(found, Volume)
    return found


def loaded(path: Path) -> nib.MGHImage:
    """By nibabel, which of a path leaves its file open."""
    content = path.read_bytes()
    return nib.MGHImage.from_bytes(gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content)


@pytest.mark.parametrize("suffix", [".mgz", ".mgh"])
@pytest.mark.parametrize("dtype", ["u1", "i2", "i4", "f4"])
def test_the_world_is_the_scanners_ras_in_millimetres(tmp_path: Path, suffix: str, dtype: str) -> None:
    """Samples and affine are nibabel's."""
    path = save(tmp_path / f"scan{suffix}", ramp(dtype=dtype))
    found, image = volume(path), loaded(path)
    assert (found.space, found.unit, found.samples.dtype) == ("ras", "mm", np.dtype(dtype))
    assert np.array_equal(found.samples, np.asarray(image.dataobj))
    assert np.allclose(found.affine, AFFINE, atol=1e-5) and np.allclose(found.affine, image.affine, atol=1e-5)


def test_a_header_without_a_place_is_a_coronal_scan(tmp_path: Path) -> None:
    """As FreeSurfer and nibabel have it, with a warning."""
    path = patched(save(tmp_path / "scan.mgh", ramp()), 28, struct.pack(">h", 0))
    found = volume(path)
    assert np.allclose(found.affine, loaded(path).affine) and "states no orientation" in found.warnings[0]


def test_frames_are_volumes(tmp_path: Path) -> None:
    """One after the other."""
    samples = ramp((4, 5, 6, 3), "f4")
    path = save(tmp_path / "scan.mgz", samples)
    assert count_volumes(path) == 3 and np.array_equal(volume(path, 2).samples, samples[..., 2])


def test_unsigned_shorts_of_newer_versions_are_read(tmp_path: Path) -> None:
    """Type 10, which nibabel does not know."""
    samples = ramp(dtype="u2") + np.uint16(40_000)
    path = patched(save(tmp_path / "scan.mgh", samples.view("i2")), 20, struct.pack(">i", 10))
    assert np.array_equal(volume(path).samples, samples)


@pytest.mark.parametrize(
    ("at", "value", "said"),
    [
        (0, b"\0\0\0\2", "version 2, not 1"),
        (4, b"\xff\xff\xff\xff", "an axis of -1 samples"),
        (4, b"\0\0\0\1", "holds 1x5x6 samples"),
        (4, b"\x7f\0\0\0", "ends early"),
        (16, b"\0\0\0\0", "holds 0 volumes"),
        (20, b"\0\0\0\x09", "FreeSurfer's type 9"),
        (30, b"\x7f\xc0\0\0", "a place that is no number"),
        (30, b"\0\0\0\0", "affine is singular"),
    ],
)
def test_a_damaged_header_is_refused_by_one_line(tmp_path: Path, at: int, value: bytes, said: str) -> None:
    """It says what is wrong; packed or not."""
    path = patched(save(tmp_path / "scan.mgh", ramp()), at, value)
    packed = tmp_path / "scan.mgz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        with pytest.raises(IsocoreError) as caught:
            read(file)
        assert str(caught.value).startswith(f"{file}: ") and "\n" not in str(caught.value)
        assert said in str(caught.value) or (said == "ends early" and "hold at most" in str(caught.value))


@pytest.mark.skipif(not REAL_DATA.is_dir(), reason=f"no real data at {REAL_DATA}")
def test_a_real_file_is_read_as_nibabel_reads_it() -> None:
    """Both of its frames, to the last bit."""
    path = REAL_DATA / "volumes" / "nibabel" / "test.mgz"
    image = loaded(path)
    for frame in range(2):
        found = volume(path, frame)
        assert np.array_equal(found.samples, np.asarray(image.dataobj)[..., frame])
        assert np.allclose(found.affine, image.affine, atol=1e-5)
