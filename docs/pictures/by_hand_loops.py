"""From the boxes of by_hand.py to triangles: the kept crossings on each box, their loop, and how it is cut."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt
from by_hand import Block, Box, Edge, axes, ends

Triangle = tuple[int, int, int]  # vertex numbers, counter-clockwise seen from outside
Face = int  # of a box: 2 * axis, plus 1 for the high side
PER_STOP = 1 << 16  # more than any way along one face


def faces(box: Box, edge: Edge) -> set[Face]:
    """The faces of a box that a grid edge lies on."""
    axis, place = edge
    return {2 * a + n for a in range(3) if a != axis for n, end in enumerate(ends(box, a)) if place[a] == end}


def on_surface(block: Block, box: Box) -> list[int]:
    """The crossings on the surface of a box, by number."""
    found = []
    for number, (axis, place) in enumerate(block.crossings):
        within = all(
            low <= place[a] <= high - (a == axis) for a, (low, high) in enumerate(ends(box, a) for a in range(3))
        )
        if within and faces(box, (axis, place)):
            found.append(number)
    return found


def kept(block: Block, box: Box) -> list[int]:
    return [number for number in on_surface(block, box) if block.kept[number]]


def dropped(block: Block, box: Box) -> list[int]:
    """The crossings of a box that are no vertices, but for those in a high face with a box beyond."""
    found = []
    for number, (axis, place) in enumerate(block.crossings):
        highs = [ends(box, a)[1] for a in range(3)]
        within = all(ends(box, a)[0] <= place[a] <= highs[a] - (a == axis) for a in range(3))
        own = all(a == axis or place[a] < highs[a] or highs[a] == 4 for a in range(3))
        if within and own and not block.kept[number]:
            found.append(number)
    return found


def edge_number(box: Box, edge: Edge) -> int:
    """Of the box's twelve edges, as common/cube.hpp numbers them."""
    axis, place = edge
    first, second = (a for a in range(3) if a != axis)
    return 4 * axis + (place[first] == ends(box, first)[1]) + 2 * (place[second] == ends(box, second)[1])


def rim(block: Block, box: Box) -> list[tuple[int, Face]]:
    """The crossings on the edges of a box in the order of its loop, each with the face that leads to the next."""
    on_edges = {number for number in kept(block, box) if len(faces(box, block.crossings[number])) == 2}
    order: list[tuple[int, Face]] = []
    here = min(on_edges, key=lambda number: edge_number(box, block.crossings[number]))
    while len(order) < len(on_edges):
        # Seen from outside the box, a segment has the inside on its right.
        for face in faces(box, block.crossings[here]):
            there = [n for n in on_edges if n != here and face in faces(box, block.crossings[n])]
            if there and inside_on_the_right(block, face, here, there[0]):
                order.append((here, face))
                here = there[0]
                break
    return order


