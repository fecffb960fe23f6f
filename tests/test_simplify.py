"""Simplification as a stage: what may be asked for, of which inputs, and what the report says."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from shapes import SAMPLES, sphere
from simplification_oracle import broken_promises

import isocore
from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.cell_mesh import CellMesh
from isocore.errors import OptionError
from isocore.placing import placing_in
from isocore.volume import Volume


def run(folder: Path, *arguments: str) -> tuple[int, dict[str, Any], str]:
    """Exit code, the first record and what was printed."""
    report = folder / "report.json"
    result = CliRunner().invoke(convert, [*arguments, "-d", str(folder), "--report", str(report)])
    record = json.loads(report.read_text())["outputs"][0] if report.is_file() else {}
    return result.exit_code, record, result.output


def torus() -> CellMesh:
    mesh = isocore.read(SAMPLES / "torus.vtu")
    assert isinstance(mesh, CellMesh)
    return mesh


def test_the_report_says_what_simplification_did(tmp_path: Path) -> None:
    """How many triangles came in and went, both errors, and that both keep the bound."""
    code, record, _ = run(tmp_path, str(SAMPLES / "knot.nii.gz"), "-i", "200", "--simplify")
    assert code == 0
    found, error = record["simplification"], record["error"]
    assert found["triangles_before"] - 2 * found["collapses"] == record["surface"]["triangles"] <= 800
    assert 0.25 < error["max"] <= 0.5
    assert 0.25 < error["back_max"] <= 0.5
    assert error["max_world"] == pytest.approx(2 * error["max"])
    assert 0 < found["seconds"] <= record["seconds"]["extract"]


@pytest.mark.parametrize("backend", ["mc", "thinning"])
def test_other_methods_of_volumes_are_simplified_alike(backend: str) -> None:
    """Marching cubes' surface is its own reference, and thinning's is the same surface."""
    volume = isocore.read(SAMPLES / "knot.nii.gz")
    options = Options(simplify=True, max_error="0.3")
    found = prepare(volume, backend, options)(200)
    error = found.findings.error
    assert error is not None and error.max is not None and error.back_max is not None
    assert error.max <= 0.3 and error.back_max <= 0.3
    assert len(found.surface.triangles) < 1600


def test_a_bound_in_millimetres_holds_in_the_world() -> None:
    """Distances are measured with each axis stretched by its spacing."""
    rng = np.random.default_rng(3)
    samples = rng.normal(size=(8, 9, 7))
    for axis in range(3):
        samples = samples + np.roll(samples, 1, axis) + np.roll(samples, -1, axis)
    spacing = (0.5, 1.0, 2.0)
    volume = Volume(np.asfortranarray(samples.astype(np.float32)), affine=np.diag([*spacing, 1.0]), unit="mm")
    found = prepare(volume, "asc", Options(simplify=True, max_error="0.2mm"))(0.0)
    marched = _kernels.marching_cubes(volume.samples, 0.0)
    ours = (found.surface.vertices / np.array(spacing, np.float32), found.surface.triangles)
    assert not broken_promises(ours, marched[:2], 0.2, stretch=spacing)
    error = found.findings.error
    assert error is not None and error.max_world <= 0.2 and error.back_max_world is not None
    assert error.back_max_world <= 0.2


def test_what_is_not_proved_of_climbings_mesh_is_not_kept() -> None:
    """Climbing bounds no way back; where a triangle of its is too far to prove, marching cubes' mesh is simplified."""
    rows = [[-156, -45, 276, 203, 265], [291, -267, 165, -158, 19], [51, -72, -268, -35, 7], [-102, 176, -1, 279, 274]]
    layer = np.array(rows, np.float32).T / 1000
    volume = Volume(np.asfortranarray(np.repeat(layer[:, :, None], 3, axis=2)))
    asked = Options(block_size=4, max_error="0.1")
    marched = _kernels.marching_cubes(volume.samples, 0.0568)
    climbed = _kernels.climb(volume.samples, 0.0568, block_size=4, max_error=0.1)
    assert _kernels.simplify(climbed.vertices, climbed.triangles, *marched[:2], 0.1).unproved == 1
    found = prepare(volume, "asc", asked)(0.0568)
    assert not broken_promises((found.surface.vertices, found.surface.triangles), marched[:2], 0.1)
    assert found.findings.error is not None and found.findings.error.back_max is not None
    facts = found.findings.simplification
    assert facts is not None and facts.triangles_before == len(marched.triangles)


def test_a_mesh_is_simplified_in_its_own_unit() -> None:
    """Against its own marching tetrahedra; the border stays, and so does the topology."""
    mesh = torus()
    options = Options(normals=True)
    whole = prepare(mesh, "mc", options)(0.4).surface
    fewer = prepare(mesh, "mc", replace(options, simplify=True, max_error="0.02"))(0.4)
    arrays = ((fewer.surface.vertices, fewer.surface.triangles), (whole.vertices, whole.triangles))
    assert len(fewer.surface.triangles) < len(whole.triangles) / 2
    assert not broken_promises(*arrays, 0.02)
    error = fewer.findings.error
    assert error is not None and error.max is None and error.max_world <= 0.02
    known = {place.tobytes(): normal for place, normal in zip(whole.vertices, whole.normals, strict=True)}
    kept = zip(fewer.surface.vertices, fewer.surface.normals, strict=True)
    same = [known[place.tobytes()] @ normal for place, normal in kept]
    assert np.mean(np.array(same) > 0.9999) > 0.95
    assert min(same) > 0.8


