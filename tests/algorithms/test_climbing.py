"""Adaptive skeleton climbing against marching cubes, on every kind of small volume, and against a slow oracle."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt
import pytest
from climbing_oracle import Oracle
from climbing_promises import compare
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from knot import knot_field
from shapes import SHARED

from isocore import _kernels
from isocore.volume import Volume

BLOCK_SIZES = (1, 2, 4, 8, 16, 32)

few_values = arrays(np.uint8, st.tuples(*[st.integers(2, 9)] * 3), elements=st.integers(0, 3), fill=st.nothing())


def knot(n: int, *, truncated: bool = True) -> npt.NDArray[np.generic]:
    """The knot of the paper's first figure."""
    value = knot_field(n)
    return np.asfortranarray(np.trunc(value).astype(np.uint8) if truncated else value.astype(np.float32))


@given(samples=few_values, size=st.sampled_from(BLOCK_SIZES), isovalue=st.sampled_from([0.5, 1.0, 2.0, 2.5]))
@settings(max_examples=120, deadline=None)
def test_topology_is_marching_cubes_on_any_small_volume(samples: np.ndarray, size: int, isovalue: float) -> None:
    """Euler number, components, open or closed, manifold, oriented, vertices to the bit, and threads, all agree."""
    assert compare(Volume(np.asfortranarray(samples)), isovalue, block_size=size) == []


@given(samples=few_values, size=st.sampled_from((2, 4, 8, 16)), isovalue=st.sampled_from([0.5, 1.0, 2.0]))
@settings(max_examples=60, deadline=None)
def test_capped_and_bounded_surfaces_keep_every_promise(samples: np.ndarray, size: int, isovalue: float) -> None:
    """The same with a closed border and an error bound, which holds."""
    volume = Volume(np.asfortranarray(samples))
    assert compare(volume, isovalue, block_size=size, capped=True, max_error=0.2) == []


def test_every_sign_pattern_of_one_cell_is_marching_cubes() -> None:
    """All 256 cells, at block sizes that see a cell and a ragged block."""
    for corners in range(256):
        samples = np.array([corners >> n & 1 for n in range(8)], np.uint8).reshape((2, 2, 2), order="F")
        for size in (1, 16):
            assert compare(Volume(np.asfortranarray(samples)), 0.5, block_size=size, threads=1) == []


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_every_pair_of_cells_across_a_face_is_closed(axis: int) -> None:
    """All 4,096 sign patterns of two cells, drawn in one volume of separate pairs, capped by a layer of outside."""
    cells = np.zeros([16 * (4 if a == axis else 3) for a in range(3)], np.uint8)
    for pattern, at in zip(range(4096), itertools.product(range(16), repeat=3), strict=True):
        shape = [3 if a == axis else 2 for a in range(3)]
        bits = np.array([pattern >> n & 1 for n in range(12)], np.uint8).reshape(shape)
        cells[tuple(slice(n * (s + 1), n * (s + 1) + s) for n, s in zip(at, shape, strict=True))] = bits
    assert compare(Volume(np.asfortranarray(cells)), 0.5, block_size=8, capped=True) == []


def test_two_crossed_stairs_that_hide_a_handle_are_split() -> None:
    """Simple ligns and disk corners, yet a handle between them: separate below, joined above, decided by saddles."""
    samples = np.zeros((2, 2, 4), np.float32)
    samples[0, 0, :] = samples[1, 1, :] = 1
    samples[1, 0, 0] = 1
    samples[1, 1, 3] = 0
    samples[0, 1, 1], samples[1, 0, 1] = -2, -2
    samples[0, 0, 2] = samples[1, 1, 2] = 5
    volume = Volume(np.asfortranarray(samples))
    assert compare(volume, 0.5, block_size=4, capped=True) == []


