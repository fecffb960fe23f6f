"""Divide curved cells into straight ones through all their nodes, so that neighbours meet face to face.

Nodes on a face are cut alike from both sides. A node that the file lacks in the middle of a side becomes one point for
the two cells that share the side, whichever of them has it. Bezier cells have control points instead of nodes: where
these stand in the lattice, the cell's own place and value are computed, and take the control point's number.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CurvedCells
from isocore.errors import FieldError
from isocore.readers.cell_splitting import mixed
from isocore.readers.vtk_bases import basis, values_at
from isocore.readers.vtk_cells import Block
from isocore.readers.vtk_templates import Template, template
from isocore.readers.vtk_types import Shape

Ids = npt.NDArray[np.int32]
Source = tuple[Ids, npt.NDArray[np.intp] | slice, npt.NDArray[np.intp] | None]
#: Cells of more nodes are divided too, but their surfaces' vertices are not moved onto the curve of their edges.
_MOST_NODES = 512
_MOST_CONTROL_POINTS = 2048
_MOST_POINTS = 1 << 15  # of a cell whose lattice is worth working out: a hexahedron of degree 31
_CHUNK = 1 << 14


@dataclass(slots=True)
class Divided:
    """Straight cells and the points they hang on.

    points: (n, 3); values: (n,); those of the file first. cells: (m, k) point numbers by shape.
    curved: the cells that were divided. blocks: all of them as they were given. sources: of some cells all their
    points, which cells of the file they are, and of divided ones which two of their points an edge may join.
    left: cells read by their corners since no degree fits them, by name.
    """

    points: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    cells: dict[Shape, list[Ids]] = field(default_factory=lambda: {"tet": [], "hex": [], "wedge": [], "pyramid": []})
    curved: list[CurvedCells] = field(default_factory=list)
    left: Counter[str] = field(default_factory=Counter)
    blocks: list[Block] = field(default_factory=list)
    sources: list[Source] = field(default_factory=list)


def divided(
    path: str,
    blocks: list[Block],
    points: npt.NDArray[np.float64],
    values: npt.NDArray[Any],
    weights: npt.NDArray[Any] | None = None,
) -> Divided:
    """All cells of `blocks` as straight ones. weights: (n,) of rational Bezier cells' control points."""
    result = Divided(points, values, blocks=blocks)
    curved: list[tuple[Block, Template]] = []
    for block in blocks:
        if block.kind.nodes > _MOST_POINTS:
            raise FieldError(
                f"{path}: one of its {block.kind.name} has {block.kind.nodes:,} points, more than are divided;"
                " read it with --corners"
            )
        form = None if block.kind.straight else template(block.number, block.kind.nodes, block.degrees, block.old)
        if form is None or block.kind.straight:
            corners = np.ascontiguousarray(block.corners)
            result.cells[block.kind.shape].append(corners)
            result.sources.append((corners, block.numbers, None))
            if not block.kind.straight:
                result.left[block.kind.name] += len(block.cells)
        else:
            curved.append((block, form))
    if curved:
        for block, form in curved:
            if block.bezier:
                _evaluate(path, block, form, result, weights)
        for (block, _), (form, nodes) in zip(curved, _completed(curved, result), strict=True):
            _cut(form, nodes, result)
            result.sources.append((nodes, block.numbers, _pairs(form)))
    return result


