"""Lowest and highest sample of every block: what lets a further isovalue read only the blocks that it crosses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isocore import Volume, _kernels
from isocore.backends import Options, Outlook, prepare
from isocore.volume import SAMPLE_TYPES


def ball(shape: tuple[int, int, int], dtype: np.dtype) -> np.ndarray:
    """Distances from a corner, so that many blocks lie wholly on one side."""
    i, j, k = np.ogrid[: shape[0], : shape[1], : shape[2]]
    return np.asfortranarray(np.minimum(np.sqrt(i * i + j * j + k * k), 120).astype(dtype))


def same(samples: np.ndarray, isovalue: float, **options: object) -> bool:
    """Does climbing with ranges give the bytes that it gives without?"""
    ranges = _kernels.sample_ranges(samples, 2)
    with_ranges = _kernels.climb(samples, isovalue, **options, ranges=ranges)
    without = _kernels.climb(samples, isovalue, **options)
    return all(a.tobytes() == b.tobytes() for a, b in zip(with_ranges[:2], without[:2], strict=True))


@pytest.mark.parametrize("dtype", SAMPLE_TYPES, ids=str)
@pytest.mark.parametrize("shape", [(130, 20, 33), (64, 16, 16), (65, 17, 2), (2, 40, 18)])
def test_surfaces_are_the_same_with_ranges(dtype: np.dtype, shape: tuple[int, int, int]) -> None:
    """Every sample type, ragged blocks, both sides inside, open and capped."""
    samples = ball(shape, np.dtype(dtype))
    for isovalue in (0, 0.5, 16, 30.5, 64, 119, 120, 121):
        for below, capped in ((False, False), (True, True)):
            assert same(samples, isovalue, below=below, capped=capped)


@given(
    seed=st.integers(0, 2**32 - 1),
    odd=st.sampled_from([np.nan, np.inf, -np.inf]),
    isovalue=st.sampled_from([-1.0, 0.0, 1.0]),
)
@settings(max_examples=40, deadline=None)
def test_samples_that_are_not_finite_are_outside_with_ranges_too(seed: int, odd: float, isovalue: float) -> None:
    """A block of one side with a NaN or an infinity in it is no block of one side."""
    random = np.random.default_rng(seed)
    blocks = random.integers(-2, 3, (2, 3, 2)).astype(np.float32)
    samples = np.asfortranarray(blocks.repeat(64, axis=0).repeat(16, axis=1))
    samples[tuple(random.integers(0, samples.shape))] = odd
    for below in (False, True):
        assert same(samples, isovalue, below=below)


def test_blocks_that_an_isovalue_does_not_cross_are_not_read() -> None:
    """Samples far from the surface may change once their ranges are known, and nobody notices."""
    samples = np.asfortranarray(np.broadcast_to(np.arange(192, dtype=np.int16)[:, None, None], (192, 16, 16)))
    ranges = _kernels.sample_ranges(samples)
    assert ranges.tolist() == [0, 63, 64, 127, 128, 191]
    before = _kernels.climb(samples, 96.5, ranges=ranges)
    samples[:60] = 500
    samples[132:] = -500
    after = _kernels.climb(samples, 96.5, ranges=ranges)
    assert before[0].tobytes() == after[0].tobytes()
    assert len(_kernels.climb(samples, 96.5)[1]) > len(before[1])


def test_ranges_of_another_volume_are_refused() -> None:
    """They would tell lies about this one."""
    with pytest.raises(ValueError, match="another volume"):
        _kernels.climb(ball((20, 20, 20), np.dtype(np.uint8)), 8, ranges=np.zeros(6, np.uint8))


def test_a_run_of_several_isovalues_gives_what_single_runs_give() -> None:
    """`prepare` looks the ranges up only where several isovalues are to come."""
    volume = Volume(ball((80, 40, 40), np.dtype(np.float32)))
    several = prepare(volume, "asc", Options(), Outlook(isovalues=3))
    single = prepare(volume, "asc", Options(), Outlook(isovalues=1))
    for isovalue in (10.0, 20.0, 35.0):
        assert several(isovalue).surface.vertices.tobytes() == single(isovalue).surface.vertices.tobytes()
