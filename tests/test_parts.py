"""Names, colours and labels in the files that hold them: PLY, OBJ with its materials, GLB; several labels in one."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti

NAMES = "1,spleen,255,0,128\n2,left kidney,0,255,0\n"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


@pytest.fixture
def labels(tmp_path: Path) -> tuple[Path, Path]:
    """A map of two labels that touch, and a table of their names."""
    found = np.zeros((12, 10, 8), np.int16)
    found[2:6, 2:8, 2:6] = 1
    found[6:10, 2:8, 2:6] = 2
    (tmp_path / "names.csv").write_text(NAMES)
    return write_nifti(tmp_path / "seg.nii", found), tmp_path / "names.csv"


def convert_all(labels: tuple[Path, Path], output: Path, *more: object) -> list[dict[str, Any]]:
    report = output.with_name("run.json")
    result = run(labels[0], "--labels", "all", "--names", labels[1], "-o", output, "--report", report, *more)
    assert result.exit_code == 0, result.output
    return json.loads(report.read_text())["outputs"]


def document(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    magic, version, length, text, kind = struct.unpack_from("<5I", data)
    assert (magic, version, length, kind) == (0x46546C67, 2, len(data), 0x4E4F534A)
    return json.loads(data[20 : 20 + text])


def test_a_glb_has_a_node_a_label(tmp_path: Path, labels: tuple[Path, Path]) -> None:
    """Its name, its colour (linear, as glTF wants it), its number; trimesh finds each closed."""
    rows = convert_all(labels, tmp_path / "organs.glb")
    found = document(tmp_path / "organs.glb")
    assert [node["name"] for node in found["nodes"]] == ["spleen", "left kidney"]
    assert [node["extras"]["label"] for node in found["nodes"]] == [1, 2]
    colours = [material["pbrMetallicRoughness"]["baseColorFactor"] for material in found["materials"]]
    assert colours == [[1.0, 0.0, pytest.approx(0.215861, abs=1e-6), 1.0], [0.0, 1.0, 0.0, 1.0]]
    scene = trimesh.load_scene(tmp_path / "organs.glb", process=False)
    for row, name in zip(rows, ("spleen", "left kidney"), strict=True):
        mesh = scene.geometry[name]
        assert mesh.is_watertight and mesh.volume == pytest.approx(row["surface"]["volume"], rel=1e-5)
        assert row["output"] == str(tmp_path / "organs.glb") and row["sha256"] == rows[0]["sha256"]


def test_a_ply_has_a_label_a_face_and_a_colour_a_vertex(tmp_path: Path, labels: tuple[Path, Path]) -> None:
    """As trimesh reads it."""
    rows = convert_all(labels, tmp_path / "organs.ply")
    mesh = trimesh.load_mesh(tmp_path / "organs.ply", process=False)
    counts = [row["surface"]["triangles"] for row in rows]
    numbers = mesh.metadata["_ply_raw"]["face"]["data"]["label"]
    assert np.ravel(numbers).tolist() == [1] * counts[0] + [2] * counts[1]
    first, vertices = mesh.faces[: counts[0]], rows[0]["surface"]["vertices"]
    assert first.max() < vertices <= mesh.faces[counts[0] :].min()
    colours = mesh.visual.vertex_colors[:, :3]
    assert (colours[:vertices] == (255, 0, 128)).all() and (colours[vertices:] == (0, 255, 0)).all()


def test_an_obj_has_objects_and_a_file_of_materials(tmp_path: Path, labels: tuple[Path, Path]) -> None:
    """Named in the OBJ, and beside it."""
    convert_all(labels, tmp_path / "organs.obj")
    lines = (tmp_path / "organs.obj").read_text().splitlines()
    assert "mtllib organs.mtl" in lines
    assert [line for line in lines if line.startswith(("o ", "usemtl"))] == [
        "o spleen", "usemtl label_1", "o left_kidney", "usemtl label_2",
    ]  # fmt: skip
    assert "newmtl label_1\nKd 1 0 0.501961\n" in (tmp_path / "organs.mtl").read_text()


def test_one_file_of_all_is_left_alone_while_all_of_it_is_up_to_date(tmp_path: Path, labels: tuple[Path, Path]) -> None:
    """And made anew as a whole."""
    for more, status in (((), "done"), ((), "skipped"), (("--smooth", 3), "done")):
        rows = convert_all(labels, tmp_path / "organs.glb", "--if-changed", *more)
        assert [row["status"] for row in rows] == [status] * 2


@pytest.mark.parametrize("format", ["ply", "obj", "glb"])
def test_one_surface_takes_a_colour(tmp_path: Path, format: str) -> None:
    """--color, in whatever holds it."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    assert run(source, "-i", 50, "--color", "#ff8800", "-f", format, "-d", tmp_path / "out").exit_code == 0
    output = tmp_path / "out" / f"ball.{format}"
    if format == "ply":
        assert set(trimesh.load_mesh(output, process=False).visual.vertex_colors[:, 1].tolist()) == {0x88}
    elif format == "obj":
        assert "newmtl ball\nKd 1 0.533333 0\n" in (tmp_path / "out/ball.mtl").read_text()
    else:
        assert document(output)["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][0] == 1


def test_a_colour_that_is_none_is_refused(tmp_path: Path) -> None:
    """Exit code 2, in words."""
    result = run(write_nifti(tmp_path / "ball.nii", ball()), "--color", "orange", "-d", tmp_path)
    assert result.exit_code != 0 and "is no colour" in str(result.output) + str(result.exception)


def test_an_empty_label_leaves_no_node(tmp_path: Path, labels: tuple[Path, Path]) -> None:
    """glTF knows no empty mesh."""
    result = run(labels[0], "--labels", "1,9", "-o", tmp_path / "some.glb")
    assert result.exit_code == 0
    assert [node["extras"]["label"] for node in document(tmp_path / "some.glb")["nodes"]] == [1]
    assert run(labels[0], "--labels", "9", "-o", tmp_path / "none.glb").exit_code == 0
    assert "nodes" not in document(tmp_path / "none.glb") and "meshes" not in document(tmp_path / "none.glb")


@pytest.mark.parametrize("format", ["ply", "obj", "glb", "stl"])
def test_one_file_of_all_is_read_back(tmp_path: Path, labels: tuple[Path, Path], format: str) -> None:
    """The page shows what was written."""
    from isocore.writers.read_back import read_mesh

    rows = convert_all(labels, tmp_path / f"organs.{format}")
    found = read_mesh(tmp_path / f"organs.{format}")
    assert found is not None and len(found[1]) == sum(row["surface"]["triangles"] for row in rows)
