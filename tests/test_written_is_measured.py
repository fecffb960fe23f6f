"""What a file holds is what its report and its gates speak of, after the format has rounded every coordinate."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import meshes
import meshio
import nrrd
import numpy as np
import numpy.typing as npt
import pytest
import shapes_mesh
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore import _kernels
from isocore.errors import OptionError, OutputError
from isocore.job import Job, Target
from isocore.measurements import Measurements, measure
from isocore.offset import moved_field, moved_surface, offset_of
from isocore.pipeline import convert as convert_job
from isocore.surface import Surface
from isocore.volume import Volume
from isocore.writers.rounding import as_read, rounded

FAR = (448000.25, 5412000.5, 300.0)
UTM = Path(__file__).parents[2] / "shared" / "data" / "cases" / "06-stl-far-from-origin" / "utm.vtu"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in (*arguments, "--no-progress")])


def record(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())["outputs"][0]
    return found


def far_ball(folder: Path, boxes: int) -> Path:
    """A mesh of so many boxes a side whose field is the distance from FAR; isovalue 0.6 is a sphere of radius 1.2."""
    mesh = meshes.mesh_of(np.ones((boxes,) * 3, bool))
    points = mesh.points / boxes * 4 - 2
    values = np.round(np.sqrt((points**2).sum(axis=1)) / 2, 6)
    path = folder / f"far{boxes}.vtu"
    meshio.write(path, meshio.Mesh(points + FAR, [("tetra", mesh.tets)], point_data={"u": values}))
    return path


def mesh_in(path: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """What somebody else's reader finds, an STL's corners joined where they are equal; as float64."""
    mesh = meshio.read(path)
    points, triangles = np.asarray(mesh.points, np.float64), mesh.cells_dict["triangle"].astype(np.int32)
    if path.suffix == ".stl":
        points, number = np.unique(points[triangles].reshape(-1, 3), axis=0, return_inverse=True)
        triangles = number.reshape(-1, 3).astype(np.int32)
    return points, triangles


def measured_in(path: Path) -> Measurements:
    return measure(Surface(*mesh_in(path)))


@pytest.mark.parametrize("format_", ["ply", "obj", "stl"])
@pytest.mark.parametrize("boxes", [6, 12])
@pytest.mark.parametrize("offset", [(), ("--offset", "auto"), ("--offset", "448000,5412000,0")])
def test_the_report_measures_what_the_file_holds(tmp_path, format_, boxes, offset):
    """Volume, area, box, borders and triangles without area, of a small body at map coordinates."""
    out = tmp_path / f"out.{format_}"
    run(far_ball(tmp_path, boxes), "-i", 0.6, "-o", out, "--report", tmp_path / "run.json", *offset)
    said, found = record(tmp_path / "run.json")["surface"], measured_in(out)
    for key in ("triangles", "vertices", "boundary_edges", "nonmanifold_edges", "euler", "watertight", "degenerate"):
        assert said[key] == getattr(found, key), key
    for key in ("area", "volume"):
        assert said[key] == (None if getattr(found, key) is None else pytest.approx(getattr(found, key), rel=1e-6))
    assert np.ravel(said["bounds"]) == pytest.approx(np.ravel(found.bounds), rel=1e-9, abs=1e-9)


def test_a_gate_sees_the_holes_that_rounding_tears(tmp_path):
    """STL lets vertices fall together at 5.4e6: not watertight, exit 3; PLY and an offset keep them apart."""
    mesh = far_ball(tmp_path, 12)
    torn = run(mesh, "-i", 0.6, "-o", tmp_path / "a.stl", "--require", "watertight,manifold")
    assert torn.exit_code == 3 and "vertices fall on another one" in torn.output
    assert run(mesh, "-i", 0.6, "-o", tmp_path / "a.ply", "--require", "watertight,manifold").exit_code == 0
    about = ("--offset", "auto", "--require", "watertight,manifold")
    mended = run(mesh, "-i", 0.6, "-o", tmp_path / "a.stl", *about)
    assert mended.exit_code == 0 and "moved" not in mended.output


def test_a_warning_says_how_far_vertices_moved(tmp_path):
    """Up to half a step of float32 at map coordinates, beside the mean edge."""
    out = tmp_path / "a.stl"
    said = " ".join(run(far_ball(tmp_path, 6), "-i", 0.6, "-o", out).output.split())
    assert "vertices moved by up to 0.2" in said and "times the mean edge (0.3" in said and "--offset auto" in said


@pytest.mark.skipif(not UTM.exists(), reason="needs the shared cases")
def test_the_shared_case_says_what_its_file_holds(tmp_path):
    """5.854 on disk, where memory held 6.113."""
    run(UTM, "-i", 0.6, "-o", tmp_path / "a.stl", "--report", tmp_path / "run.json")
    assert abs(record(tmp_path / "run.json")["surface"]["volume"]) == pytest.approx(5.854, abs=5e-4)


@pytest.mark.parametrize("format_", ["ply", "obj", "stl"])
def test_vertices_about_a_point_lie_where_they_did(tmp_path, format_):
    """Vertex plus offset is the world's place, and the file names the offset."""
    mesh, out = far_ball(tmp_path, 6), tmp_path / f"out.{format_}"
    run(mesh, "-i", 0.6, "-o", tmp_path / "exact.ply")
    run(mesh, "-i", 0.6, "-o", out, "--offset", "auto", "--report", tmp_path / "run.json")
    offset = record(tmp_path / "run.json")["offset"]
    assert offset == [448000, 5412000, 300] and record(tmp_path / "run.json")["options"]["offset"] == "auto"
    points, triangles = mesh_in(out)
    exact, same = mesh_in(tmp_path / "exact.ply")
    assert np.abs(points[triangles] + offset - exact[same]).max() < 1e-6
    assert (b"448000,5412000,300" if format_ == "stl" else b"448000 5412000 300") in out.read_bytes()