def test_the_unit_of_a_mesh_changes_nothing_but_the_unit() -> None:
    """A mesh a million times smaller loses the same triangles."""
    mesh, small = torus(), 2.0**-20
    tiny = replace(mesh, points=mesh.points * small)
    big = prepare(mesh, "mc", Options(simplify=True, max_error="0.02"))(0.4).surface
    little = prepare(tiny, "mc", Options(simplify=True, max_error=f"{0.02 * small}"))(0.4).surface
    assert big.triangles.tobytes() == little.triangles.tobytes()


def test_a_number_of_triangles_is_reached_with_the_least_error(tmp_path: Path) -> None:
    """At most so many, past the default bound if they must; more triangles have a smaller error."""
    errors = []
    for count in (2000, 800, 300):
        code, record, _ = run(tmp_path, str(SAMPLES / "knot.nii.gz"), "-i", "200", "--triangles", str(count))
        assert code == 0
        assert count - 2 <= record["surface"]["triangles"] <= count
        assert record["error"]["bound"] == "none"
        assert not record["warnings"]
        errors.append(record["error"]["max"])
    assert errors == sorted(errors)
    assert errors[-1] > 0.5


def test_a_given_bound_wins_over_a_number_of_triangles(tmp_path: Path) -> None:
    """What is left then is a warning."""
    asked = ("-i", "200", "--triangles", "100", "--max-error", "0.3")
    code, record, _ = run(tmp_path, str(SAMPLES / "knot.nii.gz"), *asked)
    assert code == 0
    assert record["error"]["max"] <= 0.3
    assert record["surface"]["triangles"] > 100
    assert any("--triangles 100" in line and "--max-error 0.3" in line for line in record["warnings"])


def test_topology_wins_over_a_number_of_triangles(tmp_path: Path) -> None:
    """Two rings have no fewer triangles than rings need; what is left is a warning."""
    code, record, _ = run(tmp_path, str(SAMPLES / "knot.nii.gz"), "-i", "200", "--triangles", "4")
    assert code == 0
    assert record["surface"]["triangles"] > 4
    assert any("topology" in line for line in record["warnings"])


@pytest.mark.parametrize("count", ["0", "-3"])
def test_no_triangles_is_no_number_to_ask_for(tmp_path: Path, count: str) -> None:
    """The command line is wrong, and says so."""
    code, _, output = run(tmp_path, str(SAMPLES / "knot.nii.gz"), "--triangles", count)
    assert code == 2
    assert "--triangles" in output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (Options(triangles=0), "must be 1 or more"),
        (Options(triangles=10, simplify=False), "--no-simplify"),
        (Options(simplify=True, max_error="none"), "needs a bound"),
    ],
)
def test_requests_that_make_no_sense_are_refused(options: Options, message: str) -> None:
    """Rather than ignored."""
    with pytest.raises(OptionError, match=message):
        prepare(sphere().volume, "asc", options)


def test_a_mesh_has_no_bound_of_its_own() -> None:
    """Its cells differ in size, so that the user has to say how much is little; and in which unit."""
    with pytest.raises(OptionError, match="needs --max-error, in the mesh's unit, or --triangles"):
        prepare(torus(), "mc", Options(simplify=True))
    with pytest.raises(OptionError, match="does not say its unit"):
        prepare(torus(), "mc", Options(simplify=True, max_error="1mm"))
    with pytest.raises(OptionError, match="only with --simplify"):
        prepare(torus(), "mc", Options(max_error="1"))


def test_an_empty_surface_stays_empty(tmp_path: Path) -> None:
    """There is nothing to simplify, and no error."""
    code, record, _ = run(tmp_path, str(SAMPLES / "knot.nii.gz"), "-i", "300", "--simplify")
    assert code == 0
    assert record["status"] == "empty"


def test_no_triangles_meet_where_vertices_are_rounded_far_from_the_origin() -> None:
    """Some would: there a vertex moves by 0.0002 voxels when it is written, and noise leaves triangles of that size."""
    samples = np.asfortranarray(np.random.default_rng(5).integers(0, 9, (22, 22, 22)).astype(np.int16))
    affine = np.eye(4)
    affine[:3] = [[0.96, 0.28, 0, 3000], [-0.28, 0.96, 0, 3000], [0, 0, 1, 3000]]
    marched = _kernels.marching_cubes(samples, 4.003)
    placing = placing_in(_kernels.bounds(marched.vertices), np.float32, affine)
    unaware = _kernels.simplify(*marched[:2], *marched[:2], 0.5)
    assert not _kernels.self_intersections(unaware.vertices, unaware.triangles)
    assert _kernels.self_intersections(placing(unaware.vertices), unaware.triangles)
    found = prepare(Volume(samples, affine=affine), "mc", Options(simplify=True, max_error="0.5"))(4.003)
    surface = found.surface
    assert surface.vertices.dtype == np.float32
    assert not _kernels.self_intersections(surface.vertices, surface.triangles)
    kept = {place.tobytes() for place in placing(marched.vertices)}
    assert all(place.tobytes() in kept for place in surface.vertices)
