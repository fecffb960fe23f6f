"""Cells that a file marks as ghosts are left out, and counted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from vtu_files import Mesh, write

from isocore import extract, measure
from isocore.errors import FieldError, InputError
from isocore.readers import read

CASES = Path(__file__).parents[3] / "shared" / "data" / "cases" / "02-vtu-ghost-cells"
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TWO = Mesh(POINTS, [(10, [0, 1, 2, 3]), (10, [1, 2, 3, 4])], {"u": np.array([0, 1, 2, 3, 1e30])})


def marked(tmp_path: Path, marks: np.ndarray, name: str = "vtkGhostType") -> Path:
    return write(tmp_path / "a.vtu", Mesh(TWO.points, TWO.cells, TWO.point_fields, {name: marks}))


@pytest.mark.parametrize("bits", [1, 8, 32, 33, 1 | 16])
def test_a_duplicate_refined_or_hidden_cell_is_left_out(bits, tmp_path):
    """With the points that no other cell names: what stands there may never have been computed."""
    mesh = read(marked(tmp_path, np.array([0, bits], np.uint8)))
    assert mesh.tets.tolist() == [[0, 1, 2, 3]] and mesh.values.tolist() == [0, 1, 2, 3]
    assert mesh.connectivity.ghost_cells == 1 and mesh.cell_counts == {"tetrahedra": 1}
    assert mesh.warnings == ("1 cells are marked as ghosts (duplicate, refined or hidden); they were left out",)


@pytest.mark.parametrize("bits", [0, 2, 4, 16])
def test_other_marks_say_nothing_about_drawing(bits, tmp_path):
    """Well or badly connected, or at the border of the domain."""
    mesh = read(marked(tmp_path, np.array([0, bits], np.uint8)))
    assert len(mesh.tets) == 2 and mesh.connectivity.ghost_cells == 0


@pytest.mark.parametrize("name", ["vtkGhostLevels", "avtGhostZones"])
def test_ghosts_of_older_files_and_of_visit_are_known(name, tmp_path):
    """There any number but 0 marks one."""
    assert len(read(marked(tmp_path, np.array([4, 0], np.int32), name)).tets) == 1


def test_a_cell_at_a_hidden_point_is_left_out(tmp_path):
    """A duplicate point is as good as any."""
    fields = {**TWO.point_fields, "vtkGhostType": np.array([2, 1, 1, 0, 0], np.uint8)}
    mesh = read(write(tmp_path / "a.vtu", Mesh(TWO.points, TWO.cells, fields)))
    assert mesh.values.tolist() == [1, 2, 3, 1e30] and mesh.connectivity.ghost_cells == 1


def test_a_file_of_ghosts_only_is_refused(tmp_path):
    """With their number."""
    with pytest.raises(FieldError, match="each of its 2 cells is a ghost"):
        read(marked(tmp_path, np.array([1, 32], np.uint8)))


def test_marks_that_are_no_bits_are_refused(tmp_path):
    """A field of that name is a mistake."""
    with pytest.raises(InputError, match="array 'vtkGhostType' holds float64 numbers, not bits"):
        read(marked(tmp_path, np.array([0.0, 1.0])))


@pytest.mark.parametrize("name, triangles, boundary", [("two_ranks", 104, 0), ("hidden", 52, 12)])
@pytest.mark.skipif(not CASES.is_dir(), reason="the cases lie beside the repository, not in it")
def test_the_files_users_met_are_drawn_as_vtk_draws_them(name, triangles, boundary):
    """Counts are VTK's, after its own removal of ghosts."""
    measured = measure(extract(read(CASES / f"{name}.vtu"), 0.6, backend="mc"))
    assert (measured.triangles, measured.boundary_edges) == (triangles, boundary)
