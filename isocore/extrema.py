"""Local extrema of a mesh's values: where isosurface components begin and end.

Points are ordered by (value, number), so that a plateau has one extremum, not as many as points. Neighbours are
joined by an edge of a cell; a diagonal is none.
"""

from __future__ import annotations

import numpy as np

from isocore.cell_mesh import CellMesh

_TET_EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
_HEX_RINGS = tuple((base + i, base + (i + 1) % 4) for base in (0, 4) for i in range(4))
_HEX_EDGES = (*_HEX_RINGS, *((i, i + 4) for i in range(4)))


def count_extrema(mesh: CellMesh) -> tuple[int, int]:
    """How many points of cells are local minima, and how many local maxima."""
    order = np.empty(len(mesh.points), np.int64)
    order[np.argsort(mesh.values, kind="stable")] = np.arange(len(order))
    lowest = np.zeros(len(order), np.bool_)
    for cells in (mesh.tets, mesh.hexes):
        lowest[cells.ravel()] = True
    highest = lowest.copy()
    for cells, edges in ((mesh.tets, _TET_EDGES), (mesh.hexes, _HEX_EDGES)):
        for a, b in edges:
            first, second = cells[:, a], cells[:, b]
            rising = order[first] < order[second]
            lowest[np.where(rising, second, first)] = False
            highest[np.where(rising, first, second)] = False
    return int(lowest.sum()), int(highest.sum())
