"""isocore from Python: the page's examples, keywords, other libraries' objects, and a batch."""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import io
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from small_files import ball, write_nifti

import isocore
from isocore.api import extract
from isocore.errors import FieldError, IsocoreError, OptionError
from isocore.job import Options
from isocore.many import convert_files
from isocore.report import RunReport, load_report
from isocore.surface import Surface
from isocore.volume import Volume

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "python.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
NEEDS = "trimesh"


@pytest.fixture
def volume() -> Volume:
    return Volume.from_array(ball(16, radius=5), spacing=(1, 2, 3), origin=(5, 0, 0), space="ras", unit="mm")


def test_the_pages_examples_print_what_they_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In their order, in one session; those that need a library are left out where it is not installed."""
    (tmp_path / "sample_volumes").symlink_to(ROOT / "sample_volumes")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    assert len(BLOCKS) >= 6 and sum("#> " in block for block in BLOCKS) >= 5
    for block in BLOCKS:
        if NEEDS in block and importlib.util.find_spec(NEEDS) is None:
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, str(PAGE), "exec"), names)
        assert printed.getvalue().splitlines() == re.findall(r"^#> (.*)$", block, re.MULTILINE)


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_a_users_script_passes_mypy_strict(tmp_path: Path) -> None:
    """The page's examples as one file, checked as any user's own."""
    script = tmp_path / "script.py"
    script.write_text("\n".join(BLOCKS), encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file", "", "--cache-dir", ".cache", script.name]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    missing = [line for line in done.stdout.splitlines() if "error" in line and "trimesh" not in line]
    assert not [line for line in missing if not line.startswith("Found")], done.stdout + done.stderr


def test_a_notebooks_day() -> None:
    """An array in, a surface out, and trimesh finds the volume that we find."""
    trimesh = pytest.importorskip("trimesh")
    x, y, z = np.mgrid[-1:1:40j, -1:1:40j, -1:1:40j]
    volume = Volume.from_array(1 - np.sqrt(x**2 + y**2 + z**2), spacing=2 / 39, origin=(-1, -1, -1), unit="mm")
    surface = extract(volume, 0.25, max_error=0.1, threads=2)
    mesh = surface.to_trimesh()
    ours = isocore.measure(surface)
    assert isinstance(mesh, trimesh.Trimesh) and mesh.is_watertight and mesh.units == "mm"
    assert mesh.volume == pytest.approx(ours.volume, rel=1e-6) and mesh.area == pytest.approx(ours.area, rel=1e-6)
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 0.75**3, rel=0.02)


def test_keywords_are_the_options(volume: Volume) -> None:
    """Each option of an extraction is a keyword of extract, and does the same; angles are what reports ask for."""
    keywords = inspect.signature(extract).parameters
    assert {item.name for item in fields(Options)} - {"background", "angles"} <= keywords.keys()
    assert {item.name for item in fields(Options)} - {"angles"} <= inspect.signature(convert_files).parameters.keys()
    by_name = extract(volume, 45, max_error=0.1, block_size=4, threads=2)
    by_object = extract(volume, 45, options=Options(max_error="0.1", block_size=4))  # type: ignore[arg-type]
    assert np.array_equal(by_name.vertices, by_object.vertices)
    assert len(by_name.triangles) != len(extract(volume, 45, max_error="none").triangles)
    assert extract(volume, 45, normals=True).normals is not None and extract(volume, 45).normals is None
    assert isocore.measure(extract(volume, 20, cap=True)).watertight
    smooth, rough = (extract(volume, 45, smooth=rounds, backend="mc") for rounds in (10, 0))
    assert not np.array_equal(smooth.vertices, rough.vertices)
    assert np.array_equal(smooth.vertices, extract(volume, 45, smooth=10).vertices)


@pytest.mark.parametrize("isovalue", ["otsu", "auto", "p90", "45.5", 45.5, 45, np.float32(45.5), np.int16(45)])
def test_an_isovalue_is_a_number_or_a_text(volume: Volume, isovalue: float | str) -> None:
    """Of any kind of number."""
    assert len(extract(volume, isovalue).triangles) > 0


def test_an_isovalue_as_text_is_the_number_behind_it(volume: Volume) -> None:
    """The text chooses it from the samples."""
    mask = Volume.from_array(np.asarray(volume.samples) > 45)
    assert np.array_equal(extract(mask).vertices, extract(mask, 0.5).vertices)


@pytest.mark.parametrize(
    ("arguments", "begin"),
    [
        ({"isovalue": "loud"}, "isovalue loud: "),
        ({"isovalue": float("nan")}, "isovalue: "),
        ({"isovalue": "10:20:3"}, "isovalue 10:20:3: "),
        ({"isovalue": [1, 2]}, "isovalue: "),
        ({"backend": "fast"}, "fast: no such backend"),
        ({"max_error": -1}, "max_error: "),
        ({"max_error": "-1"}, "max_error -1: "),
        ({"block_size": 3}, "block_size 3: "),
        ({"block_size": 4, "backend": "mc"}, "block_size: is not an option of mc"),
        ({"topology": "trilinear"}, "topology: is not an option of asc"),
        ({"threads": 0}, "threads: "),
        ({"smooth": -1}, "smooth: "),
        ({"field": np.zeros((2, 2, 2))}, "field: is a ndarray"),
    ],
)
def test_an_error_names_the_argument(volume: Volume, arguments: dict[str, object], begin: str) -> None:
    """As Python spells it."""
    with pytest.raises((OptionError, FieldError)) as caught:
        extract(**{"field": volume, "isovalue": 45.0, **arguments})  # type: ignore[arg-type]
    assert str(caught.value).startswith(begin) and "--" not in str(caught.value)


def test_meshio_gets_the_surface_in_the_world(volume: Volume) -> None:
    """Normals as point data; the arrays are its own."""
    surface = extract(volume, 45, normals=True)
    mesh = surface.to_meshio()
    assert np.array_equal(mesh.points, surface.vertices) and np.array_equal(mesh.cells[0].data, surface.triangles)
    assert np.array_equal(mesh.point_data["Normals"], surface.normals)
    mesh.points[:] = 0
    assert surface.vertices.any()


def test_an_offset_is_added_again() -> None:
    """Other libraries know of none; the sum is made in float64."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    surface = Surface(corners, np.array([[0, 1, 2]], np.int32), offset=(448000.25, 5412000.5, 0.0))
    assert np.array_equal(surface.to_meshio().points, corners.astype(np.float64) + surface.offset)
    assert np.array_equal(surface.world_vertices[0], [448000.25, 5412000.5, 0])


