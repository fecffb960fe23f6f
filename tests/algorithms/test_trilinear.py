"""Marching cubes with the topology of the trilinear function inside each cell, against published and sampled truth."""

from __future__ import annotations

import json

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from meshes import mesh_of
from shapes import SHARED, volume_of

from isocore.backends import Extraction, Options, prepare
from isocore.errors import OptionError
from isocore.measurements import Measurements, measure

Cell = npt.NDArray[np.float64]  # (2, 2, 2)
TOPOLOGY = SHARED / "topology"
ties = arrays(np.int8, st.tuples(*[st.integers(2, 5)] * 3), elements=st.integers(-2, 2), fill=st.nothing())
cells = arrays(np.float64, (2, 2, 2), elements=st.integers(-40, 40).filter(bool).map(float), fill=st.nothing())


def marched(samples: npt.ArrayLike, isovalue: float = 0.0, *, cap: bool = False, threads: int = 1) -> Extraction:
    return prepare(volume_of(samples), "mc", Options(topology="trilinear", cap=cap, threads=threads))(isovalue)


def sampled_regions(inside: npt.NDArray[np.bool_]) -> int:
    """Connected regions of a sampled cell. Each holds a corner: a trilinear function rises along an axis or falls."""
    ends = np.ix_([0, -1], [0, -1], [0, -1])
    reach = np.zeros(inside.shape, np.uint8)  # from which of the 8 corners
    reach[ends] = 1 << np.arange(8, dtype=np.uint8).reshape(2, 2, 2)
    reach *= inside
    before = -1
    while (now := int(reach.sum())) != before:
        before = now
        for axis in range(3):
            low, high = (np.moveaxis(reach, axis, 0)[part] for part in (slice(None, -1), slice(1, None)))
            high |= low
            low |= high
            reach *= inside
    return len(set(reach[ends][inside[ends]].tolist()))


def regions(cell: Cell, n: int) -> tuple[int, int] | None:
    """Inside and outside regions of the function on n^3 points; None if raising or lowering it a little differs."""
    t = np.linspace(0, 1, n)
    weights = np.stack([1 - t, t])
    field = np.einsum("abc,ax,by,cz->xyz", cell, weights, weights, weights)
    margin = 0.02 * np.abs(cell).max()
    counts = {(sampled_regions(field >= shift), sampled_regions(field < shift)) for shift in (-margin, 0.0, margin)}
    return counts.pop() if len(counts) == 1 else None


def assert_has_the_topology(measured: Measurements, inside: int, outside: int, loops: int) -> None:
    """In a ball, `inside` + `outside` regions have one less surface between them, each a sphere with holes."""
    components = inside + outside - 1
    assert measured.components == components
    assert measured.euler == 2 * components - loops
    assert measured.manifold and measured.misoriented_edges == 0


def loops_of(samples: npt.ArrayLike) -> int:
    """The loops on a cell's faces: its disks without the trilinear rule."""
    return measure(prepare(volume_of(samples), "mc", Options())(0.0).surface).components


def opposite_corners(value: float) -> Cell:
    """Two opposite corners inside by `value`, all others outside by 1."""
    cell = np.full((2, 2, 2), -1.0)
    cell[0, 0, 0] = cell[1, 1, 1] = value
    return cell


def test_opposite_corners_meet_where_they_are_high_enough() -> None:
    """Along the diagonal the function is v (t^3 + s^3) - 3 t s: above 0 at the middle iff v > 3."""
    apart, met = marched(opposite_corners(2.9)), marched(opposite_corners(3.1))
    assert apart.facts["ambiguous"]["tubes"] == 0 and measure(apart.surface).components == 2
    assert met.facts["ambiguous"]["tubes"] == 1 and measure(met.surface).components == 1
    assert measure(met.surface).euler == 0
    assert marched(opposite_corners(3.0)).facts["ambiguous"]["tubes"] == 1, "a saddle on the isovalue joins"


@pytest.mark.skipif(not TOPOLOGY.exists(), reason="the shared topology data are not here")
def test_2000_known_grids_have_their_components_and_euler_numbers() -> None:
    """5^3 samples each, all inside at the border; the numbers come from two independent programs."""
    known = np.load(TOPOLOGY / "random_5x5x5_shared_2000.npz")
    tubes = 0
    for grid, components, euler in zip(known["grids"], known["components"], known["euler"], strict=True):
        extraction = marched(grid)
        measured = measure(extraction.surface)
        assert measured.watertight and measured.manifold
        assert (measured.components, measured.euler) == (components, euler)
        tubes += extraction.facts["ambiguous"]["tubes"]
    assert tubes == 56


