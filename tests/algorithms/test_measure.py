"""What is measured is what a slow and obvious count finds, and what geometry says."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import astuple

import numpy as np
import pytest
import shapes_mesh
from hypothesis import given, settings
from hypothesis import strategies as st

from isocore import _kernels
from isocore.measurements import measure
from isocore.surface import Surface


def count_slowly(surface: Surface) -> dict[str, int]:
    """The topology by dictionaries of edges and flood fills, straight from the definitions."""
    triangles = [tuple(map(int, t)) for t in surface.triangles if len(set(t.tolist())) == 3]
    directed = Counter(e for a, b, c in triangles for e in ((a, b), (b, c), (c, a)))
    uses = Counter(e for edge, n in directed.items() for e in [tuple(sorted(edge))] * n)
    links = defaultdict(list)
    for a, b, c in triangles:
        for v, x, y in ((a, b, c), (b, c, a), (c, a, b)):
            links[v].append((x, y))
    p = surface.vertices.astype(np.float64)[surface.triangles]
    flat = ~np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]).any(axis=1)
    return {
        "components": len(pieces(links, [(a, b) for a, b in uses])),
        "boundary_edges": sum(n == 1 for n in uses.values()),
        "nonmanifold_edges": sum(n > 2 for n in uses.values()),
        "nonmanifold_vertices": sum(not is_ring_or_fan(link) for link in links.values()),
        "misoriented_edges": sum(n == 2 and directed[e] != 1 for e, n in uses.items()),
        "euler": len(links) - len(uses) + len(triangles),
        "degenerate": int(flat.sum()),
    }


def is_ring_or_fan(link):
    degree = Counter(x for edge in link for x in edge)
    return max(degree.values()) <= 2 and len(pieces(degree, link)) == 1


def pieces(nodes, edges):
    neighbours = defaultdict(set)
    for a, b in edges:
        neighbours[a].add(b)
        neighbours[b].add(a)
    left, found = set(nodes), []
    while left:
        reached, todo = set(), [left.pop()]
        while todo:
            node = todo.pop()
            reached.add(node)
            todo += neighbours[node] - reached
        left -= reached
        found.append(reached)
    return found


soups = st.integers(3, 9).flatmap(
    lambda n: st.lists(st.tuples(*[st.integers(0, n - 1)] * 3), max_size=14).map(lambda t: (n, t))
)


@settings(max_examples=400, deadline=None)
@given(soups, st.integers(1, 4))
def test_any_soup_of_triangles_is_counted_as_by_hand(soup, threads):
    """Open, closed, non-manifold, bow-tied, doubled and degenerate triangles, several components."""
    n, triangles = soup
    surface = shapes_mesh.surface(np.random.default_rng(n).integers(0, 3, (n, 3)), triangles)
    measured = measure(surface, threads)
    assert {name: getattr(measured, name) for name in count_slowly(surface)} == count_slowly(surface)


@settings(max_examples=100, deadline=None)
@given(soups)
def test_a_soup_with_distant_indices_is_counted_as_by_hand(soup):
    """Neighbours whose indices differ by more than 16 bits hold take another path."""
    n, triangles = soup
    vertices = np.zeros((9 * 8000, 3), np.float32)
    vertices[: n * 8000 : 8000] = np.random.default_rng(n).integers(0, 3, (n, 3))
    surface = shapes_mesh.surface(vertices, [[8000 * v for v in t] for t in triangles])
    measured = measure(surface)
    assert {name: getattr(measured, name) for name in count_slowly(surface)} == count_slowly(surface)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_a_damaged_torus_is_counted_as_by_hand(data):
    """Dropping, turning and rewiring a few triangles of a good surface."""
    torus = shapes_mesh.torus(7, 5)
    triangles = torus.triangles.copy()
    for row in data.draw(st.lists(st.integers(0, len(triangles) - 1), max_size=4)):
        triangles[row] = triangles[row, ::-1]
    for row in data.draw(st.lists(st.integers(0, len(triangles) - 1), max_size=2)):
        triangles[row, 0] = data.draw(st.integers(0, 34))
    keep = np.ones(len(triangles), bool)
    keep[data.draw(st.lists(st.integers(0, len(triangles) - 1), max_size=4))] = False
    surface = shapes_mesh.surface(torus.vertices, triangles[keep])
    measured = measure(surface)
    assert {name: getattr(measured, name) for name in count_slowly(surface)} == count_slowly(surface)


@pytest.mark.parametrize(
    ("shape", "components", "euler", "area", "volume", "tolerance"),
    [
        ("tetrahedron", 1, 2, 1.5 + 3**0.5 / 2, 1 / 6, 1e-7),
        ("cube", 1, 2, 6, 1, 1e-12),
        ("torus", 1, 0, 12 * np.pi**2, 6 * np.pi**2, 0.02),
        ("sphere", 1, 2, 4 * np.pi, 4 / 3 * np.pi, 0.02),
        ("two_spheres", 2, 4, 8 * np.pi, 8 / 3 * np.pi, 0.02),
    ],
)
def test_a_closed_shape_has_the_numbers_of_its_construction(shape, components, euler, area, volume, tolerance):
    """Components and Euler number exactly; a round shape's area and volume from below."""
    measured = measure(getattr(shapes_mesh, shape)())
    assert (measured.components, measured.euler) == (components, euler)
    assert measured.watertight
    assert measured.manifold
    assert area * (1 - tolerance) <= measured.area <= area * (1 + 1e-7)
    assert measured.volume is not None
    assert volume * (1 - tolerance) <= measured.volume <= volume * (1 + 1e-7)
    assert measured.degenerate == 0
    assert measured.unit == "mm"


