"""Join points that lie in one place, so that a mesh in pieces, or of cells with points of their own, hangs together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.readers.cell_splitting import mixed
from isocore.readers.vtk_cells import Block

#: Values differ by rounding where they differ by less than this part of the largest: sixteen steps of float32.
_ROUNDING = 16 * 2.0**-23


@dataclass(frozen=True, slots=True)
class Joining:
    """Which points became which.

    number: (n,) int32 the new number of each point. first: (k,) int32 the old number of each new one, ascending.
    """

    number: npt.NDArray[np.int32]
    first: npt.NDArray[np.int32]

    @property
    def joined(self) -> int:
        return len(self.number) - len(self.first)


@dataclass(frozen=True, slots=True)
class JoinedValues:
    """values: (k,) one of each new point.

    differing: new points that got the mean of values that differ by more than rounding; largest: by how much.
    """

    values: npt.NDArray[Any]
    differing: int = 0
    largest: float = 0.0


def joining(points: npt.NDArray[np.float64], distance: float) -> Joining | None:
    """Points at equal coordinates, or within `distance`; None where there are none. Linear in the points."""
    found = _kernels.join_points(points, distance)
    return None if len(found.first) == len(points) else Joining(found.number, found.first)


def joined_values(
    by: Joining, values: npt.NDArray[Any], points_used: Callable[[], npt.NDArray[np.bool_]]
) -> JoinedValues:
    """The value of the first point where they agree but for rounding, else their mean; NaN where one is NaN.

    points_used: tells which points count, (n,): what no cell names has no say. Not called where all values agree.
    """
    result = values[by.first]
    if _kernels.values_agree(values, by.number, result):
        return JoinedValues(result)
    used = points_used()
    members = np.flatnonzero(used)
    result[by.number[members[::-1]]] = values[members[::-1]]  # of several the first stays
    members = members[~_same(values[members], result[by.number[members]])]
    if not len(members):
        return JoinedValues(result)
    finite = np.abs(values[np.isfinite(values)])
    rounding = _ROUNDING * float(finite.max()) if len(finite) else 0.0
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(values[members].astype(np.float64) - result[by.number[members]])
    members = members[~(apart <= rounding)]
    return _averaged(by, values, result, np.unique(by.number[members]), used)


def repeated(blocks: Sequence[Block], by: Joining) -> list[npt.NDArray[np.bool_]]:
    """Per block (m,) True for the cells that name the same points as an earlier one: layers that pieces share.

    Only cells all of whose points were joined can be such; `blocks` have the new numbers. Cells are told apart by sums
    of scrambled numbers, which two of them share by chance once in 2^64 pairs.
    """
    members = np.bincount(by.number, minlength=len(by.first)) > 1
    shared = [np.flatnonzero(members[block.cells].all(axis=1)) for block in blocks]
    keys = [
        mixed(block.cells[some]).sum(axis=1, dtype=np.uint64) for block, some in zip(blocks, shared, strict=True)
    ]
    every = np.concatenate([np.empty(0, np.uint64), *keys])
    order = np.argsort(every, kind="stable")
    again = np.zeros(len(every), np.bool_)
    again[order[1:]] = every[order[1:]] == every[order[:-1]]
    masks, first = [], 0
    for block, some in zip(blocks, shared, strict=True):
        mask = np.zeros(len(block.cells), np.bool_)
        mask[some] = again[first : first + len(some)]
        first += len(some)
        masks.append(mask)
    return masks


def _same(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)))


def _averaged(
    by: Joining,
    values: npt.NDArray[Any],
    result: npt.NDArray[Any],
    numbers: npt.NDArray[np.int32],
    used: npt.NDArray[np.bool_],
) -> JoinedValues:
    """`result` with means at `numbers`."""
    if not len(numbers):
        return JoinedValues(result)
    place = np.full(len(by.first), -1, np.int32)
    place[numbers] = np.arange(len(numbers), dtype=np.int32)
    group = place[by.number]
    mine = (group >= 0) & used
    group, own = group[mine], values[mine].astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        total = np.bincount(group, weights=own, minlength=len(numbers))
        result[numbers] = total / np.bincount(group, minlength=len(numbers))
        low, high = np.full(len(numbers), np.inf), np.full(len(numbers), -np.inf)
        np.fmin.at(low, group, own)
        np.fmax.at(high, group, own)
        spread = high - low
    finite = spread[np.isfinite(spread)]
    return JoinedValues(result, len(numbers), float(finite.max()) if len(finite) else 0.0)
