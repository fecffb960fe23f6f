"""Cells known by their faces are split at their centres: the space stays filled, and faces meet."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cell_shapes import block, volume_of_tets
from hypothesis import example, given, settings
from hypothesis import strategies as st
from vtu_files import Mesh, write

from isocore import extract, measure
from isocore.errors import InputError, IsocoreError
from isocore.readers import read
from isocore.readers.cell_splitting import QUADS, TRIANGLES
from isocore.readers.vtk_faces import PRISMS

CASES = Path(__file__).parents[3] / "shared" / "data" / "cases" / "05-vtu-polyhedra"
HEX, POLYHEDRON = 12, 42
NAMES = {12: "hex", 13: "wedge", 14: "pyramid"}
#: An octahedron around the origin.
OCTAHEDRON = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
SIDES = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]


def faces_of(kind: int, ids: list[int]) -> list[list[int]]:
    name = NAMES[kind]
    return [[ids[i] for i in face] for face in (*QUADS[name], *TRIANGLES[name])]


def listed(points: Any, cells: list[tuple[int, list[int]]], faces: list[Any], *, new: bool) -> Mesh:
    """A mesh whose polyhedra have these faces (None of other cells), as VTK writes them since 9.4 or before."""
    every = [face for some in faces if some for face in some]
    if new:
        counts = [len(some or ()) for some in faces]
        arrays = {
            "face_connectivity": np.concatenate(every),
            "face_offsets": np.cumsum([len(face) for face in every]),
            "polyhedron_to_faces": np.arange(len(every)),
            "polyhedron_offsets": np.cumsum(counts),
        }
    else:
        streams = [[len(s), *(n for f in s for n in (len(f), *f))] if s else [] for s in faces]
        ends = np.cumsum([len(stream) for stream in streams])
        arrays = {
            "faces": np.concatenate(streams).astype(np.int64),
            "faceoffsets": np.where([bool(stream) for stream in streams], ends, -1),
        }
    points = np.asarray(points, float)
    return Mesh(points, cells, {"u": points @ (1.0, 2.0, 4.0)}, {}, arrays)


def octahedron(tmp_path: Path, faces: list[list[int]], points: Any = OCTAHEDRON, *, new: bool = False) -> Path:
    cells = [(POLYHEDRON, list(range(len(points))))]
    return write(tmp_path / "a.vtu", listed(points, cells, [faces], new=new))


def assert_fills(mesh: Any, volume: float, within: float = 1e-6) -> None:
    """Faces belong to one or two cells, all of whose volumes add up, and the field is linear."""
    triangles = Counter(tuple(sorted(np.delete(tet, n).tolist())) for tet in mesh.tets for n in range(4))
    assert max(triangles.values()) <= 2
    outer = [face for face, used in triangles.items() if used == 1]
    edges = Counter(pair for a, b, c in outer for pair in ((a, b), (a, c), (b, c)))
    assert set(edges.values()) == {2}
    volumes = volume_of_tets(mesh.points, mesh.tets)
    assert (volumes > 1e-9).all() and volumes.sum() == pytest.approx(volume, rel=within)
    np.testing.assert_allclose(mesh.values, mesh.points @ (1.0, 2.0, 4.0), atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(*[st.integers(1, 3)] * 3),
    letters=st.sampled_from(["hp/\\", "h", "hhh/"]),
    new=st.booleans(),
)
def test_polyhedra_among_other_cells_fill_the_box_and_meet_face_to_face(seed, shape, letters, new, tmp_path_factory):
    """Any cell may be listed by its faces, in any turn and either way around; others are split where they have to."""
    rng = np.random.default_rng(seed)
    points, cells = block(rng.choice(list(letters), size=shape), rng)
    by_faces = rng.random(len(cells)) < 0.5
    by_faces[0] = True
    faces = []
    for (kind, ids), poly in zip(cells, by_faces, strict=True):
        some = [np.roll(face, rng.integers(4)).tolist() for face in faces_of(kind, ids)]
        faces.append([face[:: rng.choice((1, -1))] for face in some] if poly else None)
    cells = [(POLYHEDRON if poly else kind, ids) for (kind, ids), poly in zip(cells, by_faces, strict=True)]
    path = write(tmp_path_factory.mktemp("poly") / "a.vtu", listed(points, cells, faces, new=new))
    mesh = read(path)
    if not len(mesh.hexes):
        assert_fills(mesh, float(np.prod(shape)))
    else:
        filled = volume_of_tets(mesh.points, mesh.tets).sum() + len(mesh.hexes)
        assert filled == pytest.approx(np.prod(shape))


@pytest.mark.parametrize("new", [False, True])
def test_an_octahedron_becomes_eight_tetrahedra(new, tmp_path):
    """A warning counts the cells that were split."""
    mesh = read(octahedron(tmp_path, SIDES, new=new))
    assert len(mesh.tets) == 8 and mesh.points[6].tolist() == [0, 0, 0]
    assert mesh.warnings == ("1 polyhedra were split into tetrahedra around their centres",)
    assert_fills(mesh, 4 / 3)


@pytest.mark.parametrize("which", [range(8), (3,)])
def test_faces_listed_inside_out_are_turned_with_a_warning(which, tmp_path):
    """All of a cell's, or one among them; the first cell is named."""
    faces = [face[::-1] if n in which else face for n, face in enumerate(SIDES)]
    mesh = read(octahedron(tmp_path, faces))
    assert_fills(mesh, 4 / 3)
    expected = "1 polyhedra list faces inside out, the first is 0; their faces were turned"
    assert expected in mesh.warnings


