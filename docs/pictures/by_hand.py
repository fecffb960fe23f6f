"""Adaptive skeleton climbing of one block, by hand: slow, obvious, and without a line of the kernels.

docs/how-climbing-works.md follows one block of 4^3 cells with it; tests/test_docs.py holds its boxes, vertices and
triangles against the compiled kernels. Names are those of isocore/kernels/climbing.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

N = 4  # cells along each axis of the block
NOTHING, ACCEPTED, SPLIT = 0, 2, 5  # prices, in halves of a box
WORTH_A_LOOK = 32  # cells from which on the partition looks one halving further

Label = int  # of a dike: 1 is the whole lign, 2k and 2k + 1 are the halves of k
Box = tuple[Label, Label, Label]
Place = tuple[int, int, int]
Edge = tuple[int, Place]  # axis, and the lower sample
Signs = npt.NDArray[np.bool_]


def length(label: Label) -> int:
    return N >> (label.bit_length() - 1)


def start(label: Label) -> int:
    return label * length(label) - N


def bit(label: Label) -> int:
    """Where a word of answers keeps this dike's: a unit dike at its label, any other at its middle sample."""
    return label if label >= N else start(label) + length(label) // 2


def ends(box: Box, axis: int) -> tuple[int, int]:
    return start(box[axis]), start(box[axis]) + length(box[axis])


def halves(box: Box, axis: int) -> tuple[Box, Box]:
    lower, upper = (tuple(2 * k + up if a == axis else k for a, k in enumerate(box)) for up in (0, 1))
    return (lower[0], lower[1], lower[2]), (upper[0], upper[1], upper[2])


def axes(box: Box) -> list[int]:
    """Those along which the box has two halves."""
    return [axis for axis in range(3) if box[axis] < N]


def shift(place: Place, axis: int, steps: int = 1) -> Place:
    i, j, k = (n + steps * (a == axis) for a, n in enumerate(place))
    return i, j, k


@dataclass
class Choice:
    """How a box was halved: what each axis would have cost, and what became of the halves."""

    box: Box
    costs: dict[int, int]
    axis: int


@dataclass
class Block:
    """samples: (5, 5, 5), i first. What the kernels find in it, step by step."""

    samples: npt.NDArray[np.uint8]
    isovalue: float
    inside: Signs = field(init=False)
    choices: list[Choice] = field(init=False)
    boxes: list[Box] = field(init=False)
    crossings: list[Edge] = field(init=False)
    kept: list[bool] = field(init=False)

    def __post_init__(self) -> None:
        self.inside = self.samples >= self.isovalue
        self.choices, self.boxes = [], []
        self.settle((1, 1, 1))
        self.crossings = list(self.edges_in_order())
        on_boxes = {edge for box in self.boxes for edge in self.box_edges(box)}
        self.kept = [edge in on_boxes for edge in self.crossings]

    # survey: what does a box hold?

    def signs(self, box: Box) -> Signs:
        (x0, x1), (y0, y1), (z0, z1) = (ends(box, axis) for axis in range(3))
        return self.inside[x0 : x1 + 1, y0 : y1 + 1, z0 : z1 + 1]

    def flaws(self, box: Box) -> list[str]:
        """Why a box may not be one highrice, by the names of the survey."""
        signs = self.signs(box)
        steps = [np.diff(signs.astype(int), axis=axis) for axis in range(3)]
        found = [f"again {'xyz'[a]}" for a in range(3) if (np.abs(steps[a]).sum(axis=a) > 1).any()]
        for a, b in ((0, 1), (0, 2), (1, 2)):
            s = np.moveaxis(signs, (a, b), (0, 1))
            if ((s[:-1, :-1] == s[1:, 1:]) & (s[1:, :-1] == s[:-1, 1:]) & (s[1:, :-1] != s[1:, 1:])).any():
                found.append(f"alternating {'xyz'[a]}{'xyz'[b]}")
        if all((step > 0).any() and (step < 0).any() for step in steps):
            found.append("both ways")
        if not self.corners_cut_a_disk(signs):
            found.append("no disk")
        return found

    @staticmethod
    def corners_cut_a_disk(signs: Signs) -> bool:
        """Do the corners alone show one loop and no ambiguous face? Iff each side's are joined by edges of the box."""
        corners = signs[np.ix_((0, -1), (0, -1), (0, -1))]
        for side in (True, False):
            members = [c for c in itertools.product((0, 1), repeat=3) if corners[c] == side]
            reached = members[:1]
            for here in reached:
                near = (o for o in members if sum(p != q for p, q in zip(here, o, strict=True)) == 1)
                reached += [other for other in near if other not in reached]
            if len(reached) != len(members) or not members:
                return False
        return True

    def price(self, box: Box) -> int:
        signs = self.signs(box)
        if signs.all() or not signs.any():
            return NOTHING
        return ACCEPTED if not axes(box) or not self.flaws(box) else SPLIT

    # partition: which boxes?

    def cost(self, box: Box, axis: int) -> int:
        """What halving a box along an axis costs; in a large box, halves that must be split count their own halves."""
        total = 0
        for half in halves(box, axis):
            further = self.price(half) == SPLIT and np.prod([length(k) for k in box]) >= WORTH_A_LOOK
            total += min(sum(map(self.price, halves(half, a))) for a in axes(half)) if further else self.price(half)
        return total

    def settle(self, box: Box) -> None:
        price = self.price(box)
        if price == ACCEPTED:
            self.boxes.append(box)
        elif price == SPLIT:
            costs = {axis: self.cost(box, axis) for axis in axes(box)}
            axis = min(costs, key=lambda a: (costs[a], -length(box[a]), a))
            self.choices.append(Choice(box, costs, axis))
            for half in halves(box, axis):
                self.settle(half)

    # layout: which crossings are vertices, and how are they numbered?

    def is_crossed(self, edge: Edge) -> bool:
        axis, place = edge
        return bool(self.inside[place] != self.inside[shift(place, axis)])

    def edges_in_order(self) -> list[Edge]:
        """The crossed grid edges: by row (k, j), then axis, then i."""
        found = []
        for k, j, axis, i in itertools.product(range(N + 1), range(N + 1), range(3), range(N + 1)):
            if (i, j, k)[axis] < N and self.is_crossed((axis, (i, j, k))):
                found.append((axis, (i, j, k)))
        return found

    def box_edges(self, box: Box) -> list[Edge]:
        """The grid edges that the twelve edges of a box consist of."""
        found: list[Edge] = []
        for axis in range(3):
            for corner in itertools.product(*((0,) if a == axis else (0, 1) for a in range(3))):
                i, j, k = (ends(box, a)[corner[a]] for a in range(3))
                found += [(axis, shift((i, j, k), axis, step)) for step in range(length(box[axis]))]
        return found

    def number(self, crossing: int) -> int:
        """The rank query: a vertex's number is how many kept crossings come before it."""
        return sum(self.kept[:crossing])

    def share(self, edge: Edge) -> float:
        axis, place = edge
        low, high = (float(self.samples[at]) for at in (place, shift(place, axis)))
        return min(max((self.isovalue - low) / (high - low), 1 / 1024), 1 - 1 / 1024)

    def place(self, edge: Edge) -> npt.NDArray[np.float64]:
        place = np.array(edge[1], dtype=float)
        place[edge[0]] += self.share(edge)
        return place
