"""VTP: what VTK reads is the surface with its fields; a series gets a list; isovalues may share a file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from cell_shapes import block
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti
from vtp_files import VtpFile
from vtu_files import Mesh, write

import isocore
from isocore import convert_files
from isocore.errors import OutputError
from isocore.surface import Surface
from isocore.writers.read_back import read_mesh
from isocore.writers.vtp import write_vtp

SLOPE, START = np.array([1.5, -2.25, 0.75]), 3.0
FAR = np.array([448000.25, 5412000.5, 300.0])


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in (*arguments, "--no-progress", "-q")])


def rows(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(path.read_text())["outputs"]
    return found


def linear(places: Any) -> Any:
    return np.asarray(places, np.float64) @ SLOPE + START


def flow(path: Path, moved: Any = 0.0, radius: float = 0.0) -> Path:
    """A mesh with a field to contour, a linear one, a vector and a number of each cell."""
    points, cells = block(np.full((4, 4, 4), "h"))
    points = points + moved
    fields = {"p": np.linalg.norm(points - moved - 2.1, axis=1) + radius, "T [K]": linear(points), "U": points}
    return write(path, Mesh(points, cells, fields, {"cell": np.arange(len(cells), dtype=np.int32)}))


def series(folder: Path, count: int = 3, name: str = "run.pvd") -> Path:
    """A series whose step n is at time n / 4."""
    for n in range(count):
        flow(folder / "steps" / f"u{n}.vtu", radius=0.1 * n)
    return listed(folder / name, {n / 4: f"steps/u{n}.vtu" for n in range(count)})


def listed(path: Path, files: dict[float, str]) -> Path:
    sets = "".join(f'<DataSet timestep="{time}" file="{file}"/>' for time, file in files.items())
    path.write_text(f'<?xml version="1.0"?><VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
    return path


def entries(path: Path) -> list[tuple[float, int, str]]:
    root = ElementTree.fromstring(path.read_bytes())
    assert root.attrib["type"] == "Collection"
    sets = [one.attrib for one in root.iter("DataSet")]
    return [(float(one["timestep"]), int(one["part"]), one["file"]) for one in sets]


@pytest.fixture(autouse=True)
def folders(tmp_path: Path) -> None:
    (tmp_path / "steps").mkdir()


@pytest.mark.parametrize("packed", [(), ("--compress",)], ids=["raw", "zlib"])
@pytest.mark.parametrize("moved", [0.0, FAR], ids=["float32", "float64"])
def test_a_surface_is_there_with_its_fields_exactly(tmp_path, packed, moved):
    """Vertices of both widths; a linear field is exact at every vertex; isovalue and normals."""
    more = ("--carry", "all", "--report", tmp_path / "r.json", *packed)
    mesh = flow(tmp_path / "flow.vtu", moved)
    assert run(mesh, "--field", "p", "-i", 1.3, "-o", tmp_path / "a.vtp", *more).exit_code == 0
    file = VtpFile.of(tmp_path / "a.vtp")
    points = file.points["Points"]
    assert points.dtype == (np.float64 if np.any(moved) else np.float32)
    assert list(file.point_data) == ["Normals", "T [K]", "U", "cell"]
    assert file.marked == {"Scalars": "T [K]", "Normals": "Normals"}
    np.testing.assert_allclose(file.point_data["T [K]"], linear(points), rtol=2e-7, atol=2e-6)
    np.testing.assert_allclose(file.point_data["U"], points, rtol=2e-7)
    np.testing.assert_array_equal(file.cell_data["isovalue"], np.full(len(file.polys), 1.3))
    (row,) = rows(tmp_path / "r.json")
    assert (len(points), len(file.polys)) == (row["surface"]["vertices"], row["surface"]["triangles"])
    low, high = row["surface"]["bounds"]
    np.testing.assert_array_equal((points.min(axis=0), points.max(axis=0)), (low, high))


def test_a_volumes_linear_field_is_exact(tmp_path):
    """The other kind of input."""
    index = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), axis=-1)
    write_nifti(tmp_path / "heat.nii", linear(index))
    more = ("-i", 40, "-o", tmp_path / "a.vtp", "--carry", tmp_path / "heat.nii", "--cap")
    assert run(write_nifti(tmp_path / "scan.nii", ball()), *more).exit_code == 0
    file = VtpFile.of(tmp_path / "a.vtp")
    np.testing.assert_allclose(file.point_data["heat"], linear(file.points["Points"]), rtol=0, atol=2e-5)
    assert file.field_data == {"space": "ras", "unit": "mm"}


@pytest.mark.parametrize("packed", [(), ("--compress",)], ids=["raw", "zlib"])
def test_vtk_reads_them(tmp_path, packed):
    """VTK's reader finds every array as it was written; of an empty surface, too."""
    vtk = pytest.importorskip("vtk", reason="VTK is not installed")
    numpy_support = pytest.importorskip("vtk.util.numpy_support")
    scan = series(tmp_path)
    for isovalue in (1.3, 99):
        more = ("--field", "p", "-i", isovalue, "-d", tmp_path, "-f", "vtp", "--carry", "all", "--steps", "2", *packed)
        assert run(scan, *more).exit_code == 0
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(str(tmp_path / "run_2.vtp"))
        reader.Update()
        found, file = reader.GetOutput(), VtpFile.of(tmp_path / "run_2.vtp")
        assert (found.GetNumberOfPoints(), found.GetNumberOfPolys()) == (len(file.points["Points"]), len(file.polys))
        assert found.GetFieldData().GetArray("TimeValue").GetValue(0) == 0.5
        if len(file.polys):
            for name, values in file.point_data.items():
                array = found.GetPointData().GetArray(name)
                np.testing.assert_array_equal(numpy_support.vtk_to_numpy(array), values)
            assert found.GetPointData().GetNormals().GetName() == "Normals"
            assert found.GetCellData().GetArray("isovalue").GetRange() == (1.3, 1.3)


