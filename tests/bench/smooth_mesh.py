"""The mesh that the benches time: bricks of tetrahedra with a smooth field. Runs with earlier installs, too."""

from __future__ import annotations

from typing import Any

import numpy as np

from isocore import CellMesh

ORDERS = ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1))


def smooth_mesh(bricks: int) -> CellMesh:
    """bricks^3 cubes of six tetrahedra each, with a field of a few extrema."""
    n = bricks + 1
    at = np.stack(np.meshgrid(*[np.arange(bricks)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    weight, unit = np.array([n * n, n, 1]), np.eye(3, dtype=np.int64)
    low = at @ weight
    tets = [
        np.stack([low, low + unit[a] @ weight, low + (unit[a] + unit[b]) @ weight, low + weight.sum()], axis=1)
        for a, b in ORDERS
    ]
    points = np.stack(np.meshgrid(*[np.linspace(0, 1, n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    x, y, z = points.T
    values = np.sin(5 * x + y) + np.cos(4 * y - z) + np.sin(3.5 * z + 1.5 * x * y)
    return CellMesh(points, np.concatenate(tets).astype(np.int32), np.empty((0, 8), np.int32), values)


def vtk_grid(mesh: CellMesh) -> Any:
    """The mesh as VTK has it."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    grid, points, cells = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(mesh.points, deep=True))
    cells.SetData(4, numpy_to_vtkIdTypeArray(mesh.tets.astype(np.int64).ravel(), deep=True))
    grid.SetPoints(points)
    grid.SetCells(vtk.VTK_TETRA, cells)
    values = numpy_to_vtk(mesh.values, deep=True)
    values.SetName("values")
    grid.GetPointData().SetScalars(values)
    return grid
