"""Which cell of a mesh, as the file has them, each vertex of a surface belongs to: it has that cell's value.

A vertex lies on an edge, which several cells may have: of these it belongs to the first in the file. A vertex in the
middle of a loop belongs to the cell that has all edges of the loop.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import numpy.typing as npt

from isocore.carried import CellSources

_CELLS = 1 << 18  # at a time
_NONE = np.iinfo(np.int64).max

Numbers = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Loops:
    """Vertices in the middle of loops. count: how many. middles, edges: (n,) one, and a vertex of its loop, once."""

    count: int
    middles: Numbers
    edges: Numbers


def cells_of(sources: tuple[CellSources, ...], edges: npt.NDArray[np.int32], points: int, loops: Loops) -> Numbers:
    """(e + m,) the number of the cell of each vertex on an edge, then of each middle of a loop; -1: no cell has it.

    edges: (e, 2), ascending, out of so many points.
    """
    keys = edges[:, 0].astype(np.int64) * points + edges[:, 1]
    order = np.argsort(keys, kind="stable")
    ends, in_loops = np.zeros(points, np.bool_), np.zeros(len(keys), np.bool_)
    ends[edges.ravel()] = True
    in_loops[loops.edges] = True
    lowest = np.full(len(keys) + loops.count, _NONE)
    seen = [np.empty((0, 2), np.int64)]
    for source in sources if len(keys) else ():
        for first in range(0, len(source.nodes), _CELLS):
            for places, numbers in _hits(source, slice(first, first + _CELLS), ends, keys[order]):
                found = order[places]
                np.minimum.at(lowest, found, numbers)
                seen.append(np.column_stack((found, numbers))[in_loops[found]])
    if loops.count:
        _find_middles(lowest[len(keys) :], loops, np.unique(np.concatenate(seen), axis=0))
    return np.where(lowest == _NONE, -1, lowest)


def _hits(
    source: CellSources, some: slice, ends: npt.NDArray[np.bool_], keys: Numbers
) -> Iterator[tuple[Numbers, Numbers]]:
    """Places in `keys` (ascending) of edges, and the cell that has each, one pair of nodes after the other.

    ends: (p,) True for the points that an edge ends at.
    """
    nodes, numbers = source.nodes[some], source.numbers[some]
    near = np.count_nonzero(ends[nodes], axis=1) > 1
    nodes, numbers = nodes[near].astype(np.int64), numbers[near]
    pairs = combinations(range(nodes.shape[1]), 2) if source.pairs is None else source.pairs.tolist()
    for a, b in pairs if len(nodes) else ():
        low, high = np.minimum(nodes[:, a], nodes[:, b]), np.maximum(nodes[:, a], nodes[:, b])
        wanted = low * len(ends) + high
        places = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        hit = keys[places] == wanted
        yield places[hit], numbers[hit]


def _find_middles(result: Numbers, loops: Loops, seen: Numbers) -> None:
    """Into `result` (m,), for each middle, the cell that has most of its loop's edges, which its own has all of.

    seen: (s, 2) an edge and a cell that has it, each pair once.
    """
    order = np.argsort(seen[:, 0], kind="stable")
    first, last = (np.searchsorted(seen[order, 0], loops.edges, side) for side in ("left", "right"))
    middles = np.repeat(loops.middles, last - first)
    cells = seen[order[spread(first, last - first)], 1]
    pairs, counts = np.unique(np.column_stack((middles, cells)), axis=0, return_counts=True)
    best = np.lexsort((pairs[:, 1], -counts, pairs[:, 0]))
    chosen, places = np.unique(pairs[best, 0], return_index=True)
    result[chosen] = pairs[best[places], 1]


def spread(starts: Numbers, counts: Numbers) -> Numbers:
    """start, start + 1, ... of each part, so many, all parts one after the other."""
    first = np.cumsum(counts) - counts
    return np.repeat(starts - first, counts) + np.arange(int(counts.sum()))
