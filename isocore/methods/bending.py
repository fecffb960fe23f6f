"""Move a surface's vertices onto the curve that value and place describe along their edges.

Where a mesh's curved cells were divided into straight ones, a vertex lies on an edge between two nodes. Along it value
and place are not linear: three values each, at its ends and half way, make parabolas. The vertex belongs where the
first reaches the isovalue, at the place the second gives. So its distance from the cells' own surface shrinks with the
third power of the cells' size, where linear interpolation's shrinks with the second.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh, CurvedCells

_CLAMP = 2.0**-10  # as in kernels/common/crossing.hpp
_NODES = 1 << 20  # values of nodes that are gathered at a time

#: (n,) vertices, and (n, k) values there.
_Values = tuple[npt.NDArray[np.intp], npt.NDArray[np.float64]]
#: Weights (n, L) and nodes (n, L) whose sum is the value half way along each edge.
_HalfWay = tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]
#: By the name of a carried field of points: the vertices that were moved, and its values there.
Curved = dict[str, _Values]


def bend(
    mesh: CellMesh,
    edges: npt.NDArray[np.int32],
    vertices: npt.NDArray[Any],
    triangles: npt.NDArray[np.int32],
    isovalue: float,
) -> tuple[npt.NDArray[Any], Curved]:
    """(v, 3) the vertices on edges of divided cells moved along them, the others as they are; carried values there.

    edges: (e, 2) points of the mesh, ascending, of the first e vertices; those behind lie in the middle of a loop.
    """
    curved: dict[str, list[_Values]] = {}
    if not len(edges):
        return vertices, {}
    keys = edges[:, 0].astype(np.int64) * len(mesh.points) + edges[:, 1]
    order = np.argsort(keys, kind="stable")
    moved = vertices.astype(np.float64)
    left = np.ones(len(edges), np.bool_)
    for cells in mesh.curved:
        step = max(1, _NODES // cells.nodes.shape[1])
        for first in range(0, len(cells.nodes), step):
            some = cells.nodes[first : first + step]
            _bend_some(mesh, cells, some, isovalue, (keys[order], order, left), moved, curved)
    _follow(moved, vertices, triangles, len(edges))
    return moved.astype(vertices.dtype), {name: _whole(parts) for name, parts in curved.items()}


def _bend_some(
    mesh: CellMesh,
    cells: CurvedCells,
    nodes: npt.NDArray[np.int32],
    isovalue: float,
    search: tuple[npt.NDArray[np.int64], npt.NDArray[np.intp], npt.NDArray[np.bool_]],
    moved: npt.NDArray[np.float64],
    curved: dict[str, list[_Values]],
) -> None:
    """search: keys of edges, ascending; the vertex of each; which vertices no cell has moved so far."""
    inside = mesh.values[nodes] >= isovalue
    some = nodes[inside.any(axis=1) & ~inside.all(axis=1)]
    inside = mesh.values[some] >= isovalue
    cell, pair = np.nonzero(inside[:, cells.pairs[:, 0]] != inside[:, cells.pairs[:, 1]])
    ends = np.sort(np.take_along_axis(some[cell], cells.pairs[pair], axis=1), axis=1)
    keys, order, left = search
    wanted = ends[:, 0].astype(np.int64) * len(mesh.points) + ends[:, 1]
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    found = np.flatnonzero(keys[place] == wanted)
    found = found[left[order[place[found]]]]
    _, once = np.unique(place[found], return_index=True)
    found = found[once]
    step = max(1, _NODES // nodes.shape[1])
    for first in range(0, len(found), step):
        chosen = found[first : first + step]
        vertex = order[place[chosen]]
        weights, around = cells.weights[pair[chosen]], some[cell[chosen]]
        share = _crossing(mesh, ends[chosen], (weights, around), isovalue)
        at = _parabola(mesh.points, ends[chosen], (weights, around), share)
        sound = np.isfinite(at).all(axis=1)
        moved[vertex[sound]] = at[sound]
        for carried in mesh.carried:
            if carried.of == "points":
                nodal = carried.values.reshape(len(mesh.points), -1)
                values = _parabola(nodal, ends[chosen], (weights, around), share)
                curved.setdefault(carried.name, []).append((vertex[sound], values[sound]))
        left[vertex] = False


def _crossing(
    mesh: CellMesh,
    ends: npt.NDArray[np.int32],
    half_way: _HalfWay,
    isovalue: float,
) -> npt.NDArray[np.float64]:
    """(n, 1) how far along the edge the parabola of the values reaches the isovalue; NaN where one is no number."""
    weights, around = half_way
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        a, c = (mesh.values[ends[:, n]].astype(np.float64) - isovalue for n in (0, 1))
        b = np.einsum("nl,nl->n", weights, mesh.values[around]) - isovalue
        # a + linear t + square t^2 is a at 0, b half way and c at 1; a and c differ in sign, so one root lies between.
        linear, square = 4 * b - 3 * a - c, 2 * (a + c) - 4 * b
        root = np.sqrt(np.maximum(linear * linear - 4 * square * a, 0))
        summed = -0.5 * (linear + np.copysign(root, linear))
        first, second = a / summed, summed / square
        t = np.where((first >= 0) & (first <= 1), first, second)
    return np.asarray(np.clip(np.where((t >= 0) & (t <= 1), t, a / (a - c)), _CLAMP, 1 - _CLAMP)[:, None])


def _parabola(
    nodal: npt.NDArray[Any], ends: npt.NDArray[np.int32], half_way: _HalfWay, share: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """(n, k) at `share` (n, 1) of the way along each edge. nodal: (p, k), of the mesh's points."""
    weights, around = half_way
    start, end = (nodal[ends[:, n]].astype(np.float64) for n in (0, 1))
    middle = np.einsum("nl,nlx->nx", weights, nodal[around])
    along = start + share * (4 * middle - 3 * start - end)
    return np.asarray(along + share * share * (2 * (start + end) - 4 * middle))


def _whole(parts: list[_Values]) -> _Values:
    return np.concatenate([rows for rows, _ in parts]), np.concatenate([values for _, values in parts])


def _follow(
    moved: npt.NDArray[np.float64], vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], edges: int
) -> None:
    """Vertices in the middle of a loop move as their neighbours do on average."""
    if edges == len(vertices):
        return
    shift = moved[:edges] - vertices[:edges]
    total, count = np.zeros((len(vertices) - edges, 3)), np.zeros(len(vertices) - edges)
    for a, b in ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)):
        touching = (triangles[:, a] >= edges) & (triangles[:, b] < edges)
        middle, beside = triangles[touching, a] - edges, triangles[touching, b]
        np.add.at(total, middle, shift[beside])
        np.add.at(count, middle, 1)
    moved[edges:] += total / np.maximum(count, 1)[:, None]