@pytest.mark.parametrize("scale", [1.0, -0.5])
def test_a_far_volume_about_a_point_needs_no_float64(scale):
    """Its places in the world are those of float64, which it needs without the offset."""
    affine = np.diag([scale, 0.5, 2.0, 1.0])
    affine[:3, 3] = FAR
    volume = Volume(np.asfortranarray(ball(8)), affine=affine)
    point = offset_of(volume, Job(source=Path("x"), targets=(), offset="auto").offset)
    assert point is not None and all(number == round(number) for number in point)
    box = volume.affine[:3, :3] @ ((np.array(volume.shape) - 1) / 2) + volume.affine[:3, 3]
    assert np.abs(np.array(point) - box).max() <= 10
    moved = moved_field(volume, point)
    assert np.array_equal(moved.affine[:3, 3] + point, volume.affine[:3, 3])


def test_a_near_field_is_not_moved_by_auto(tmp_path):
    """The offset is the origin, and the bytes are those without the option."""
    scan = write_nifti(tmp_path / "ball.nii", ball(8))
    run(scan, "-i", 50, "-o", tmp_path / "a.ply")
    run(scan, "-i", 50, "-o", tmp_path / "b.ply", "--offset", "auto", "--report", tmp_path / "run.json")
    assert record(tmp_path / "run.json")["offset"] == [0, 0, 0]
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_all_isovalues_of_a_field_share_its_offset():
    """Or their surfaces would not fit each other."""
    volume = Volume(np.asfortranarray(ball(8)))
    surface = shapes_mesh.sphere()
    assert moved_surface(surface, volume, None) is surface
    assert moved_surface(surface, volume, (1.0, 2.0, 3.0)).offset == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("text", ["1,2", "1,2,x", "1,2,inf", "near", "-5"])
def test_an_offset_that_is_no_point_is_refused(tmp_path, text):
    """Exit 2, and the message says what it needs."""
    refused = run(UTM, "-i", 1, "-o", tmp_path / "a.ply", "--offset", text)
    assert refused.exit_code == 2 and "auto" in refused.output
    with pytest.raises(OptionError, match="--offset"):
        Job(source=Path("x"), targets=(), offset=text)


def test_a_raw_file_takes_bytes_and_a_point(tmp_path):
    """Both are --offset, told apart by their form; two of a kind are refused."""
    samples = np.ascontiguousarray(ball(8).T)
    raw = tmp_path / "ball.raw"
    raw.write_bytes(b"head" + samples.tobytes())
    form = (raw, "--shape", "x".join(map(str, samples.shape[::-1])), "--dtype", samples.dtype.name, "-i", 50)
    target = ("-o", tmp_path / "a.ply", "--report", tmp_path / "run.json")
    assert run(*form, "--offset", 4, "--offset", "1,-2,0.1", *target).exit_code == 0
    assert record(tmp_path / "run.json")["offset"] == [1, -2, 0.1]
    assert b"comment offset 1 -2 0.1\n" in (tmp_path / "a.ply").read_bytes()
    assert run(*form, "--offset", 4, "--offset", 5, *target).exit_code == 2


@pytest.mark.parametrize("format_", ["ply", "obj", "stl"])
def test_where_a_format_rounds_nothing_nothing_is_done(format_):
    """The surface itself is measured and written, not a copy."""
    sphere = shapes_mesh.sphere()
    assert rounded(sphere, format_) == (sphere, ())
    assert as_read(sphere, format_) is sphere
    exact = Surface(sphere.vertices.astype(np.float64) + FAR, sphere.triangles)
    assert rounded(exact, "ply")[0] is exact


