"""Vertex normals in the files: there by default, unit, and towards the lower values, in the world."""

from __future__ import annotations

from pathlib import Path

import meshes
import meshio
import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore import Options, extract
from isocore.cell_mesh import CellMesh
from isocore.volume import Volume

MIDDLE = np.array([15.3, 16.1, 15.7])
#: Mirrored, stretched, turned and sheared worlds.
AFFINES = {
    "plain": np.eye(4),
    "mirrored": np.diag([-1.0, 1.0, 1.0, 1.0]),
    "stretched": np.diag([0.4, 1.0, 3.0, 1.0]),
    "swapped": np.array([[0, -2.0, 0, 5], [0.5, 0, 0, -7], [0, 0, 1, 3], [0, 0, 0, 1]]),
    "mirrored and sheared": np.array([[-1.0, 0.4, 0, 1], [0, 0.7, -0.3, 2], [0, 0, 2, 3], [0, 0, 0, 1]]),
}
METHODS = {
    "mc": ("mc", Options(normals=True)),
    "trilinear": ("mc", Options(normals=True, topology="trilinear")),
    "asc": ("asc", Options(normals=True)),
    "thinning": ("thinning", Options(normals=True)),
}


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in (*arguments, "--no-progress")])


def quadratic(affine: npt.NDArray[np.float64], slope: float = 1.0) -> Volume:
    """Samples of a field that is quadratic in the world, with a maximum (slope > 0: of the values) at MIDDLE."""
    grid = np.stack(np.indices((32, 32, 32)), axis=-1) - MIDDLE
    world = grid @ affine[:3, :3].T
    return Volume(np.asfortranarray(-(world**2).sum(axis=-1) / slope), slope=slope, affine=affine)


@pytest.mark.parametrize("world", AFFINES)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("slope", [1.0, -2.0])
def test_normals_of_a_volume_are_the_fields_gradient_in_the_world(world, method, slope):
    """Unit, within a degree of the true direction, and on the side to which the triangles turn.

    But for few: where a stretched voxel is as large as the body, the gradient contradicts the samples around it.
    """
    volume = quadratic(AFFINES[world], slope)
    backend, options = METHODS[method]
    surface = extract(volume, -34.8, backend=backend, options=options)
    assert surface.normals is not None and len(surface.vertices) > 25
    outwards = surface.vertices - (volume.affine[:3, :3] @ MIDDLE + volume.affine[:3, 3])
    outwards /= np.linalg.norm(outwards, axis=1)[:, None]
    assert np.abs(np.linalg.norm(surface.normals, axis=1) - 1).max() < 1e-6
    off = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", surface.normals, outwards), -1, 1)))
    assert (off < 1).mean() > 0.97 and off.max() < 35
    corners = surface.vertices[surface.triangles].astype(np.float64)
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", turned, surface.normals[surface.triangles[:, 0]]) > 0).mean() > 0.9


@pytest.mark.parametrize("backend", ["mc", "thinning"])
@pytest.mark.parametrize("hexes", [False, True])
def test_normals_of_a_mesh_are_the_fields_gradient(backend, hexes):
    """Of a distance field whose cells are stretched; cells inside out change nothing."""
    mesh = meshes.mesh_of(np.ones((12, 12, 12), bool), hexes=hexes)
    points = mesh.points * [1.0, 0.5, 0.8] - [6, 3, 4.8]
    tets = mesh.tets.copy()
    tets[::3] = tets[::3][:, [1, 0, 2, 3]]
    distance = np.sqrt((points**2).sum(axis=1))
    surface = extract(
        CellMesh(points, tets, mesh.hexes, -distance), -2.2, backend=backend, options=Options(normals=True)
    )
    assert surface.normals is not None
    outwards = surface.vertices / np.linalg.norm(surface.vertices, axis=1)[:, None]
    assert np.abs(np.linalg.norm(surface.normals, axis=1) - 1).max() < 1e-6
    off = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", surface.normals, outwards), -1, 1)))
    assert off.max() < 6 and off.mean() < 2.5


@pytest.mark.parametrize(
    ("format_", "asked", "there"),
    [
        ("ply", (), True),
        ("obj", (), True),
        ("ply", ("--no-normals",), False),
        ("obj", ("--no-normals",), False),
        ("obj", ("--normals",), True),
    ],
)
def test_normals_are_written_unless_they_are_declined(tmp_path, format_, asked, there):
    """PLY as nx, ny, nz; OBJ as vn, one for each vertex."""
    scan, out = write_nifti(tmp_path / "ball.nii", ball()), tmp_path / f"out.{format_}"
    said = run(scan, "-i", 50, "-o", out, *asked)
    assert "vertex normals" not in said.output
    head = out.read_bytes()
    assert (b"property float nx" in head or b"\nvn " in head) == there
    if there and format_ == "ply":
        mesh = meshio.read(out)
        normals = np.stack([mesh.point_data[name] for name in ("nx", "ny", "nz")], axis=1)
        outwards = (mesh.points - 5.5) / np.linalg.norm(mesh.points - 5.5, axis=1)[:, None]
        assert np.einsum("ij,ij->i", normals, outwards).min() > 0.97