@pytest.mark.parametrize(
    "faces, message",
    [
        (SIDES[:-1], "polyhedron 0 is not closed: 1 of its faces meet between points"),
        ([*SIDES, SIDES[0]], "polyhedron 0 is not closed: 3 of its faces meet between points"),
        (SIDES[:3], "polyhedron 0 has fewer than 4 faces"),
        ([*SIDES[:-1], [0, 3]], "polyhedron 0 has a"),
        ([*SIDES[:-1], [0, 3, 99]], "one of its polyhedra names point 99, but there are 6"),
        ([*SIDES[:-1], [0, 3, -1]], "one of its polyhedra names point -1, but there are 6"),
    ],
)
@pytest.mark.parametrize("new", [False, True])
def test_faces_that_are_wrong_are_refused_with_the_first_cell(faces, message, new, tmp_path):
    """Open ones, doubled ones, too few, too short, and points that are not there."""
    with pytest.raises(InputError) as caught:
        read(octahedron(tmp_path, faces, new=new))
    assert str(caught.value).startswith(f"{tmp_path / 'a.vtu'}: ") and message in str(caught.value)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"faces": lambda a: [8, 99, *a[2:]]}, "polyhedron 0 has a face with a wrong count of points"),
        ({"faces": lambda a: [7, *a[1:]]}, "polyhedron 0 lists more or fewer faces than it says"),
        ({"faces": lambda a: [-1, *a[1:]]}, "polyhedron 0 has a wrong count of faces"),
        ({"faces": lambda a: [9, *a[1:]]}, "polyhedron 0 has a wrong count of faces"),
        ({"faces": lambda a: [2**40, *a[1:]]}, "polyhedron 0 has a wrong count of faces"),
        ({"faces": lambda a: [2**62 + 1, *a[1:]]}, "polyhedron 0 has a wrong count of faces"),
        ({"faceoffsets": lambda a: [99]}, "polyhedron 0 has no faces"),
        ({"faceoffsets": lambda a: [-1]}, "polyhedron 0 has no faces"),
        ({"faceoffsets": lambda a: [*a, *a]}, "array 'faceoffsets' is for 2 cells, there are 1"),
        ({"faces": None}, "lists no faces for its 1 polyhedra"),
    ],
)
def test_counts_of_the_older_listing_that_are_wrong_are_refused(change, message, tmp_path):
    """Before anything is reserved for them."""
    mesh = listed(OCTAHEDRON, [(POLYHEDRON, list(range(6)))], [SIDES], new=False)
    ((name, changed),) = change.items()
    arrays = dict(mesh.cell_arrays)
    old = arrays.pop(name)
    if changed is not None:
        arrays[name] = np.array(changed(old.tolist()))
    with pytest.raises(InputError, match=message):
        read(write(tmp_path / "a.vtu", Mesh(mesh.points, mesh.cells, mesh.point_fields, {}, arrays)))


def test_a_cell_of_many_faces_is_read_face_by_face(tmp_path):
    """More than are read side by side: a fan of triangles around two poles."""
    around = 200
    turn = 2 * np.pi * np.arange(around) / around
    points = np.concatenate(([(0, 0, 1), (0, 0, -1)], np.column_stack((np.cos(turn), np.sin(turn), 0 * turn))))
    ring = [(2 + n, 2 + (n + 1) % around) for n in range(around)]
    faces = [face for a, b in ring for face in ([0, a, b], [1, b, a])]
    for new in (False, True):
        assert_fills(read(octahedron(tmp_path, faces, points, new=new)), around / 3 * np.sin(2 * np.pi / around))
    with pytest.raises(InputError, match="wrong count of points"):
        read(octahedron(tmp_path, [[0, 2, 3, 1, 4], *faces[1:-1], [1, 2]], points))