def test_pyvista_gets_triangles(volume: Volume) -> None:
    """As many as there are, with normals."""
    pyvista = pytest.importorskip("pyvista")
    surface = extract(volume, 45, normals=True)
    mesh = surface.to_pyvista()
    assert isinstance(mesh, pyvista.PolyData) and mesh.n_cells == len(surface.triangles) and mesh.is_all_triangles
    assert mesh.volume == pytest.approx(isocore.measure(surface).volume, rel=1e-5)
    assert np.array_equal(mesh.point_data["Normals"], surface.normals)


def test_a_library_that_is_missing_is_named(volume: Volume, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the command that installs it; isocore itself imports none of them."""
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(IsocoreError, match="pip install trimesh"):
        extract(volume, 45).to_trimesh()


def test_a_batch_reports_every_output_in_order(tmp_path: Path) -> None:
    """Failed ones too, and each as soon as it is known; the report is saved as asked."""
    for name in ("b.nii", "a.nii.gz"):
        write_nifti(tmp_path / "in" / name, ball())
    (tmp_path / "in" / "c.nii").write_bytes(b"junk" * 100)
    seen: list[RunReport] = []
    batch = convert_files(
        tmp_path / "in", tmp_path / "out", isovalues=[50, "60"], jobs=2, reports=tmp_path / "r.json", done=seen.append
    )
    assert [Path(run.output).name for run in batch.outputs] == [f"{n}_{v}.ply" for n in "abc" for v in (50, 60)]
    assert [run.status for run in batch.outputs] == ["done"] * 4 + ["failed"] * 2
    assert len(seen) == 6 and load_report(tmp_path / "r.json").totals["done"] == 4
    assert repr(batch).startswith("BatchReport(4 done, 2 failed, ")
    assert repr(batch.outputs[0]) == f"RunReport({tmp_path}/out/a_50.ply: done, {batch.outputs[0].triangles} triangles)"


def test_a_batch_of_one_file_needs_no_more_than_its_name(tmp_path: Path) -> None:
    """The surface lies beside it."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    (run,) = convert_files(str(source), isovalues="10:50:+20").outputs[:1] or (None,)
    assert run is not None and run.status == "done" and (tmp_path / "ball_10.ply").exists()


def test_a_label_map_gives_a_surface_for_each_label(tmp_path: Path) -> None:
    """Asked for as on the command line; a report over a sidecar is refused as there."""
    labels = np.zeros((12, 12, 12), np.uint8)
    labels[2:6, 2:10, 2:10], labels[6:10, 2:10, 2:10] = 1, 2
    source = write_nifti(tmp_path / "map.nii", labels)
    batch = convert_files(source, tmp_path / "out", labels="all", smooth=5)
    assert [run.status for run in batch.outputs] == ["done", "done"] and len(list((tmp_path / "out").iterdir())) == 2
    raw = tmp_path / "box.raw"
    raw.write_bytes(labels.tobytes(order="F"))
    (tmp_path / "box.raw.json").write_text('{"shape": [12, 12, 12], "dtype": "uint8"}')
    with pytest.raises(OptionError, match="overwritten"):
        convert_files(raw, isovalues=1, reports=tmp_path / "box.raw.json")


@pytest.mark.parametrize(
    ("arguments", "begin"),
    [
        ({"inputs": []}, "inputs: "),
        ({"isovalues": "loud"}, "isovalue loud: "),
        ({"name": "{nothing}"}, "name {nothing}: "),
        ({"backend": "mc", "options": Options(block_size=4)}, "block_size: is not an option of mc"),
        ({"reports": "run.txt"}, "run.txt: "),
        ({"jobs": 0}, "jobs: "),
        ({"labels": "loud"}, "labels loud: "),
        ({"labels": "all", "isovalues": 5}, "labels all: "),
    ],
)
def test_a_batch_that_makes_no_sense_is_refused_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: dict[str, object], begin: str
) -> None:
    """By an error that names the argument, although the input does not even exist."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OptionError) as caught:
        convert_files(**{"inputs": "missing.nii", **arguments})  # type: ignore[arg-type]
    assert str(caught.value).startswith(begin) and not list(tmp_path.iterdir())
