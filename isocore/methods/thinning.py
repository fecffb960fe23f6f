"""Volume thinning and isosurface propagation: thin a mesh once, contour it many times.

Follows Itoh, Yamaguchi, Koyamada, "Volume Thinning for Automatic Isosurface Propagation", IEEE Visualization 1996,
and "Fast Isosurface Generation Using the Volume Thinning Algorithm", IEEE TVCG 7(1), 2001; isocore/kernels/thinning
says where it departs.
"""

from __future__ import annotations

from threading import Lock
from typing import Any, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.errors import IsocoreError
from isocore.extraction import Extract, Extraction, Field, Options
from isocore.methods.grid_thinning import NOISE, prepare_grid_thinning
from isocore.methods.index_file import load_index
from isocore.methods.marching_cells import mesh_surface, mesh_warnings, single_precision
from isocore.methods.mesh_index import IndexPart, MeshIndex

#: Vertices (v, 3), triangles (t, 3), seeds, visited cells.
Walked: TypeAlias = tuple[npt.NDArray[Any], npt.NDArray[np.int32], int, int]


def build_index(mesh: CellMesh) -> MeshIndex:
    """Thin the mesh; linear in its cells."""
    tets, hexes, original, edges = _kernels.build_index(mesh.points, mesh.tets, mesh.hexes, mesh.values)
    return MeshIndex(IndexPart(*tets), IndexPart(*hexes), original, edges)


def prepare_thinning(field: Field, options: Options) -> Extract:
    """Thin the field once, then walk for every isovalue."""
    return _prepare_mesh(field, options) if isinstance(field, CellMesh) else prepare_grid_thinning(field, options)


def _prepare_mesh(mesh: CellMesh, options: Options) -> Extract:
    """Take the index from `options.index` if it matches, else thin now; then walk for every isovalue."""
    index, warnings = _index_of(mesh, options)
    warnings = (*mesh_warnings(options), *warnings, *_oddities(index))
    walker, single = Walker(mesh, index), single_precision(mesh)
    known = {"cells": mesh.cells, "extrema": index.extrema, "skeleton": index.skeleton_cells}

    def extract(isovalue: float) -> Extraction:
        vertices, triangles, seeds, visited = walker.propagate(isovalue, options.threads, single=single)
        surface = mesh_surface(mesh, vertices, triangles, normals=options.normals)
        search = {**known, "seeds": seeds, "visited": visited, "intersected": visited}
        return Extraction(surface, {"search": search}, warnings)

    return extract


def _index_of(mesh: CellMesh, options: Options) -> tuple[MeshIndex, tuple[str, ...]]:
    """The index beside the mesh if it matches, else a new one; and what to tell the user about that choice."""
    warnings = []
    if options.index is not None:
        try:
            return load_index(options.index, mesh), ()
        except IsocoreError as error:
            warnings.append(f"{error}; thinned anew")
    index = build_index(mesh)
    if options.isovalues == 1:
        warnings.append("one isovalue does not repay thinning: choose -b mc, or keep the index with `isocore index`")
    if index.extrema > NOISE * len(mesh.points):
        share = 100 * index.extrema / len(mesh.points)
        warnings.append(
            f"{share:.0f} % of the points are extrema, so the field is noise to thinning and its skeleton holds "
            f"{index.skeleton_cells:,} of {mesh.cells:,} cells: -b mc may be faster"
        )
    return index, tuple(warnings)


def _oddities(index: MeshIndex) -> tuple[str, ...]:
    """One line per kind of cell that is not glued to its neighbours, naming the first offender."""
    warnings = []
    for kind, part in (("tetrahedra", index.tets), ("hexahedra", index.hexes)):
        if part.crowded_faces:
            cells = ", ".join(str(cell) for cell in part.crowded_cells)
            warnings.append(
                f"{part.crowded_faces:,} faces are shared by more than two {kind}, the first by {cells}: "
                "contoured, but each side for itself"
            )
        if part.collapsed_cells:
            warnings.append(
                f"{part.collapsed_cells:,} {kind} name a point twice, the first is {part.collapsed_cell}: "
                "contoured, but each for itself"
            )
    return tuple(warnings)


class Walker:
    """A mesh and its index, ready to walk; one call at a time, since calls number their vertices in the same place."""

    def __init__(self, mesh: CellMesh, index: MeshIndex) -> None:
        self._arrays: list[Any] = [mesh.points[index.original], mesh.values[index.original]]
        for part in index.parts:
            self._arrays += [part.records, part.skeleton, part.low, part.high]
        self._arrays += [index.original, np.zeros(index.edges, np.int32)]
        self._one_at_a_time = Lock()

    def propagate(self, isovalue: float, threads: int = 1, *, single: bool = False) -> Walked:
        """The isosurface, as a full scan finds it; vertices in float32 (single) or float64."""
        kernel: Any = _kernels.propagate
        with self._one_at_a_time:
            return cast(Walked, kernel(*self._arrays, isovalue, threads, single))

    def walk(self, isovalue: float) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32], int]:
        """The search alone: tetrahedra and hexahedra visited, in the index's numbers, and seeds."""
        kernel: Any = _kernels.walk
        with self._one_at_a_time:
            return cast("tuple[npt.NDArray[np.int32], npt.NDArray[np.int32], int]", kernel(*self._arrays, isovalue))
