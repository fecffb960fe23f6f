"""Simplification's promises, each told by brute force on small volumes: tests/simplification_oracle.py."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from shapes import padded_shapes
from simplification_oracle import broken_promises, meeting_pairs

from isocore import _kernels

Samples = npt.NDArray[Any]


@dataclass(frozen=True)
class Case:
    """A small volume, and what is asked of climbing and simplification."""

    samples: Samples
    isovalue: float
    capped: bool
    bound: float
    block_size: int  # 0: marching cubes' mesh is simplified, not climbing's

    @staticmethod
    def random(seed: int) -> Case:
        rng = np.random.default_rng(seed)
        shape = tuple(rng.integers(3, 7, 3))
        kind = seed % 5
        isovalue = 0.0
        if kind == 0:
            samples, isovalue = rng.integers(0, 3, shape).astype(np.uint8), (0.5, 1.0, 1.5)[rng.integers(3)]
        elif kind == 1:
            samples = rng.normal(size=shape).astype(np.float32)
        elif kind == 2:
            samples, isovalue = (rng.random(shape) < 0.5).astype(np.uint8), 0.5
        elif kind == 3:
            samples = _blurred(rng.normal(size=shape))
        else:
            samples, isovalue = _ellipsoid(rng, shape), -float(rng.uniform(1, 9))
        bound = (0.1, 0.25, 0.5, 1.0, 2.0)[rng.integers(5)]
        return Case(np.asfortranarray(samples), isovalue, bool(rng.integers(2)), bound, (0, 4, 16)[rng.integers(3)])

    def marched(self) -> Any:
        return _kernels.marching_cubes(self.samples, self.isovalue, False, self.capped)

    def coarse(self) -> Any:
        """What is simplified."""
        if self.block_size == 0:
            return self.marched()
        asked = (self.samples, self.isovalue, False, self.capped, 1, self.block_size, self.bound)
        return _kernels.climb(*asked, tilted=True)

    def simplified(self, threads: int = 1) -> Any:
        coarse, marched = self.coarse(), self.marched()
        return _kernels.simplify(
            coarse.vertices, coarse.triangles, marched.vertices, marched.triangles, self.bound, threads=threads
        )


def _blurred(samples: Samples) -> Samples:
    for axis in range(3):
        samples = samples + np.roll(samples, 1, axis) + np.roll(samples, -1, axis)
    return samples.astype(np.float32)


def _ellipsoid(rng: np.random.Generator, shape: tuple[int, ...]) -> Samples:
    at = [axis - rng.uniform(0, n - 1) for axis, n in zip(np.indices(shape), shape, strict=True)]
    noise = rng.normal(size=shape) * rng.uniform(0, 1)
    return (noise - sum(rng.uniform(0.3, 2) * axis**2 for axis in at)).astype(np.float32)


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_every_promise_holds_on_small_volumes(first: int) -> None:
    """Topology, both bounds, vertices, and no two triangles that meet, whatever comes in."""
    collapses = 0
    for seed in range(first, first + 20):
        case = Case.random(seed)
        found, marched = case.simplified(), case.marched()
        assert not broken_promises(found[:2], marched[:2], case.bound), f"seed {seed}"
        assert found.unproved == 0, f"seed {seed}"
        collapses += found.collapses
    assert collapses > 20


@pytest.mark.parametrize("shape", padded_shapes(), ids=lambda shape: shape.name)
def test_the_count_of_triangles_follows_from_the_collapses(shape: Any) -> None:
    """Each takes two triangles and a vertex; every promise holds on larger shapes too, and for two threads."""
    marched = _kernels.marching_cubes(shape.volume.samples, shape.isovalue)
    arrays = (marched.vertices, marched.triangles, marched.vertices, marched.triangles, 0.5)
    found, again = _kernels.simplify(*arrays), _kernels.simplify(*arrays, threads=2)
    assert len(found.triangles) == len(marched.triangles) - 2 * found.collapses
    assert len(found.vertices) == len(marched.vertices) - found.collapses
    assert len(found.triangles) < len(marched.triangles) / 3
    assert [array.tobytes() for array in found[:2]] == [array.tobytes() for array in again[:2]]
    assert found.error[0] <= 0.5


def sheets(distance: float) -> Samples:
    """Two flat sheets with so much between them, in the middle of a slab."""
    height = np.indices((14, 14, 9))[2].astype(np.float32)
    tilt = 0.03 * np.sin(np.indices((14, 14, 9))[0])
    return np.asfortranarray((distance / 2 - np.abs(height - 4.1 + tilt)).astype(np.float32))


@pytest.mark.parametrize("distance", [0.3, 0.5, 0.9])
def test_two_sheets_closer_than_the_bound_never_meet(distance: float) -> None:
    """Each could take the other's place within the bound; that they stay apart is a rule of its own."""
    samples = sheets(distance)
    marched = _kernels.marching_cubes(samples, 0.0)
    found = _kernels.simplify(marched.vertices, marched.triangles, marched.vertices, marched.triangles, 0.5)
    assert found.collapses > 100
    assert not broken_promises(found[:2], marched[:2], 0.5)


