"""Volume thinning: the skeleton keeps what the theorem asks for, and propagation finds what a full scan finds."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import numpy.typing as npt
import pytest
from mesh_oracles import Glued, triangle_set

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.extraction import Outlook
from isocore.job import Options
from isocore.methods.thinning import build_index, prepare_thinning, ready_index

KINDS = pytest.mark.parametrize("hexes", [False, True], ids=["tets", "hexes"])
EACH_BODY = pytest.mark.parametrize("body", meshes.BODIES)
EACH_FIELD = pytest.mark.parametrize("field", meshes.FIELDS)


def body_with(body: str, field: str, *, hexes: bool, seed: int = 0) -> CellMesh:
    random = np.random.default_rng([seed, list(meshes.BODIES).index(body), list(meshes.FIELDS).index(field)])
    mesh = meshes.mesh_of(meshes.BODIES[body][0], hexes=hexes)
    return meshes.shuffled(meshes.with_values(mesh, meshes.FIELDS[field](mesh, random)), random)


def skeleton_of(mesh: CellMesh, cells_per_block: int = 0) -> list[int]:
    """The skeleton in the mesh's own cell numbers: the index has others, so cells are known by their points."""
    index = build_index(mesh, cells_per_block=cells_per_block)
    part, cells = (index.tets, mesh.tets) if len(mesh.tets) else (index.hexes, mesh.hexes)
    number = {frozenset(cell): n for n, cell in enumerate(cells.tolist())}
    corners = index.original[part.records[part.skeleton, : cells.shape[1]]]
    return sorted(number[frozenset(cell)] for cell in corners.tolist())


def assert_same_as_full_scan(mesh: CellMesh, limit: int = 12, cells_per_block: int = 0) -> None:
    ready = ready_index(mesh, build_index(mesh, cells_per_block=cells_per_block))
    for isovalue in meshes.isovalues(mesh, limit):
        vertices, triangles, seeds, visited, _ = ready.propagate(isovalue)
        scanned = _kernels.marching_cells(mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue)
        assert visited == scanned[2]
        assert (seeds > 0) == (visited > 0)
        assert len(vertices) == len(scanned[0])
        assert triangle_set(vertices, triangles) == triangle_set(scanned[0], scanned[1])


@KINDS
@EACH_FIELD
@EACH_BODY
def test_the_triangles_are_those_of_the_full_scan(body: str, field: str, hexes: bool) -> None:
    """On every body and field, at distinct values and midpoints; visited cells are the intersected ones."""
    assert_same_as_full_scan(body_with(body, field, hexes=hexes))


@KINDS
@EACH_FIELD
@pytest.mark.parametrize("cells_per_block", [7, 60])
def test_blocks_that_are_thinned_apart_lose_nothing(field: str, hexes: bool, cells_per_block: int) -> None:
    """Some with a void of their own, some with boundary; the same triangles as the full scan's."""
    mesh = body_with("void and hole", field, hexes=hexes)
    assert_same_as_full_scan(mesh, 6, cells_per_block)


def test_a_skeleton_is_the_same_for_any_number_of_threads() -> None:
    """Of two blocks and their rims: all arrays are equal, and less than one in a hundred cells remains."""
    mesh = meshes.mesh_of(np.ones((33, 33, 33), bool))
    mesh = meshes.with_values(mesh, np.sin(mesh.points / 7).sum(axis=1))
    one = build_index(mesh)
    assert one.skeleton_cells < 0.01 * mesh.cells
    for threads in (2, 3):
        other = build_index(mesh, threads)
        assert np.array_equal(one.original, other.original)
        for a, b in zip(one.parts, other.parts, strict=True):
            for array in ("records", "skeleton", "low", "high"):
                assert np.array_equal(getattr(a, array), getattr(b, array)), array
    assert_same_as_full_scan(mesh, 2)


@KINDS
@EACH_BODY
def test_the_skeleton_carries_components_and_loops(body: str, hexes: bool) -> None:
    """Connected within every component of the glued mesh, and onto its loops: by rank over Z2; blocks or not."""
    mesh = body_with(body, "smooth", hexes=hexes)
    glued = Glued(mesh)
    for cells_per_block in (0, 30):
        assert_carries_all(mesh, glued, skeleton_of(mesh, cells_per_block), body)


def assert_carries_all(mesh: CellMesh, glued: Glued, kept: list[int], body: str) -> None:
    whole, thinned = glued.components(list(range(mesh.cells))), glued.components(kept)
    assert len(whole) == len(thinned) == (1 if "contact" in body else meshes.BODIES[body][1])
    assert all(any(part <= component for component in whole) for part in thinned)
    assert glued.lost_loops(kept) == 0


