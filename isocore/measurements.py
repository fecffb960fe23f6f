"""Measure a surface: how large it is, and whether it is closed, manifold and oriented.

Edges are those between the corners of triangles; positions never join two vertices. A triangle with a
repeated corner counts as degenerate and takes part in nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

from isocore import _kernels
from isocore.surface import Surface


@dataclass(frozen=True, slots=True)
class Measurements:
    """What a surface is; lengths, areas and volumes are in `unit`, its square and its cube.

    components: pieces that share no vertex.
    boundary_edges, nonmanifold_edges: edges with one triangle, and with more than two.
    nonmanifold_vertices: vertices whose triangles form neither one ring nor one fan.
    misoriented_edges: edges whose two triangles turn against each other.
    euler: used vertices - edges + triangles.
    watertight: every edge has two triangles that turn the same way; None where there is none, as in an empty surface.
    manifold: no non-manifold edge and no non-manifold vertex; None where there is no edge.
    volume: enclosed, positive when normals point outside; None unless watertight.
    bounds: lowest and highest corner of the box around all vertices; None where there is none.
    degenerate: triangles with a repeated corner or an area of exactly zero.
    self_intersections: pairs of triangles that meet beyond the corner or edge they share; None where they were not
        counted. Exact; to touch is to meet, and triangles without area meet nothing.
    """

    triangles: int
    vertices: int
    components: int
    boundary_edges: int
    nonmanifold_edges: int
    nonmanifold_vertices: int
    misoriented_edges: int
    euler: int
    watertight: bool | None
    manifold: bool | None
    area: float
    volume: float | None
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None
    degenerate: int
    self_intersections: int | None
    unit: str


def measure(surface: Surface, threads: int = 1, *, self_intersections: bool = True) -> Measurements:
    """Measure `surface`. The result does not depend on `threads`.

    self_intersections: whether to count them, which takes longer than everything else.

    Raises ValueError if a triangle names a vertex that does not exist.
    """
    measured = _kernels.measure(surface.vertices, surface.triangles, threads)
    pairs = _kernels.self_intersections(surface.vertices, surface.triangles, threads) if self_intersections else None
    has_edges = measured.components > 0
    watertight = measured.boundary_edges == measured.nonmanifold_edges == measured.misoriented_edges == 0
    return Measurements(
        triangles=len(surface.triangles),
        vertices=len(surface.vertices),
        components=measured.components,
        boundary_edges=measured.boundary_edges,
        nonmanifold_edges=measured.nonmanifold_edges,
        nonmanifold_vertices=measured.nonmanifold_vertices,
        misoriented_edges=measured.misoriented_edges,
        euler=measured.euler,
        watertight=watertight if has_edges else None,
        manifold=measured.nonmanifold_edges == measured.nonmanifold_vertices == 0 if has_edges else None,
        area=measured.area,
        volume=measured.volume if has_edges and watertight else None,
        bounds=(measured.bounds[:3], measured.bounds[3:]) if len(surface.vertices) else None,
        degenerate=measured.degenerate,
        self_intersections=pairs,
        unit=surface.unit,
    )
