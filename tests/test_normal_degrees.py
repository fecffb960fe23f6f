"""The angles between triangles and the field's gradient, as the report says them, against another way to find them."""

from __future__ import annotations

import json
from dataclasses import astuple
from pathlib import Path
from typing import Any

import meshes
import nibabel
import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from shapes import SAMPLES

import isocore
from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.cell_mesh import CellMesh
from isocore.surface import Surface
from isocore.volume import Volume

MIDDLE = np.array([15.3, 16.1, 15.7])
SHEARED = np.array([[-1.0, 0.4, 0, 1], [0, 0.7, -0.3, 2], [0, 0, 2, 3], [0, 0, 0, 1]])


def quadratic(affine: npt.NDArray[np.float64]) -> Volume:
    """A field that is quadratic in the world, with its maximum at MIDDLE: central differences of it are exact."""
    world = (np.stack(np.indices((32, 32, 32)), axis=-1) - MIDDLE) @ affine[:3, :3].T
    return Volume(np.asfortranarray(-(world**2).sum(axis=-1)), affine=affine)


def degrees(surface: Surface, outwards: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Of every corner of every triangle: the angle between the triangle's normal and outwards at the corner."""
    a, b, c = (surface.vertices[surface.triangles[:, n]].astype(np.float64) for n in range(3))
    normals = np.cross(b - a, c - a)[:, None]
    there = outwards[surface.triangles].astype(np.float64)
    lengths = np.linalg.norm(normals, axis=2) * np.linalg.norm(there, axis=2)
    return np.degrees(np.arccos(np.clip((normals * there).sum(axis=2) / lengths, -1, 1)))


def found(field: Volume | CellMesh, isovalue: float, backend: str, **asked: Any) -> tuple[Surface, Any]:
    extraction = prepare(field, backend, Options(**asked, angles=True))(isovalue)
    error = extraction.findings.error
    assert error is not None and error.normal_degrees is not None
    return extraction.surface, error.normal_degrees


@pytest.mark.parametrize("affine", [np.eye(4), SHEARED], ids=["plain", "mirrored and sheared"])
@pytest.mark.parametrize("simplify", [False, True])
def test_the_angles_are_those_to_the_fields_own_gradient(affine: npt.NDArray[np.float64], simplify: bool) -> None:
    """In the world, mirrored or not, whose gradient here points to the middle."""
    surface, angles = found(quadratic(affine), -60.0, "asc", simplify=simplify)
    known = degrees(surface, surface.vertices - (affine[:3, :3] @ MIDDLE + affine[:3, 3]))
    assert known.mean() > 3
    assert angles.mean == pytest.approx(known.mean(), abs=0.02)
    assert angles.p95 == pytest.approx(np.percentile(known, 95), abs=0.05)
    assert angles.max == pytest.approx(known.max(), abs=0.1)


def test_a_plane_in_a_linear_field_of_a_mesh_is_not_turned() -> None:
    """Tetrahedra's own gradient is exact there, whatever is left of the plane's triangles."""
    grid = meshes.mesh_of(np.ones((5, 5, 5), bool))
    mesh = meshes.with_values(grid, grid.points @ np.array([1.0, 2.0, 3.0]))
    surface, angles = found(mesh, float(np.median(mesh.values)) + 0.01, "mc", simplify=True, max_error="0.1")
    assert len(surface.triangles) > 4
    assert angles.max < 0.1


@pytest.mark.parametrize("normals", [False, True])
def test_vertices_in_the_middle_of_a_loop_are_on_no_edge(normals: bool) -> None:
    """Simplification keeps the edges of those that lie on one, and the gradient is asked there alone."""
    grid = meshes.mesh_of(np.ones((8, 8, 8), bool), hexes=True)
    values = np.random.default_rng(2).normal(size=len(grid.points))
    mesh = meshes.with_values(grid, values)
    marched = _kernels.marching_cells(mesh.points, mesh.tets, mesh.hexes, mesh.values, 0.0, 1, True, True)
    assert 0 < len(marched.edges) < len(marched.vertices)
    surface, angles = found(mesh, 0.0, "mc", simplify=True, max_error="0.05", normals=normals)
    assert 0 < len(surface.triangles) <= len(marched.triangles)
    assert 0 < angles.mean < angles.p95 < angles.max <= 180


def test_the_angles_do_not_depend_on_threads_or_on_normals_being_written() -> None:
    """Normals that the triangles have to stand in for are no gradient, and are left out."""
    rng = np.random.default_rng(5)
    volume = Volume(np.asfortranarray(rng.integers(0, 4, (30, 30, 30)).astype(np.uint8)))
    runs = [found(volume, 2.0, "asc", threads=t, normals=n) for t in (1, 3) for n in (False, True)]
    assert len({astuple(angles) for _, angles in runs}) == 1
    surface, normals = runs[1][0], runs[1][0].normals
    assert normals is not None
    bare = _kernels.gradient_normals(volume.samples, surface.vertices, surface.triangles, False, complete=False)
    missing = np.isnan(bare[:, 0])
    assert 0 < missing.sum() < len(bare)
    assert np.allclose(bare[~missing], normals[~missing], atol=1e-6)
    known = degrees(surface, np.where(missing[:, None], np.nan, normals))
    assert runs[0][1].mean == pytest.approx(np.nanmean(known), abs=0.01)
    assert runs[0][1].max == pytest.approx(np.nanmax(known), abs=0.1)


def test_angles_near_none_and_near_a_half_turn_are_told() -> None:
    """A cosine in single precision would be wrong by hundredths of a degree there."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    triangles = np.array([[0, 1, 2]], np.int32)
    for turned in (0.0, 0.01, 1.0, 90.0, 179.0, 180.0):
        normal = [np.sin(np.radians(turned)), 0, np.cos(np.radians(turned))]
        normals = np.array([normal] * 3, np.float32)
        mean, p95, largest, count = _kernels.tilt(vertices, triangles, normals, np.eye(4)[:3].copy())
        assert (mean, p95, largest) == pytest.approx([turned] * 3, abs=5e-4)
        assert count == 3
    assert _kernels.tilt(vertices, triangles, normals * np.nan, np.eye(4)[:3].copy())[3] == 0
    with pytest.raises(ValueError, match="does not exist"):
        _kernels.tilt(vertices, triangles + 1, normals, np.eye(4)[:3].copy())


def test_the_report_and_the_table_say_the_angles(tmp_path: Path) -> None:
    """In JSON, in CSV; of what the format holds, where that moves vertices."""
    known = isocore.read(SAMPLES / "knot.nii.gz")
    assert isinstance(known, Volume)
    far = tmp_path / "far.nii"
    away = np.array([[0, 0, 0, 3e6]] * 3 + [[0] * 4])
    nibabel.save(nibabel.Nifti1Image(known.samples, known.affine + away), far)
    records = []
    for source in (SAMPLES / "knot.nii.gz", far):
        for form in ("ply", "stl"):
            report = tmp_path / f"{source.stem}-{form}"
            arguments = [str(source), "-i", "200", "-f", form, "-d", str(tmp_path), "--report", f"{report}.json"]
            result = CliRunner().invoke(convert, [*arguments, "--report", f"{report}.csv", "-q"])
            assert result.exit_code == 0, result.output
            records.append(json.loads(Path(f"{report}.json").read_text())["outputs"][0]["error"]["normal_degrees"])
            header, row = Path(f"{report}.csv").read_text().splitlines()[:2]
            assert "error.normal_degrees.p95" in header
            assert str(records[-1]["p95"]) in row
    assert records[0] == records[1]
    assert 20 < records[0]["mean"] < 25
    assert records[3]["mean"] == pytest.approx(records[2]["mean"], abs=3)
    assert records[3]["mean"] != records[2]["mean"]


@pytest.mark.parametrize("isovalue", [150.0, 200.0, 220.0])
def test_loops_are_cut_by_the_gradient_before_simplification_and_by_area_without_it(isovalue: float) -> None:
    """The same vertices and as many triangles, turned less; without simplification speed comes first."""
    volume = isocore.read(SAMPLES / "knot.nii.gz")
    assert isinstance(volume, Volume)
    coarse = [_kernels.climb(volume.samples, isovalue, max_error=0.5, tilted=tilted) for tilted in (False, True)]
    assert coarse[0].vertices.tobytes() == coarse[1].vertices.tobytes()
    assert len(coarse[0].triangles) == len(coarse[1].triangles)
    normals = _kernels.gradient_normals(volume.samples, *coarse[0][:2], False, complete=False)
    area, gradient = (_kernels.tilt(*mesh[:2], normals, np.eye(4)[:3].copy()) for mesh in coarse)
    assert gradient[0] < area[0] - 0.5
    assert gradient[1] < area[1]
    bare = prepare(volume, "asc", Options(simplify=False))(isovalue)
    assert bare.surface.triangles.tobytes() == coarse[0].triangles.tobytes()
    marched = _kernels.marching_cubes(volume.samples, isovalue)
    ours = _kernels.climb(volume.samples, isovalue, max_error=0.5, measured=False, tilted=True)
    assert ours.triangles.tobytes() != coarse[0].triangles.tobytes()
    fewer = _kernels.simplify(*ours[:2], *marched[:2], 0.5)
    assert np.array_equal(prepare(volume, "asc", Options())(isovalue).surface.triangles, fewer.triangles)