def test_a_reader_of_stl_joins_what_lies_at_one_place(tmp_path):
    """Two sheets that share places, not vertices, are closed in STL; two that touch are no longer manifold."""
    cube = shapes_mesh.cube()
    apart = Surface(cube.vertices[cube.triangles].reshape(-1, 3), np.arange(36, dtype=np.int32).reshape(-1, 3))
    assert measure(apart).components == 12 and measure(as_read(apart, "obj")).components == 12
    joined = measure(as_read(apart, "stl"))
    assert joined.watertight and joined.vertices == 8 and joined.volume == measure(cube).volume


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_vertices_at_one_place_are_found(dtype, threads):
    """The earliest of each place, as numpy finds it; zero and minus zero are one place; nothing where all differ."""
    rng = np.random.default_rng(threads)
    vertices = rng.integers(-9, 9, (5000, 3)).astype(dtype)
    vertices[rng.random(vertices.shape) < 0.1] *= -1
    _, first, number = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    assert np.array_equal(_kernels.weld(vertices, threads), first[number.ravel()])
    assert len(_kernels.weld(rng.random((5000, 3)).astype(dtype), threads)) == 0


def test_nine_digits_are_those_of_the_text():
    """As Python prints and reads them."""
    rng = np.random.default_rng(1)
    numbers = rng.standard_normal((5000, 3)) * 10.0 ** rng.integers(-300, 300, (5000, 3))
    expected = [[float(f"{number:.9g}") for number in row] for row in numbers.tolist()]
    assert _kernels.nine_digits(numbers, 2).tolist() == expected


def test_coordinates_beyond_float32_are_no_stl(tmp_path):
    """An infinity would be written; the message names what will do."""
    huge = Surface(shapes_mesh.cube().vertices.astype(np.float64) * 1e39, shapes_mesh.cube().triangles)
    with pytest.raises(OutputError, match=r"float32.*PLY, VTP or OBJ"):
        rounded(huge, "stl")


def test_a_job_in_python_takes_an_offset_as_text(tmp_path):
    """As on the command line."""
    scan = write_nifti(tmp_path / "ball.nii", ball(8))
    (found,) = convert_job(Job(source=scan, targets=(Target("50", tmp_path / "a.ply"),), offset="1,2,3"))
    assert found.offset == (1, 2, 3)


def distances(points, corners):
    """Of points (n, 3) to the nearest of triangles (t, 3, 3), one by one, all in float64."""
    a, b, c = (corners[:, n] for n in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    found = []
    for point in points:
        height = np.einsum("ij,ij->i", point - a, normal)
        inside = np.ones(len(a), bool)
        best = np.full(len(a), np.inf)
        for start, end in ((a, b), (b, c), (c, a)):
            way, off = end - start, point - start
            inside &= np.einsum("ij,ij->i", np.cross(normal, way), off) >= 0
            t = np.clip(np.einsum("ij,ij->i", off, way) / np.einsum("ij,ij->i", way, way), 0, 1)
            best = np.minimum(best, np.linalg.norm(off - t[:, None] * way, axis=1))
        found.append(np.where(inside, np.minimum(best, np.abs(height)), best).min())
    return np.array(found)


@pytest.mark.parametrize("format_", ["stl", "obj"])
def test_the_error_is_that_of_the_vertices_in_the_file(tmp_path, format_):
    """Of a volume so far away that its vertices move by a good part of a voxel, in voxels and in the world."""
    place = np.array([3.1e6, -2.2e6, 1e5]) * (1 if format_ == "stl" else 40)
    affine = np.eye(4)
    affine[:3] = [[0.4, 0.1, 0, place[0]], [0, 0.5, 0, place[1]], [0, 0, 0.6, place[2]]]
    scan, out = tmp_path / "far.nrrd", tmp_path / f"out.{format_}"
    header = {"space": "left-posterior-superior", "space origin": affine[:3, 3], "space directions": affine[:3, :3].T}
    nrrd.write(str(scan), ball(14, radius=5.0), header)
    run(scan, "-i", 50, "-o", out, "--max-error", 0.3, "--report", tmp_path / "run.json")
    run(scan, "-i", 50, "-b", "mc", "--space", "index", "-o", tmp_path / "mc.ply", "--no-normals")
    points, triangles = mesh_in(out)
    index = (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T
    reference = mesh_in(tmp_path / "mc.ply")[0]
    said = record(tmp_path / "run.json")["error"]
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    corners = index[triangles]
    corners = corners[np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).any(axis=1)]
    for suffix, scale in (("", np.ones(3)), ("_world", spacing)):
        found = distances(reference * scale, corners * scale)
        assert said[f"max{suffix}"] == pytest.approx(found.max(), rel=1e-6)
        assert said[f"mean{suffix}"] == pytest.approx(found.mean(), rel=1e-6)
        assert said[f"rms{suffix}"] == pytest.approx(np.sqrt((found**2).mean()), rel=1e-6)
    assert said["max"] > 0.3
