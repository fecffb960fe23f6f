"""Splitting keeps the space filled and the faces matched, whatever stands beside whatever."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

import cell_shapes
import numpy as np
import pytest
from cell_shapes import HEX, PYRAMID, WEDGE, block, of_kind, volume_of_tets
from hypothesis import given, settings
from hypothesis import strategies as st

from isocore.readers.cell_splitting import QUADS, SplitCells, repeats_a_corner, split_cells

NO_TETS = np.empty((0, 4), np.int32)


def split(cells):
    return split_cells(NO_TETS, of_kind(cells, HEX), of_kind(cells, WEDGE), of_kind(cells, PYRAMID))


def faces_of(result: SplitCells):
    """Every triangle of the tetrahedra and every quad of the hexahedra, with how many cells it belongs to."""
    triangles = Counter(
        tuple(sorted(row))
        for tet in result.tets.tolist()
        for row in (tet[1:], tet[:1] + tet[2:], tet[:2] + tet[3:], tet[:3])
    )
    quads = Counter(
        tuple(sorted(cell[i] for i in quad)) for cell in result.hexes.tolist() for quad in QUADS["hex"]
    )
    return triangles, quads


def assert_fits(points, kinds, result):
    """All inner faces are shared by two cells of the same sort, and the volumes add up to the box."""
    size = np.array(kinds.shape, float)
    for faces in faces_of(result):
        assert max(faces.values(), default=1) <= 2
        for face, used in faces.items():
            corners = points[list(face)]
            outside = (corners == 0).all(axis=0) | (corners == size).all(axis=0)
            assert outside.any() == (used == 1)
    volumes = volume_of_tets(points, result.tets)
    assert (volumes > 1e-9).all()
    assert volumes.sum() + len(result.hexes) == pytest.approx(size.prod())


def random_kinds(draw_seed, shape, letters):
    return np.random.default_rng(draw_seed).choice(list(letters), size=shape)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(*[st.integers(1, 3)] * 3),
    letters=st.sampled_from(["hp/\\", "hhhp", "/\\", "p", "hhhhhhh/"]),
)
def test_any_mixture_fills_its_box_and_meets_face_to_face(seed, shape, letters):
    """Wedges, pyramids and hexahedra in random stacks, with random point numbers."""
    kinds = random_kinds(seed, shape, letters)
    points, cells = block(kinds, np.random.default_rng(seed + 1))
    assert_fits(points, kinds, split(cells))


def test_hexahedra_alone_stay_whole():
    """Nothing is split where nothing has to be."""
    _, cells = block(np.full((2, 2, 2), "h"))
    result = split(cells)
    assert len(result.hexes) == 8 and len(result.tets) == 0 and result.beside == 0


def test_a_chain_of_hexahedra_is_split_to_its_end():
    """A pyramid at one end reaches every hexahedron that hangs together with it, and no other."""
    kinds = np.full((40, 1, 1), "h")
    kinds[0] = "p"
    points, cells = block(kinds, np.random.default_rng(3))
    apart = of_kind(block(np.full((2, 1, 1), "h"))[1], HEX) + len(points)
    hexes = np.concatenate((apart, of_kind(cells, HEX)))
    result = split_cells(NO_TETS, hexes, of_kind(cells, WEDGE), of_kind(cells, PYRAMID))
    assert result.beside == 39
    np.testing.assert_array_equal(result.hexes, apart)


def test_hexahedra_that_touch_only_along_an_edge_stay_whole():
    """An edge carries no rule of its own: only faces have to agree."""
    _, cells = block(np.array([["p", "h"], ["h", "h"]])[:, :, None])
    hexes = of_kind(cells, HEX)
    corner = hexes[[2]]
    result = split_cells(NO_TETS, corner, of_kind(cells, WEDGE), of_kind(cells, PYRAMID))
    assert len(result.hexes) == 1


def test_every_order_of_point_numbers_cuts_a_wedge_into_three_tetrahedra():
    """720 numberings of one wedge: always three tetrahedra of a third of its volume together."""
    rng = np.random.default_rng(0)
    points, cells = block(np.full((1, 1, 1), "/"))
    for _ in range(100):
        new = rng.permutation(8)
        moved = np.empty_like(points)
        moved[new] = points
        tets = split([(kind, new[ids].tolist()) for kind, ids in cells]).tets
        assert len(tets) == 6
        assert volume_of_tets(moved, tets).sum() == pytest.approx(1)


def collapsed_wedge(ids):
    """A wedge written as a hexahedron: corners 2 and 3, 6 and 7 fall together."""
    a, b, c, d, e, f = ids
    return [a, b, c, c, d, e, f, f]


def test_a_wedge_written_as_a_hexahedron_is_split_like_the_wedge():
    """Files from finite elements write wedges as hexahedra that name corners twice."""
    points, cells = block(np.full((2, 1, 2), "/"), np.random.default_rng(5))
    hexes = np.array([collapsed_wedge(ids) for _, ids in cells], np.int32)
    result = split_cells(NO_TETS, hexes, np.empty((0, 6), np.int32), np.empty((0, 5), np.int32))
    assert result.collapsed == len(cells) and len(result.hexes) == 0
    assert_fits(points, np.full((2, 1, 2), "/"), result)


def test_a_sound_hexahedron_beside_a_collapsed_one_is_split_with_it():
    """Its neighbour's quad faces are cut, so its own have to be."""
    kinds = np.array(["/", "h", "h"])[:, None, None]
    points, cells = block(kinds, np.random.default_rng(1))
    hexes = [collapsed_wedge(ids) if kind == WEDGE else ids for kind, ids in cells]
    result = split_cells(
        NO_TETS, np.array(hexes, np.int32), np.empty((0, 6), np.int32), np.empty((0, 5), np.int32)
    )
    assert (result.collapsed, result.beside) == (2, 2)
    assert_fits(points, kinds, result)


def test_cells_collapsed_to_nothing_are_dropped_and_counted():
    """A tetrahedron with two equal corners encloses nothing."""
    tets = np.array([(0, 1, 2, 3), (0, 1, 1, 3), (2, 2, 2, 2)], np.int32)
    flat = np.array([[0, 1, 1, 0, 4, 5, 5, 4]], np.int32)
    result = split_cells(tets, flat, np.empty((0, 6), np.int32), np.empty((0, 5), np.int32))
    assert result.tets.tolist() == [[0, 1, 2, 3]]
    assert result.collapsed == 3


@pytest.mark.parametrize("corners", [4, 5, 6, 8])
def test_a_repeated_corner_is_found_at_every_pair_of_places(corners):
    """Also behind the first chunk of rows."""
    cells = np.arange(corners * 40_000, dtype=np.int32).reshape(-1, corners)
    expected = np.zeros(len(cells), bool)
    for row, (a, b) in enumerate(combinations(range(corners), 2)):
        cells[-1 - row, a] = cells[-1 - row, b]
        expected[-1 - row] = True
    np.testing.assert_array_equal(repeats_a_corner(cells), expected)


def test_the_sides_of_the_test_cubes_face_outward_in_turn():
    """The shapes the tests build on are what they say."""
    points, cells = block(np.full((1, 1, 1), "p"))
    assert len(cells) == 6 and len(points) == 9
    assert cell_shapes.volume_of_tets(points, split(cells).tets).sum() == pytest.approx(1)
