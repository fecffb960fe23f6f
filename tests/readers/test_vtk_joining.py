"""Points that coincide are joined: pieces grow together, and so do cells with points of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isocore import _kernels, extract, measure
from isocore.cell_mesh import Connectivity
from isocore.readers import ReadOptions, read
from isocore.readers.options import MeshOptions
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtk_pieces import PieceData

CASES = Path(__file__).parents[3] / "shared" / "data" / "cases"
U, OF_CELLS = FieldInfo("u", 1, "points", "Float64"), FieldInfo("u", 1, "cells", "Float64")
#: Two tetrahedra on either side of a triangle.
POINTS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], np.float64)
TETS = np.array([(0, 1, 2, 3), (1, 2, 3, 4)])


def apart(values: np.ndarray, moved: float = 0.0, points: np.ndarray = POINTS) -> PieceData:
    """Both tetrahedra, each with points of its own: eight of five. values: eight, or two of the cells."""
    corners = points[TETS.ravel()].copy()
    corners[4:] += moved
    return PieceData(corners, np.array([10, 10], np.uint8), np.array([4, 8]), np.arange(8), values)


def shared(values: np.ndarray) -> np.ndarray:
    """Values of the five points for the eight corners."""
    return np.asarray(values, np.float64)[TETS.ravel()]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 300), steps=st.integers(1, 6))
def test_each_point_goes_to_the_first_at_its_place(seed, count, steps):
    """As a search among all earlier points finds it."""
    points = np.random.default_rng(seed).integers(-steps, steps, (count, 3)) * 0.1
    points[::3] *= -0.0 if steps == 1 else 1.0
    found = _kernels.join_points(points)
    first = [next(i for i in range(n + 1) if (points[i] == points[n]).all()) for n in range(count)]
    assert found.first[found.number].tolist() == first
    assert found.first.tolist() == sorted(set(first))


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 200), distance=st.sampled_from([1e-3, 0.1, 0.5, 10.0]))
def test_within_a_distance_each_point_goes_to_the_lowest_that_stands_for_itself(seed, count, distance):
    """No chain of small steps joins what lies far apart, and none that stand for themselves are near."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    expected: list[int] = []
    for n in range(count):
        near = [i for i in range(n) if expected[i] == i and np.linalg.norm(points[i] - points[n]) <= distance]
        expected.append(min(near, default=n))
    found = _kernels.join_points(points, distance)
    assert found.first[found.number].tolist() == expected


def test_a_distance_below_the_steps_of_the_coordinates_joins_equal_points_only():
    """Also where their quotient is beyond every number."""
    points = np.array([(1e300, 0, 0), (1e300, 0, 0), (2e300, 0, 0)])
    found = _kernels.join_points(points, 1e-300)
    assert found.first[found.number].tolist() == [0, 0, 2]


def test_equal_values_are_joined_as_they_are():
    """To the last bit, whatever their mean would round to."""
    values = np.array([0.1, 0.7, 1 / 3, 1e-300, 5])
    mesh = assembled("any.file", [apart(shared(values))], U, 0)
    assert mesh.values.tolist() == values.tolist() and mesh.tets.tolist() == TETS.tolist()
    assert mesh.connectivity == Connectivity(joined_points=3)
    assert mesh.warnings == ("3 points coincide with others and were joined; --keep-duplicates leaves them apart",)


def test_values_that_differ_by_rounding_are_joined_without_a_word_about_it():
    """A field in single precision, computed twice."""
    values = shared([1, 2, 3, 4, 5]).astype(np.float32)
    values[4:] = np.nextafter(values[4:], np.float32(9))
    mesh = assembled("any.file", [apart(values)], U, 0)
    assert mesh.values.tolist()[:4] == [1, 2, 3, 4] and mesh.connectivity.averaged_points == 0


def test_values_that_differ_become_their_mean_and_a_warning_says_by_how_much():
    """Discontinuous output is drawn as one surface."""
    values = shared([1, 2, 3, 4, 5])
    values[4:7] += (0.5, 0, 0.25)
    mesh = assembled("any.file", [apart(values)], U, 0)
    assert mesh.values.tolist() == [1, 2.25, 3, 4.125, 5]
    assert mesh.connectivity == Connectivity(joined_points=3, averaged_points=2, largest_difference=0.5)
    assert "u is discontinuous: at 2 points the joined values differ, by up to 0.5" in " ".join(mesh.warnings)


def test_a_point_is_outside_where_one_of_its_values_is_no_number():
    """NaN among them makes NaN; NaN everywhere differs from nothing."""
    values = shared([1, 2, 3, np.nan, 5])
    values[4] = np.nan
    mesh = assembled("any.file", [apart(values)], U, 0)
    np.testing.assert_array_equal(mesh.values, [1, np.nan, 3, np.nan, 5])
    assert mesh.connectivity.averaged_points == 1 and mesh.connectivity.largest_difference == 0


