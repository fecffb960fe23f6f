"""Which pairs of triangles meet, by brute force in exact rational numbers: slow, and written from the definition alone.

One triangle is cut by the other as a convex polygon: what is left is a polygon, a segment or a point, whose corners are
exact fractions. A pair counts if that part holds a point that is not in what the two share.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

Point = tuple[Fraction, Fraction, Fraction]


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _clipped(polygon: list[Point], normal: Point, anchor: Point) -> list[Point]:
    """What of a convex polygon (or segment, or point) lies where (p - anchor) . normal >= 0."""
    heights = [_dot(_minus(p, anchor), normal) for p in polygon]
    kept: list[Point] = []
    for n, (p, height) in enumerate(zip(polygon, heights, strict=True)):
        if height >= 0:
            kept.append(p)
        q, other = polygon[(n + 1) % len(polygon)], heights[(n + 1) % len(polygon)]
        if height * other < 0:
            t = height / (height - other)
            step = _minus(q, p)
            kept.append((p[0] + t * step[0], p[1] + t * step[1], p[2] + t * step[2]))
    return list(dict.fromkeys(kept))


def _common(one: Sequence[Point], other: Sequence[Point]) -> list[Point]:
    """The corners of what two triangles have in common."""
    normal = _cross(_minus(other[1], other[0]), _minus(other[2], other[0]))
    part = _clipped(list(one), normal, other[0])
    part = _clipped(part, (-normal[0], -normal[1], -normal[2]), other[0])
    for n in range(3):
        inwards = _cross(normal, _minus(other[(n + 1) % 3], other[n]))
        part = _clipped(part, inwards, other[n])
    return part


def _is_on_segment(p: Point, a: Point, b: Point) -> bool:
    step, way = _minus(b, a), _minus(p, a)
    return not any(_cross(step, way)) and 0 <= _dot(step, way) <= _dot(step, step)


def pair_meets(one: Sequence[Point], other: Sequence[Point]) -> bool:
    """Do two triangles meet in a point that is not their shared corner or edge?"""
    for triangle in (one, other):
        if not any(_cross(_minus(triangle[1], triangle[0]), _minus(triangle[2], triangle[0]))):
            return False
    shared = [corner for corner in one if corner in other]
    part = _common(one, other)
    if len(shared) == 3:
        return True
    if len(shared) == 2:
        return not all(_is_on_segment(p, shared[0], shared[1]) for p in part)
    return any(p not in shared for p in part)


def count(vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32]) -> int:
    """Pairs of triangles that meet; vertices (v, 3), triangles (t, 3)."""
    points = [tuple(Fraction(x) for x in row) for row in vertices.astype(np.float64).tolist()]
    corners = [[points[v] for v in row] for row in triangles.tolist()]
    lows, highs = vertices[triangles].min(axis=1), vertices[triangles].max(axis=1)
    found = 0
    for a, b in combinations(range(len(triangles)), 2):
        if (lows[a] <= highs[b]).all() and (lows[b] <= highs[a]).all():
            found += pair_meets(corners[a], corners[b])  # type: ignore[arg-type]
    return found
