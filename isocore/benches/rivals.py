"""The paper's rivals behind one interface: build(cells) once, candidates(isovalue) for every isovalue.

Each answers with the cells that the isosurface meets, ascending, and with how many cells it looked at to find them.
Cells are intervals: one is met iff low < isovalue <= high.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Ids: TypeAlias = npt.NDArray[np.int64]
Ends: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """low, high: (m,) float64, the range of every cell. shape: cells per axis of a grid, i fastest; None of a mesh."""

    low: Ends
    high: Ends
    shape: tuple[int, int, int] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Search:
    """candidates: isovalue -> (cells met, cells looked at). registered: cells that the structure names."""

    registered: int
    candidates: Callable[[float], tuple[Ids, int]]


@dataclass(frozen=True, slots=True)
class Rival:
    """One method. grids_only: it needs Cells.shape."""

    name: str
    build: Callable[[Cells], Search]
    cites: str
    grids_only: bool = False


def _met(cells: Cells, ids: Ids, isovalue: float) -> tuple[Ids, int]:
    """Those of `ids` that the isosurface meets, and how many were looked at."""
    hits = ids[(cells.low[ids] < isovalue) & (isovalue <= cells.high[ids])]
    return np.sort(hits), len(ids)


def _full_scan(cells: Cells) -> Search:
    def candidates(isovalue: float) -> tuple[Ids, int]:
        return np.flatnonzero((cells.low < isovalue) & (isovalue <= cells.high)), len(cells.low)

    return Search(len(cells.low), candidates)


def _span_filtering(cells: Cells, buckets: int = 256) -> Search:
    """Gallagher 1991: lists by how many buckets of the value range a cell spans, each sorted by the first of them."""
    bottom = float(cells.low[np.isfinite(cells.low)].min(initial=np.inf))
    top = float(cells.high[np.isfinite(cells.high)].max(initial=-np.inf))
    bottom, top = (bottom, top) if bottom <= top else (top, top) if np.isfinite(top) else (0.0, 1.0)
    width = (top - bottom) / buckets or 1.0

    def bucket(value: Any) -> Any:
        return np.clip(np.floor((np.maximum(value, bottom) - bottom) / width), 0, buckets - 1).astype(np.int64)

    first = bucket(cells.low)
    span = bucket(cells.high) - first
    key = span * buckets + first
    order = np.argsort(key, kind="stable")
    spans = np.unique(span)
    starts = np.searchsorted(key[order], np.arange(buckets * buckets + 1))

    def candidates(isovalue: float) -> tuple[Ids, int]:
        if not bottom <= isovalue <= top:
            return _met(cells, order if isovalue <= top else order[:0], isovalue)
        here = int(bucket(isovalue))
        runs = [order[starts[s * buckets + max(0, here - s)] : starts[s * buckets + here + 1]] for s in spans.tolist()]
        return _met(cells, np.concatenate(runs), isovalue)

    return Search(len(cells.low), candidates)


def _sorting(cells: Cells) -> Search:
    """Giles, Haines 1990: cells sorted by their low end; those more than the longest range below cannot be met."""
    order = np.argsort(cells.low, kind="stable")
    low = cells.low[order]
    with np.errstate(invalid="ignore"):
        lengths = np.where(np.isfinite(cells.low), cells.high - cells.low, np.inf)
    longest = float(lengths.max(initial=0.0))

    def candidates(isovalue: float) -> tuple[Ids, int]:
        first = 0 if np.isinf(longest) else int(np.searchsorted(low, isovalue - longest * (1 + 1e-12)))
        return _met(cells, order[first : np.searchsorted(low, isovalue)], isovalue)

    return Search(len(cells.low), candidates)


def _span_space_tree(cells: Cells, leaf: int = 1024) -> Search:
    """Livnat, Shen, Johnson 1996: a kd-tree over the points (low, high), its leaves runs of one array."""
    order = np.arange(len(cells.low))
    leaves: list[tuple[int, int]] = []
    boxes: list[tuple[float, float, float, float]] = []
    waiting = [(0, len(order), 0)]
    while waiting:
        begin, end, axis = waiting.pop()
        run = order[begin:end]
        if end - begin > leaf:
            ends = cells.high if axis else cells.low
            order[begin:end] = run[np.argpartition(ends[run], len(run) // 2)]
            middle = begin + len(run) // 2
            waiting += [(middle, end, 1 - axis), (begin, middle, 1 - axis)]
        elif len(run):
            low, high = cells.low[run], cells.high[run]
            leaves.append((begin, end))
            boxes.append((low.min(), low.max(), high.min(), high.max()))
    corners = np.array(boxes).reshape(-1, 4)

    def candidates(isovalue: float) -> tuple[Ids, int]:
        some = np.flatnonzero((corners[:, 0] < isovalue) & (isovalue <= corners[:, 3]))
        sure = (corners[some, 1] < isovalue) & (isovalue <= corners[some, 2])
        runs = [order[slice(*leaves[n])] for n in some.tolist()]
        inside = [run for run, whole in zip(runs, sure, strict=True) if whole]
        partly = [run for run, whole in zip(runs, sure, strict=True) if not whole]
        found, seen = _met(cells, np.concatenate([order[:0], *partly]), isovalue)
        return np.sort(np.concatenate([found, *inside])), seen + sum(map(len, inside))

    return Search(len(cells.low), candidates)


def _octree(cells: Cells) -> Search:
    """Wilhelms, Van Gelder 1992: the range of every 2 x 2 x 2 cells, of those, and so on up to one."""
    assert cells.shape is not None
    low, high = (ends.reshape(cells.shape, order="F") for ends in (cells.low, cells.high))
    levels = [(low, high)]
    while max(levels[-1][0].shape) > 1:
        low, high = levels[-1]
        odd = [(0, size % 2) for size in low.shape]
        low = np.pad(low, odd, constant_values=np.inf)
        high = np.pad(high, odd, constant_values=-np.inf)
        a, b, c = (size // 2 for size in low.shape)
        split = (a, 2, b, 2, c, 2)
        levels.append((low.reshape(split).min(axis=(1, 3, 5)), high.reshape(split).max(axis=(1, 3, 5))))
    children = np.stack(np.meshgrid(*[[0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)

    def candidates(isovalue: float) -> tuple[Ids, int]:
        nodes, seen = np.zeros((1, 3), np.int64), 0
        for low, high in reversed(levels):
            nodes = nodes[(nodes < low.shape).all(axis=1)]
            seen += len(nodes)
            at = tuple(nodes.T)
            nodes = nodes[(low[at] < isovalue) & (isovalue <= high[at])]
            if low is not levels[0][0]:
                nodes = (2 * nodes[:, None] + children).reshape(-1, 3)
        return np.sort(np.ravel_multi_index(tuple(nodes.T), levels[0][0].shape, order="F")), seen

    return Search(sum(low.size for low, _ in levels), candidates)


RIVALS = (
    Rival("full scan", _full_scan, "Lorensen, Cline 1987"),
    Rival("span filtering", _span_filtering, "Gallagher 1991"),
    Rival("sorting", _sorting, "Giles, Haines 1990"),
    Rival("octree", _octree, "Wilhelms, Van Gelder 1992", grids_only=True),
    Rival("span-space kd-tree", _span_space_tree, "Livnat, Shen, Johnson 1996"),
)
