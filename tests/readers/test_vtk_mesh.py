"""A mesh from bare arrays of VTK's data model: what any reader of a VTK format hands over."""

from __future__ import annotations

import numpy as np
import pytest

from isocore.errors import InputError
from isocore.readers.options import MeshOptions
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtk_pieces import PieceData

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float32)


def tetrahedron(values: np.ndarray, *, connectivity: tuple[int, ...] = (0, 1, 2, 3)) -> PieceData:
    numbers = np.array(connectivity)
    return PieceData(CORNERS, np.array([10], np.uint8), np.array([len(numbers)]), numbers, values)


def test_pieces_become_one_mesh_with_a_value_per_point() -> None:
    """Of each point the magnitude, or one component; numbers of the second piece follow those of the first."""
    vectors = np.array([(3.0, 4.0), (0, 1), (6, 8), (5, 12)])
    field = FieldInfo("v", 2, "points", "Float64")
    pieces = [tetrahedron(vectors.ravel()), tetrahedron(2 * vectors.ravel())]
    mesh = assembled("any.file", pieces, field, None, MeshOptions(keep_duplicates=True))
    assert mesh.values.tolist() == [5, 1, 10, 13, 10, 2, 20, 26]
    assert mesh.tets.tolist() == [[0, 1, 2, 3], [4, 5, 6, 7]] and mesh.points.dtype == np.float64
    assert mesh.cell_counts == {"tetrahedra": 2} and mesh.field_name == "v"
    assert assembled("any.file", pieces[:1], field, 1).values.tolist() == [4, 1, 8, 12]


def test_values_of_cells_are_averaged_to_the_points() -> None:
    """And a warning says that this blurs them."""
    mesh = assembled("any.file", [tetrahedron(np.array([7.0]))], FieldInfo("p", 1, "cells", "Float64"), 0)
    assert mesh.values.tolist() == [7, 7, 7, 7] and "p is a cell field" in mesh.warnings[0]


def test_a_contradiction_names_the_file() -> None:
    """The arrays know no file, the message does."""
    piece = tetrahedron(np.zeros(4), connectivity=(0, 1, 2, 4))
    with pytest.raises(InputError, match=r"^any\.file: one of its tetrahedra names point 4, but there are 4;"):
        assembled("any.file", [piece], FieldInfo("p", 1, "points", "Float64"), 0)
