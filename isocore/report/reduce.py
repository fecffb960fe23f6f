"""A small copy of a surface to look at: vertices in one cell of a coarse grid become one."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from isocore.writers.read_back import Mesh

#: 16-bit indices reach so many vertices.
MOST_TRIANGLES = 60_000
#: Of a reduced copy inside a page: half a vertex of 6 bytes and 6 bytes of indices, as base64.
BYTES_PER_TRIANGLE = 12
_TRIES = 6


def reduced(mesh: Mesh, most: int) -> Mesh:
    """At most `most` triangles; the surface itself where it has no more."""
    vertices, triangles = mesh
    if len(triangles) <= most and len(vertices) < 65536:
        return mesh
    corners = vertices[triangles].astype(np.float64)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    cell = float(np.sqrt(2.5 * area / most)) or 1.0
    for _ in range(_TRIES):
        small = _clustered(mesh, cell)
        if len(small[1]) <= most and len(small[0]) < 65536:
            return small
        cell *= 1.1 * max(1.1, float(np.sqrt(len(small[1]) / most)))
    return small[0][:0], small[1][:0]


def _clustered(mesh: Mesh, cell: float) -> Mesh:
    vertices, triangles = mesh
    steps = np.floor((vertices - vertices.min(axis=0)) / cell).astype(np.int64)
    sides = steps.max(axis=0) + 1
    keys = steps[:, 0] + sides[0] * (steps[:, 1] + sides[1] * steps[:, 2])
    _, number = np.unique(keys, return_inverse=True)
    counts = np.bincount(number)
    points = np.stack([np.bincount(number, vertices[:, axis]) / counts for axis in range(3)], axis=1)
    merged = number[triangles]
    alive = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
    return points.astype(np.float32), np.unique(merged[alive], axis=0).astype(np.int32)


def packed(mesh: Mesh) -> dict[str, Any] | None:
    """The mesh as the page reads it: 16-bit steps between two corners, 16-bit indices, base64."""
    vertices, triangles = mesh
    if not len(triangles):
        return None
    low, high = vertices.min(axis=0).astype(float), vertices.max(axis=0).astype(float)
    steps = np.rint((vertices - low) / np.where(high > low, high - low, 1) * 65535).astype("<u2")
    return {
        "low": low.tolist(),
        "high": high.tolist(),
        "vertices": base64.b64encode(steps.tobytes()).decode(),
        "triangles": base64.b64encode(triangles.astype("<u2").tobytes()).decode(),
    }