def test_blocks_of_packed_arrays_are_read_back(tmp_path):
    """Also a last one that is full, and for any number of threads the same bytes."""
    count = 1 << 18  # 12 bytes each: three blocks, exactly
    vertices = np.random.default_rng(1).random((count, 3)).astype(np.float32)
    triangles = np.random.default_rng(2).integers(0, count, (1000, 3)).astype(np.int32)
    surface = Surface(vertices, triangles, fields={"Normals": np.arange(count, dtype=np.float64)})
    made = []
    for threads in (1, 3):
        with (tmp_path / "a.vtp").open("wb") as stream:
            write_vtp(stream, surface, threads, compress=True)
        made.append((tmp_path / "a.vtp").read_bytes())
    assert made[0] == made[1]
    np.testing.assert_array_equal(VtpFile.of(tmp_path / "a.vtp").point_data["Normals"], np.arange(count))
    mesh = read_mesh(tmp_path / "a.vtp")
    assert mesh is not None
    np.testing.assert_array_equal(mesh[0], vertices)
    np.testing.assert_array_equal(mesh[1], triangles)
    (tmp_path / "a.vtp").write_bytes(made[0][: len(made[0]) // 2])
    assert read_mesh(tmp_path / "a.vtp") is None


def test_a_field_called_normals_stands_beside_the_normals(tmp_path):
    """Two arrays of one name would be one."""
    surface = Surface(
        np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32), np.eye(3, dtype=np.float32),
        offset=(1.0, 2.0, 3.5), unit="mm", fields={"Normals": np.arange(3.0), "<&'\"": np.zeros(3)},
    )  # fmt: skip
    isocore.write(surface, tmp_path / "a.vtp")
    file = VtpFile.of(tmp_path / "a.vtp")
    assert list(file.point_data) == ["Normals", "Normals_2", "<&'\""]
    assert file.field_data == {"offset": [1, 2, 3.5], "unit": "mm"}


def test_labels_are_data_of_the_cells(tmp_path):
    """In a file of all labels."""
    labels = (ball() > 50).astype(np.uint8) + (ball() > 70).astype(np.uint8)
    scan = write_nifti(tmp_path / "scan.nii", labels)
    assert run(scan, "--labels", "all", "-o", tmp_path / "a.vtp").exit_code == 0
    file = VtpFile.of(tmp_path / "a.vtp")
    assert set(file.cell_data) == {"label"} and set(file.cell_data["label"]) == {1, 2}


def test_a_series_gets_a_list_of_its_surfaces(tmp_path):
    """By time, several isovalues as parts; steps that fail are left out, those that are up to date are in."""
    path, out = series(tmp_path, 4), tmp_path / "out"
    (tmp_path / "steps" / "u2.vtu").write_text("junk")
    more = ("--field", "p", "-i", 1.3, "-i", 1.5, "-d", out, "-f", "vtp", "--if-changed")
    wanted = [(n / 4, part, f"run_{n}_{name}.vtp") for n in (0, 1, 3) for part, name in enumerate((1.3, 1.5))]
    for _ in range(2):
        assert run(path, *more).exit_code == 1
        assert entries(out / "run.pvd") == wanted
        (out / "run.pvd").unlink()
    flow(tmp_path / "steps" / "u2.vtu")
    assert run(path, *more, "-j", 2).exit_code == 0
    assert [entry[0] for entry in entries(out / "run.pvd")] == [0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75]
    assert not list(out.glob(".*.part")) + list(out.glob("*.part"))


def test_the_list_takes_no_other_files_place(tmp_path):
    """Beside its series it has another name; a folder that holds it is converted as if it were not there."""
    path = series(tmp_path)
    before = path.read_bytes()
    more = ("--field", "p", "-i", 1.3, "-f", "vtp", "--report", tmp_path / "r.json")
    for _ in range(2):
        assert run(path, *more).exit_code == 0
        assert path.read_bytes() == before
        names = [file for _, _, file in entries(tmp_path / "run_surfaces.pvd")]
        assert names == ["run_0.vtp", "run_1.vtp", "run_2.vtp"]
    assert run(tmp_path, *more).exit_code == 0
    assert {row["source"] for row in rows(tmp_path / "r.json")} == {str(path)}
    named = run(tmp_path / "run_surfaces.pvd", *more)
    assert named.exit_code == 1 and "lists surfaces, as run_0.vtp; name the series" in named.stderr
    (tmp_path / "sim.vtu.series").write_text(json.dumps({"files": [{"name": "steps/u0.vtu", "time": 1}]}))
    solver = listed(tmp_path / "sim.pvd", {0.0: "steps/u1.vtu"}).read_bytes()
    assert run(tmp_path / "sim.vtu.series", *more).exit_code == 0
    assert (tmp_path / "sim.pvd").read_bytes() == solver
    assert entries(tmp_path / "sim_surfaces.pvd") == [(1.0, 0, "sim_0.vtp")]


def test_the_list_is_told_of_beforehand_and_to_make(tmp_path):
    """--dry-run and the depfile name it; other formats have none."""
    path, out = series(tmp_path), tmp_path / "out"
    more = ("--field", "p", "-i", 1.3, "-d", out)
    found = run(path, *more, "-f", "vtp", "--dry-run")
    assert f"{path} -> {out / 'run.pvd'}: lists 3 surfaces with their times" in found.stdout
    assert not out.exists()
    assert run(path, *more, "-f", "vtp", "--depfile", tmp_path / "a.d").exit_code == 0
    assert f"{out / 'run.pvd'}: {out / 'run_0.vtp'} {out / 'run_1.vtp'}" in (tmp_path / "a.d").read_text()
    (out / "run.pvd").unlink()
    assert run(path, *more, "-f", "ply").exit_code == 0
    assert not (out / "run.pvd").exists()


def test_a_list_that_cannot_be_written_is_a_warning(tmp_path, monkeypatch):
    """The surfaces are whole."""

    def refuse(self: object) -> None:
        raise OutputError("run.pvd: disk full")

    monkeypatch.setattr("isocore.batches.collection.Collection.save", refuse)
    more = ("--field", "p", "-i", 1.3, "-d", tmp_path / "out", "-f", "vtp", "--report", tmp_path / "r.json")
    assert run(series(tmp_path, 2), *more).exit_code == 0
    assert all("the surfaces themselves are whole" in row["warnings"][-1] for row in rows(tmp_path / "r.json"))


MERGED = ("-i", 45, "-i", 55, "-i", 999, "--merge-isovalues")


@pytest.mark.parametrize("format_", ["ply", "obj", "vtp", "glb", "stl", "gii"])
def test_all_isovalues_of_an_input_share_a_file(tmp_path, format_):
    """Which has the vertices and triangles of all, and says of each triangle which it belongs to, where it can."""
    scan = write_nifti(tmp_path / "scan.nii", ball())
    assert run(scan, *MERGED, "-d", tmp_path / "out", "-f", format_, "--report", tmp_path / "r.json").exit_code == 0
    made = rows(tmp_path / "r.json")
    assert [row["status"] for row in made] == ["done", "done", "empty"]
    assert {row["output"] for row in made} == {str(tmp_path / "out" / f"scan.{format_}")}
    assert {row["sha256"] for row in made} == {made[0]["sha256"]}
    counts = [row["surface"]["triangles"] for row in made]
    target = tmp_path / "out" / f"scan.{format_}"
    mesh = read_mesh(target)
    assert mesh is not None and len(mesh[1]) == sum(counts)
    wanted = np.repeat([45.0, 55.0], counts[:2])
    if format_ == "ply":
        raw = trimesh.load(target, process=False).metadata["_ply_raw"]["face"]["data"]
        np.testing.assert_array_equal(raw["isovalue"].ravel(), wanted)
    if format_ == "vtp":
        np.testing.assert_array_equal(VtpFile.of(target).cell_data["isovalue"], wanted)
    if format_ == "obj":
        assert [line for line in target.read_text().splitlines() if line[:2] == "o "] == [
            "o scan_45", "o scan_55", "o scan_999"
        ]  # fmt: skip
    if format_ == "glb":
        assert set(trimesh.load_scene(target).geometry) == {"scan_45", "scan_55"}


def test_a_merged_file_is_up_to_date_only_with_the_same_isovalues(tmp_path):
    """One more, or one less, and it is made again, with all its rows."""
    scan = write_nifti(tmp_path / "scan.nii", ball())
    more = ("-o", tmp_path / "a.ply", "--merge-isovalues", "--if-changed", "--report", tmp_path / "r.json")
    statuses = []
    for isovalues in ((45, 55), (45, 55), (45,), (45,), (55, 45)):
        assert run(scan, *(word for one in isovalues for word in ("-i", one)), *more).exit_code == 0
        statuses.append([row["status"] for row in rows(tmp_path / "r.json")])
    assert statuses == [["done"] * 2, ["skipped"] * 2, ["done"], ["skipped"], ["done"] * 2]


def test_a_merged_file_of_fields_has_one_range_of_colours(tmp_path):
    """That of all its isovalues, in each row; requirements are those of each surface."""
    scan = write_nifti(tmp_path / "scan.nii", ball())
    write_nifti(tmp_path / "heat.nii", np.arange(12.0)[:, None, None] * np.ones((12, 12, 12)))
    more = ("--carry", tmp_path / "heat.nii", "--require", "watertight", "--report", tmp_path / "r.json")
    more += ("--report", tmp_path / "r.xml")
    assert run(scan, *MERGED, *more, "-o", tmp_path / "a.glb").exit_code == 3
    made = rows(tmp_path / "r.json")
    assert made[0]["colors"] == made[1]["colors"]
    ranges = [row["carried"][0]["range"] for row in made[:2]]
    assert made[0]["colors"]["range"] == [min(low for low, _ in ranges), max(high for _, high in ranges)]
    assert [bool(row["missed"]) for row in made] == [False, False, True]
    assert (tmp_path / "r.xml").read_text().count("<testcase") == 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--merge-isovalues", "--name", "{stem}_{isovalue}"), "with --merge-isovalues one file has all"),
        (("--merge-isovalues", "--labels", "all"), "does not go with --merge-isovalues"),
        (("-f", "ply", "--compress"), "--compress: packs the arrays of VTP, and ply has no such thing"),
        (("-o", "a.ply"), "use -d, or --merge-isovalues"),
    ],
)
def test_nonsense_is_refused_before_any_work(tmp_path, arguments, message):
    """With what to do instead."""
    scan = write_nifti(tmp_path / "scan.nii", ball())
    isovalues = () if "--labels" in arguments else ("-i", 45, "-i", 55)
    found = run(scan, *isovalues, *arguments)
    assert found.exit_code and message in found.output + str(found.exception)


def test_python_merges_too(tmp_path):
    """One output, a report of each isovalue in order."""
    scan = write_nifti(tmp_path / "scan.nii", ball())
    asked = {"isovalues": [45, 55], "format": "vtp", "merge_isovalues": True, "compress": True}
    result = convert_files(scan, tmp_path / "out", **asked)
    assert [run.asked.asked for run in result.outputs] == ["45", "55"]
    assert {run.output for run in result.outputs} == {str(tmp_path / "out" / "scan.vtp")}