def test_a_tube_of_one_voxel_stays_a_tube() -> None:
    """It is thinner than the bound, so that only the link condition keeps it open."""
    samples = np.zeros((7, 7, 12), np.float32, order="F")
    samples[2:5, 2:5, 1:11] = 1
    samples[3, 3, :] = 0
    marched = _kernels.marching_cubes(samples, 0.5)
    found = _kernels.simplify(marched.vertices, marched.triangles, marched.vertices, marched.triangles, 3.0)
    assert found.collapses > 100
    assert not broken_promises(found[:2], marched[:2], 3.0)


def test_a_bound_of_zero_costs_nothing() -> None:
    """Only flat places lose triangles, and no reference vertex is left behind."""
    samples = np.zeros((9, 9, 9), np.uint8, order="F")
    samples[2:7, 2:7, 2:7] = 1
    marched = _kernels.marching_cubes(samples, 0.5)
    found = _kernels.simplify(marched.vertices, marched.triangles, marched.vertices, marched.triangles, 0.0)
    assert found.error[0] <= 1e-6
    assert not broken_promises(found[:2], marched[:2], 1e-6)


def test_stretched_axes_stretch_the_bound() -> None:
    """A bound in the world holds in the world, where a cell is not a cube."""
    rng = np.random.default_rng(5)
    samples = np.asfortranarray(_blurred(rng.normal(size=(9, 9, 9))))
    stretch = (1.0, 0.25, 0.5)
    marched = _kernels.marching_cubes(samples, 0.0)
    found = _kernels.simplify(
        marched.vertices, marched.triangles, marched.vertices, marched.triangles, 0.2, stretch=stretch
    )
    assert found.collapses > 20
    assert not broken_promises(found[:2], marched[:2], 0.2, stretch=stretch)


def test_the_oracle_sees_triangles_that_meet() -> None:
    """Crossing, touching, folded and overlapping ones; not those that only share a side or a corner."""
    flat = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    others = [[1, 1, -1], [1, 1, 1], [2, 1, 1], [1, 1, 0], [5, 5, 0], [3, -1, 0]]
    places = np.array([*flat, *others], np.float32)

    def meet(one: tuple[int, int, int], other: tuple[int, int, int]) -> bool:
        return bool(meeting_pairs(places, np.array([one, other], np.int32)))

    base = (0, 1, 2)
    assert meet(base, (3, 4, 5))
    assert meet(base, (6, 4, 5))
    assert meet(base, (0, 1, 6))
    assert meet(base, (0, 6, 4))
    assert meet(base, (7, 8, 6))
    assert not meet(base, (1, 0, 8))
    assert not meet(base, (1, 0, 4))
    assert not meet(base, (1, 4, 7))


def test_numbers_of_vertices_that_are_not_there_are_refused() -> None:
    """Rather than read elsewhere in memory."""
    vertices = np.zeros((2, 3), np.float32)
    triangles = np.array([[0, 1, 2]], np.int32)
    with pytest.raises(ValueError, match="does not exist"):
        _kernels.simplify(vertices, triangles, vertices, triangles, 0.5)
