"""Thinning of volumes: the surface is that of marching cubes, vertex for vertex, in another order."""

from __future__ import annotations

import numpy as np
import pytest
import shapes
from mesh_oracles import triangle_set

from isocore.backends import Options, prepare
from isocore.volume import Volume


def assert_same_as_marching_cubes(volume: Volume, isovalue: float, *, cap: bool = False) -> None:
    thinned = prepare(volume, "thinning", Options(cap=cap))(isovalue).surface
    marched = prepare(volume, "mc", Options(cap=cap))(isovalue).surface
    assert thinned.vertices.dtype == marched.vertices.dtype
    assert len(thinned.vertices) == len(marched.vertices)
    assert triangle_set(thinned.vertices, thinned.triangles) == triangle_set(marched.vertices, marched.triangles)


@pytest.mark.parametrize("cap", [False, True], ids=["open", "capped"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "float32", "float64"])
@pytest.mark.parametrize("seed", range(6))
def test_noise_gives_the_triangles_of_marching_cubes(seed: int, dtype: str, cap: bool) -> None:
    """Few levels, the isovalue among them and between them, both signs of the slope."""
    random = np.random.default_rng(seed)
    samples = np.asfortranarray(random.integers(0, random.integers(3, 9), random.integers(2, 8, 3)).astype(dtype))
    for slope in (1.0, -2.0):
        volume = Volume(samples, slope=slope)
        for isovalue in (slope * 1, slope * 2.5):
            assert_same_as_marching_cubes(volume, isovalue, cap=cap)


def test_samples_that_are_not_finite_are_outside() -> None:
    """NaN and both infinities, strewn over noise."""
    random = np.random.default_rng(9)
    samples = random.random((7, 6, 5)).astype(np.float32)
    for outside in (np.nan, np.inf, -np.inf):
        samples[random.random(samples.shape) < 0.1] = outside
    for isovalue in (0.25, 0.5, 0.75):
        assert_same_as_marching_cubes(Volume(np.asfortranarray(samples)), isovalue)


def test_a_smooth_volume_leaves_a_thin_skeleton_that_finds_all() -> None:
    """A gyroid-like field: few cells of many, and the walk visits the intersected ones."""
    i, j, k = np.meshgrid(*[np.arange(32) / 5] * 3, indexing="ij")
    volume = Volume(np.asfortranarray(np.sin(i) * np.cos(j) + np.sin(j) * np.cos(k) + np.sin(k) * np.cos(i)))
    search = prepare(volume, "thinning", Options())(0.2).facts["search"]
    assert search["skeleton"] < 0.05 * search["cells"]
    assert search["visited"] == search["intersected"] > 0
    assert_same_as_marching_cubes(volume, 0.2)


def test_threads_do_not_change_a_byte() -> None:
    """One, two and four threads give the same arrays."""
    extracted = [prepare(shapes.sphere().volume, "thinning", Options(threads=n))(0.0).surface for n in (1, 2, 4)]
    for surface in extracted[1:]:
        assert surface.vertices.tobytes() == extracted[0].vertices.tobytes()
        assert surface.triangles.tobytes() == extracted[0].triangles.tobytes()
