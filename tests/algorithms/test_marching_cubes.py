"""Marching cubes beyond the contract of every backend: symmetries, exact to the last bit, and a slow oracle."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from shapes import integer_noise, volume_of

from isocore.backends import Options, prepare
from isocore.measurements import measure

Samples = npt.NDArray[np.int8]
shapes = st.tuples(*[st.integers(2, 5)] * 3)
volumes = arrays(np.int8, shapes, elements=st.sampled_from([-4, -2, 0, 2, 4]), fill=st.nothing())
#: Samples that differ by powers of two, so that crossings and their mirror images are exact.
exact_volumes = arrays(np.int8, shapes, elements=st.sampled_from([-5, -1, 3]), fill=st.nothing())


def vertices_of(samples: npt.ArrayLike, isovalue: float) -> npt.NDArray[np.float32]:
    return prepare(volume_of(samples), "mc", Options())(isovalue).surface.vertices


def as_rows(vertices: npt.NDArray[np.float32]) -> set[tuple[float, ...]]:
    return {tuple(row) for row in vertices.tolist()}


def crossings_by_definition(samples: Samples, isovalue: float) -> set[tuple[float, ...]]:
    """One vertex per grid edge whose ends differ in sign, found edge by edge."""
    found = set()
    for at in itertools.product(*(range(n) for n in samples.shape)):
        for axis in range(3):
            end = tuple(c + (a == axis) for a, c in enumerate(at))
            if end[axis] == samples.shape[axis] or (samples[at] >= isovalue) == (samples[end] >= isovalue):
                continue
            t = (isovalue - float(samples[at])) / (float(samples[end]) - float(samples[at]))
            t = min(max(t, 2**-10), 1 - 2**-10)
            found.add(tuple(float(np.float32(c + t * (a == axis))) for a, c in enumerate(at)))
    return found


@given(samples=volumes, isovalue=st.sampled_from([-3.0, -1.0, 0.0, 1.0, 2.0]))
@settings(max_examples=60, deadline=None)
def test_the_vertices_are_the_crossed_edges(samples: Samples, isovalue: float) -> None:
    """Against the definition, edge by edge."""
    found = vertices_of(samples, isovalue)
    assert as_rows(found) == crossings_by_definition(samples, isovalue)
    assert len(found) == len(as_rows(found))


@given(samples=volumes, order=st.permutations([0, 1, 2]))
@settings(max_examples=40, deadline=None)
def test_permuting_the_axes_permutes_the_vertices(samples: Samples, order: list[int]) -> None:
    """Marching cubes prefers no axis."""
    permuted = vertices_of(samples.transpose(order), 1.0)
    assert as_rows(permuted) == as_rows(vertices_of(samples, 1.0)[:, order])


@given(samples=exact_volumes, axis=st.integers(0, 2))
@settings(max_examples=40, deadline=None)
def test_mirroring_the_volume_mirrors_the_vertices(samples: Samples, axis: int) -> None:
    """Exact, because steps of the samples are powers of two."""
    mirrored = vertices_of(np.flip(samples, axis), 1.0)
    expected = vertices_of(samples, 1.0).copy()
    expected[:, axis] = samples.shape[axis] - 1 - expected[:, axis]
    assert as_rows(mirrored) == as_rows(expected)


@given(samples=volumes)
@settings(max_examples=60, deadline=None)
def test_negating_everything_turns_the_surface_inside_out(samples: Samples) -> None:
    """Between the samples' values there are no ties, so the crossings are the same and the volume changes sign."""
    plain = prepare(volume_of(samples), "mc", Options())(1.0).surface
    negated = prepare(volume_of(-samples), "mc", Options())(-1.0).surface
    assert as_rows(plain.vertices) == as_rows(negated.vertices)


def test_a_cap_adds_only_what_lies_outside() -> None:
    """Inside the volume the capped surface has the plain one's vertices; the others lie 2^-10 beyond the border."""
    samples = np.random.default_rng(2).integers(0, 5, (7, 8, 9)).astype(np.uint8)
    plain = as_rows(vertices_of(samples, 2))
    capped = prepare(volume_of(samples), "mc", Options(cap=True))(2).surface
    rows = as_rows(capped.vertices)
    assert plain <= rows
    last = np.array(samples.shape) - 1
    for row in rows - plain:
        outside = [c for c, end in zip(row, last, strict=True) if c < 0 or c > end]
        assert len(outside) == 1
        assert min(abs(outside[0]), *(abs(outside[0] - end) for end in last)) == 2**-10
    assert measure(capped).watertight


@pytest.mark.parametrize("length", [63, 64, 65, 127, 128, 129])
def test_rows_of_any_length_are_marched(length: int) -> None:
    """Around the word size nothing is lost and nothing doubled."""
    samples = np.random.default_rng(length).integers(0, 5, (length, 3, 4)).astype(np.int8)
    assert as_rows(vertices_of(samples, 2)) == crossings_by_definition(samples, 2)


def test_the_ambiguous_faces_are_counted() -> None:
    """A checkerboard cell has six; noise has many."""
    board = np.indices((2, 2, 2)).sum(axis=0) % 2
    facts = prepare(volume_of(board.astype(np.uint8)), "mc", Options())(0.5).facts
    assert facts["ambiguous"] == {"faces": 6, "cells": 1}
    assert prepare(integer_noise(10, 2), "mc", Options())(1).facts["ambiguous"]["cells"] > 100


def test_an_axis_longer_than_float32_can_tell_apart_gets_double_coordinates() -> None:
    """Two crossings 2^-9 apart at the far end of 20,000 samples stay two vertices."""
    samples = np.zeros((20_000, 2, 2), np.uint8)
    samples[19_990] = 1
    surface = prepare(volume_of(samples), "mc", Options())(1).surface
    assert surface.vertices.dtype == np.float64
    assert len(np.unique(surface.vertices, axis=0)) == len(surface.vertices) == 8
