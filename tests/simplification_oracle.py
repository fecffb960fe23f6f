"""What simplification promises, told by brute force: every vertex, every point, every pair of triangles is looked at.

Slow and obvious on purpose, and without a line of the kernels: distances are numpy's in float64, and whether two
triangles meet is decided with Python's integers, which do not round.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.measurements import measure
from isocore.surface import Surface

Mesh = tuple[npt.NDArray[Any], npt.NDArray[np.int32]]
Points = npt.NDArray[np.float64]
Whole = tuple[int, int, int]

#: What float64 may lose of a distance, in cells.
ROUNDING = 1e-9


def broken_promises(
    ours: Mesh, reference: Mesh, bound: float, *, stretch: tuple[float, ...] = (1, 1, 1), meetings: bool = True
) -> list[str]:
    """What a simplified mesh breaks, in words; nothing if all is well.

    stretch: from coordinates to the unit. meetings: whether pairs of triangles are looked at, too.
    """
    broken = _topology(ours, reference)
    if len(ours[1]):
        there = distances(reference[0] * np.array(stretch), corners(ours, stretch)).max(initial=0)
        back = distances(sampled(ours, stretch), corners(reference, stretch)).max(initial=0)
        if there > bound + ROUNDING:
            broken.append(f"a vertex of the reference is {there} away")
        if back > bound + ROUNDING:
            broken.append(f"a point of the surface is {back} away")
    meeting = meeting_pairs(*ours) if meetings else []
    if meeting:
        broken.append(f"{len(meeting)} pairs of triangles meet, the first are {meeting[0]}")
    return broken


def _topology(ours: Mesh, reference: Mesh) -> list[str]:
    is_, was = (measure(Surface(*mesh)) for mesh in (ours, reference))
    broken = [
        f"{name} is {getattr(is_, name)}, not {getattr(was, name)}"
        for name in ("euler", "components")
        if getattr(is_, name) != getattr(was, name)
    ]
    for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges", "degenerate"):
        if getattr(is_, name) != getattr(was, name):
            broken.append(f"{getattr(is_, name)} {name}")
    if border_loops(ours[1]) != border_loops(reference[1]):
        broken.append("another number of borders")
    known = {place.tobytes() for place in reference[0]}
    if any(place.tobytes() not in known for place in ours[0]):
        broken.append("a vertex is not the reference's")
    if len(np.unique(ours[1])) != len(ours[0]):
        broken.append("a vertex is not used")
    return broken


def border_loops(triangles: npt.NDArray[np.int32]) -> int:
    """How many closed lines the border consists of; each of its vertices has one border edge in and one out."""
    edges = {(int(t[n]), int(t[(n + 1) % 3])) for t in triangles for n in range(3)}
    onward = {a: b for a, b in edges if (b, a) not in edges}
    loops = 0
    while onward:
        loops += 1
        at = next(iter(onward))
        while at in onward:
            at = onward.pop(at)
    return loops


def corners(mesh: Mesh, stretch: tuple[float, ...] = (1, 1, 1)) -> Points:
    """(t, 3, 3) float64: the stretched corners of each triangle."""
    return np.asarray((mesh[0].astype(np.float64) * np.array(stretch))[mesh[1]])


def sampled(mesh: Mesh, stretch: tuple[float, ...] = (1, 1, 1), steps: int = 4) -> Points:
    """(n, 3): a lattice of points on each triangle, its sides and corners included."""
    shares = [(i / steps, j / steps, (steps - i - j) / steps) for i in range(steps + 1) for j in range(steps + 1 - i)]
    return np.einsum("sc,tcd->tsd", np.array(shares), corners(mesh, stretch)).reshape(-1, 3)


def distances(points: Points, triangles: Points) -> Points:
    """(n,): from each point to the nearest of (t, 3, 3) triangles."""
    best = np.full(len(points), np.inf)
    for some in np.array_split(triangles, 1 + len(triangles) * len(points) // 100_000):
        best = np.minimum(best, _all_distances(points, some).min(axis=1, initial=np.inf))
    return best


def _all_distances(points: Points, triangles: Points) -> Points:
    """(n, t): from each point to each of (t, 3, 3) triangles. By products of matrices: good to 1e-7 near 0."""

    def along(vectors: Points, start: Points) -> Points:
        return np.asarray(points @ vectors.T - (start * vectors).sum(1))

    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    best = np.full((len(points), len(triangles)), np.inf)  # squared
    inside = np.broadcast_to(lengths > 0, best.shape)
    for n in range(3):
        p, side = triangles[:, n], triangles[:, (n + 1) % 3] - triangles[:, n]
        squared = (points * points).sum(1)[:, None] - 2 * points @ p.T + (p * p).sum(1)
        way, length = along(side, p), (side * side).sum(1)
        share = np.clip(way / np.maximum(length, 1e-300), 0, 1)
        best = np.minimum(best, squared - 2 * share * way + share * share * length)
        inside = inside & (along(np.cross(normals, side), p) >= 0)
    over = np.abs(along(normals, triangles[:, 0])) / np.maximum(lengths, 1e-300)
    best = np.sqrt(np.maximum(best, 0))
    return np.asarray(np.where(inside, np.minimum(best, over), best))


def meeting_pairs(vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32]) -> list[tuple[int, int]]:
    """All pairs of triangles that meet elsewhere than in what corners they share; coplanar ones that overlap do."""
    if not len(triangles):
        return []
    whole = [tuple(int(x) for x in place) for place in _whole(vertices)]
    boxes = corners((vertices, triangles))
    low, high = boxes.min(axis=1), boxes.max(axis=1)
    found = []
    for n in range(len(triangles) - 1):
        near = ((low[n + 1 :] <= high[n]) & (low[n] <= high[n + 1 :])).all(axis=1)
        for m in np.flatnonzero(near) + n + 1:
            if _meet([int(v) for v in triangles[n]], [int(v) for v in triangles[m]], whole):
                found.append((n, int(m)))
    return found


def _whole(vertices: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The same places in whole numbers: all times one power of two."""
    denominators = {Fraction(float(x)).denominator for x in vertices.ravel()}
    scale = max(denominators, default=1)
    return np.array([[int(Fraction(float(x)) * scale) for x in place] for place in vertices], object)


