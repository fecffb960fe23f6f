"""Self-intersections, counted exactly: against brute force in rational numbers, and by hand."""

from __future__ import annotations

from pathlib import Path

import intersection_oracle
import numpy as np
import pytest
import shapes
import shapes_mesh
from click.testing import CliRunner
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore import _kernels
from isocore.api import extract
from isocore.measurements import measure
from isocore.requirements import missed
from isocore.surface import Surface


def count(places, triangles, threads=1):
    """Of vertices (v, 3) and triangles (t, 3), as lists or arrays."""
    vertices = np.ascontiguousarray(places, np.float64)
    return _kernels.self_intersections(vertices, np.ascontiguousarray(triangles, np.int32).reshape(-1, 3), threads)


def soup(kind, rng):
    """Vertices and triangles without any order; small whole numbers make every touch and overlap likely."""
    vertices = {
        "whole": lambda: rng.integers(0, 3, (11, 3)),
        "in one plane": lambda: np.hstack([rng.integers(0, 5, (11, 2)), np.ones((11, 1))]),
        "tenths far away": lambda: rng.integers(0, 4, (11, 3)) * 0.1 + 1e5,
        "turned": lambda: rng.integers(0, 4, (11, 3)) @ rng.random((3, 3)),
        "anywhere": lambda: rng.random((11, 3)),
        "tiny": lambda: rng.integers(0, 3, (11, 3)) * 1e-200,
        "huge": lambda: rng.integers(0, 3, (11, 3)) * 1e200 / 3,
    }[kind]()
    return vertices.astype(np.float64), rng.integers(0, 11, (9, 3)).astype(np.int32)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["whole", "in one plane", "tenths far away", "turned", "anywhere", "tiny", "huge"])
def test_the_count_is_that_of_exact_brute_force(kind, dtype):
    """Every pair of triangles, with every way to share corners, touch, cross, overlap and have no area."""
    rng = np.random.default_rng(len(kind))
    for _ in range(40):
        vertices, triangles = soup(kind, rng)
        if dtype is np.float32 and kind in ("tiny", "huge"):
            vertices = vertices * (1e170 if kind == "tiny" else 1e-170)
        vertices = np.ascontiguousarray(vertices, dtype)
        expected = intersection_oracle.count(vertices, triangles)
        assert [_kernels.self_intersections(vertices, triangles, threads) for threads in (1, 3)] == [expected] * 2


FLAT = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]


@pytest.mark.parametrize(
    ("other", "shared", "pairs"),
    [
        ([[1, 1, -1], [1, 1, 1], [2, 1, 1]], 0, 1),
        ([[1, 1, 0], [1, 1, 1], [2, 1, 1]], 0, 1),
        ([[4, 1, 0], [4, 1, 1], [5, 1, 1]], 0, 0),
        ([[0, 0, 0], [0, 0, 1], [1, 0, 1]], 0, 0),
        ([[1, 1, 0], [2, 1, 0], [1, 2, 0]], 0, 1),
        ([[4, 4, 0], [4, 1, 0], [1, 4, 0]], 0, 0),
        ([[2, 2, 0], [4, 4, 0], [4, 1, 0]], 0, 1),
        ([[-1, -1, 0], [-1, -2, 0], [-2, -1, 0]], 0, 0),
        ([[1, 2, 0], [2, 1, 0]], 1, 1),
        ([[-1, -2, 0], [-2, -1, 0]], 1, 0),
        ([[1, 1, -1], [1, 1, 1]], 1, 1),
        ([[1, 1, 1]], 2, 0),
        ([[1, 1, 0]], 2, 1),
        ([[1, -1, 0]], 2, 0),
        ([], 3, 1),
    ],
)
def test_two_triangles_meet_or_do_not(other, shared, pairs):
    """Crossing, touching, beside, within; with none, one, two or three corners in common, by number or by place."""
    by_number = [*range(shared), *range(3, 3 + len(other))]
    assert count([*FLAT, *other], [[0, 1, 2], by_number]) == pairs
    apart = [*FLAT, *FLAT[:shared], *other]
    assert count(apart, [[0, 1, 2], [3, 4, 5]]) == pairs