def inside_on_the_right(block: Block, face: Face, here: int, there: int) -> bool:
    axis, place = block.crossings[here]
    normal, to_inside = np.zeros(3), np.zeros(3)
    normal[face // 2] = 1 if face % 2 else -1
    to_inside[axis] = -1 if block.inside[place] else 1
    along = block.place(block.crossings[there]) - block.place(block.crossings[here])
    turn = float(np.dot(np.cross(along, to_inside), normal))
    if turn == 0:  # both on one line: only where the segment runs along the edge's axis
        raise ValueError("a segment along its own edge")
    return turn < 0


def half_steps(edge: Edge) -> npt.NDArray[np.int64]:
    axis, place = edge
    return np.array([2 * n + (a == axis) for a, n in enumerate(place)])


def along(block: Block, box: Box) -> dict[int, int]:
    """How far each kept crossing is along the loop: a stop of the rim, and the way within a face."""
    order = rim(block, box)
    found = {number: 2 * n * PER_STOP for n, (number, _) in enumerate(order)}
    for number in kept(block, box):
        if number in found:
            continue
        (face,) = faces(box, block.crossings[number])
        n = [face_here for _, face_here in order].index(face)
        first, last = (half_steps(block.crossings[order[m % len(order)][0]]) for m in (n, n + 1))
        found[number] = (2 * n + 1) * PER_STOP + int((last - first) @ (half_steps(block.crossings[number]) - first))
    return found


def loop(block: Block, box: Box) -> list[int]:
    """The crossings of a box in the order of its loop."""
    places = along(block, box)
    return sorted(places, key=places.__getitem__)


def cut(block: Block, box: Box) -> list[Triangle]:
    """The triangles of a box, as crossings, by dynamic programming over the parts of its loop.

    A box of several cells takes the least area and no diagonal in a face of the box, which a neighbour could draw too.
    A single cell goes by marching cubes' table instead: the shortest diagonals on the lattice of half cells.
    """
    corners = loop(block, box)
    spots = [block.place(block.crossings[n]) for n in corners]
    last = len(corners) - 1

    def side(i: int, j: int) -> float:
        if j - i == 1 or (i, j) == (0, last):
            return 0
        if faces(box, block.crossings[corners[i]]) & faces(box, block.crossings[corners[j]]):
            return float("inf")
        lattice = half_steps(block.crossings[corners[i]]) - half_steps(block.crossings[corners[j]])
        return int(lattice @ lattice) if is_cell(box) else 0

    def area(i: int, k: int, j: int) -> float:
        return 0 if is_cell(box) else float(np.linalg.norm(np.cross(spots[k] - spots[i], spots[j] - spots[i]))) / 2

    @cache
    def best(i: int, j: int) -> tuple[float, tuple[tuple[int, int, int], ...]]:
        """Of the part from corner i to corner j: what it costs, and its triangles."""
        cost = 0.0 if j - i < 2 else float("inf")
        drawn: tuple[tuple[int, int, int], ...] = ()
        for k in range(i + 1, j):
            (before, left), (after, right) = best(i, k), best(k, j)
            price = before + after + area(i, k, j) + side(i, k) + side(k, j)
            if price < cost:
                cost, drawn = price, (*left, (i, k, j), *right)
        return cost, drawn

    return [(corners[a], corners[b], corners[c]) for a, b, c in best(0, last)[1]]


def triangles(block: Block) -> list[Triangle]:
    """Of the whole block, as vertex numbers. Single cells with one loop and no ambiguous face are cut alike."""
    drawn = (triangle for box in block.boxes for triangle in cut(block, box))
    return [(block.number(a), block.number(b), block.number(c)) for a, b, c in drawn]


def deviation(block: Block, box: Box) -> list[tuple[int, float]]:
    """How far each dropped crossing of a box lies from the nearest of its triangles."""
    drawn = [[block.place(block.crossings[n]) for n in t] for t in cut(block, box)]
    return [(n, min(distance(block.place(block.crossings[n]), t) for t in drawn)) for n in dropped(block, box)]


def distance(point: npt.NDArray[np.float64], corners: list[npt.NDArray[np.float64]]) -> float:
    """From a point to a triangle: to its plane if the foot lies within, else to the nearest side."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    sides = [(a, b), (b, c), (c, a)]
    if all(np.dot(np.cross(q - p, point - p), normal) >= 0 for p, q in sides):
        return abs(float(np.dot(point - a, normal))) / float(np.linalg.norm(normal))
    shares = [float(np.clip(np.dot(point - p, q - p) / np.dot(q - p, q - p), 0, 1)) for p, q in sides]
    return min(float(np.linalg.norm(p + t * (q - p) - point)) for (p, q), t in zip(sides, shares, strict=True))


def is_cell(box: Box) -> bool:
    return not axes(box)


def neighbours(block: Block, box: Box, face: Face) -> list[Box]:
    """The boxes that share a part of a face of a box: each overlap is a padi."""
    axis, end = face // 2, ends(box, face // 2)[face % 2]
    return [
        other
        for other in block.boxes
        if ends(other, axis)[1 - face % 2] == end
        and all(
            max(ends(box, a)[0], ends(other, a)[0]) < min(ends(box, a)[1], ends(other, a)[1])
            for a in range(3)
            if a != axis
        )
    ]
