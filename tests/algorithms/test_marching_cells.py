"""Marching tetrahedra and marching cubes on hexahedra: closed, oriented, on the edges, in any cell order."""

from __future__ import annotations

import meshes
import numpy as np
import numpy.typing as npt
import pytest

from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.cell_mesh import CellMesh

KINDS = pytest.mark.parametrize("hexes", [False, True], ids=["tets", "hexes"])


Triangulated = tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]


def march(mesh: CellMesh, isovalue: float, threads: int = 1) -> Triangulated:
    vertices, triangles, *_ = _kernels.marching_cells(
        mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue, threads
    )
    return vertices, triangles


def directed_edges(triangles: npt.NDArray[np.int32]) -> list[tuple[int, int]]:
    return [(int(t[n]), int(t[(n + 1) % 3])) for t in triangles for n in range(3)]


def enclosed_volume(vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32]) -> float:
    a, b, c = (vertices[triangles[:, n]] for n in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def padded_noise(seed: int, *, hexes: bool) -> CellMesh:
    """Levels 0..7 inside a 6^3 box, below all of them on its border."""
    random = np.random.default_rng(seed)
    mesh = meshes.mesh_of(np.ones((6, 6, 6), bool), hexes=hexes)
    border = ((mesh.points == 0) | (mesh.points == 6)).any(axis=1)
    values = np.where(border, -1, random.integers(0, 8, len(mesh.points)))
    return meshes.shuffled(meshes.with_values(mesh, values), random)


@KINDS
@pytest.mark.parametrize("seed", range(4))
def test_noise_with_the_isovalue_among_its_levels_gives_a_closed_manifold(seed: int, hexes: bool) -> None:
    """Every directed edge occurs once, and so does its reverse; no vertex is unused."""
    vertices, triangles = march(padded_noise(seed, hexes=hexes), 4.0)
    edges = directed_edges(triangles)
    assert len(set(edges)) == len(edges) > 0
    assert {(b, a) for a, b in edges} == set(edges)
    assert len(np.unique(triangles)) == len(vertices)


@KINDS
def test_triangles_turn_counter_clockwise_seen_from_outside(hexes: bool) -> None:
    """A ball of high values has a positive volume, near the true one, with all tetrahedra inside out."""
    mesh = meshes.mesh_of(np.ones((12, 12, 12), bool), hexes=hexes)
    values = 16 - ((mesh.points - 6.1) ** 2).sum(axis=1)
    mesh = meshes.with_values(mesh, values)
    mesh = CellMesh(mesh.points, mesh.tets[:, [1, 0, 2, 3]].copy(), mesh.hexes, mesh.values)
    assert enclosed_volume(*march(mesh, 0.0)) == pytest.approx(4 / 3 * np.pi * 64, rel=0.06)


@KINDS
def test_the_number_of_threads_does_not_change_a_byte(hexes: bool) -> None:
    """One, two and four threads give the same arrays."""
    mesh = meshes.mesh_of(np.ones((24, 24, 24), bool), hexes=hexes)
    mesh = meshes.with_values(mesh, np.random.default_rng(1).random(len(mesh.points)))
    vertices, triangles = march(mesh, 0.4)
    for threads in (2, 4):
        again_vertices, again_triangles = march(mesh, 0.4, threads)
        assert again_vertices.tobytes() == vertices.tobytes()
        assert again_triangles.tobytes() == triangles.tobytes()


def test_vertices_of_tetrahedra_lie_on_crossed_edges_away_from_their_ends() -> None:
    """With the isovalue equal to samples, each vertex stays 2^-10 of its edge away from them."""
    mesh = meshes.mesh_of(np.ones((2, 2, 2), bool))
    mesh = meshes.with_values(mesh, np.arange(27) % 3)
    vertices, _ = march(mesh, 1.0)
    distance = np.abs(vertices[:, None] - mesh.points[None]).max(axis=2).min(axis=1)
    assert distance.min() == pytest.approx(1 / 1024)


def test_an_edge_with_a_non_finite_end_is_crossed_in_its_middle() -> None:
    """NaN and both infinities are outside."""
    mesh = meshes.mesh_of(np.ones((1, 1, 1), bool), hexes=True)
    for outside in (np.nan, np.inf, -np.inf):
        values = np.full(8, outside)
        values[np.argmin(mesh.points.sum(axis=1))] = 7.0
        vertices, triangles = march(meshes.with_values(mesh, values), 1.0)
        assert len(triangles) == 1
        assert np.sort(vertices.sum(axis=1)).tolist() == [0.5, 0.5, 0.5]


def test_cells_that_name_a_point_twice_draw_nothing_degenerate() -> None:
    """A wedge written as a hexahedron, and a flat tetrahedron, give triangles of three different vertices."""
    mesh = meshes.mesh_of(np.ones((1, 1, 1), bool), hexes=True)
    wedge = mesh.hexes.copy()
    wedge[0, 3], wedge[0, 7] = wedge[0, 2], wedge[0, 6]
    flat = np.array([[0, 0, 1, 2]], np.int32)
    random = np.random.default_rng(2)
    for _ in range(50):
        _, triangles = march(CellMesh(mesh.points, flat, wedge, random.random(8)), 0.5)
        assert all(len({*triangle}) == 3 for triangle in triangles.tolist())


def test_a_field_without_the_isovalue_gives_an_empty_surface() -> None:
    """Above, below and at NaN there is nothing; arrays keep their shape."""
    mesh = meshes.mesh_of(np.ones((2, 2, 2), bool))
    for isovalue in (-1.0, 1.0, np.nan):
        vertices, triangles = march(mesh, isovalue)
        assert vertices.shape == (0, 3)
        assert triangles.shape == (0, 3)


@pytest.mark.parametrize("backend", ["mc", "thinning"])
@pytest.mark.parametrize(("away", "dtype"), [(0.0, np.float32), (1e6, np.float64)])
def test_coordinates_keep_a_cell_apart(backend: str, away: float, dtype: type) -> None:
    """float32 near the origin; float64 where the steps of float32 come near the size of a cell."""
    mesh = meshes.mesh_of(np.ones((3, 3, 3), bool))
    far = CellMesh(mesh.points + np.array([away, 0, 0]), mesh.tets, mesh.hexes, mesh.points.sum(axis=1))
    vertices = prepare(far, backend, Options())(4.3).surface.vertices
    assert vertices.dtype == dtype
    assert np.allclose(vertices.sum(axis=1) - away, 4.3, atol=1e-6, rtol=0)


@KINDS
def test_single_precision_only_rounds(hexes: bool) -> None:
    """The same triangles, and vertices that differ by rounding."""
    mesh = meshes.mesh_of(np.ones((3, 4, 3), bool), hexes=hexes)
    mesh = meshes.with_values(mesh, np.random.default_rng(3).random(len(mesh.points)))
    exact = _kernels.marching_cells(mesh.points, mesh.tets, mesh.hexes, mesh.values, 0.5)
    single = _kernels.marching_cells(mesh.points, mesh.tets, mesh.hexes, mesh.values, 0.5, single=True)
    assert single[0].dtype == np.float32
    assert np.array_equal(exact[1], single[1])
    assert np.allclose(exact[0], single[0], atol=1e-6, rtol=0)
