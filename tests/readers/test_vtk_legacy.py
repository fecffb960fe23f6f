"""Legacy VTK files: every grid, as text and in bytes, of every version, and what is wrong with damaged ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cell_shapes import block
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from legacy_files import WAYS, structured, write_grid
from vtu_files import Mesh, write

from isocore import extract, measure
from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, IsocoreError
from isocore.readers import ReadOptions, read
from isocore.readers.vtk_legacy import legacy_fields
from isocore.volume import Volume

DATA = Path(__file__).parents[3] / "shared" / "data"
def mixed() -> Mesh:
    """Every straight shape, with a field in single precision and others beside it."""
    points, cells = block(np.array([["/", "p"], ["h", "\\"]])[:, :, None].repeat(2, axis=2))
    cells.insert(3, (10, [0, 1, 3, 9]))
    values = np.sin(np.arange(len(points)) + 0.5)
    vector = np.stack([values, 2 * values, 0 * values], axis=1)
    of_points = {"f": values.astype(np.float32), "a vector": vector, "n": np.arange(len(points), dtype=np.int16)}
    return Mesh(points, cells, of_points, {"part": np.arange(len(cells), dtype=np.int32)})


def assert_same(ours: CellMesh, theirs: CellMesh) -> None:
    for name in ("points", "tets", "hexes", "values"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)
    assert ours.cell_counts == theirs.cell_counts and ours.warnings == theirs.warnings


@pytest.mark.parametrize("version, mode", WAYS)
@pytest.mark.parametrize("field, component", [("f", None), ("a vector", "1"), ("n", None), ("part", None)])
def test_an_unstructured_grid_is_the_mesh_that_vtu_holds(field, component, version, mode, tmp_path):
    """Whatever the version, as text or in bytes; names have their blanks again."""
    options = ReadOptions(field=field, component=component)
    ours = read(write_grid(tmp_path / "a.vtk", mixed(), version, mode), options)
    assert_same(ours, read(write(tmp_path / "a.vtu", mixed()), options))


@pytest.mark.parametrize("version, mode", WAYS)
def test_fields_are_listed_without_reading_them(version, mode, tmp_path):
    """Those of points first."""
    path = write_grid(tmp_path / "a.vtk", mixed(), version, mode)
    found = [(field.name, field.components, field.of) for field in legacy_fields(path)]
    assert found == [("f", 1, "points"), ("a vector", 3, "points"), ("n", 1, "points"), ("part", 1, "cells")]


@pytest.mark.parametrize("version, mode", WAYS)
@pytest.mark.parametrize("field", ["u", "c"])
def test_polyhedra_stand_in_the_connectivity_by_their_faces(field, version, mode, tmp_path):
    """An octahedron beside a tetrahedron; a field of cells is averaged at their points."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (2, 2, 2)], float)
    sides = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    stream = [8, *(n for side in sides for n in (3, *side))]
    cells = [(10, [0, 2, 4, 6]), (42, list(range(6))), (10, [0, 2, 5, 6])]
    mesh = Mesh(points, cells, {"u": points[:, 0]}, {"c": np.array([1.0, 2.0, 3.0])})
    path = write_grid(tmp_path / "a.vtk", mesh, version, mode, faces={1: stream})
    found = read(path, ReadOptions(field=field))
    assert len(found.tets) == 10 and found.cell_counts == {"tetrahedra": 2, "polyhedra": 1}
    assert found.values[6] == (2 if field == "u" else 2.0) and found.values[1] == (-1 if field == "u" else 2.0)


def test_ghosts_and_old_nodes_are_known_here_too(tmp_path):
    """vtkGhostType among the fields of cells; Lagrange hexahedra by the order of the file's version."""
    marked = Mesh(mixed().points, mixed().cells, {"f": mixed().point_fields["f"]}, {})
    marks = np.zeros(len(marked.cells), np.uint8)
    marks[0] = 1
    mesh = Mesh(marked.points, marked.cells, marked.point_fields, {"part": marks, "vtkGhostType": marks})
    found = read(write_grid(tmp_path / "a.vtk", mesh), ReadOptions(field="f"))
    assert found.connectivity.ghost_cells == 1


