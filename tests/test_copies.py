"""Coarser copies of surfaces, to look at."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
import shapes

from isocore import _kernels, extract
from isocore.copies import copied
from isocore.measurements import measure
from isocore.surface import Surface

Floats = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int32]


def sheet(n: int, height: float) -> tuple[Floats, Triangles]:
    """A square of n by n points, flat, from 0 to 1."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    points = np.column_stack((x.ravel(), y.ravel(), np.full(n * n, height)))
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    lower = np.column_stack((corner, corner + n, corner + n + 1))
    upper = np.column_stack((corner, corner + n + 1, corner + 1))
    return points, np.concatenate((lower, upper)).astype(np.int32)


def together(*meshes: tuple[Floats, Triangles]) -> tuple[Floats, Triangles]:
    """Several meshes as one."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    triangles = [mesh[1] + start for mesh, start in zip(meshes, starts, strict=False)]
    return np.concatenate([mesh[0] for mesh in meshes]), np.concatenate(triangles).astype(np.int32)


def octahedron(centre: tuple[float, float, float], radius: float) -> tuple[Floats, Triangles]:
    points = np.array(centre) + radius * np.concatenate((np.eye(3), -np.eye(3)))
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    return points, np.array(faces, np.int32)


def clustered(mesh: tuple[npt.NDArray[np.float64], Triangles], most: int) -> Surface:
    kept, triangles = _kernels.cluster(*mesh, most)
    assert np.all(np.diff(kept) > 0) and len(np.unique(triangles)) == len(kept) and len(triangles) <= most
    return Surface(mesh[0][kept], triangles)


@pytest.mark.parametrize("most", [300, 1000, 5000])
@pytest.mark.parametrize("shape", shapes.padded_shapes(), ids=lambda shape: str(shape.name))
def test_a_closed_surface_stays_closed(shape: shapes.Shape, most: int) -> None:
    """With about as many triangles as asked for, each of them near the surface, and no side that has but one."""
    surface = extract(shape.volume, shape.isovalue, backend="mc")
    before = measure(surface)
    coarse = clustered((surface.vertices.astype(np.float64), surface.triangles), most)
    form = measure(coarse)
    assert form.boundary_edges == 0 and form.misoriented_edges == 0
    assert form.components == before.components
    if before.triangles > most:
        assert form.triangles > 0.6 * most
    assert form.area == pytest.approx(before.area, rel=0.15)


def test_noise_stays_closed() -> None:
    """Where every cell holds many sheets: each side has as many triangles one way round as the other."""
    surface = extract(shapes.integer_noise(24, 9), 4.5, backend="mc", cap=True)
    assert measure(surface).watertight
    kept, triangles = _kernels.cluster(surface.vertices, surface.triangles, len(surface.triangles) // 8)
    ways: dict[tuple[int, int], int] = {}
    for a, b in np.concatenate((triangles[:, :2], triangles[:, 1:], triangles[:, [2, 0]])).tolist():
        ways[min(a, b), max(a, b)] = ways.get((min(a, b), max(a, b)), 0) + (1 if a < b else -1)
    assert len(kept) > 100 and set(ways.values()) == {0}


def test_sheets_side_by_side_stay_apart() -> None:
    """Also where they are closer than a cell is wide: in every column of cells there is a vertex of each."""
    coarse = clustered(together(sheet(60, 0.0), sheet(60, 0.001)), 400)
    heights, counts = np.unique(coarse.vertices[:, 2], return_counts=True)
    assert heights.tolist() == [0.0, 0.001] and counts[0] == counts[1]
    assert np.all(np.ptp(coarse.vertices[coarse.triangles][:, :, 2], axis=1) == 0)
    assert measure(coarse).components == 2


def test_a_border_stays_straight() -> None:
    """What stands for a cell at the border lies on it, so that an edge of the volume is not frayed."""
    coarse = clustered(sheet(97, 0.5), 300)
    low, high = coarse.vertices[:, :2].min(axis=0), coarse.vertices[:, :2].max(axis=0)
    assert low.tolist() == [0, 0] and high.tolist() == [1, 1]
    sides = np.concatenate([coarse.triangles[:, [n, (n + 1) % 3]] for n in range(3)])
    _, first, counts = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    on_border = coarse.vertices[np.unique(sides[first[counts == 1]])][:, :2]
    assert np.all(np.any((on_border == 0) | (on_border == 1), axis=1))


def test_small_pieces_stay_where_there_is_room() -> None:
    """As they are; where there are too many of a size none of that size do."""
    places = [(x / 10, y / 10, 0.5) for x in range(10) for y in range(10)]
    specks = [octahedron(place, 0.002) for place in places]
    few = clustered(together(sheet(60, 0.0), *specks[:3]), 500)
    assert measure(few).components == 4
    assert np.count_nonzero(few.vertices[:, 2] > 0.1) == 18
    many = clustered(together(sheet(60, 0.0), *specks), 500)
    assert np.count_nonzero(many.vertices[:, 2] > 0.1) < 12  # of one or two that lie across the sides of cells


@pytest.mark.parametrize("most", [1, 2, 7])
def test_hardly_any_triangles(most: int) -> None:
    """No more than so many, if that is none."""
    clustered(sheet(30, 0.0), most)


def test_a_triangle_of_no_vertex_is_refused() -> None:
    with pytest.raises(ValueError, match="vertex that does not exist"):
        _kernels.cluster(np.zeros((3, 3)), np.array([[0, 1, 3]], np.int32), 1)


def test_a_coarser_copy_takes_its_normals_from_its_triangles() -> None:
    """Which the page does; a copy that is whole has the surface's own."""
    shape = shapes.sphere(24)
    surface = extract(shape.volume, shape.isovalue, backend="mc", normals=True)
    whole, coarse = copied(surface, 10**6), copied(surface, 500)
    assert whole is not None and whole.normals is not None and whole.count == len(surface.triangles)
    assert coarse is not None and coarse.normals is None and 250 < coarse.count <= 500