def test_stl_says_that_it_has_no_normals_where_they_are_asked_for(tmp_path):
    """A warning, and the same file; without --normals nothing is said."""
    scan = write_nifti(tmp_path / "ball.nii", ball())
    plain = run(scan, "-i", 50, "-o", tmp_path / "a.stl")
    asked = run(scan, "-i", 50, "-o", tmp_path / "b.stl", "--normals")
    assert plain.exit_code == asked.exit_code == 0
    assert "vertex normals" not in plain.output and "STL holds no vertex normals" in " ".join(asked.output.split())
    assert (tmp_path / "a.stl").read_bytes() == (tmp_path / "b.stl").read_bytes()


def test_a_stamp_of_stl_holds_whatever_is_said_of_normals(tmp_path: Path):
    """Its bytes do not depend on them; those of PLY do."""
    scan = write_nifti(tmp_path / "ball.nii", ball())
    for format_, statuses in (("stl", ["done", "skipped", "skipped"]), ("ply", ["done", "skipped", "done"])):
        out = ("-o", tmp_path / f"a.{format_}", "-i", 50, "--if-changed", "--json", "-q")
        outputs = [run(scan, *out, *asked).stdout for asked in ((), (), ("--no-normals",))]
        assert [text.split('"status": "')[1].split('"')[0] for text in outputs] == statuses


@pytest.mark.parametrize("backend", ["mc", "thinning"])
def test_normals_of_a_mesh_are_the_same_for_any_number_of_threads(backend):
    """And for both ways to find the surface, vertex by vertex."""
    mesh = meshes.mesh_of(np.ones((9, 8, 7), bool))
    field = meshes.with_values(mesh, np.sin(mesh.points).sum(axis=1))
    one, three = (extract(field, 0.4, backend=backend, options=Options(normals=True, threads=n)) for n in (1, 3))
    assert one.normals is not None and three.normals is not None and len(one.vertices) > 100
    assert np.array_equal(one.normals, three.normals) and np.array_equal(one.vertices, three.vertices)


def test_a_gradient_that_contradicts_its_edge_gives_way_to_the_triangles():
    """A single low sample in a steep ramp: the central difference at its edges points the wrong way."""
    samples = np.asfortranarray(np.indices((9, 9, 9))[0].astype(np.float32) * 10)
    samples[5, 4, 4] = 0
    surface = extract(Volume(samples), 25.0, backend="mc", options=Options(normals=True))
    assert surface.normals is not None
    around = np.flatnonzero(np.abs(surface.vertices - [5, 4, 4]).max(axis=1) < 1)
    inwards = np.array([5, 4, 4]) - surface.vertices[around]
    assert len(around) == 6 and (np.einsum("ij,ij->i", surface.normals[around], inwards) > 0).all()


@pytest.mark.parametrize("backend", ["mc", "thinning"])
def test_normals_beside_a_value_that_is_no_number_are_still_unit(backend):
    """Cells with such a value have no gradient; those around them do."""
    mesh = meshes.mesh_of(np.ones((6, 6, 6), bool))
    values = -np.sqrt(((mesh.points - 3.1) ** 2).sum(axis=1))
    values[np.argsort(-values)[:40:3]] = np.nan
    surface = extract(meshes.with_values(mesh, values), -1.7, backend=backend, options=Options(normals=True))
    assert surface.normals is not None and len(surface.vertices) > 50
    assert np.abs(np.linalg.norm(surface.normals, axis=1) - 1).max() < 1e-6


def test_a_surface_whose_self_intersections_were_not_counted_is_made_again_to_count_them(tmp_path: Path):
    """Once; and the other way round what is counted stays."""
    scan = write_nifti(tmp_path / "ball.nii", ball())
    out = ("-o", tmp_path / "a.ply", "-i", 50, "--if-changed", "--json", "-q")
    asked = (("--no-self-intersections",), (), (), ("--no-self-intersections",), ("--require", "simple"))
    outputs = [run(scan, *out, *each).stdout for each in asked]
    statuses = [text.split('"status": "')[1].split('"')[0] for text in outputs]
    assert statuses == ["done", "done", "skipped", "skipped", "skipped"]
