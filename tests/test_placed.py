"""Placing: into the world through any affine, always counter-clockwise seen from outside."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest
import shapes_mesh

from isocore import _kernels
from isocore.errors import FieldError
from isocore.measurements import measure
from isocore.surface import Surface, place_fresh
from isocore.volume import Volume


def orientations():
    """The 48 ways to lay three axes along three axes."""
    for order in permutations(range(3)):
        for signs in product((1, -1), repeat=3):
            affine = np.eye(4)
            affine[:3, :3] = np.eye(3)[list(order)] * np.array(signs)[:, None]
            yield affine


def name_of(affine):
    return "".join("xyz"[np.abs(row).argmax()] + ("+" if row.sum() > 0 else "-") for row in affine[:3, :3])


@pytest.mark.parametrize("affine", list(orientations()), ids=name_of)
def test_all_48_orientations_keep_the_outside_outside(affine):
    """Volume, triangle normals and vertex normals point outside in each of them."""
    affine[:3, :3] *= 2
    affine[:3, 3] = (10, -20, 30)
    sphere = shapes_mesh.sphere()
    placed = Surface(sphere.vertices, sphere.triangles, sphere.vertices.copy()).placed(affine, space="lps", unit="mm")
    measured = measure(placed)
    assert measured.volume == pytest.approx(8 * measure(sphere).volume, rel=1e-6)
    outwards = (placed.vertices - affine[:3, 3]) / 2
    assert np.allclose(placed.normals, outwards, atol=1e-6)
    turned = _kernels.triangle_normals(placed.vertices, placed.triangles)
    assert np.einsum("ij,ij->i", turned, outwards).min() > 0.9
    assert (placed.space, placed.unit, placed.vertices.dtype) == ("lps", "mm", np.float32)


def test_normals_stay_at_right_angles_in_a_sheared_world():
    """They go through the inverse transpose, so they still stand on the triangles."""
    affine = np.array([[2, 0.5, 0, 1], [0, 0.7, 0.3, 2], [0.1, 0, -3, 3], [0, 0, 0, 1]])
    plane = shapes_mesh.surface([[0, 0, 0], [1, 0, 0], [0, 1, 1]], [[0, 1, 2]])
    normals = _kernels.triangle_normals(plane.vertices, plane.triangles)
    placed = Surface(plane.vertices, plane.triangles, normals).placed(affine)
    expected = _kernels.triangle_normals(placed.vertices, placed.triangles)
    assert np.allclose(placed.normals, expected, atol=1e-6)


def test_placing_makes_a_new_surface_and_leaves_the_old_one():
    """A surface is a value."""
    cube = shapes_mesh.cube()
    before = cube.vertices.copy(), cube.triangles.copy()
    placed = cube.placed(np.diag([-1.0, 1, 1, 1]))
    assert np.array_equal(cube.vertices, before[0])
    assert np.array_equal(cube.triangles, before[1])
    assert not np.array_equal(placed.triangles, cube.triangles)
    assert (placed.space, placed.unit) == ("ras", "mm")
    assert not placed.vertices.flags.writeable


def test_fresh_arrays_are_placed_where_they_lie():
    """A surface that was just extracted costs no second copy."""
    cube = shapes_mesh.cube()
    vertices, triangles = cube.vertices.copy(), cube.triangles.copy()
    placed = place_fresh(vertices, triangles, None, np.diag([-1.0, 1, 1, 1]), space="ras", unit="mm")
    assert placed.vertices is vertices
    assert placed.triangles is triangles
    assert measure(placed).volume == 1


@pytest.mark.parametrize("steps", [(5e-324, 1e100, 1.0), (1e-310, 0.5, 2.0), (0.0, 1.0, 1.0)])
def test_axes_without_length_are_refused(steps: tuple[float, float, float]) -> None:
    """Also where a length is the smallest number there is, without a warning of Python's."""
    with pytest.raises(FieldError, match="the affine is singular"):
        turned = np.diag([*steps, 1.0])[[1, 0, 2, 3]]
        Volume(np.zeros((2, 2, 2), np.float32, order="F"), affine=turned)


@pytest.mark.parametrize("far", [1e101, -1e300, 1.7e308])
@pytest.mark.parametrize("place", [(0, 0), (1, 0), (2, 3)])
def test_places_beyond_all_reckoning_are_refused(far: float, place: tuple[int, int]) -> None:
    """A product of three lengths has to be a number; Python would warn of it, or the surface lie nowhere."""
    affine = np.eye(4)
    affine[place] = far
    with pytest.raises(FieldError, match="the affine is too large to reckon with: places lie beyond 1e"):
        Volume(np.zeros((2, 2, 2), np.float32, order="F"), affine=affine)


@pytest.mark.parametrize(
    ("spacing", "offset", "dtype"),
    [
        (1, 0, "float32"),
        (1, 9000, "float64"),
        (0.01, 10, "float32"),
        (0.01, 100, "float64"),
        (1e-30, 0, "float32"),
        (1, 1e39, "float64"),
    ],
)
def test_float64_is_taken_where_float32_would_move_a_vertex(spacing, offset, dtype):
    """No vertex of 200 voxels moves by more than 1e-3 voxel, and none falls on another."""
    rng = np.random.default_rng(0)
    points = rng.integers(0, 200, (3000, 3)).astype(np.float32)
    points[np.arange(3000), rng.integers(0, 3, 3000)] += 2**-10
    affine = np.diag([spacing, spacing, spacing, 1.0])
    affine[:3, 3] = offset
    placed = Surface(points, np.zeros((0, 3), np.int32)).placed(affine)
    exact = points.astype(np.float64) * spacing + offset
    assert placed.vertices.dtype == dtype
    assert np.linalg.norm(placed.vertices - exact, axis=1).max() <= max(1e-3 * spacing, np.spacing(offset))
    if offset < 1e30:
        assert len(np.unique(placed.vertices, axis=0)) == len(np.unique(points, axis=0))


def test_a_singular_affine_cannot_turn_normals():
    """The kernel refuses what has no inverse."""
    with pytest.raises(ValueError, match="singular"):
        _kernels.turn_normals(np.zeros((1, 3), np.float32), np.zeros((3, 4)))


def test_placing_an_empty_surface_gives_an_empty_surface():
    """Nothing to decide the type from."""
    assert len(shapes_mesh.empty().placed(np.diag([-1.0, 1, 1, 1])).vertices) == 0
