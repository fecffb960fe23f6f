"""Marching tetrahedra, and marching cubes on hexahedra: a mesh's full scan, and its surfaces' coordinates.

Doi, Koide 1991; Lorensen, Cline 1987; ambiguous faces by Nielson, Hamann 1991.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.extraction import Extract, Extraction, Options
from isocore.surface import Surface

# float32 is enough while its steps are below this part of a cell: some cells are smaller than the mean one, and
# vertices keep 2^-10 of an edge away from its ends.
_COARSEST_STEP = 2.0**-14

_CAP = "--cap closes volumes only: a mesh's surface stays open where it meets the mesh's boundary"


def prepare_marching_cells(mesh: CellMesh, options: Options) -> Extract:
    """Scan all cells for every isovalue."""
    warnings, cell = mesh_warnings(options), mean_cell(mesh)

    def extract(isovalue: float) -> Extraction:
        vertices, triangles, intersected = _kernels.marching_cells(
            mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue, options.threads
        )
        surface = mesh_surface(mesh, cell, vertices, triangles, normals=options.normals)
        facts = {"search": {"cells": mesh.cells, "visited": mesh.cells, "intersected": intersected}}
        return Extraction(surface, facts, warnings)

    return extract


def mesh_warnings(options: Options) -> tuple[str, ...]:
    """What an option does not do for meshes."""
    return (_CAP,) if options.cap else ()


def mean_cell(mesh: CellMesh) -> float:
    """The edge of a cube as large as the mean cell, were the mesh's box full of them. Paid once per mesh."""
    extents = np.subtract(*_box(mesh.points)[::-1])
    return float(np.cbrt(np.prod(np.maximum(extents, extents.max() * 1e-6)) / mesh.cells))


def mesh_surface(
    mesh: CellMesh, cell: float, vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32], *, normals: bool
) -> Surface:
    """A kernel's vertices (v, 3) and triangles (t, 3), which lie in the mesh's world already, as a Surface.

    cell: what `mean_cell` says of the mesh.
    """
    rounded = vertices.astype(_coordinate_type(cell, vertices), copy=False)
    directions = _kernels.triangle_normals(rounded, triangles) if normals else None
    return Surface(rounded, triangles, directions, unit=mesh.unit)


def _coordinate_type(cell: float, vertices: npt.NDArray[np.float64]) -> type[np.float32] | type[np.float64]:
    """float32, or float64 where the steps of float32 are too coarse for the mean cell."""
    if not len(vertices):
        return np.float32
    farthest = np.abs(_box(vertices)).max()
    if not farthest < np.finfo(np.float32).max:
        return np.float64
    return np.float32 if np.spacing(np.float32(farthest)) <= _COARSEST_STEP * cell else np.float64


def _box(places: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(2, 3) lowest and highest corner; numpy takes ten times as long for it."""
    return np.array(_kernels.bounds(places)).reshape(2, 3)
