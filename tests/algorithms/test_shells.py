"""Shells and how they nest, by slow oracles: a walk over triangles, and winding numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isocore import _kernels

Mesh = tuple[npt.NDArray[Any], npt.NDArray[np.int32]]
masks = st.tuples(*[st.integers(3, 7)] * 3).flatmap(
    lambda shape: st.integers(1, 9).flatmap(
        lambda tenths: arrays(np.uint8, shape, elements=st.integers(0, 9), fill=st.nothing()).map(
            lambda samples: (samples < tenths).astype(np.uint8)
        )
    )
)
label_maps = arrays(np.uint8, st.tuples(*[st.integers(3, 6)] * 3), elements=st.integers(0, 3), fill=st.nothing())


def walked(mesh: Mesh) -> npt.NDArray[np.int32]:
    """The shell of each vertex, -1 for none, by spreading from vertex to vertex over triangles."""
    vertices, triangles = mesh
    beside: dict[int, set[int]] = {}
    for a, b, c in triangles.tolist():
        for one in (a, b, c):
            beside.setdefault(one, set()).update((a, b, c))
    found, number = np.full(len(vertices), -1, np.int32), -1
    for start in sorted(beside):
        if found[start] >= 0:
            continue
        number += 1
        ready = [start]
        while ready:
            at = ready.pop()
            if found[at] < 0:
                found[at] = number
                ready += beside[at]
    return found


def winding(mesh: Mesh, triangles: npt.NDArray[np.int32], points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """How often a closed shell goes around each point: the sum of its triangles' solid angles."""
    corners = mesh[0].astype(np.float64)[triangles]
    a, b, c = (corners[None, :, n] - points[:, None] for n in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    above = (a * np.cross(b, c)).sum(2)
    below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return np.asarray(2 * np.arctan2(above, below).sum(1) / (4 * np.pi))


def volume_of(mesh: Mesh, triangles: npt.NDArray[np.int32]) -> float:
    a, b, c = mesh[0].astype(np.float64)[triangles].transpose(1, 0, 2)
    return float((a * np.cross(b, c)).sum() / 6)


def assert_nests(mesh: Mesh) -> int:
    """Compares with the oracles; returns the number of bubbles."""
    found = _kernels.shells(*mesh)
    of_vertex = walked(mesh)
    np.testing.assert_array_equal(found.of_vertex, of_vertex)
    number = len(found.areas)
    parts = [mesh[1][of_vertex[mesh[1][:, 0]] == n] for n in range(number)]
    volumes = [volume_of(mesh, part) for part in parts]
    np.testing.assert_allclose(found.volumes, volumes, atol=1e-9)
    assert found.triangles.tolist() == [len(part) for part in parts]
    assert found.closed.all()
    bubbles = 0
    for inner in range(number):
        points = mesh[0][of_vertex == inner].astype(np.float64)
        around = []
        for outer in set(range(number)) - {inner}:
            touching = (points[:, None] == mesh[0][of_vertex == outer][None]).all(2).any(1)
            numbers = winding(mesh, parts[outer], points[~touching])
            np.testing.assert_allclose(numbers, np.full(len(numbers), round(float(numbers[0]))), atol=1e-5)
            if round(float(numbers[0])) and (volumes[outer] < 0) != (volumes[inner] < 0):
                around.append((abs(volumes[outer]), outer))
        parent = min(around)[1] if around else -1
        is_bubble = volumes[inner] < 0 and parent >= 0
        assert found.around[inner] == parent
        assert found.piece[inner] == (parent if is_bubble else inner)
        bubbles += is_bubble
    return bubbles


def marched(samples: npt.NDArray[Any], isovalue: float = 0.5, *, cap: bool = True) -> Mesh:
    found = _kernels.marching_cubes(np.asfortranarray(samples), isovalue, False, cap)
    return found.vertices, found.triangles


@given(samples=masks)
@settings(max_examples=80, deadline=None)
def test_shells_of_masks_nest_as_winding_numbers_say(samples: npt.NDArray[np.uint8]) -> None:
    """Every vertex lies on the lines of others: all of them share coordinates."""
    assert_nests(marched(samples))


@given(samples=masks, turn=st.sampled_from([(0, 1, 2), (2, 1, 0), (1, 2, 0)]))
@settings(max_examples=40, deadline=None)
def test_shells_that_lie_askew_nest_as_well(samples: npt.NDArray[np.uint8], turn: tuple[int, int, int]) -> None:
    """Turned and sheared, inside out where that mirrors."""
    vertices, triangles = marched(samples)
    shear = np.eye(3)[list(turn)] @ np.array([[1, 0.25, 0], [0, 0.75, 0.5], [0, 0, 3]])
    placed = np.ascontiguousarray(vertices.astype(np.float64) @ shear + [1e4, -50, 7])
    if np.linalg.det(shear) > 0:
        assert_nests((placed, triangles))
    else:
        assert_nests((placed, np.ascontiguousarray(triangles[:, ::-1])))


@given(labels=label_maps)
@settings(max_examples=60, deadline=None)
def test_solids_of_a_label_that_touch_in_a_vertex_are_apart(labels: npt.NDArray[np.uint8]) -> None:
    """In a cell's middle two shells may have a vertex each at the same place."""
    values = np.arange(4, dtype=np.float64)
    surfaces = _kernels.label_surfaces(np.asfortranarray(labels), values, values.astype(np.uint32), 1)
    for label in set(np.unique(labels).tolist()) - {0}:
        solid = surfaces.solid(label)
        assert_nests((solid.vertices, solid.triangles))


def test_a_nest_of_five_shells() -> None:
    """A ball in a shell in a shell: solid, bubble, solid, bubble, solid."""
    distance = np.abs(np.mgrid[-6:7, -6:7, -6:7]).max(0)
    mesh = marched(np.isin(distance, [0, 1, 3, 5]).astype(np.uint8))
    assert assert_nests(mesh) == 2
    found = _kernels.shells(*mesh)
    assert found.around.tolist() == [-1, 0, 1, 2, 3]
    assert found.piece.tolist() == [0, 0, 2, 2, 4]


@pytest.mark.parametrize("threads", [2, 5])
def test_threads_change_nothing(threads: int) -> None:
    """Over more blocks of triangles than one."""
    mesh = marched(np.random.default_rng(1).integers(0, 2, (40, 40, 40)).astype(np.uint8))
    for one, more in zip(_kernels.shells(*mesh, 1), _kernels.shells(*mesh, threads), strict=True):
        assert one.tobytes() == more.tobytes()


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("flip", [1, -1])
def test_a_bubble_of_an_open_solid_belongs_to_it(axis: int, flip: int) -> None:
    """The solid ends at the volume's border in all directions but one."""
    samples = np.ones((9, 9, 9), np.uint8)
    samples[2, 2, 2] = 0  # the bubble
    samples[7] = samples[8] = 0
    samples = np.moveaxis(samples[::flip], 0, axis)
    found = _kernels.shells(*marched(samples, cap=False))
    bubble = int(np.flatnonzero(found.closed)[0])
    assert len(found.piece) == 2 and found.volumes[bubble] < 0
    assert found.piece.tolist() == [1 - bubble] * 2


def test_what_is_left_out_of_a_field_that_fills_the_border_is_a_piece() -> None:
    """Inward shells without anything around them."""
    samples = np.ones((9, 9, 9), np.uint8)
    samples[2, 2, 2] = samples[6, 6, 6] = 0
    found = _kernels.shells(*marched(samples, cap=False))
    assert (found.volumes < 0).all() and found.piece.tolist() == [0, 1]


def test_no_triangles_are_no_shells() -> None:
    """A vertex that nothing uses has no shell."""
    found = _kernels.shells(np.zeros((2, 3), np.float32), np.empty((0, 3), np.int32))
    assert found.of_vertex.tolist() == [-1, -1] and len(found.piece) == 0


def test_a_vertex_that_is_not_there_is_refused() -> None:
    """Before anything is looked up."""
    with pytest.raises(ValueError, match="names a vertex that does not exist"):
        _kernels.shells(np.zeros((2, 3), np.float32), np.array([[0, 1, 2]], np.int32))