def test_a_polyhedron_whose_centre_does_not_see_its_faces_is_refused_by_number(tmp_path):
    """A deep notch: the mean of its points lies outside."""
    outline = np.array([(0, 0), (9, 0), (9, 9), (8, 9), (8, 1), (0, 1)], float)
    points = np.concatenate([np.column_stack((outline, np.full(6, z))) for z in (0.0, 1.0)])
    sides = [[n, (n + 1) % 6, (n + 1) % 6 + 6, n + 6] for n in range(6)]
    with pytest.raises(IsocoreError, match="polyhedron 0 cannot be split at its centre"):
        read(octahedron(tmp_path, [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *sides], points))


@pytest.mark.parametrize("number, sides", [(15, 5), (16, 6)])
def test_prisms_are_split_at_their_centres(number, sides, tmp_path):
    """Two stacked on each other share their face; a regular prism's volume is known."""
    turn = 2 * np.pi * np.arange(sides) / sides
    points = np.concatenate([np.column_stack((np.cos(turn), np.sin(turn), 0 * turn + z)) for z in range(3)])
    cells = [(number, list(range(n * sides, (n + 2) * sides))) for n in range(2)]
    mesh = read(write(tmp_path / "a.vtu", Mesh(points, cells, {"u": points @ (1.0, 2.0, 4.0)})))
    assert_fills(mesh, sides * np.sin(2 * np.pi / sides))
    assert len(mesh.tets) == 2 * (2 * (sides - 2) + 2 * sides) and len(PRISMS[number]) == sides + 2


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), letters=st.sampled_from(["h", "hp/\\"]))
def test_convex_point_sets_are_split_like_the_cells_they_are(seed, letters, tmp_path_factory):
    """Their points stand in any order; faces are found, and points in one plane make one face."""
    rng = np.random.default_rng(seed)
    points, cells = block(rng.choice(list(letters), size=(2, 2, 2)), rng)
    sets = [(41, rng.permutation(ids).tolist()) for _, ids in cells]
    mesh = read(write(tmp_path_factory.mktemp("sets") / "a.vtu", Mesh(points, sets, {"u": points @ (1.0, 2.0, 4.0)})))
    assert_fills(mesh, 8)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(4, 20))
@example(seed=358812, count=20)  # four of them lie nearly in one plane
def test_a_convex_set_of_points_on_a_sphere_is_filled(seed, count, tmp_path_factory):
    """All points become corners of triangles: 2 n - 4 of them."""
    points = np.random.default_rng(seed).normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    path = tmp_path_factory.mktemp("sphere") / "a.vtu"
    mesh = read(write(path, Mesh(points, [(41, list(range(count)))], {"u": points @ (1.0, 2.0, 4.0)})))
    assert len(mesh.tets) == 2 * count - 4
    np.testing.assert_allclose(mesh.values, mesh.points @ (1.0, 2.0, 4.0), atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), corners=st.integers(3, 8), noise=st.sampled_from([1e-8, 1e-7, 3e-7]))
def test_a_convex_set_whose_faces_are_flat_but_for_rounding_is_filled(seed, corners, noise, tmp_path_factory):
    """Of four points that are nearly in one plane, three may be near enough to the fourth, and three others not."""
    rng = np.random.default_rng(seed)
    turn = 2 * np.pi * (np.arange(corners) + rng.uniform(0, 0.7, corners)) / corners
    ring = np.column_stack((np.cos(turn), np.sin(turn), 0 * turn))
    turned, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    points = np.concatenate((ring, np.add(ring, (0, 0, 1)))) @ turned
    points += noise * rng.normal(size=points.shape)
    cells = [(41, rng.permutation(2 * corners).tolist())]
    path = tmp_path_factory.mktemp("nearly") / "a.vtu"
    mesh = read(write(path, Mesh(points, cells, {"u": points @ (1.0, 2.0, 4.0)})))
    assert_fills(mesh, 0.5 * np.sin(np.diff(turn, append=turn[:1] + 2 * np.pi)).sum(), within=1e-4)


@pytest.mark.parametrize(
    "points, message",
    [(OCTAHEDRON[:4], "is flat"), (OCTAHEDRON[:3], "has 3 points"), (np.zeros((40, 3)), "has 40 points")],
)
def test_convex_sets_that_enclose_nothing_are_refused_by_number(points, message, tmp_path):
    """Flat ones, too few points, and more than are tried."""
    cells = [(10, [0, 1, 2, 2]), (41, list(range(len(points))))]
    with pytest.raises(IsocoreError, match=f"convex point set 1 {message}"):
        read(write(tmp_path / "a.vtu", Mesh(points, cells, {"u": np.zeros(len(points))})))


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases lie beside the repository, not in it")
def test_the_file_users_met_gives_a_closed_surface_near_its_radius():
    """A sphere of radius 0.6 in a coarse grid of polyhedra."""
    surface = extract(read(CASES / "poly.vtu"), 0.6, backend="mc")
    assert measure(surface).watertight
    assert np.abs(np.linalg.norm(surface.vertices, axis=1) - 0.6).max() < 0.15