@given(samples=few_values, size=st.sampled_from((2, 4, 8)), isovalue=st.sampled_from([0.5, 1.0, 2.0]))
@settings(max_examples=60, deadline=None)
def test_boxes_and_vertices_are_those_of_the_slow_oracle(samples: np.ndarray, size: int, isovalue: float) -> None:
    """As many boxes, and the same crossed grid edges, as counting crossings one by one gives."""
    vertices, _, facts = _kernels.climb(np.asfortranarray(samples), isovalue, block_size=size)
    oracle = Oracle(samples >= isovalue, size)
    assert facts.highrices == len(oracle.boxes)
    axes = (vertices != np.floor(vertices)).argmax(axis=1)
    found = {(int(axis), *map(int, np.floor(place))) for axis, place in zip(axes, vertices, strict=True)}
    assert found == oracle.vertices()


@pytest.mark.parametrize(
    ("n", "size", "most"),
    [(64, 8, 1120), (64, 16, 1096), (128, 8, 2280), (128, 16, 1852), (256, 8, 6124), (256, 16, 4520)],
)
def test_the_knot_takes_no_more_triangles_than_the_prototype(n: int, size: int, most: int) -> None:
    """Counts may only fall."""
    _, triangles, _ = _kernels.climb(knot(n), 200, threads=2, block_size=size)
    assert len(triangles) <= most


@pytest.mark.parametrize(("error", "most"), [(0.1, 18_984), (0.2, 10_452), (0.4, 5_772)])
def test_the_bounded_knot_takes_no_more_triangles_than_the_prototype(error: float, most: int) -> None:
    """On the knot before rounding, whose steps would be errors of their own."""
    _, triangles, facts = _kernels.climb(knot(128, truncated=False), 199.5, threads=2, max_error=error)
    assert len(triangles) <= most
    assert facts.error_voxels.max <= error


@pytest.mark.parametrize(
    "shape", [(2, 2, 2), (2, 2, 40), (40, 2, 3), (33, 17, 2), (19, 18, 17), (65, 5, 5), (3, 70, 66)]
)
@pytest.mark.parametrize("size", BLOCK_SIZES)
def test_ragged_volumes_need_no_padding(shape: tuple[int, int, int], size: int) -> None:
    """Sizes that are no multiple of the block size, rows of several words, thin plates."""
    samples = np.random.default_rng(sum(shape)).integers(0, 3, shape).astype(np.int16)
    assert compare(Volume(np.asfortranarray(samples)), 1, block_size=size) == []


def test_single_voxels_plates_and_touching_voxels_are_manifold() -> None:
    """Voxels alone, in a plate, and touching at an edge or a corner."""
    samples = np.zeros((24, 12, 12), np.uint8)
    samples[2, 2, 2] = samples[5, 5, 5] = samples[6, 6, 5] = 1
    samples[9, 3, 3] = samples[10, 4, 4] = 1
    samples[13, 2:9, 2:9] = 1
    samples[16:20, 4:8, 4] = 1
    for size in BLOCK_SIZES:
        assert compare(Volume(np.asfortranarray(samples)), 0.5, block_size=size, max_error=0.3) == []


def test_a_block_may_hold_more_crossings_than_a_short_counts() -> None:
    """A chessboard beside a flat wall: 67,765 crossings in one block of the largest size."""
    samples = (np.indices((33, 33, 33)).sum(axis=0) % 2).astype(np.uint8)
    samples[21:28] = 0
    samples[28:] = 1
    assert compare(Volume(np.asfortranarray(samples)), 0.5, block_size=32, max_error=0.3) == []


@pytest.mark.parametrize("size", [0, 3, 64, -1])
def test_the_kernel_refuses_other_block_sizes(size: int) -> None:
    """Callers check first; the kernel checks all the same."""
    with pytest.raises(ValueError, match="block size"):
        _kernels.climb(np.zeros((4, 4, 4), np.uint8, order="F"), 0.5, block_size=size)


@pytest.mark.skipif(not (SHARED / "topology").exists(), reason="the real data is not here")
def test_known_grids_keep_marching_cubes_topology() -> None:
    """The first of 2,000 published 5^3 grids; all of them by climbing_trials.py."""
    grids = np.load(SHARED / "topology" / "random_5x5x5_shared_2000.npz")
    samples = next(grids[name] for name in grids.files if grids[name].ndim == 4)
    for grid in samples[:60]:
        assert compare(Volume(np.asfortranarray(grid.astype(np.float64))), 0.0, block_size=4) == []
