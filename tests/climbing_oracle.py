"""Adaptive skeleton climbing without an error bound, slow and obvious: boxes by counting, one sample at a time."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

Signs = npt.NDArray[np.bool_]
Interval = tuple[int, int]
Box = tuple[Interval, Interval, Interval]
Edge = tuple[int, int, int, int]  # axis, then the lower sample

_SPLIT_PRICE = 5
_WORTH_A_LOOK = 32


def is_simple(inside: Signs) -> bool:
    """Is every line of samples crossed at most once?"""
    return all((np.diff(inside.astype(int), axis=axis) != 0).sum(axis=axis).max(initial=0) <= 1 for axis in range(3))


def is_graph(inside: Signs) -> bool:
    """Are all lines along some axis crossed in one direction only, and no cell face's corners alternate?"""
    steps = [np.diff(inside.astype(int), axis=axis) for axis in range(3)]
    if not any((step >= 0).all() or (step <= 0).all() for step in steps):
        return False
    for a, b in ((0, 1), (0, 2), (1, 2)):
        s = np.moveaxis(inside, (a, b), (0, 1))
        ring = s[:-1, :-1], s[1:, :-1], s[1:, 1:], s[:-1, 1:]
        if ((ring[0] == ring[2]) & (ring[1] == ring[3]) & (ring[0] != ring[1])).any():
            return False
    return True


def cuts_a_disk(inside: Signs) -> bool:
    """Are the inside corners of the box joined along its edges, and the outside corners too?"""
    corners = inside[np.ix_((0, -1), (0, -1), (0, -1))]
    places = list(itertools.product((0, 1), repeat=3))
    for side in (True, False):
        members = [p for p in places if corners[p] == side]
        reached, todo = set(members[:1]), members[:1]
        while todo:
            here = todo.pop()
            for other in members:
                if other not in reached and sum(x != y for x, y in zip(here, other, strict=True)) == 1:
                    reached.add(other)
                    todo.append(other)
        if len(reached) != len(members):
            return False
    return True


class Oracle:
    """The boxes of one volume. inside: (nx, ny, nz) bool."""

    def __init__(self, inside: Signs, block_size: int) -> None:
        self._inside = inside
        self._size = block_size
        self.boxes: list[Box] = []
        for low in itertools.product(*(range(0, n - 1, block_size) for n in inside.shape)):
            x, y, z = ((start, start + block_size) for start in low)
            self._settle((x, y, z))

    def vertices(self) -> set[Edge]:
        """The crossed grid edges on the twelve edges of some box."""
        return {edge for box in self.boxes for edge in self._box_edges(box) if self._is_crossed(edge)}

    def _samples(self, box: Box) -> Signs:
        return self._inside[tuple(slice(low, high + 1) for low, high in box)]

    def _verdict(self, box: Box) -> str:
        if any(low >= n - 1 for (low, _), n in zip(box, self._inside.shape, strict=True)):
            return "nothing"
        samples = self._samples(box)
        if samples.all() or not samples.any():
            return "nothing"
        if samples.shape == (2, 2, 2):
            return "accepted"
        good = is_simple(samples) and cuts_a_disk(samples) and is_graph(samples)
        return "accepted" if good else "split"

    def _halves(self, box: Box, axis: int) -> list[Box]:
        low, high = box[axis]
        middle = (low + high) // 2
        halves = []
        for part in ((low, middle), (middle, high)):
            x, y, z = (part if a == axis else box[a] for a in range(3))
            halves.append((x, y, z))
        return halves

    def _price(self, box: Box) -> int:
        return {"nothing": 0, "accepted": 2, "split": _SPLIT_PRICE}[self._verdict(box)]

    def _axes(self, box: Box) -> list[int]:
        return [axis for axis in range(3) if box[axis][1] - box[axis][0] > 1]

    def _cost(self, box: Box, axis: int, look_further: bool) -> int:
        cost = 0
        for half in self._halves(box, axis):
            if look_further and self._verdict(half) == "split":
                cost += min(sum(map(self._price, self._halves(half, a))) for a in self._axes(half))
            else:
                cost += self._price(half)
        return 64 * cost - (box[axis][1] - box[axis][0])

    def _settle(self, box: Box) -> None:
        verdict = self._verdict(box)
        if verdict == "nothing":
            return
        if verdict == "accepted":
            shape = self._inside.shape
            x, y, z = ((low, min(high, n - 1)) for (low, high), n in zip(box, shape, strict=True))
            self.boxes.append((x, y, z))
            return
        look_further = np.prod([high - low for low, high in box]) >= _WORTH_A_LOOK
        best = min(self._axes(box), key=lambda axis: self._cost(box, axis, bool(look_further)))
        for half in self._halves(box, best):
            self._settle(half)

    def _box_edges(self, box: Box) -> Iterator[Edge]:
        for axis in range(3):
            u, v = (a for a in range(3) if a != axis)
            for at_u, at_v, along in itertools.product(box[u], box[v], range(*box[axis])):
                place = [0, 0, 0]
                place[u], place[v], place[axis] = at_u, at_v, along
                yield (axis, place[0], place[1], place[2])

    def _is_crossed(self, edge: Edge) -> bool:
        axis, low = edge[0], edge[1:]
        high = tuple(n + (a == axis) for a, n in enumerate(low))
        return bool(self._inside[low] != self._inside[high])
