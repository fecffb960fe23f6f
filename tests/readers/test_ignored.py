"""`--ignore VALUE`: samples that mean "nothing here" are outside, as NaN is."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.info import info
from small_files import ball, write_nifti
from vtu_files import Mesh
from vtu_files import write as write_vtu

from isocore import Options, extract
from isocore.histogram import histogram
from isocore.isovalue import percentile
from isocore.readers import ReadOptions, read
from isocore.readers.ignored import without_ignored
from isocore.volume import Volume


def scan(dtype: str, fill: float) -> npt.NDArray[Any]:
    """A ball with a slab and some single samples of `fill` in it."""
    samples = ball(dtype="float64").astype(dtype)
    samples[:, :, :5] = fill
    samples[::3, 5, 6] = fill
    return np.asfortranarray(samples)


def run(*arguments: object) -> Result:
    command, *others = map(str, arguments)
    return CliRunner().invoke(info if command == "info" else convert, others)


@pytest.mark.parametrize("cap", [False, True])
@pytest.mark.parametrize("backend", ["asc", "mc", "thinning"])
@pytest.mark.parametrize(
    ("dtype", "fill", "becomes"),
    [
        ("uint8", 255, "float32"),
        ("int8", -128, "float32"),
        ("uint16", 65535, "float32"),
        ("int16", -32768, "float32"),
        ("int16", 0, "float32"),
        ("uint32", 2**32 - 1, "float32"),
        ("int32", -(2**31), "float32"),
        ("float32", 1e20, "float32"),
        ("float64", -1.7976931348623157e308, "float64"),
    ],
)
def test_an_ignored_sample_is_as_nan(dtype: str, fill: float, becomes: str, backend: str, cap: bool) -> None:
    """Every backend draws the surface of the same samples with NaN there, to the last bit."""
    samples = scan(dtype, fill)
    with_nan = np.where(samples == samples[0, 0, 0], np.nan, samples.astype(np.float64)).astype(becomes)
    wanted = extract(Volume(np.asfortranarray(with_nan)), 50.0, backend=backend, options=Options(cap=cap))
    volume = without_ignored(Volume(samples.copy(order="F")), [fill])
    found = extract(volume, 50.0, backend=backend, options=Options(cap=cap))
    assert volume.samples.dtype == becomes and len(found.triangles) > 50
    assert np.array_equal(found.vertices, wanted.vertices) and np.array_equal(found.triangles, wanted.triangles)
    assert volume.ignored == np.count_nonzero(samples == samples[0, 0, 0]) and not volume.warnings


def test_wide_integers_stay_exact() -> None:
    """Ids of nine digits, which float32 would round, become float64; those that are ignored do not count."""
    samples = np.asfortranarray(np.full((2, 2, 2), 614_454_277, np.uint32))
    samples[0, 0, 0] = 0
    volume = without_ignored(Volume(samples), [0])
    assert volume.samples.dtype == np.float64 and volume.samples[1, 1, 1] == 614_454_277


def test_a_scaled_value_is_named_as_info_shows_it() -> None:
    """With slope and intercept, of integers and floats; a shorter text names the nearest integer."""
    stored = np.asfortranarray(np.arange(8).reshape(2, 2, 2))
    for dtype in ("int16", "float32", "float64"):
        volume = Volume(stored.astype(dtype, order="F"), slope=2.008, intercept=-0.1)
        named = without_ignored(replace(volume, samples=volume.samples.copy(order="F")), [volume.scaled(3)])
        assert named.ignored == 1 and np.isnan(named.samples[0, 1, 1])
    assert without_ignored(Volume(stored.astype(np.int16, order="F"), slope=1 / 3), [0.333333]).ignored == 1


def test_a_value_is_rounded_as_float32_samples_are() -> None:
    """1e20 and 0.1 are no float32, and yet name one."""
    samples = np.asfortranarray(np.array([0.1, 1e20, 5, 6, 7, 8, 9, -3.4028235e38], np.float32).reshape(2, 2, 2))
    assert without_ignored(Volume(samples), [0.1, 1e20, -3.4028235e38]).ignored == 3


def test_a_value_that_no_sample_has_is_told() -> None:
    """And the samples stay what they are, in their type."""
    samples = np.asfortranarray(np.arange(8, dtype=np.uint8).reshape(2, 2, 2))
    infinite = np.asfortranarray(np.full((2, 2, 2), np.inf, np.float32))
    assert without_ignored(Volume(infinite), [1e300]).ignored == 0
    for value in (99, 0.5, 1e300, -1):
        volume = without_ignored(Volume(samples), [value])
        assert volume.samples is samples and "which --ignore names" in volume.warnings[0]


def test_ignored_samples_are_in_no_statistics(tmp_path: Path) -> None:
    """Percentiles, range and histogram are those of the others; the report counts them apart from NaN."""
    samples = scan("float32", 1e20)
    samples[0, 0, 11] = np.nan
    path = write_nifti(tmp_path / "ball.nii", samples)
    volume = read(path, ReadOptions(ignore=(1e20,)))
    kept = samples[np.isfinite(samples) & (samples < 1e19)].astype(np.float64)
    assert percentile(histogram(volume), 30) == np.percentile(kept, 30)
    result = run("info", path, "--ignore", "1e20")
    assert "ignored" in result.output and "1e+20" not in result.output


def test_convert_says_what_was_ignored(tmp_path: Path) -> None:
    """In the report, as a count and among the options; a stamp tells other values apart."""
    path = write_nifti(tmp_path / "ball.nii", scan("int16", -9999))
    out, report = tmp_path / "ball.ply", tmp_path / "run.json"
    arguments = ["convert", path, "-i", "50", "-o", out, "--report", report, "--if-changed"]
    statuses = ("done", "skipped", "done", "skipped", "done")
    for values, status in zip(([-9999], [-9999], [], [], [-9999, 0]), statuses, strict=True):
        result = run(*arguments, *(part for value in values for part in ("--ignore", value)))
        assert result.exit_code == 0
        (record,) = json.loads(report.read_text())["outputs"]
        assert record["status"] == status
        assert record["ignored"] == (0 if not values else pytest.approx(record["ignored"])) and record["nonfinite"] == 0
        assert record["options"].get("ignore") == (values or None)
    assert record["ignored"] == np.count_nonzero(np.isin(scan("int16", -9999), [-9999, 0]))


@pytest.mark.parametrize("backend", ["mc", "thinning"])
def test_an_ignored_point_of_a_mesh_is_as_nan(tmp_path: Path, backend: str) -> None:
    """A sheet of points through a ball; the same surface, to the last bit."""
    n = 7
    points = np.stack(np.meshgrid(*3 * [np.arange(float(n))], indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(n**3).reshape(n, n, n)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexes = np.stack([number[i : n - 1 + i, j : n - 1 + j, k : n - 1 + k].ravel() for i, j, k in corners], axis=1)
    cells = [(12, cell.tolist()) for cell in hexes]
    heights = 10 - ((points - 3) ** 2).sum(axis=1)
    surfaces = []
    for fill, ignore in ((np.nan, ()), (-9999.0, (-9999.0,)), (1e20, (1e20,))):
        values = np.where(points[:, 0] == 3, fill, heights)
        path = write_vtu(tmp_path / "mesh.vtu", Mesh(points, cells, {"u": values}))
        mesh = read(path, ReadOptions(ignore=ignore))
        assert mesh.ignored == (n * n if ignore else 0)
        surfaces.append(extract(mesh, 3.5, backend=backend))
    assert len(surfaces[0].triangles) > 20
    for other in surfaces[1:]:
        assert np.array_equal(other.vertices, surfaces[0].vertices)
        assert np.array_equal(other.triangles, surfaces[0].triangles)
    assert "which --ignore names" in read(path, ReadOptions(ignore=(7.25,))).warnings[-1]


@pytest.mark.parametrize("value", ["nan", "inf", "nothing"])
def test_only_a_number_is_ignored(tmp_path: Path, value: str) -> None:
    """What is not finite counts as outside anyway: refused before any work."""
    assert run("convert", write_nifti(tmp_path / "ball.nii", ball()), "--ignore", value).exit_code == 2
