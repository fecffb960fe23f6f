"""Parts of records as reports hold them, for tests that need no run."""

from __future__ import annotations

from typing import Any

#: A closed surface of four triangles.
SURFACE: dict[str, Any] = {
    "triangles": 4, "vertices": 4, "components": 1, "boundary_edges": 0, "nonmanifold_edges": 0,
    "nonmanifold_vertices": 0, "misoriented_edges": 0, "euler": 2, "watertight": True, "manifold": True,
    "area": 1.0, "volume": 1.0, "bounds": None, "degenerate": 0, "self_intersections": 0, "unit": "mm",
}  # fmt: skip
