"""The tables of the thinning paper for the user's own mesh: what every method registers, visits and takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.benches.rivals import RIVALS, Cells
from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError
from isocore.histogram import histogram
from isocore.methods.mesh_index import IndexPart, MeshIndex
from isocore.methods.thinning import build_index, ready_index

T = TypeVar("T")

# From the corner order of the index to VTK's, which the full scan expects.
_TO_VTK = (0, 1, 3, 2, 4, 5, 7, 6)


@dataclass(frozen=True, slots=True)
class Table:
    """One of the paper's tables; a row has one entry per column.

    leaving: columns that a narrow screen goes without, in this order.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str | int | float, ...], ...]
    leaving: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Measured:
    """One method over all isovalues."""

    name: str
    registered: int
    visited: int
    found: int
    seconds_build: float
    seconds_search: float
    seconds_total: float  # search and drawing


def mesh_bench(mesh: CellMesh, *, isovalues: int = 20, threads: int = 1) -> list[Table]:
    """Tables 1 to 5 of Itoh, Yamaguchi, Koyamada 2001, over evenly spaced isovalues; what lies far apart is no end."""
    spread = histogram(mesh, threads=threads)
    if not spread.low < spread.high:
        raise FieldError("a constant field has no isosurfaces to time; choose another with --field")
    asked = np.linspace(spread.low, spread.high, isovalues + 2)[1:-1].tolist()
    seconds, index = _timed(build_index, mesh)
    measured = [*_measure_rivals(mesh, index, asked, threads), *_measure_walks(mesh, index, asked, threads, seconds)]
    return [
        _table_1(mesh, index),
        Table("Table 2: registered cells", ("method", "cells", "share"), tuple(_registered(measured, mesh.cells))),
        _table_3(index),
        Table(
            f"Table 4: visited cells, {isovalues} isovalues",
            ("method", "visited", "intersected", "visited / intersected"),
            tuple((m.name, m.visited, m.found, round(m.visited / max(m.found, 1), 3)) for m in measured),
            leaving=("intersected", "visited / intersected"),
        ),
        Table(
            f"Table 5: seconds, {isovalues} isovalues",
            ("method", "build", "search", "search and draw", "build and all"),
            tuple(_seconds(m) for m in measured),
            leaving=("search", "build"),
        ),
    ]


def _timed(function: Callable[..., T], *arguments: object) -> tuple[float, T]:
    start = perf_counter()
    result = function(*arguments)
    return perf_counter() - start, result


def _table_1(mesh: CellMesh, index: MeshIndex) -> Table:
    row = (mesh.cells, len(mesh.points), index.extrema, len(mesh.tets), len(mesh.hexes))
    return Table("Table 1: the mesh", ("cells", "nodes", "extrema", "tetrahedra", "hexahedra"), (row,))


def _table_3(index: MeshIndex) -> Table:
    """Skeleton cells by the number of their neighbours in it: C1 are its ends, C2 its paths, the others its forks."""
    classes = tuple(sum(pair) for pair in zip(*(part.classes for part in index.parts), strict=True))
    columns = ("cells", *(f"C{n}" for n in range(len(classes))))
    return Table("Table 3: skeleton cells by face neighbours", columns, ((sum(classes), *classes),))


def _registered(measured: list[Measured], cells: int) -> list[tuple[str | int | float, ...]]:
    return [(m.name, m.registered, f"{100 * m.registered / cells:.2f} %") for m in measured]


def _seconds(m: Measured) -> tuple[str | int | float, ...]:
    return (
        m.name,
        *(round(s, 4) for s in (m.seconds_build, m.seconds_search, m.seconds_total)),
        round(m.seconds_build + m.seconds_total, 4),
    )


def _corners(part: IndexPart, count: int) -> npt.NDArray[np.int32]:
    return part.records[:, :count]