def test_a_surface_turned_inside_out_has_a_negative_volume():
    """The volume's sign tells whether normals point outside."""
    cube = shapes_mesh.cube()
    assert measure(Surface(cube.vertices, cube.triangles[:, ::-1])).volume == -1


def test_a_moebius_strip_is_manifold_but_neither_closed_nor_oriented():
    """A misoriented edge is found even if every vertex is ordinary."""
    measured = measure(shapes_mesh.moebius_strip(20))
    assert (measured.boundary_edges, measured.misoriented_edges, measured.euler) == (40, 1, 0)
    assert measured.manifold
    assert not measured.watertight
    assert measured.volume is None


def test_two_bodies_that_touch_at_a_vertex_are_closed_but_not_manifold():
    """A vertex with two rings is not manifold; the volume still means something."""
    measured = measure(shapes_mesh.bow_tie())
    assert (measured.nonmanifold_edges, measured.nonmanifold_vertices, measured.components) == (0, 1, 1)
    assert measured.watertight
    assert not measured.manifold
    assert measured.volume == pytest.approx(1 / 3)


@pytest.mark.parametrize("blades", [1, 2, 3, 4, 40])
def test_an_edge_with_many_triangles_is_one_bad_edge_with_two_bad_ends(blades):
    """More than two triangles at an edge are too many."""
    measured = measure(shapes_mesh.fan(blades))
    assert measured.nonmanifold_edges == (blades > 2)
    assert measured.nonmanifold_vertices == 2 * (blades > 2)


@pytest.mark.parametrize("sides", [3, 24, 25, 1000])
def test_a_vertex_with_any_number_of_triangles_is_ordinary(sides):
    """Long rings take the slow way and come out the same."""
    measured = measure(shapes_mesh.cone(sides))
    assert (measured.boundary_edges, measured.euler, measured.manifold) == (sides, 1, True)


def test_a_small_body_far_away_keeps_its_volume():
    """Volumes are summed around the middle of the surface, not around the origin."""
    sphere = shapes_mesh.sphere()
    far = Surface(sphere.vertices.astype(np.float64) + 1e7, sphere.triangles)
    assert measure(far).volume == pytest.approx(measure(sphere).volume, rel=1e-7)


def test_the_box_holds_unused_vertices_and_skips_what_is_not_a_number():
    """Every vertex counts, whatever its place in memory; NaN is nowhere."""
    torus = shapes_mesh.torus(50, 20)
    vertices = np.concatenate([torus.vertices, [[9, 0, 0], [0, -8, np.nan], [0, 0, 7]]]).astype(np.float32)
    box = (tuple(np.nanmin(vertices, axis=0).tolist()), tuple(np.nanmax(vertices, axis=0).tolist()))
    assert measure(Surface(vertices, torus.triangles)).bounds == box


def test_an_empty_surface_measures_nothing():
    """No triangles are no error; there is no box, nothing open and nothing that could be closed."""
    measured = measure(shapes_mesh.empty())
    assert astuple(measured)[:8] == (0,) * 8
    assert (measured.area, measured.bounds) == (0, None)
    assert (measured.watertight, measured.manifold, measured.volume) == (None, None, None)


def test_triangles_without_an_edge_close_nothing():
    """A repeated corner takes part in nothing: two such triangles are not watertight either."""
    measured = measure(shapes_mesh.surface([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1], [2, 2, 2]]))
    assert (measured.triangles, measured.degenerate) == (2, 2)
    assert (measured.watertight, measured.manifold, measured.volume) == (None, None, None)


@pytest.mark.parametrize("kind", ["float32", "float64"])
def test_the_numbers_do_not_depend_on_the_number_of_threads(kind):
    """Sums are taken in one order, so that they agree to the last bit."""
    torus = shapes_mesh.torus(400, 100)
    surface = Surface((torus.vertices * 1.1).astype(kind), torus.triangles[: len(torus.triangles) - 7])
    assert measure(surface, 1) == measure(surface, 2) == measure(surface, 4)


@pytest.mark.parametrize("threads", [1, 3])
def test_the_order_of_vertices_and_triangles_changes_no_count(threads):
    """A large mesh is looked at window by window; shuffled, every window needs every triangle."""
    torus = shapes_mesh.torus(300, 120)
    rng = np.random.default_rng(0)
    order = rng.permutation(len(torus.vertices))
    triangles = np.argsort(order).astype(np.int32)[rng.permutation(torus.triangles)][100:]
    expected = measure(shapes_mesh.joined(torus, Surface(torus.vertices, torus.triangles[:7])), threads)
    assert (expected.components, expected.euler) == (2, 1)
    shuffled = measure(Surface(torus.vertices[order], triangles), threads)
    plain = count_slowly(Surface(torus.vertices[order], triangles))
    assert {name: getattr(shuffled, name) for name in plain} == plain


def test_an_index_out_of_range_is_refused():
    """Neither too large nor negative indices reach memory."""
    for index in (3, -1):
        with pytest.raises(ValueError, match="does not exist"):
            measure(shapes_mesh.surface(np.zeros((3, 3)), [[0, 1, index]]))
        with pytest.raises(ValueError, match="does not exist"):
            _kernels.stl_records(np.zeros((3, 3)), np.array([[0, 1, index]], np.int32))