@pytest.mark.parametrize("mode", ["ASCII", "BINARY"])
@pytest.mark.parametrize("kind", ["STRUCTURED_POINTS", "RECTILINEAR_GRID", "STRUCTURED_GRID"])
def test_grids_of_all_kinds_have_the_same_surface(kind, mode, tmp_path):
    """Structured points are a volume, the others meshes of hexahedra; a ball in each is the same closed surface."""
    shape = (9, 8, 7)
    z, y, x = np.meshgrid(*(np.linspace(0, 1, n) for n in reversed(shape)), indexing="ij")
    ball = np.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2).ravel()
    path = tmp_path / "a.vtk"
    path.write_bytes(structured(kind, mode, shape, {"r": ball}, {"c": np.zeros(8 * 7 * 6, np.float32)}))
    field = read(path, ReadOptions(field="r"))
    assert isinstance(field, Volume if kind == "STRUCTURED_POINTS" else CellMesh)
    measured = measure(extract(field, 0.37, backend="mc"))
    assert measured.watertight
    expected = tmp_path / "b.vtk"
    expected.write_bytes(structured("STRUCTURED_GRID", "ASCII", shape, {"r": ball}, {}))
    reference = measure(extract(read(expected), 0.37, backend="mc"))
    assert measured.triangles == reference.triangles and measured.area == pytest.approx(reference.area, rel=1e-5)


def test_flat_grids_and_surfaces_are_refused_with_what_they_are(tmp_path):
    """There is no cell that fills space."""
    path = tmp_path / "a.vtk"
    for kind, said in (("RECTILINEAR_GRID", "holds a grid of 4x3x1"), ("STRUCTURED_GRID", "holds a grid of 4x3x1")):
        text = structured(kind, "ASCII", (4, 3, 2), {}, {}).decode()
        path.write_text(structured_flat(kind, text))
        with pytest.raises(IsocoreError, match=said):
            read(path)
    path.write_text("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n")
    with pytest.raises(IsocoreError, match=r"holds only surface cells \(POLYDATA\)"):
        read(path)


def structured_flat(kind: str, text: str) -> str:
    """The same grid with one layer of points, and a field."""
    text = text.replace("DIMENSIONS 4 3 2", "DIMENSIONS 4 3 1")
    if kind == "RECTILINEAR_GRID":
        text = text.replace("Z_COORDINATES 2 double\n0.0 1.0", "Z_COORDINATES 1 double\n0.0")
    else:
        head, numbers = text.split("POINTS 24 double\n")
        text = f"{head}POINTS 12 double\n{' '.join(numbers.split()[:36])}\n"
    return text + "POINT_DATA 12\nSCALARS r float 1\nLOOKUP_TABLE default\n" + "0 " * 12 + "\n"


def test_numbers_are_read_as_fortran_prints_them(tmp_path):
    """The words of VTU's text are those of legacy files."""
    path = write_grid(tmp_path / "a.vtk", Mesh(np.eye(4, 3), [(10, [0, 1, 2, 3])], {"u": np.arange(4.0)}))
    path.write_text(path.read_text().replace("0.0 1.0 2.0 3.0", "0.0 1.0D+00 2.0-101 -nan(ind)"))
    np.testing.assert_array_equal(read(path).values, [0, 1, 2e-101, np.nan])


@pytest.mark.parametrize("mode", ["ASCII", "BINARY"])
def test_strings_bits_and_colours_are_passed_over(mode, tmp_path):
    """They stand between arrays of numbers, and have no isosurface."""
    path = write_grid(tmp_path / "a.vtk", Mesh(np.eye(4, 3), [(10, [0, 1, 2, 3])], {"u": np.arange(4.0)}), "4.2", mode)
    binary = mode == "BINARY"
    words = [b"", b"a b", b"c" * 70, b"d"]
    strings = b"".join((b"\xc0" if not w else bytes([0xC0 | len(w)]) if len(w) < 64 else b"\x80F") + w for w in words)
    more = b"FIELD more 2\nnames 1 4 string\n" + (strings if binary else b"\na%20b\nc\nd") + b"\n"
    more += b"bits 1 4 bit\n" + (b"\x50" if binary else b"0 1 0 1") + b"\n"
    more += b"COLOR_SCALARS colours 3\n" + (bytes(range(12)) if binary else b"0.5 " * 12) + b"\n"
    more += b"LOOKUP_TABLE table 2\n" + (bytes(8) if binary else b"0 " * 8) + b"\n"
    more += b"VECTORS v float\n" + (np.arange(12, dtype=">f4").tobytes() if binary else b"1 " * 12) + b"\n"
    path.write_bytes(path.read_bytes() + more)
    assert [field.name for field in legacy_fields(path)] == ["u", "colours", "v"]
    assert len(read(path, ReadOptions(field="v", component="0")).values) == 4


