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
    warnings = mesh_warnings(options)

    def extract(isovalue: float) -> Extraction:
        vertices, triangles, intersected = _kernels.marching_cells(
            mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue, options.threads
        )
        surface = mesh_surface(mesh, vertices, triangles, normals=options.normals)
        facts = {"search": {"cells": mesh.cells, "visited": mesh.cells, "intersected": intersected}}
        return Extraction(surface, facts, warnings)

    return extract


def mesh_warnings(options: Options) -> tuple[str, ...]:
    """What an option does not do for meshes."""
    return (_CAP,) if options.cap else ()


def mesh_surface(
    mesh: CellMesh, vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32], *, normals: bool
) -> Surface:
    """A kernel's vertices (v, 3) and triangles (t, 3), which lie in the mesh's world already, as a Surface."""
    rounded = vertices.astype(coordinate_type(mesh, vertices), copy=False)
    directions = _kernels.triangle_normals(rounded, triangles) if normals else None
    return Surface(rounded, triangles, directions, unit=mesh.unit)


def coordinate_type(mesh: CellMesh, vertices: npt.NDArray[np.float64]) -> type[np.float32] | type[np.float64]:
    """float32, or float64 where the steps of float32 are too coarse for the mean cell."""
    if not len(vertices):
        return np.float32
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    farthest = max(np.abs(low).max(), np.abs(high).max())
    if not farthest < np.finfo(np.float32).max:
        return np.float64
    extents = np.ptp(mesh.points, axis=0)
    cell = float(np.prod(np.maximum(extents, extents.max() * 1e-6)) / mesh.cells) ** (1 / 3)
    return np.float32 if np.spacing(np.float32(farthest)) <= _COARSEST_STEP * cell else np.float64
