"""Cells that are known by their faces, and the prisms among them.

vtk_polyhedra.py reads those that are listed face by face, vtk_convex.py finds the faces of convex point sets,
vtk_centres.py splits all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.vtk_cells import CellArrays, narrow
from isocore.readers.vtk_types import FACETED

#: Faces of the prisms, in VTK's order of their points.
PRISMS = {
    15: ((0, 4, 3, 2, 1), (5, 6, 7, 8, 9), *((i, (i + 1) % 5, (i + 1) % 5 + 5, i + 5) for i in range(5))),
    16: ((0, 5, 4, 3, 2, 1), (6, 7, 8, 9, 10, 11), *((i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6) for i in range(6))),
}


@dataclass(frozen=True, slots=True)
class Faces:
    """The faces of some cells, one after the other.

    name: of the cells. numbers: (p,) of the cells in their piece. counts: (p,) faces of each cell.
    sizes: (f,) points of each face. corners: flat, int32, the points in turn around each face, either way.
    """

    name: str
    numbers: npt.NDArray[np.intp]
    counts: npt.NDArray[np.int64]
    sizes: npt.NDArray[np.int64]
    corners: npt.NDArray[np.int32]


def prisms(arrays: CellArrays, number: int, points: int) -> Faces:
    """Pentagonal (15) or hexagonal (16) prisms."""
    numbers = np.arange(len(arrays.types))[arrays.where(number)]
    faces, name = PRISMS[number], FACETED[number]
    nodes = 1 + max(max(face) for face in faces)
    sizes = arrays.starts[numbers + 1] - arrays.starts[numbers]
    if (wrong := sizes != nodes).any():
        raise InputError(
            f"{arrays.path}: one of its {name} has {sizes[wrong][0]:,} points instead of {nodes}; copy it again"
        )
    rows = arrays.connectivity[arrays.starts[numbers][:, None] + np.concatenate([np.array(face) for face in faces])]
    corners = np.empty(rows.shape, np.int32)
    narrow(arrays.path, rows, name, points, corners)
    lengths = np.array([len(face) for face in faces], np.int64)
    return Faces(
        name,
        numbers,
        np.full(len(numbers), len(faces), np.int64),
        np.tile(lengths, len(numbers)),
        corners.ravel(),
    )


def ragged(
    arrays: CellArrays, numbers: npt.NDArray[np.intp], points: int, name: str
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int64]]:
    """(corners, counts) of cells of any number of points, as the connectivity lists them."""
    counts = arrays.starts[numbers + 1] - arrays.starts[numbers]
    rows = arrays.connectivity[spread(arrays.starts[numbers], counts)]
    corners = np.empty(len(rows), np.int32)
    narrow(arrays.path, rows, name, points, corners)
    return corners, counts


def spread(starts: npt.NDArray[np.int64], counts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """start, start + 1, ... of each part, all parts one after the other."""
    first = np.cumsum(counts) - counts
    return np.repeat(starts - first, counts) + np.arange(int(counts.sum()))