@pytest.mark.skipif(not TOPOLOGY.exists(), reason="the shared topology data are not here")
def test_known_single_cells_are_manifold_and_have_their_components() -> None:
    """Degenerate and ambiguous cells; b0 where it is stated."""
    for case in json.loads((TOPOLOGY / "mcpro_single_cells.json").read_text())["cases"].values():
        cell = np.reshape(np.array(case["values"], float), (2, 2, 2), order="F")
        measured = measure(marched(cell).surface)
        assert measured.manifold is not False and measured.misoriented_edges == 0
        if case["betti"] is not None:
            assert measured.components == case["betti"][0]


@given(cell=cells)
@settings(max_examples=100, deadline=None)
def test_a_cell_has_the_topology_of_its_sampled_function(cell: Cell) -> None:
    """Where the samples tell it safely."""
    sampled = regions(cell, 21)
    if sampled is not None and not (np.all(cell > 0) or np.all(cell < 0)):
        assert_has_the_topology(measure(marched(cell).surface), *sampled, loops_of(cell))


def test_cells_with_a_tube_are_those_of_the_sampled_function() -> None:
    """Random cells of many loops, so that tubes are frequent: every kind of tube against dense samples."""
    random = np.random.default_rng(11)
    checked = with_tube = 0
    while with_tube < 40:
        cell = random.normal(size=(2, 2, 2)) * np.exp(random.normal(size=(2, 2, 2)))
        extraction = marched(cell)
        is_tube = extraction.facts["ambiguous"]["tubes"] == 1
        loops = loops_of(cell)
        if loops < 2 or (not is_tube and checked > 2 * with_tube) or (sampled := regions(cell, 25)) is None:
            continue
        assert_has_the_topology(measure(extraction.surface), *sampled, loops)
        assert extraction.facts["ambiguous"]["tubes"] == loops + 1 - sum(sampled)
        checked += 1
        with_tube += extraction.facts["ambiguous"]["tubes"]
    assert checked > with_tube


@pytest.mark.parametrize("topology", ["faces", "trilinear"])
@given(samples=ties)
@settings(max_examples=100, deadline=None)
def test_ties_leave_it_closed_and_manifold(topology: str, samples: npt.NDArray[np.int8]) -> None:
    """Small integers with the isovalue among them; both sides of every face may hold a tube."""
    surface = prepare(volume_of(samples), "mc", Options(topology=topology, cap=True))(0.0).surface
    measured = measure(surface)
    assert measured.watertight and measured.manifold and measured.degenerate == 0


def test_only_triangles_change_and_threads_change_nothing() -> None:
    """Same vertices as by faces alone, each tube two boundary loops for one piece: four more triangles."""
    noise = np.random.default_rng(3).normal(size=(30, 20, 25))
    by_faces = prepare(volume_of(noise), "mc", Options(cap=True))(0.1).surface
    trilinear = marched(noise, 0.1, cap=True)
    tubes = trilinear.facts["ambiguous"]["tubes"]
    assert tubes > 50
    assert trilinear.surface.vertices.tobytes() == by_faces.vertices.tobytes()
    assert len(trilinear.surface.triangles) == len(by_faces.triangles) + 4 * tubes
    assert measure(trilinear.surface).euler == measure(by_faces).euler - 2 * tubes
    assert measure(trilinear.surface).manifold
    again = marched(noise, 0.1, cap=True, threads=3).surface
    assert again.triangles.tobytes() == trilinear.surface.triangles.tobytes()


def test_a_negative_slope_finds_the_same_tubes() -> None:
    """Inside is then the low side of the stored samples."""
    noise = np.random.default_rng(5).normal(size=(12, 12, 12))
    turned = volume_of(-noise, slope=-1.0)
    extraction = prepare(turned, "mc", Options(topology="trilinear"))(0.0)
    assert extraction.surface.triangles.tobytes() == marched(noise).surface.triangles.tobytes()


def test_what_is_not_finite_meets_nothing() -> None:
    """A cell with an infinite corner keeps its disks."""
    cell = opposite_corners(9.0)
    cell[1, 0, 0] = -np.inf
    extraction = marched(cell)
    assert extraction.facts["ambiguous"]["tubes"] == 0
    assert measure(extraction.surface).components == 2


def test_a_topology_that_makes_no_sense_is_refused() -> None:
    """An unknown word, a mesh, and a backend that has no cells of its own."""
    volume = volume_of(np.zeros((2, 2, 2)))
    with pytest.raises(OptionError, match="must be faces or trilinear"):
        prepare(volume, "mc", Options(topology="smooth"))
    with pytest.raises(OptionError, match="is for volumes"):
        prepare(mesh_of(np.ones((1, 1, 1), bool)), "mc", Options(topology="trilinear"))
    with pytest.raises(OptionError, match="is not an option of asc"):
        prepare(volume, "asc", Options(topology="trilinear"))