def _meet(one: list[int], other: list[int], places: list[Any]) -> bool:
    shared = [v for v in one if v in other]
    rest, other_rest = [[v for v in t if v not in shared] for t in (one, other)]
    if len(shared) == 3:
        return True
    t, u = [places[v] for v in one], [places[v] for v in other]
    if len(shared) == 2:
        p, q = places[shared[0]], places[shared[1]]
        a, b = places[rest[0]], places[other_rest[0]]
        normal, turned = _cross(_minus(q, p), _minus(a, p)), _cross(_minus(q, p), _minus(b, p))
        return _dot(normal, _minus(b, p)) == 0 and _dot(normal, turned) > 0
    if len(shared) == 1:
        return _side_meets(*(places[v] for v in rest), u) or _side_meets(*(places[v] for v in other_rest), t)
    return any(_side_meets(p, q, u) for p, q in combinations(t, 2)) or any(
        _side_meets(p, q, t) for p, q in combinations(u, 2)
    )


def _side_meets(p: Whole, q: Whole, triangle: list[Whole]) -> bool:
    """Does the segment from p to q have a point in the closed triangle?"""
    a, b, c = triangle
    normal = _cross(_minus(b, a), _minus(c, a))
    of_p, of_q = _dot(normal, _minus(p, a)), _dot(normal, _minus(q, a))
    if of_p * of_q > 0:
        return False
    if of_p == of_q == 0:
        drop = max(range(3), key=lambda n: abs(normal[n]))
        flat = [tuple(x for n, x in enumerate(place) if n != drop) for place in (p, q, a, b, c)]
        return _flat_meets(*flat)
    turns = [_dot(_minus(q, p), _cross(_minus(x, p), _minus(y, p))) for x, y in ((a, b), (b, c), (c, a))]
    return min(turns) >= 0 or max(turns) <= 0


def _flat_meets(p: Any, q: Any, a: Any, b: Any, c: Any) -> bool:
    def turn(x: Any, y: Any, z: Any) -> int:
        return int((y[0] - x[0]) * (z[1] - x[1]) - (y[1] - x[1]) * (z[0] - x[0]))

    turns = [turn(x, y, p) for x, y in ((a, b), (b, c), (c, a))]
    if min(turns) >= 0 or max(turns) <= 0:
        return True
    for x, y in ((a, b), (b, c), (c, a)):
        if turn(p, q, x) * turn(p, q, y) <= 0 and turn(x, y, p) * turn(x, y, q) <= 0:
            ranges = [(sorted((p[n], q[n])), sorted((x[n], y[n]))) for n in range(2)]
            if all(max(s[0], t[0]) <= min(s[1], t[1]) for s, t in ranges):
                return True
    return False


def _minus(a: Whole, b: Whole) -> Whole:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: Whole, b: Whole) -> int:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Whole, b: Whole) -> Whole:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