GOOD = Mesh(np.eye(5, 3), [(10, [0, 1, 2, 3]), (10, [1, 2, 3, 4])], {"u": np.arange(5.0)}, {})


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("DATASET UNSTRUCTURED_GRID", "DATASET TABLE", "holds a TABLE, which is none of UNSTRUCTURED_GRID"),
        ("DATASET UNSTRUCTURED_GRID", "", "where DATASET is expected"),
        ("POINTS 5", "POINTS 999999999999", "array 'POINTS' ends early"),
        ("POINTS 5", "POINTS -5", "has '-5' in its line 'POINTS -5 double', not a count"),
        ("POINTS 5 double", "POINTS 5", "is cut short"),
        ("POINTS 5 double", "POINTS 5 quad", "array 'POINTS' has type 'quad', none of VTK's"),
        ("CELL_TYPES 2", "CELL_TYPES 3", "has '5' where a keyword of the format is expected, behind CELL_TYPES"),
        ("CELLS 2 10\n4", "CELLS 2 10\n55", "cell 0 has 55 points, more than are listed"),
        ("CELLS 2 10\n4", "CELLS 2 10\n9", "lists 1 cells and 2 types"),
        ("CELLS 2 10\n4 0", "CELLS 2 10\n4 77", "names point 77, but there are 5"),
        ("POINT_DATA 5", "POINT_DATA 4", "POINT_DATA is for 4 of them, there are 5"),
        ("SCALARS u", "SCALES u", "has 'SCALES u double 1' where a keyword of the format is expected"),
        ("0.0 1.0 2.0 3.0 4.0", "0.0 1.0 oops 3.0 4.0", "holds 'oops' in line"),
        ("0.0 1.0 2.0 3.0 4.0", "0.0 1.0 2.0", "has '0' where a keyword of the format is expected, behind u"),
        ("ASCII", "ASKEY", "does not start as a legacy VTK file does"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(old, new, message, tmp_path):
    """Counts, words and types that do not fit."""
    path = write_grid(tmp_path / "a.vtk", GOOD)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ") and message in str(caught.value)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), way=st.sampled_from(WAYS))
def test_any_damaged_byte_is_read_or_refused_in_one_line(data, way, tmp_path):
    """Whatever happens, it is an error of ours or a field."""
    path = write_grid(tmp_path / "a.vtk", mixed(), *way)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place : place + data.draw(st.integers(0, 2))] = data.draw(st.binary(max_size=2))
    if data.draw(st.booleans()):
        content = content[: data.draw(st.integers(1, len(content)))]
    path.write_bytes(content)
    try:
        read(path, ReadOptions(field="f"))
    except IsocoreError as error:
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error)


@pytest.mark.skipif(not DATA.is_dir(), reason="the real data lies beside the repository, not in it")
@pytest.mark.parametrize(
    "name, field, isovalue, triangles",
    [
        ("meshes/vtk-data/hexa.vtk", "scalars", 8.1, 3308),
        ("meshes/vtk-data/tetraMesh.vtk", "scalars", 2.2, 180),
        ("meshes/vtk-data/CylinderLinear.vtk", "vel_norm", 0.51, 1622),
        ("meshes/cleaver/output.vtk", "labels", 1.37, 1960),
        ("meshes/sfepy/multi_material_cylinder_plate.vtk", "mat_id", 1.63, 1469),
        ("meshes/sfepy/piezo_mesh_micro.vtk", "mat_id", 1.37, 11764),
    ],
)
def test_real_files_have_as_many_triangles_as_vtk_finds(name, field, isovalue, triangles):
    """Counts are VTK 9.7's, of its cleaned grid."""
    assert measure(extract(read(DATA / name, ReadOptions(field=field)), isovalue, backend="mc")).triangles == triangles


def test_a_number_that_is_no_float32_is_infinite(tmp_path):
    """It counts as outside, as in VTU, without a warning of Python's."""
    path = write_grid(tmp_path / "a.vtk", mixed())
    text = path.read_text()
    start = text.index("LOOKUP_TABLE default\n", text.index("SCALARS f float")) + len("LOOKUP_TABLE default\n")
    path.write_text(f"{text[:start]}1e300 {text[text.index(' ', start) + 1 :]}")
    mesh = read(path, ReadOptions(field="f"))
    assert np.isinf(mesh.values).sum() == 1 and any("not finite" in warning for warning in mesh.warnings)