@KINDS
@EACH_FIELD
def test_the_skeleton_holds_every_extremum(field: str, hexes: bool) -> None:
    """Each point without a lower, or without a higher, neighbour along the edges is in a skeleton cell."""
    mesh = body_with("torus void", field, hexes=hexes)
    glued = Glued(mesh)
    height = np.where(np.isfinite(mesh.values), mesh.values, -np.inf)
    number = np.empty(len(height), int)  # ties go by the index's own numbers
    number[build_index(mesh).original] = np.arange(len(height))
    order = {point: place for place, point in enumerate(np.lexsort((number, height)).tolist())}
    at = {
        name: point
        for names, points in zip(glued.vertices, glued.cells, strict=True)
        for name, point in zip(names, points, strict=True)
    }
    lower, higher = set(), set()
    for a, b in (tuple(ends) for ends in glued.boundary[1].values()):
        a, b = (a, b) if order[at[a]] < order[at[b]] else (b, a)
        higher.add(a)
        lower.add(b)
    extrema = set(at) - (lower & higher)
    assert extrema <= glued.touched(skeleton_of(mesh))[0]
    assert build_index(mesh).extrema == len(extrema)


@pytest.mark.parametrize("body", [name for name, body in meshes.BODIES.items() if body[3]])
def test_voids_are_opened(body: str) -> None:
    """No closed sheet remains around a void: H2 of the skeleton vanishes, by its Euler number."""
    mesh = body_with(body, "smooth", hexes=False)
    glued = Glued(mesh)
    kept = skeleton_of(mesh)
    vertices, edges, faces = (len(kind) for kind in glued.touched(kept))
    euler = vertices - edges + faces - len(kept)
    assert euler == meshes.BODIES[body][1] - meshes.BODIES[body][2]


# Slices along the first axis; the void is the box in the middle of the second. Found by random search, then shrunk.
_CAGE = (
    "..#..  .####  ..#..  ..#..",
    "####.  .#.#.  .###.  .....",
    "..#..  ####.  ..#..  .....",
    "..#..  .#...  .....  .....",
)


def test_a_void_is_opened_where_no_cell_may_be_pricked() -> None:
    """Every point is an extremum, so no cell that reaches both sides may go: a path of others leads out."""
    rows = [line.split() for line in _CAGE]
    boxes = np.array([[[box == "#" for box in row[x]] for row in rows] for x in range(4)])
    mesh = meshes.mesh_of(boxes, hexes=True)
    mesh = meshes.with_values(mesh, mesh.points.sum(axis=1) % 2)
    kept = skeleton_of(mesh)
    walls = np.zeros(boxes.shape, bool)
    walls[tuple(np.argwhere(boxes)[kept].T)] = True
    assert outside_of(np.pad(boxes, 1))[2, 2, 3] < outside_of(np.pad(walls, 1))[2, 2, 3]
    assert Glued(mesh).lost_loops(kept) == 0
    assert_same_as_full_scan(mesh)


