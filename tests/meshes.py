"""Small meshes with known topology, and the fields that test them.

A body is a set of unit boxes; each becomes six tetrahedra (cut alike, so that they meet face to face) or one
hexahedron. What a body's name promises (holes, voids, contacts) is counted in BODIES.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh

Boxes = npt.NDArray[np.bool_]
NO_TETS = np.zeros((0, 4), np.int32)
NO_HEXES = np.zeros((0, 8), np.int32)
HEX_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))


def _solid(*shape: int) -> Boxes:
    return np.ones(shape, bool)


def _without(shape: tuple[int, int, int], *holes: tuple[slice, slice, slice]) -> Boxes:
    boxes = _solid(*shape)
    for hole in holes:
        boxes[hole] = False
    return boxes


def _only(shape: tuple[int, int, int], *kept: tuple[int, int, int]) -> Boxes:
    boxes = np.zeros(shape, bool)
    for box in kept:
        boxes[box] = True
    return boxes


_inner = slice(1, -1)
_all = slice(None)

#: name -> (boxes, bodies, through-holes, voids). Parts that meet at an edge or a vertex are bodies apart.
BODIES: dict[str, tuple[Boxes, int, int, int]] = {
    "box": (_solid(3, 4, 3), 1, 0, 0),
    "one box": (_solid(1, 1, 1), 1, 0, 0),
    "sheet": (_solid(4, 4, 1), 1, 0, 0),
    "rod": (_solid(6, 1, 1), 1, 0, 0),
    "torus": (_without((3, 3, 2), (_inner, _inner, _all)), 1, 1, 0),
    "double torus": (_without((5, 3, 1), (slice(1, 2), _inner, _all), (slice(3, 4), _inner, _all)), 1, 2, 0),
    "thin shell": (_without((3, 3, 3), (_inner, _inner, _inner)), 1, 0, 1),
    "thick shell": (_without((5, 5, 5), (slice(2, 3),) * 3), 1, 0, 1),
    "wide shell": (_without((4, 5, 4), (_inner, _inner, _inner)), 1, 0, 1),
    "two voids": (_without((5, 3, 3), (slice(1, 2), _inner, _inner), (slice(3, 4), _inner, _inner)), 1, 0, 2),
    "nested shells": (
        _without((7, 7, 7), (_inner,) * 3) | np.pad(_without((3, 3, 3), (_inner,) * 3), 2),
        2,
        0,
        2,
    ),
    "shell around a body": (_without((5, 5, 5), (_inner,) * 3) | np.pad(_solid(1, 1, 1), 2), 2, 0, 1),
    "void and hole": (
        _without((5, 5, 3), (slice(1, 2), slice(1, 2), _inner), (slice(3, 4), slice(3, 4), _all)),
        1,
        1,
        1,
    ),
    "torus void": (
        _without((5, 5, 3), (_inner, _inner, _inner)) | np.pad(_solid(1, 1, 1), ((2, 2), (2, 2), (1, 1))),
        1,
        1,
        1,
    ),
    "two bodies": (_without((5, 2, 2), (slice(2, 3), _all, _all)), 2, 0, 0),
    "edge contact": (_only((2, 2, 1), (0, 0, 0), (1, 1, 0)), 2, 0, 0),
    "vertex contact": (_only((2, 2, 2), (0, 0, 0), (1, 1, 1)), 2, 0, 0),
    "ring with an edge contact": (
        _only((3, 3, 1), (0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (2, 2, 0), (1, 2, 0), (0, 1, 0)),
        1,
        0,
        0,
    ),
}


def mesh_of(boxes: Boxes, *, hexes: bool = False) -> CellMesh:
    """The boxes as tetrahedra or hexahedra; the values are zero until `with_values`."""
    shape = np.array(boxes.shape)
    ids = np.arange(np.prod(shape + 1)).reshape(shape + 1)
    corners = np.argwhere(boxes)

    def at(offset: tuple[int, int, int]) -> npt.NDArray[np.int64]:
        i, j, k = (corners + np.array(offset)).T
        return ids[i, j, k]

    if hexes:
        cells = np.stack([at(offset) for offset in HEX_CORNERS], axis=1)
    else:
        paths = []
        for order in permutations(range(3)):
            path = [np.zeros(3, int)]
            for axis in order:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            paths.append(np.stack([at(tuple(p)) for p in path], axis=1))
        cells = np.stack(paths, axis=1).reshape(-1, 4)
    used, packed = np.unique(cells, return_inverse=True)
    points = np.argwhere(np.ones(shape + 1, bool))[used].astype(np.float64)
    packed = packed.reshape(cells.shape).astype(np.int32)
    tets, cubes = (NO_TETS, packed) if hexes else (packed, NO_HEXES)
    return CellMesh(points, tets, cubes, np.zeros(len(points)))


def with_values(mesh: CellMesh, values: npt.ArrayLike) -> CellMesh:
    """The same mesh with another field."""
    array = np.asarray(values)
    array = array if array.dtype == np.float32 else array.astype(np.float64)
    return CellMesh(mesh.points, mesh.tets, mesh.hexes, array.copy())


def shuffled(mesh: CellMesh, random: np.random.Generator) -> CellMesh:
    """The same body: points and cells renumbered, points moved a little, half of the cells inside out."""
    order = random.permutation(len(mesh.points))
    place = np.argsort(order).astype(np.int32)
    tets = place[mesh.tets][random.permutation(len(mesh.tets))]
    hexes = place[mesh.hexes][random.permutation(len(mesh.hexes))]
    turned = random.random(len(tets)) < 0.5
    tets[turned] = tets[turned][:, [1, 0, 2, 3]]
    turned = random.random(len(hexes)) < 0.5
    hexes[turned] = hexes[turned][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    points = mesh.points[order] + random.uniform(-0.1, 0.1, mesh.points.shape)
    return CellMesh(points, tets, hexes, mesh.values[order].copy())


def _noise(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    return random.random(len(mesh.points))


def _levels(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    return random.integers(0, random.integers(3, 9), len(mesh.points)).astype(np.float32)


def _constant(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    return np.full(len(mesh.points), 2.0)


def _one_apart(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    values = np.zeros(len(mesh.points))
    values[random.integers(len(values))] = random.choice([-1.0, 1.0])
    return values


def _plateau(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    smooth = np.sin(mesh.points @ random.normal(size=(3, 3)) + random.uniform(0, 6, 3)).sum(axis=1)
    values = np.clip(np.round(smooth), -1, 1)
    values[random.random(len(values)) < 0.05] = random.integers(-2, 3)
    return values


def _smooth(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    return np.sin(mesh.points @ random.normal(size=(3, 3)) + random.uniform(0, 6, 3)).sum(axis=1)


def _with_gaps(mesh: CellMesh, random: np.random.Generator) -> npt.ArrayLike:
    values = random.integers(0, 5, len(mesh.points)).astype(np.float64)
    values[random.random(len(values)) < 0.1] = random.choice([np.nan, np.inf, -np.inf])
    return values


FIELDS: dict[str, Callable[[CellMesh, np.random.Generator], npt.ArrayLike]] = {
    "noise": _noise,
    "few levels": _levels,
    "constant": _constant,
    "one vertex apart": _one_apart,
    "plateaus": _plateau,
    "smooth": _smooth,
    "not finite": _with_gaps,
}


def isovalues(mesh: CellMesh, limit: int = 200) -> list[float]:
    """Every distinct finite value and every midpoint between two, or `limit` evenly chosen ones of them."""
    distinct = np.unique(mesh.values[np.isfinite(mesh.values)].astype(np.float64))
    both = np.sort(np.concatenate([distinct, (distinct[:-1] + distinct[1:]) / 2]))
    if len(both) > limit:
        both = both[np.linspace(0, len(both) - 1, limit).astype(int)]
    return [float(value) for value in both]
