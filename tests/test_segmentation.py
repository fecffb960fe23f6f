"""Masks and label maps under one isovalue: a warning that names what to ask for instead."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.info import info
from small_files import ball, write_nifti

from isocore.choices import Number
from isocore.histogram import histogram
from isocore.isovalue import Chosen
from isocore.readers import read
from isocore.segmentation import isovalue_warnings, label_count
from isocore.volume import Volume

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
LABELS = ("julich_lh_207.nii.gz", "totalsegmentator_42.nii.gz", "totalsegmentator_dicom_32.nii.gz")
IMAGES = ("ct/example_ct_sm.nii.gz", "seg3d/tooth.nhdr", "nifti_space/SPL.nii.gz", "nifti-rs/minimal.nii.gz")


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def labels_of(samples: npt.NDArray[Any], **scale: float) -> int:
    volume = Volume(np.asfortranarray(samples), **scale)
    return label_count(volume, histogram(volume))


def regions(dtype: str, numbers: list[int]) -> npt.NDArray[Any]:
    """(24, 24, 24): cubes of labels in a background of 0."""
    samples = np.zeros((24, 24, 24), dtype)
    for place, number in enumerate(numbers):
        i, j, k = (2 + 7 * (place // 3**axis % 3) for axis in range(3))
        samples[i : i + 6, j : j + 6, k : k + 6] = number
    return samples


@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "float32", "float64"])
def test_regions_of_whole_numbers_are_labels(dtype: str) -> None:
    """Whatever the type they are stored in; the background counts as one of the values."""
    assert labels_of(regions(dtype, [1, 2])) == 3
    assert labels_of(regions(dtype, [3, 7, 12, 40, 41, 100, 9, 55])) == 9


def test_labels_of_nine_digits_are_labels() -> None:
    """Atlas ids lie in no exact histogram."""
    assert labels_of(regions("uint32", [614_454_277, 997, 312_782_546, 3])) == 5


@pytest.mark.parametrize(
    "samples",
    [
        ball(24, dtype="uint8"),
        np.random.default_rng(0).integers(0, 4, (24, 24, 24), dtype=np.uint8),
        regions("uint8", [1]),
        regions("float32", [1, 2, 3]) + np.float32(0.5),
        np.zeros((24, 24, 24), np.uint8),
        np.repeat(np.repeat(np.arange(24, dtype=np.uint8)[:, None, None], 24, 1), 24, 2),
        (np.add.outer(np.add.outer(np.arange(24), np.arange(24)), np.arange(24)) // 7).astype(np.uint8),
    ],
    ids=["image", "noise", "mask", "no whole numbers", "constant", "ramp", "few grey levels"],
)
def test_other_fields_are_no_labels(samples: npt.NDArray[Any]) -> None:
    """Images change from sample to sample, masks have two values, grey levels follow each other."""
    assert labels_of(samples) == 0


@pytest.mark.skipif(not DATA.is_dir(), reason="needs ../shared/data beside the checkout")
def test_real_label_maps_are_told_from_real_images() -> None:
    """Atlases and segmentations of organs; CT, MR and an index drawn as an image."""
    for name in LABELS:
        volume = read(DATA / "labels" / name)
        assert isinstance(volume, Volume) and label_count(volume, histogram(volume)) > 30, name
    for name in IMAGES:
        volume = read(DATA / "volumes" / name)
        assert isinstance(volume, Volume) and label_count(volume, histogram(volume)) == 0, name


def test_a_label_map_under_one_isovalue_is_warned_of(tmp_path: Path) -> None:
    """Given or chosen; `info` says that it looks like one."""
    path = write_nifti(tmp_path / "labels.nii", regions("uint8", [1, 2, 5]))
    for isovalue in ("1.5", "otsu", "auto"):
        assert "look like labels (4 values" in run(path, "-i", isovalue, "-o", tmp_path / "out.ply").stderr
    assert "looks like a label map" in CliRunner().invoke(info, [str(path)]).stdout
    assert "labels" not in run(write_nifti(tmp_path / "ball.nii", ball()), "-i", 50, "-o", tmp_path / "out.ply").stderr


@pytest.mark.parametrize(
    ("low", "high", "isovalue", "says"),
    [
        (0, 1, 1.0, "samples that are 1, so that it encloses too little: -i 0.5 lies midway"),
        (0, 1, 0.95, "too little: -i 0.5 lies midway"),
        (0, 1, 0.01, "samples that are 0, so that it encloses too much: -i 0.5 lies midway"),
        (0, 255, 255.0, "too little: -i 127.5 lies midway"),
        (3, 4, 4.0, "too little: -i 3.5 lies midway"),
        (0, 1, 0.5, ""),
        (0, 1, 0.3, ""),
        (0, 1, 0.0, ""),
        (0, 1, 1.5, ""),
    ],
)
def test_the_end_of_a_mask_is_warned_of(low: int, high: int, isovalue: float, says: str) -> None:
    """Not beyond the ends, where there is no surface at all."""
    mask = np.where(ball() > 50, high, low).astype(np.int16)
    chosen = Chosen(Number(isovalue, str(isovalue)), isovalue, "given")
    found = isovalue_warnings(chosen, histogram(Volume(np.asfortranarray(mask))), 0)
    assert says in found[0] if says else found == ()


def test_a_masks_isovalue_counts_as_scaled(tmp_path: Path) -> None:
    """Stored 0 and 1, values 10 and 8: 10 is the upper end, as the header's slope has it."""
    path = write_nifti(tmp_path / "mask.nii", (ball() > 50).astype(np.uint8), slope=-2.0, intercept=10.0)
    assert "encloses too little: -i 9 lies midway" in run(path, "-i", 10, "-o", tmp_path / "out.ply").stderr


def test_an_isovalue_beyond_a_mask_names_its_middle(tmp_path: Path) -> None:
    """-i 0 on a mask of 0 and 1 has no surface."""
    path = write_nifti(tmp_path / "mask.nii", (ball() > 50).astype(np.uint8))
    assert "the samples are 0 or 1, so ask for -i 0.5" in run(path, "-i", 0, "-o", tmp_path / "out.ply").stderr
