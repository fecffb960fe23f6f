"""Label maps: every label closed, all of them sharing their borders, by slow oracles on small volumes."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from isocore import _kernels

Labels = npt.NDArray[np.uint8]
shapes = st.tuples(*[st.integers(1, 5)] * 3)
label_maps = st.integers(2, 6).flatmap(
    lambda labels: arrays(np.uint8, shapes, elements=st.integers(0, labels - 1), fill=st.nothing())
)


def surfaces_of(labels: npt.NDArray[Any], threads: int = 1) -> _kernels.LabelSurfaces:
    values = np.arange(256, dtype=np.float64)
    return _kernels.label_surfaces(np.asfortranarray(labels), values, values.astype(np.uint32), threads)


def solids_of(labels: Labels, surfaces: _kernels.LabelSurfaces) -> dict[int, _kernels.LabelSolid]:
    return {int(label): surfaces.solid(int(label)) for label in np.unique(labels) if label}


def winding_numbers(solid: _kernels.LabelSolid, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """How often a closed surface goes around each point: the sum of its triangles' solid angles."""
    corners = solid.vertices.astype(np.float64)[solid.triangles]
    a, b, c = (corners[None, :, n] - points[:, None] for n in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    above = (a * np.cross(b, c)).sum(2)
    below = la * lb * lc + (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    return 2 * np.arctan2(above, below).sum(1) / (4 * np.pi)


def crossing_pairs(vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32]) -> int:
    """Pairs of triangles without a common vertex of which a side of one passes through the other, by their signs."""
    corners = vertices.astype(np.float64)[triangles]

    def volumes(a: Any, b: Any, c: Any, d: Any) -> npt.NDArray[np.float64]:
        return np.asarray(((b - a) * np.cross(c - a, d - a)).sum(-1))

    apart = (triangles[:, None, :, None] != triangles[None, :, None, :]).all((2, 3))
    t = corners[None, :]
    found = np.zeros(apart.shape, bool)
    for n in range(3):
        p, q = corners[:, None, n], corners[:, None, (n + 1) % 3]
        over, under = volumes(t[:, :, 0], t[:, :, 1], t[:, :, 2], p), volumes(t[:, :, 0], t[:, :, 1], t[:, :, 2], q)
        sides = [volumes(p, q, t[:, :, m], t[:, :, (m + 1) % 3]) for m in range(3)]
        inside = np.logical_or(*(np.logical_and.reduce([sign * side >= 0 for side in sides]) for sign in (1, -1)))
        flat = np.logical_and.reduce([side == 0 for side in sides])
        found |= (over * under <= 0) & inside & ~flat & ((over != 0) | (under != 0))
    return int((found & apart).sum())


def assert_sound(labels: Labels, surfaces: _kernels.LabelSurfaces) -> None:
    solids = solids_of(labels, surfaces)
    points = np.argwhere(np.ones(labels.shape, bool)).astype(np.float64)
    for label, solid in solids.items():
        measured = _kernels.measure(solid.vertices, solid.triangles, 1)
        broken = measured.boundary_edges, measured.nonmanifold_edges, measured.nonmanifold_vertices
        assert broken == (0, 0, 0)
        assert measured.misoriented_edges == measured.degenerate == 0
        inside = (labels == label)[tuple(points.astype(int).T)]
        np.testing.assert_allclose(winding_numbers(solid, points), inside, atol=1e-6)
    mesh = surfaces.shared()
    assert crossing_pairs(mesh.vertices, mesh.triangles) == 0


@given(labels=label_maps)
@settings(max_examples=50, deadline=None)
def test_every_label_is_closed_and_holds_its_samples_alone(labels: Labels) -> None:
    """Each a closed, oriented 2-manifold around its own samples; no triangle of the shared mesh cuts another."""
    assert_sound(labels, surfaces_of(labels))


@given(labels=label_maps, rounds=st.integers(1, 30))
@settings(max_examples=25, deadline=None)
def test_smoothing_keeps_all_that(labels: Labels, rounds: int) -> None:
    """Vertices move inside their edges, faces and cells only."""
    surfaces = surfaces_of(labels)
    before = surfaces.shared()
    surfaces.smooth(rounds)
    assert_sound(labels, surfaces)
    after = surfaces.shared()
    free = (before.elements[:, None] >> np.arange(3) & 1).astype(bool)
    moved = after.vertices - before.vertices
    assert (moved[~free] == 0).all()
    assert (np.abs(moved) <= 0.4501).all()


@given(labels=label_maps)
@settings(max_examples=50, deadline=None)
def test_the_volumes_of_all_labels_add_up_to_what_is_not_background(labels: Labels) -> None:
    """Exactly: vertices are halves, and neighbours share their border triangle by triangle."""
    surfaces = surfaces_of(labels)

    def sixfold_volume(solid: _kernels.LabelSolid) -> int:
        doubled = (2 * solid.vertices).astype(np.int64)[solid.triangles]
        return int((doubled[:, 0] * np.cross(doubled[:, 1], doubled[:, 2])).sum())

    labelled = sum(sixfold_volume(solid) for solid in solids_of(labels, surfaces).values())
    assert labelled == -sixfold_volume(surfaces.solid(0))


@given(labels=label_maps)
@settings(max_examples=30, deadline=None)
def test_neighbours_share_their_border(labels: Labels) -> None:
    """Every triangle of a label is a triangle of exactly one other, turned round."""
    surfaces = surfaces_of(labels)
    shared, whole = surfaces.shared(), {}
    for label in np.unique(np.append(labels, 0)):
        solid = surfaces.solid(int(label))
        for triangle in solid.shared[solid.triangles].tolist():
            whole.setdefault(frozenset(triangle), []).append(int(label))
    assert len(whole) == len(shared.triangles)
    assert all(len(sides) == 2 and sides[0] != sides[1] for sides in whole.values())


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_change_nothing(threads: int) -> None:
    """The same bytes, over more slabs than one, before smoothing and after."""
    labels = np.random.default_rng(5).integers(0, 4, (9, 8, 70)).astype(np.uint8)
    one, more = surfaces_of(labels), surfaces_of(labels, threads)
    for rounds in (0, 7):
        one.smooth(rounds, 1)
        more.smooth(rounds, threads)
        for a, b in zip(one.shared(), more.shared(), strict=True):
            assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize("dtype", ["i1", "u2", "i2", "u4", "i4", "f4", "f8"])
def test_every_type_gives_the_same_mesh(dtype: str) -> None:
    """Labels are numbers, whatever type they are stored in."""
    labels = np.random.default_rng(6).integers(0, 5, (6, 5, 4)).astype(np.uint8)
    for a, b in zip(surfaces_of(labels).shared(), surfaces_of(labels.astype(dtype)).shared(), strict=True):
        assert a.tobytes() == b.tobytes()


@pytest.mark.parametrize("step", [1 << 6, 1 << 14])
def test_high_ranks_give_the_same_mesh_as_low_ones(step: int) -> None:
    """Ranks are kept in one byte, two or four, as the highest needs."""
    labels = np.random.default_rng(7).integers(0, 5, (6, 5, 4)).astype(np.uint8)
    values = np.arange(0, 5 * step, step, dtype=np.float64)
    wide = np.asfortranarray(labels.astype(np.uint32) * np.uint32(step))
    high = _kernels.label_surfaces(wide, values, values.astype(np.uint32)).shared()
    low = surfaces_of(labels).shared()
    assert (high.sides == low.sides * step).all()
    same = "vertices", "elements", "triangles"
    for a, b in ((getattr(high, name), getattr(low, name)) for name in same):
        assert a.tobytes() == b.tobytes()


def test_smoothing_a_ball_turns_its_normals_right_and_keeps_its_volume() -> None:
    """Against the true sphere, radius 20: normals' mean deviation at most 0.4 of the staircase's, volume within 1 %."""
    grid = np.mgrid[-23:24, -23:24, -23:24]
    surfaces = surfaces_of(((grid**2).sum(0) <= 400).astype(np.uint8))

    def deviation() -> float:
        solid = surfaces.solid(1)
        corners = solid.vertices.astype(np.float64)[solid.triangles] - 23
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        centres = corners.mean(1)
        cosines = (normals * centres).sum(1) / np.linalg.norm(normals, axis=1) / np.linalg.norm(centres, axis=1)
        return float(np.arccos(np.clip(cosines, -1, 1)).mean())

    rough, volume = deviation(), _kernels.measure(*surfaces.solid(1)[:2], 1).volume
    surfaces.smooth(20)
    assert deviation() <= 0.4 * rough
    assert _kernels.measure(*surfaces.solid(1)[:2], 1).volume == pytest.approx(volume, rel=0.01)


def test_a_census_counts_every_label() -> None:
    """Values ascending, with their numbers; NaN is none; what is not whole is named."""
    census = _kernels.label_census(np.array([3, 3, 0, np.nan, -2, 3], dtype=np.float32), 10)
    assert census.values.tolist() == [-2, 0, 3]
    assert census.counts.tolist() == [1, 1, 3]
    assert (census.not_a_number, census.too_many, census.not_whole) == (1, False, 0)
    assert _kernels.label_census(np.array([1, 2.5]), 10).not_whole == 2.5
    assert _kernels.label_census(np.arange(20, dtype=np.int32), 10).too_many