def cells_of(mesh: CellMesh, index: MeshIndex) -> Cells:
    """The ranges of all cells as the index orders them, tetrahedra first."""
    heights = mesh.values[index.original].astype(np.float64)
    heights[~np.isfinite(heights)] = -np.inf
    corners = [heights[_corners(part, count)] for part, count in ((index.tets, 4), (index.hexes, 8))]
    low = np.concatenate([ends.min(axis=1, initial=np.inf) for ends in corners])
    high = np.concatenate([ends.max(axis=1, initial=-np.inf) for ends in corners])
    return Cells(low, high)


def _measure_rivals(mesh: CellMesh, index: MeshIndex, isovalues: list[float], threads: int) -> list[Measured]:
    cells = cells_of(mesh, index)
    points, values = mesh.points[index.original], mesh.values[index.original]
    tets = np.ascontiguousarray(_corners(index.tets, 4))
    hexes = np.ascontiguousarray(_corners(index.hexes, 8)[:, _TO_VTK])
    measured = []
    for rival in RIVALS:
        if rival.grids_only and cells.shape is None:
            continue
        seconds_build, search = _timed(rival.build, cells)
        seconds_search = seconds_draw = 0.0
        visited = found = 0
        for isovalue in isovalues:
            seconds, (ids, looked_at) = _timed(search.candidates, isovalue)
            seconds_search += seconds
            visited += looked_at
            found += len(ids)
            some = ids[ids < len(tets)], ids[ids >= len(tets)] - len(tets)
            chosen = tets[some[0]], hexes[some[1]]
            seconds_draw += _timed(_kernels.marching_cells, points, *chosen, values, isovalue, threads)[0]
        total = seconds_search + seconds_draw
        measured.append(Measured(rival.name, search.registered, visited, found, seconds_build, seconds_search, total))
    return measured


def _measure_walks(
    mesh: CellMesh, index: MeshIndex, isovalues: list[float], threads: int, seconds_thinning: float
) -> list[Measured]:
    seconds_graph, graph = _timed(extrema_graph, mesh, index)
    measured = []
    for name, some, seconds_build in (
        ("extrema graph", graph, seconds_graph),
        ("volume thinning", index, seconds_thinning),
    ):
        ready = ready_index(mesh, some)
        seconds_search = seconds_total = 0.0
        found = 0
        for isovalue in isovalues:
            seconds, (tets, hexes, _) = _timed(ready.walk, isovalue)
            seconds_search += seconds
            found += len(tets) + len(hexes)
            seconds_total += _timed(ready.propagate, isovalue, threads)[0]
        measured.append(Measured(name, some.skeleton_cells, found, found, seconds_build, seconds_search, seconds_total))
    return measured


def extrema_graph(mesh: CellMesh, index: MeshIndex) -> MeshIndex:
    """The index with the cells of Itoh, Koyamada 1995 in place of the skeleton: paths between extrema, boundary."""
    cells = cells_of(mesh, index)
    heights = mesh.values[index.original].astype(np.float64)
    heights[~np.isfinite(heights)] = -np.inf
    order = np.argsort(heights, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    parts = []
    first = 0
    for part, count, faces, edges in ((index.tets, 4, 4, _TET_EDGES), (index.hexes, 8, 6, _HEX_EDGES)):
        corners = _corners(part, count)
        lower, higher = np.zeros((2, len(heights)), bool)
        for a, b in edges:
            above = rank[corners[:, a]] > rank[corners[:, b]]
            lower[np.where(above, corners[:, a], corners[:, b])] = True
            higher[np.where(above, corners[:, b], corners[:, a])] = True
        extremum = (~(lower & higher)).astype(np.uint8)
        at_extremum = np.ascontiguousarray(extremum[corners].max(axis=1, initial=0))
        kept = _kernels.extrema_graph(part.records, count, faces, at_extremum)
        kept = kept[np.argsort(cells.low[first + kept], kind="stable")]
        parts.append(replace(part, skeleton=kept, low=cells.low[first + kept], high=cells.high[first + kept]))
        first += len(part.records)
    return replace(index, tets=parts[0], hexes=parts[1])


_TET_EDGES = tuple((a, b) for a in range(4) for b in range(a + 1, 4))
_HEX_EDGES = tuple((a, a | 1 << axis) for axis in range(3) for a in range(8) if not a >> axis & 1)
