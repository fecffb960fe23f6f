"""A small copy of a surface to look at: vertices in one cell of a coarse grid become one."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from isocore.writers.read_back import Mesh

#: 16-bit indices reach so many vertices.
MOST_TRIANGLES = 60_000
#: Of a reduced copy inside a page: half a vertex of 6 bytes and 6 bytes of indices, as base64.
BYTES_PER_TRIANGLE = 12
_TRIES = 6
#: Of the unit box: the cells of a grid so fine still have numbers of 64 bits.
_FINEST = 1e-6


def reduced(mesh: Mesh, most: int) -> Mesh:
    """At most `most` triangles; the surface itself where it has no more."""
    vertices, triangles = mesh
    if len(triangles) <= most and len(vertices) < 65536:
        return mesh
    vertices = _in_unit_box(vertices)
    corners = vertices[triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    cell = max(float(np.sqrt(2.5 * area / most)), _FINEST)
    for _ in range(_TRIES):
        number, kept = _clustered(vertices, triangles, cell)
        if len(kept) <= most and number.max() < 65535:
            return _centres(mesh[0], number), kept
        cell *= 1.1 * max(1.1, float(np.sqrt(len(kept) / most)))
    return mesh[0][:0], triangles[:0]


def _in_unit_box(vertices: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """The vertices moved and scaled, all axes alike, to lie in 0 to 1: coordinates may be as large as a double."""
    halves = vertices.astype(np.float64) / 2
    offsets = halves - halves.min(axis=0)
    return np.asarray(offsets / (offsets.max() or 1.0))


def _clustered(
    vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32], cell: float
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.int32]]:
    """The number of each vertex' cell, counted over those that hold any; the triangles between different cells."""
    steps = np.floor(vertices / cell).astype(np.int64)
    sides = steps.max(axis=0) + 1
    keys = steps[:, 0] + sides[0] * (steps[:, 1] + sides[1] * steps[:, 2])
    _, number = np.unique(keys, return_inverse=True)
    merged = number[triangles]
    alive = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
    return number, np.unique(merged[alive], axis=0).astype(np.int32)


def _centres(vertices: npt.NDArray[Any], number: npt.NDArray[np.intp]) -> npt.NDArray[np.float64]:
    """The mean of the vertices under each number."""
    shares = 1 / np.bincount(number)[number]
    return np.stack([np.bincount(number, vertices[:, axis] * shares) for axis in range(3)], axis=1)


def packed(mesh: Mesh) -> dict[str, Any] | None:
    """The mesh as the page reads it: 16-bit steps between two corners, 16-bit indices, base64.

    None where there is nothing to draw, or where a side is longer than a double can say.
    """
    vertices, triangles = mesh
    if not len(triangles):
        return None
    low, high = vertices.min(axis=0).astype(float), vertices.max(axis=0).astype(float)
    with np.errstate(over="ignore"):
        sides = high - low
    if not np.isfinite(sides).all():
        return None
    steps = np.rint((vertices - low) / np.where(sides > 0, sides, 1) * 65535).astype("<u2")
    return {
        "low": low.tolist(),
        "high": high.tolist(),
        "vertices": base64.b64encode(steps.tobytes()).decode(),
        "triangles": base64.b64encode(triangles.astype("<u2").tobytes()).decode(),
    }