def outside_of(walls: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """The boxes that can be reached from the first one through faces, without a wall."""
    reached = np.zeros(walls.shape, bool)
    reached[0, 0, 0] = True
    for _ in range(walls.size):
        for axis in range(3):
            ahead, behind = np.roll(reached, 1, axis), np.roll(reached, -1, axis)  # the border is free all around
            reached |= (ahead | behind) & ~walls
    return reached


def test_a_smooth_field_leaves_a_thin_skeleton() -> None:
    """Of 24,000 tetrahedra less than one in a hundred remains."""
    mesh = meshes.mesh_of(np.ones((16, 16, 16), bool))
    values = np.sin(mesh.points / 4).sum(axis=1)
    assert len(skeleton_of(meshes.with_values(mesh, values))) < 0.01 * mesh.cells


def test_tetrahedra_and_hexahedra_in_one_mesh_share_their_vertices() -> None:
    """Where the two kinds touch, a crossed edge has one vertex."""
    hexes = meshes.mesh_of(np.ones((2, 2, 2), bool), hexes=True)
    tets = meshes.mesh_of(np.ones((2, 2, 2), bool))
    random = np.random.default_rng(5)
    mesh = CellMesh(hexes.points, tets.tets[:24], hexes.hexes, random.random(len(hexes.points)))
    assert_same_as_full_scan(mesh)


@KINDS
def test_lots_of_cells_share_the_vertices_of_their_edges(hexes: bool) -> None:
    """Noise in ten thousand cells; some, all over the mesh, share an edge with others, but no face."""
    random = np.random.default_rng(11)
    mesh = meshes.mesh_of(np.ones((15, 15, 15), bool), hexes=hexes)
    cells = mesh.hexes if hexes else mesh.tets
    edges = random.choice(cells, 2000)[:, :2]
    others = np.hstack([edges, random.integers(0, len(mesh.points), (2000, 2), dtype=np.int32)])
    distinct = (np.diff(np.sort(others, axis=1), axis=1) > 0).all(axis=1)
    mesh = replace(mesh, tets=np.vstack([mesh.tets, others[distinct]]))
    mesh = meshes.with_values(mesh, random.normal(size=len(mesh.points)))
    assert_same_as_full_scan(meshes.shuffled(mesh, random), 2)


def test_the_number_of_threads_does_not_change_a_byte() -> None:
    """One, two and four threads give the same arrays, and so does a second call."""
    mesh = meshes.mesh_of(np.ones((20, 20, 20), bool))
    mesh = meshes.with_values(mesh, np.sin(mesh.points).sum(axis=1))
    index = build_index(mesh)
    ready = ready_index(mesh, index)
    first = ready_index(mesh, index).propagate(0.3)
    for threads in (1, 2, 4):
        ready.propagate(-0.2, threads)
        again = ready.propagate(0.3, threads)
        assert all(np.array_equal(a, b) for a, b in zip(again[:2], first[:2], strict=True))


def broken_mesh(what: str) -> CellMesh:
    mesh = meshes.mesh_of(np.ones((2, 2, 2), bool))
    random = np.random.default_rng(6)
    points, tets, values = mesh.points.copy(), mesh.tets.copy(), random.random(len(mesh.points))
    if what == "duplicate cells":
        tets = np.concatenate([tets, tets[:5]])
    elif what == "three cells at a face":
        points = np.concatenate([points, [[0.4, 0.3, 5.0]]])
        values = np.append(values, 0.9)
        diagonal = [0, len(mesh.points) // 2]  # of the first box: all six of its tetrahedra are around it
        third = next(p for p in tets[0] if p not in diagonal)
        tets = np.concatenate([tets, [[*diagonal, third, len(points) - 1]]]).astype(np.int32)
    elif what == "unused points":
        points = np.concatenate([np.full((3, 3), 9.0), points])
        values = np.concatenate([[np.nan, 1e9, -1e9], values])
        tets = tets + np.int32(3)
    elif what == "flat cells":
        tets[3] = tets[3, [0, 0, 1, 2]]
    elif what == "one cell twice":
        tets = tets[[0, 0]]
    elif what == "all values missing":
        values[:] = np.nan
    elif what == "coincident points":
        points[:] = 0
    return CellMesh(points, tets, mesh.hexes, values)


BROKEN = (
    "duplicate cells",
    "three cells at a face",
    "unused points",
    "flat cells",
    "one cell twice",
    "all values missing",
    "coincident points",
)


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_mesh_is_contoured_as_the_full_scan_does(what: str) -> None:
    """No crash, no hang, and the same triangles."""
    assert_same_as_full_scan(broken_mesh(what))


@pytest.mark.parametrize(
    ("what", "sentence"),
    [
        ("duplicate cells", "shared by more than two tetrahedra, the first by 0, "),
        ("three cells at a face", "1 faces are shared by more than two tetrahedra"),
        ("flat cells", "1 tetrahedra name a point twice, the first is 3"),
    ],
)
def test_the_first_offender_is_named(what: str, sentence: str) -> None:
    """Meshes that cannot be glued everywhere are contoured with a warning that says where."""
    warnings = prepare_thinning(broken_mesh(what), Options(), Outlook())(0.5).warnings
    assert any(sentence in warning for warning in warnings), warnings


def test_advice_when_thinning_does_not_pay() -> None:
    """A single isovalue, and noise, each get a line that names the better choice."""
    mesh = meshes.mesh_of(np.ones((6, 6, 6), bool))
    noise = meshes.with_values(mesh, np.random.default_rng(7).random(len(mesh.points)))
    smooth = meshes.with_values(mesh, mesh.points.sum(axis=1))
    assert prepare_thinning(smooth, Options(), Outlook())(5.0).warnings == ()
    (one,) = prepare_thinning(smooth, Options(), Outlook(isovalues=1))(5.0).warnings
    assert "-b mc" in one
    (noisy,) = prepare_thinning(noise, Options(), Outlook())(0.5).warnings
    assert "% of the points are extrema" in noisy


def test_the_report_part_counts_the_search() -> None:
    """cells, extrema, skeleton, seeds, visited, intersected, as cli.md names them."""
    mesh = meshes.mesh_of(np.ones((6, 6, 6), bool))
    extraction = prepare_thinning(meshes.with_values(mesh, mesh.points.sum(axis=1)), Options(), Outlook())(5.5)
    search = extraction.facts["search"]
    assert list(search) == ["cells", "extrema", "skeleton", "seeds", "visited", "intersected"]
    assert search["cells"] == 1296
    assert search["extrema"] == 2
    assert 0 < search["seeds"] <= search["skeleton"]
    assert search["visited"] == search["intersected"] > 0


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_points_and_values_are_ordered_as_numpy_takes_them(threads: int, kind: type) -> None:
    """In several chunks; and a number that names no point is refused."""
    random = np.random.default_rng(1)
    points, values = random.normal(size=(150_000, 3)), random.normal(size=150_000).astype(kind)
    original = random.permutation(150_000).astype(np.int32)
    ordered = _kernels.in_order(points, values, original, threads)
    assert np.array_equal(ordered.points, points[original])
    assert np.array_equal(ordered.values, values[original])
    for wrong in (-1, 150_000):
        original[77_777] = wrong
        with pytest.raises(IndexError):
            _kernels.in_order(points, values, original, threads)
