"""What every volume backend in the table promises, whatever its method."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from shapes import Shape, integer_noise, padded_shapes, sphere, volume_of

from isocore.backends import BACKENDS, Options, prepare
from isocore.measurements import measure
from isocore.surface import Surface
from isocore.volume import Volume

VOLUME_BACKENDS = [name for name, backend in BACKENDS.items() if Volume in backend.accepts]
each_backend = pytest.mark.parametrize("backend", VOLUME_BACKENDS)
each_shape = pytest.mark.parametrize("shape", padded_shapes(), ids=lambda shape: shape.name)

small_volumes = arrays(np.int8, st.tuples(*[st.integers(2, 6)] * 3), elements=st.integers(-1, 1), fill=st.nothing())


def surface_of(volume: Volume, isovalue: float, backend: str, **options: object) -> Surface:
    return prepare(volume, backend, Options(**options))(isovalue).surface  # type: ignore[arg-type]  # options by name


@each_backend
@each_shape
def test_a_padded_shape_is_closed_manifold_and_oriented(backend: str, shape: Shape) -> None:
    """Every directed edge occurs once, and so does its reverse; vertex links are single cycles."""
    measured = measure(surface_of(shape.volume, shape.isovalue, backend))
    assert measured.boundary_edges == 0
    assert measured.nonmanifold_edges == 0
    assert measured.nonmanifold_vertices == 0
    assert measured.misoriented_edges == 0
    assert measured.degenerate == 0


@each_backend
@each_shape
def test_topology_is_exact(backend: str, shape: Shape) -> None:
    """Euler number and components are those of the shape."""
    measured = measure(surface_of(shape.volume, shape.isovalue, backend))
    assert (measured.euler, measured.components) == (shape.euler, shape.components)


@each_backend
@each_shape
def test_area_and_volume_are_near_the_truth(backend: str, shape: Shape) -> None:
    """Within the error of a polyhedron at this spacing; positive volume means outward triangles."""
    fine = {"max_error": "0.1"} if "max_error" in BACKENDS[backend].options else {}
    measured = measure(surface_of(shape.volume, shape.isovalue, backend, **fine))
    assert shape.area is not None and shape.enclosed is not None
    assert measured.volume is not None
    assert measured.area == pytest.approx(shape.area, rel=0.08)
    assert measured.volume == pytest.approx(shape.enclosed, rel=0.08)


def test_the_area_error_of_marching_cubes_shrinks_with_the_spacing() -> None:
    """Half the spacing, about a quarter of the error, and a sphere's area comes out too small."""
    errors = []
    for n in (16, 31, 61):
        shape = sphere(n)
        assert shape.area is not None
        errors.append(shape.area - measure(surface_of(shape.volume, 0.0, "mc")).area)
    assert errors[0] > 2.5 * errors[1] > 6 * errors[2] > 0


@each_backend
@given(samples=small_volumes, isovalue=st.sampled_from([-0.5, 0.0, 0.5, 1.0]))
@settings(max_examples=150, deadline=None)
def test_any_small_integer_volume_is_closed_when_capped(backend: str, samples: np.ndarray, isovalue: float) -> None:
    """Values tie with the isovalue all the time; still no open, no fourfold edge, no triangle without area."""
    measured = measure(surface_of(volume_of(samples), isovalue, backend, cap=True))
    assert measured.boundary_edges == 0
    assert measured.nonmanifold_edges == 0
    assert measured.nonmanifold_vertices == 0
    assert measured.misoriented_edges == 0


@each_backend
@pytest.mark.parametrize("isovalue", [1, 4, 7])
def test_integer_noise_stays_closed_after_welding_by_position(backend: str, isovalue: int) -> None:
    """As an STL reader would weld it: vertices of equal float32 position become one, and nothing opens or doubles."""
    surface = surface_of(integer_noise(24, 8), isovalue, backend, cap=True)
    _, welded = np.unique(surface.vertices.astype(np.float32), axis=0, return_inverse=True)
    assert welded.max() + 1 == len(surface.vertices)
    measured = measure(surface)
    assert measured.watertight
    assert measured.nonmanifold_edges == 0