def test_what_no_cell_names_has_no_say():
    """A probe that lies at a point of the mesh keeps its value to itself."""
    piece = apart(np.concatenate((shared([1, 2, 3, 4, 5]), [99.0])))
    with_probe = PieceData(
        np.concatenate((piece.points[[7]], piece.points)),
        piece.types,
        piece.offsets,
        piece.connectivity + 1,
        np.concatenate(([99.0], piece.values[:8])),
    )
    mesh = assembled("any.file", [with_probe], U, 0)
    assert sorted(mesh.values.tolist()) == [1, 2, 3, 4, 5] and mesh.connectivity.averaged_points == 0


def test_values_of_cells_are_averaged_after_joining():
    """So the shared points know both cells."""
    mesh = assembled("any.file", [apart(np.array([1.0, 3.0]))], OF_CELLS, 0)
    assert mesh.values.tolist() == [1, 2, 2, 2, 3]


def test_pieces_are_joined_as_the_cells_of_one_are():
    """The surface has no seam between them."""
    whole = apart(shared([1, 2, 3, 4, 5]))
    halves = [
        PieceData(whole.points[part], whole.types[:1], np.array([4]), np.arange(4), whole.values[part])
        for part in (slice(0, 4), slice(4, 8))
    ]
    mesh = assembled("any.file", halves, U, 0)
    assert mesh.tets.tolist() == TETS.tolist() and mesh.connectivity.joined_points == 3


def test_the_same_cell_in_one_piece_stays_as_it_is_listed():
    """Only pieces overlap; what a piece lists twice is its own."""
    twice = np.array([0, 1, 2, 3] * 2)
    piece = PieceData(POINTS, np.array([10, 10], np.uint8), np.array([4, 8]), twice, np.arange(5.0))
    assert len(assembled("any.file", [piece], U, 0).tets) == 2
    assert len(assembled("any.file", [piece, piece], U, 0).tets) == 1


def test_points_that_nearly_coincide_are_joined_on_request():
    """Within the distance, and not beyond it."""
    piece = apart(shared([1, 2, 3, 4, 5]), moved=1e-5)
    assert len(assembled("any.file", [piece], U, 0).points) == 8
    near = assembled("any.file", [piece], U, 0, MeshOptions(merge_points=1e-4))
    assert near.tets.tolist() == TETS.tolist() and "lie within 0.0001 of others" in near.warnings[0]


def test_duplicates_are_kept_on_request():
    """Nothing is joined and nothing said."""
    mesh = assembled("any.file", [apart(shared([1, 2, 3, 4, 5]))], U, 0, MeshOptions(keep_duplicates=True))
    assert len(mesh.points) == 8 and mesh.warnings == () and mesh.connectivity == Connectivity()


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases lie beside the repository, not in it")
def test_cells_with_points_of_their_own_give_the_surface_of_shared_points():
    """The file users met, to the last bit, and closed."""
    folder = CASES / "03-vtu-points-per-cell"
    ours, theirs = (
        extract(read(folder / f"{name}.vtu"), 0.6, backend="mc") for name in ("per_cell", "shared")
    )
    assert sorted(ours.vertices.tolist()) == sorted(theirs.vertices.tolist())
    assert measure(ours).watertight and measure(ours).triangles == measure(theirs).triangles
    kept = read(folder / "per_cell.vtu", ReadOptions(mesh=MeshOptions(keep_duplicates=True)))
    assert not measure(extract(kept, 0.6, backend="mc")).watertight


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 9000), kind=st.sampled_from([np.float32, np.float64]))
def test_one_value_that_differs_is_found(seed, count, kind):
    """Wherever it stands; and cells get the numbers that numpy looks up."""
    random = np.random.default_rng(seed)
    joined = random.normal(size=max(1, count // 3)).astype(kind)
    number = random.integers(0, len(joined), count).astype(np.int32)
    values = joined[number]
    assert _kernels.values_agree(values, number, joined)
    anew = random.permutation(len(joined)).astype(np.int32)
    assert np.array_equal(_kernels.renumbered(number, anew), anew[number])
    values[random.integers(count)] = np.nan
    assert not _kernels.values_agree(values, number, joined)


def test_what_names_no_point_is_refused():
    """Before it is looked up."""
    for wrong in (3, -1):
        with pytest.raises(IndexError):
            _kernels.renumbered(np.array([0, wrong], np.int32), np.zeros(3, np.int32))
        with pytest.raises(IndexError):
            _kernels.values_agree(np.zeros(2), np.array([0, wrong], np.int32), np.zeros(3))