def test_triangles_without_area_and_corners_without_a_place_meet_nothing():
    """They are counted elsewhere."""
    needle = [[1, 1, -1], [1, 1, 1], [1, 1, 0]]
    assert count([*FLAT, *needle], [[0, 1, 2], [3, 4, 5]]) == 0
    assert count([*FLAT, [1, 1, -1], [1, 1, 1], [2, np.nan, 1]], [[0, 1, 2], [3, 4, 5]]) == 0
    crossing = [*FLAT, [1, 1, -1], [1, 1, 1], [2, 1, 1], [np.inf, 0, -np.inf], [np.nan] * 3]
    assert count(crossing, [[0, 1, 2], [3, 4, 5], [0, 1, 6], [6, 2, 7]]) == 1
    assert count(np.zeros((0, 3)), np.zeros((0, 3))) == 0


@pytest.mark.parametrize("name", ["cube", "sphere", "torus", "tetrahedron"])
def test_a_closed_body_does_not_meet_itself(name):
    """And two of them that overlap do, where their surfaces cross."""
    body = getattr(shapes_mesh, name)()
    assert measure(body).self_intersections == 0
    moved = body.vertices + np.float32(0.21)
    both = Surface(np.vstack([body.vertices, moved]), np.vstack([body.triangles, body.triangles + len(body.vertices)]))
    found = measure(both).self_intersections
    assert found and found == measure(both, 3).self_intersections
    if len(both.triangles) < 500:
        assert found == intersection_oracle.count(both.vertices, both.triangles)


def test_a_fan_that_goes_around_twice_is_no_tidy_one():
    """Ten triangles around one vertex, all turning one way, on two storeys that pass through each other."""
    angles = np.arange(10) * 4 * np.pi / 10 + 0.1
    ring = np.stack([np.cos(angles), np.sin(angles), 0.1 * np.cos(angles / 2)], axis=1)
    triangles = [[0, 1 + n, 1 + (n + 1) % 10] for n in range(10)]
    vertices = np.vstack([[[0, 0, 0]], ring])
    expected = intersection_oracle.count(vertices, np.array(triangles, np.int32))
    assert expected > 0 and count(vertices, triangles) == expected


def test_a_pinched_surface_is_counted_as_brute_force_does():
    """A corner pushed through the opposite wall: seen by the triangles that it crosses."""
    sphere = shapes_mesh.sphere()
    vertices = np.array(sphere.vertices)
    vertices[0] = -1.3 * vertices[0]
    found = count(vertices, sphere.triangles)
    assert found > 0 and found == intersection_oracle.count(vertices.astype(np.float64), sphere.triangles)


@pytest.mark.parametrize("backend", ["mc", "asc", "thinning"])
@pytest.mark.parametrize("levels", [2, 3, 5])
def test_what_the_methods_draw_of_noise_does_not_meet_itself(backend, levels):
    """Few different samples, the isovalue among them: vertices as near to each other as they come."""
    rng = np.random.default_rng(levels)
    for size in (4, 9):
        for _ in range(15):
            volume = shapes.volume_of(rng.integers(0, levels, (size, size, size)).astype(np.uint8))
            for isovalue in (0.5, 1.0):
                assert measure(extract(volume, isovalue, backend=backend)).self_intersections == 0


def test_simple_is_a_requirement(tmp_path: Path):
    """Met by a ball; missed by two that cross, by a surface nobody counted, and by none at all."""
    scan = write_nifti(tmp_path / "ball.nii", ball())
    arguments = [str(scan), "-i", "50", "-o", str(tmp_path / "a.ply"), "--require", "simple", "--no-self-intersections"]
    assert CliRunner().invoke(convert, arguments).exit_code == 0
    arguments[2] = "5000"
    assert CliRunner().invoke(convert, arguments).exit_code == 3
    flat = [*FLAT, [1, 1, -1], [1, 1, 1], [2, 1, 1]]
    crossing = Surface(np.array(flat, np.float32), np.array([[0, 1, 2], [3, 4, 5]], np.int32))
    assert missed(measure(crossing), ("simple",), None) == ("simple: 1 pairs of triangles meet",)
    uncounted = measure(crossing, self_intersections=False)
    assert uncounted.self_intersections is None and "not counted" in missed(uncounted, ("simple",), None)[0]
