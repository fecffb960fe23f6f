"""Vertex normals from samples and from triangles."""

from __future__ import annotations

import numpy as np
import pytest
import shapes_mesh

from isocore import _kernels
from isocore.volume import SAMPLE_TYPES


def ball(dtype="float64", size=17):
    """Samples that fall with the distance from the middle, and a sphere on them in index space."""
    middle = (size - 1) / 2
    i, j, k = np.indices((size, size, size)) - middle
    samples = np.asfortranarray((100 - (i * i + j * j + k * k) / 4).astype(dtype))
    unit = shapes_mesh.sphere()
    return samples, (unit.vertices * 5 + middle).astype(np.float32), unit


@pytest.mark.parametrize("dtype", SAMPLE_TYPES)
@pytest.mark.parametrize("below", [False, True])
def test_normals_point_towards_lower_values(dtype, below):
    """In every sample type; with a negative slope a high sample is a low value."""
    samples, vertices, unit = ball(dtype)
    normals = _kernels.gradient_normals(samples, vertices, unit.triangles, below)
    cosine = np.einsum("ij,ij->i", normals, unit.vertices) * (-1 if below else 1)
    assert cosine.min() > (0.9999 if dtype.startswith("float") else 0.97)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)


def test_a_linear_field_has_its_own_gradient_at_border_and_beside_holes():
    """One-sided differences are exact there; samples that are not finite are passed by."""
    i, j, k = np.indices((5, 6, 7)).astype(np.float64)
    samples = np.asfortranarray(i + 2 * j - 2 * k)
    samples[2, 3, 3] = np.nan
    samples[1, 1, 1] = np.inf
    rng = np.random.default_rng(1)
    places = rng.uniform(0, 1, (500, 3)) * (4, 5, 6)
    places[::2, 0] = rng.integers(0, 5, 250)
    normals = _kernels.gradient_normals(samples, places, np.zeros((0, 3), np.int32), False)
    assert np.allclose(normals, np.array([-1, -2, 2]) / 3, atol=1e-6)


def test_a_flat_field_and_a_cap_take_the_normals_of_triangles():
    """Where the gradient says nothing, and beside the grid."""
    sphere = shapes_mesh.sphere((5, 5, 5))
    flat = np.zeros((11, 11, 11), np.uint8, order="F")
    expected = _kernels.triangle_normals(sphere.vertices, sphere.triangles)
    assert np.array_equal(_kernels.gradient_normals(flat, sphere.vertices, sphere.triangles, False), expected)
    ramp = np.asfortranarray(np.indices((11, 11, 11))[0].astype(np.float32))
    beside = shapes_mesh.sphere((-3, 5, 5))
    expected = _kernels.triangle_normals(beside.vertices, beside.triangles)
    assert np.array_equal(_kernels.gradient_normals(ramp, beside.vertices, beside.triangles, False), expected)


def test_triangles_weigh_as_much_as_their_area():
    """Two walls and a ground twice as large as each of them meet at vertex 0."""
    places = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 1]]
    corner = shapes_mesh.surface(places, [[0, 2, 1], [0, 1, 3], [0, 3, 2]])
    normals = _kernels.triangle_normals(corner.vertices, corner.triangles)
    assert np.allclose(normals[0], np.array([-1, -1, -2]) / 6**0.5, atol=1e-6)


def test_a_vertex_without_triangles_still_has_a_unit_normal():
    """Any direction will do; zero would not."""
    assert _kernels.triangle_normals(np.zeros((1, 3)), np.zeros((0, 3), np.int32)).tolist() == [[0, 0, 1]]


@pytest.mark.parametrize("threads", [2, 4])
def test_normals_do_not_depend_on_the_number_of_threads(threads):
    """To the last bit."""
    samples, _, _ = ball()
    torus = shapes_mesh.torus(200, 60, 4, 2)
    places = torus.vertices + 8
    one = _kernels.gradient_normals(samples, places, torus.triangles, False, 1)
    assert np.array_equal(one, _kernels.gradient_normals(samples, places, torus.triangles, False, threads))
