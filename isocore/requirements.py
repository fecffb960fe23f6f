"""What a surface may be required to be, and which of it one misses. The command line's help reads the names here."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from isocore.measurements import Measurements

REQUIREMENTS = ("watertight", "manifold", "nonempty")


def missed(surface: Measurements, require: tuple[str, ...], max_triangles: int | None) -> tuple[str, ...]:
    """The requirements that this surface does not meet, each with the count that says so.

    require: names out of REQUIREMENTS; max_triangles: a further one.
    """
    misses = []
    if "watertight" in require and not surface.watertight:
        misses.append(f"watertight: {surface.boundary_edges:,} open edges")
    edges, vertices = surface.nonmanifold_edges, surface.nonmanifold_vertices
    if "manifold" in require and (edges or vertices):
        misses.append(f"manifold: {edges:,} edges and {vertices:,} vertices are not")
    if "nonempty" in require and not surface.triangles:
        misses.append("nonempty: no triangles")
    if max_triangles is not None and surface.triangles > max_triangles:
        misses.append(f"max-triangles: {surface.triangles:,} of at most {max_triangles:,}")
    return tuple(misses)