@each_backend
@pytest.mark.parametrize("threads", [2, 4])
def test_threads_change_nothing(backend: str, threads: int) -> None:
    """The same bytes from one thread and from several."""
    volume = integer_noise(40, 5, seed=3)
    one, several = (surface_of(volume, 2, backend, threads=n) for n in (1, threads))
    assert one.vertices.tobytes() == several.vertices.tobytes()
    assert one.triangles.tobytes() == several.triangles.tobytes()


@each_backend
def test_no_vertex_is_unused(backend: str) -> None:
    """Every vertex belongs to a triangle, unless it lies on the border's own edges, where no cell is."""
    surface = surface_of(integer_noise(12, 4), 2, backend, cap=True)
    assert len(np.unique(surface.triangles)) == len(surface.vertices)


@each_backend
def test_every_vertex_lies_on_a_crossed_grid_edge(backend: str) -> None:
    """One coordinate is between two samples of different sign, the others are whole."""
    volume = integer_noise(14, 5, seed=9)
    at = surface_of(volume, 2, backend).vertices.astype(np.float64)
    low, high = np.floor(at).astype(int), np.ceil(at).astype(int)
    assert ((low != high).sum(axis=1) == 1).all()
    inside = np.asarray(volume.samples) >= 2
    assert (inside[tuple(low.T)] != inside[tuple(high.T)]).all()


@each_backend
def test_a_negative_slope_turns_the_same_surface_the_same_way(backend: str) -> None:
    """Stored values -s with slope -1 are the values s: same vertices, same triangles."""
    samples = np.random.default_rng(5).integers(-8, 8, (10, 11, 12)).astype(np.int16)
    plain = surface_of(volume_of(samples), 0, backend, cap=True)
    negated = surface_of(volume_of(-samples, slope=-1.0), 0, backend, cap=True)
    assert plain.triangles.tobytes() == negated.triangles.tobytes()
    assert plain.vertices.tobytes() == negated.vertices.tobytes()


@each_backend
def test_slope_and_intercept_move_the_isovalue(backend: str) -> None:
    """The surface of scaled samples at a scaled isovalue is the surface of the samples."""
    samples = np.random.default_rng(6).integers(0, 9, (10, 9, 8)).astype(np.uint16)
    plain = surface_of(volume_of(samples), 4, backend)
    scaled = surface_of(volume_of(samples, slope=2.008, intercept=-3.25), 2.008 * 4 - 3.25, backend)
    assert plain.triangles.tobytes() == scaled.triangles.tobytes()


@each_backend
@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"])
def test_every_sample_type_gives_the_same_surface(backend: str, dtype: str) -> None:
    """Equal values, equal surface, to the last bit."""
    samples = np.random.default_rng(7).integers(0, 100, (9, 10, 11))
    expected = surface_of(volume_of(samples.astype(np.int32)), 50, backend)
    surface = surface_of(volume_of(samples.astype(dtype)), 50, backend)
    assert surface.vertices.tobytes() == expected.vertices.tobytes()
    assert surface.triangles.tobytes() == expected.triangles.tobytes()


@each_backend
def test_samples_that_are_not_finite_are_outside(backend: str) -> None:
    """NaN and both infinities behave like a hole in the body, and the surface stays closed."""
    samples = np.ones((8, 8, 8), np.float32)
    samples[2, 2, 2], samples[5, 5, 5], samples[2, 5, 2] = np.nan, np.inf, -np.inf
    measured = measure(surface_of(volume_of(samples), 0.5, backend, cap=True))
    assert measured.watertight
    assert measured.components == 4


@each_backend
@pytest.mark.parametrize("isovalue", [-1.0, 300.0])
def test_an_isovalue_out_of_range_gives_an_empty_surface(backend: str, isovalue: float) -> None:
    """Nothing is crossed, nothing is drawn, nothing fails."""
    surface = surface_of(integer_noise(6, 3), isovalue, backend)
    assert surface.vertices.shape == (0, 3)
    assert surface.triangles.shape == (0, 3)