def _evaluate(
    path: str, block: Block, form: Template, result: Divided, weights: npt.NDArray[Any] | None
) -> None:
    """Put the cell's own places and values where its control points were."""
    count = block.kind.nodes
    if count > _MOST_CONTROL_POINTS or len(form.at) != len(at := form.at[:count]) or form.shape == "pyramid":
        raise FieldError(
            f"{path}: its {block.kind.name} of {count:,} control points cannot be evaluated; lower their degree"
        )
    matrix = basis(form.shape, form.degrees, at)
    if matrix.shape != (count, count):
        raise FieldError(f"{path}: its {block.kind.name} of {count:,} control points have no degree; write them again")
    points, values = result.points.copy(), result.values.copy()
    step = max(1, _CHUNK * 64 // count)
    for first in range(0, len(block.cells), step):
        nodes = block.cells[first : first + step]
        share = np.ones(nodes.shape) if weights is None else np.asarray(weights, np.float64)[nodes]
        whole = share @ matrix.T
        with np.errstate(invalid="ignore", divide="ignore"):
            points[nodes] = np.einsum("ij,mjx->mix", matrix, share[..., None] * result.points[nodes]) / whole[..., None]
            values[nodes] = ((share * result.values[nodes]) @ matrix.T / whole).astype(values.dtype)
    if not np.isfinite(points).all():
        raise FieldError(f"{path}: the weights of its {block.kind.name} add up to nothing; write them again")
    result.points, result.values = points, values


def _completed(curved: list[tuple[Block, Template]], result: Divided) -> list[tuple[Template, Ids]]:
    """The nodes of every cell with those that the file lacks; each of these is one new point of `result`."""
    first = len(result.points)
    known_keys = [_keys(block.cells, form.known[:, :4]) for block, form in curved]
    known_points = [block.cells[:, form.known[:, 4]].ravel() for block, form in curved]
    lacking = [_keys(block.cells, form.sides[:, :4]) for block, form in curved]
    eights = [block.cells[:, form.sides].reshape(-1, 8) for block, form in curved]
    keys = np.concatenate([*known_keys, *lacking])
    number_of = np.concatenate([*known_points, np.full(sum(map(len, lacking)), -1)])
    places, inverse = np.unique(keys, return_index=True, return_inverse=True)[1:]
    chosen = number_of[places]
    new = chosen < 0
    chosen[new] = first + np.arange(np.count_nonzero(new))
    found = chosen[inverse][sum(map(len, known_keys)) :].astype(np.int32)
    every_eight = np.concatenate(eights)
    _append(result, every_eight[places[new] - sum(map(len, known_keys))], np.repeat((-0.25, 0.5), 4))
    complete = []
    at = 0
    for block, form in curved:
        count = len(block.cells) * len(form.sides)
        nodes = np.concatenate((block.cells, found[at : at + count].reshape(len(block.cells), -1)), axis=1)
        at += count
        if form.middle is not None:
            inner = len(result.points) + np.arange(len(nodes), dtype=np.int32)[:, None]
            around = np.concatenate(form.middle)
            _append(result, nodes[:, around], np.repeat((0.5, -0.25, 0.125), [len(part) for part in form.middle]))
            nodes = np.concatenate((nodes, inner.astype(np.int32)), axis=1)
        complete.append((form, np.ascontiguousarray(nodes)))
    return complete


def _keys(cells: Ids, sides: npt.NDArray[np.intp]) -> npt.NDArray[np.uint64]:
    """A number for each side of each cell, the same in whatever order its corners are named."""
    scrambled = mixed(cells)
    return np.asarray(scrambled[:, sides].sum(axis=2, dtype=np.uint64)).ravel()


def _append(result: Divided, nodes: Ids, weights: npt.NDArray[np.float64]) -> None:
    """New points whose places and values are sums over (m, k) nodes."""
    with np.errstate(invalid="ignore"):
        places = np.einsum("mkx,k->mx", result.points[nodes], weights)
        values = (result.values[nodes] @ weights).astype(result.values.dtype)
    result.points = np.concatenate((result.points, places))
    result.values = np.concatenate((result.values, values))


def _cut(form: Template, nodes: Ids, result: Divided) -> None:
    for shape, cells in form.cells.items():
        if len(cells):
            result.cells[shape].append(nodes[:, cells].reshape(-1, cells.shape[1]))
    if len(form.octahedra):
        result.cells["tet"].append(_halved(nodes[:, form.octahedra].reshape(-1, 6), result.points))
    if len(form.at) <= _MOST_NODES:
        result.curved.append(_curve(form, nodes))


def _halved(octahedra: Ids, points: npt.NDArray[np.float64]) -> Ids:
    """(4 o, 4) tetrahedra around the shortest diagonal of each octahedron; of equal ones the first."""
    found = np.empty((len(octahedra), 4, 4), np.int32)
    turns = np.array([np.roll(np.arange(6), -2 * n) for n in range(3)])
    for first in range(0, len(octahedra), _CHUNK):
        some = octahedra[first : first + _CHUNK]
        across = points[some[:, ::2]] - points[some[:, 1::2]]
        shortest = np.einsum("onx,onx->on", across, across).argmin(axis=1)
        a, b, c, d, e, f = np.take_along_axis(some, turns[shortest], axis=1).T
        around = (c, e, d, f, c)
        for n in range(4):
            found[first : first + len(some), n] = np.stack((a, b, around[n], around[n + 1]), axis=1)
    return found.reshape(-1, 4)


def _pairs(form: Template) -> npt.NDArray[np.intp]:
    """(e, 2) nodes of a cell that an edge of a straight one may join, ascending, each once."""
    straight = [*form.cells.values(), form.octahedra]
    pairs = np.concatenate([cells[:, (a, b)] for cells in straight for a in range(cells.shape[1]) for b in range(a)])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _curve(form: Template, nodes: Ids) -> CurvedCells:
    """What the surface needs to know of the cells: how value and place run between any two nodes of a straight one."""
    pairs = _pairs(form)
    middles = form.at[pairs].mean(axis=1)
    return CurvedCells(nodes, pairs, values_at(form.shape, form.degrees, form.at, middles))
