"""What a surface may be required to be, and which of it one misses. The command line's help reads the names here."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from isocore.measurements import Measurements

REQUIREMENTS = ("watertight", "manifold", "simple", "nonempty")


def missed(surface: Measurements, require: tuple[str, ...], max_triangles: int | None) -> tuple[str, ...]:
    """The requirements that this surface does not meet, each with the count that says so.

    Of an empty surface nothing can be said, so it is neither `watertight` nor `manifold` nor `simple`.

    require: names out of REQUIREMENTS; max_triangles: a further one.
    """
    misses = []
    if "watertight" in require and not surface.watertight:
        misses.append(f"watertight: {_leaks(surface) or _nothing(surface)}")
    if "manifold" in require and not surface.manifold:
        edges, vertices = surface.nonmanifold_edges, surface.nonmanifold_vertices
        counts = f"{edges:,} edges and {vertices:,} vertices are not"
        misses.append(f"manifold: {counts if edges or vertices else _nothing(surface)}")
    if "simple" in require and (surface.self_intersections != 0 or not surface.triangles):
        misses.append(f"simple: {_crossings(surface)}")
    if "nonempty" in require and not surface.triangles:
        misses.append("nonempty: no triangles")
    if max_triangles is not None and surface.triangles > max_triangles:
        misses.append(f"max-triangles: {surface.triangles:,} of at most {max_triangles:,}")
    return tuple(misses)


def _leaks(surface: Measurements) -> str:
    """Why a surface is not watertight, in numbers of edges."""
    kinds = (
        (surface.boundary_edges, "open edges"),
        (surface.nonmanifold_edges, "edges of more than two triangles"),
        (surface.misoriented_edges, "edges whose triangles turn against each other"),
    )
    return ", ".join(f"{edges:,} {what}" for edges, what in kinds if edges)


def _crossings(surface: Measurements) -> str:
    """Why nobody can say that a surface does not meet itself."""
    if surface.self_intersections is None:
        return "self-intersections were not counted"
    pairs = surface.self_intersections
    return f"{pairs:,} pairs of triangles meet" if pairs else "the surface is empty"


def _nothing(surface: Measurements) -> str:
    return "all triangles are degenerate" if surface.triangles else "the surface is empty"
