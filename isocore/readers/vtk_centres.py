"""Split cells that are known by their faces into tetrahedra around their centre.

Every face is cut into triangles from its lowest point number, so two cells that share it cut it alike, and so does
cell_splitting.py the faces of its cells. The centre is the mean of the corners of all faces, each as often as it is
named; so is its value, which keeps a linear field linear.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, InputError
from isocore.readers.cell_splitting import mixed
from isocore.readers.vtk_faces import Faces, spread

#: Triangles that turn away from the centre may take this part of a cell's volume: faces are flat but for rounding.
_AWAY = 1e-3
_CELLS = 1 << 14  # split at a time: their numbers stay in the cache


@dataclass(frozen=True, slots=True)
class SplitFaces:
    """What cells became. tets: (t, 4), the centre first. centres: (p, 3), one of each cell; values: (p,).

    quads: (q, 4) their faces of four corners, in turn. turned: cells that list a face inside out; first: one of them.
    """

    tets: npt.NDArray[np.int32]
    centres: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    quads: npt.NDArray[np.int32]
    turned: int = 0
    first: int = -1


def split_at_centres(
    path: str, faces: Faces, points: npt.NDArray[np.float64], values: npt.NDArray[Any], first_centre: int
) -> SplitFaces:
    """The cells as tetrahedra; the centre of the first of them is to become the point `first_centre`.

    Raises InputError, which names the cell, where faces do not close, FieldError where one turns away from the centre.
    """
    first_face = np.concatenate(([0], np.cumsum(faces.counts)))
    first_corner = np.concatenate(([0], np.cumsum(faces.sizes)))
    parts = []
    for first in range(0, len(faces.counts), _CELLS):
        cells = slice(first, first + _CELLS)
        face_range = slice(first_face[first], first_face[min(first + _CELLS, len(faces.counts))])
        part = Faces(
            faces.name,
            faces.numbers[cells],
            faces.counts[cells],
            faces.sizes[face_range],
            faces.corners[first_corner[face_range.start] : first_corner[face_range.stop]],
        )
        parts.append(_split(path, part, points, values, first_centre + first))
    turned = [part for part in parts if part.turned]
    return SplitFaces(
        np.concatenate([part.tets for part in parts]),
        np.concatenate([part.centres for part in parts]),
        np.concatenate([part.values for part in parts]),
        np.concatenate([part.quads for part in parts]),
        sum(part.turned for part in turned),
        turned[0].first if turned else -1,
    )


def _split(
    path: str, given: Faces, points: npt.NDArray[np.float64], values: npt.NDArray[Any], first_centre: int
) -> SplitFaces:
    faces = _without_repeats(given)
    cell_of_face = np.repeat(np.arange(len(faces.counts)), faces.counts)
    cell_of_corner = np.repeat(cell_of_face, faces.sizes)
    named = np.bincount(cell_of_corner, minlength=len(faces.counts))
    if (gone := named == 0).any():
        raise InputError(f"{path}: {_cell(faces, int(np.argmax(gone)))} has no faces left; write it again")

    def mean(numbers: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        return np.asarray(np.bincount(cell_of_corner, numbers, len(named)) / named)

    centres = np.stack([mean(points[faces.corners, axis]) for axis in range(3)], axis=1)
    with np.errstate(invalid="ignore"):
        centre_values = mean(values[faces.corners]).astype(values.dtype)
    triangles, face_of = _fans(faces)
    volumes = _volumes(points, centres[cell_of_face[face_of]], triangles)
    of_face = np.bincount(face_of, volumes, len(faces.sizes))
    inward = of_face < 0
    _check(path, faces, cell_of_face, (face_of, volumes), inward)
    tets = np.column_stack((first_centre + cell_of_face[face_of], triangles)).astype(np.int32)
    quads = faces.corners[_starts(faces.sizes)[faces.sizes == 4][:, None] + np.arange(4)]
    turned = np.bincount(cell_of_face, inward, len(named)) > 0
    first = int(faces.numbers[np.argmax(turned)]) if turned.any() else -1
    return SplitFaces(tets, centres, centre_values, quads, int(np.count_nonzero(turned)), first)


def _without_repeats(faces: Faces) -> Faces:
    """Faces without corners that repeat the one before them, which joining points may have left."""
    repeats = faces.corners == faces.corners[_following(faces.sizes)]
    if not repeats.any():
        return faces
    face_of = np.repeat(np.arange(len(faces.sizes)), faces.sizes)
    sizes = faces.sizes - np.bincount(face_of, repeats, len(faces.sizes)).astype(np.int64)
    kept = sizes > 2
    cell_of_face = np.repeat(np.arange(len(faces.counts)), faces.counts)
    counts = np.bincount(cell_of_face[kept], minlength=len(faces.counts))
    corners = faces.corners[~repeats & kept[face_of]]
    return Faces(faces.name, faces.numbers, counts, sizes[kept], corners)


def _starts(sizes: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return np.asarray(np.cumsum(sizes) - sizes)


def _following(sizes: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """For each corner the place of the next one around its face."""
    following = np.arange(1, int(sizes.sum()) + 1)
    starts = _starts(sizes)
    following[(starts + sizes - 1)[sizes > 0]] = starts[sizes > 0]
    return following


def _fans(faces: Faces) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.intp]]:
    """(t, 3) triangles from the lowest corner of each face, and (t,) the face of each."""
    starts, sizes = _starts(faces.sizes), faces.sizes
    lowest = np.repeat(np.minimum.reduceat(faces.corners, starts), sizes)
    place = np.where(faces.corners == lowest, np.arange(len(faces.corners)), len(faces.corners))
    apex = np.minimum.reduceat(place, starts) - starts
    face_of = np.repeat(np.arange(len(sizes)), sizes - 2)
    step = spread(np.ones(len(sizes), np.int64), sizes - 2)
    start, size, top = starts[face_of], sizes[face_of], apex[face_of]
    triangles = [faces.corners[start + (top + step * (n > 0) + (n == 2)) % size] for n in range(3)]
    return np.stack(triangles, axis=1), face_of


def _volumes(
    points: npt.NDArray[np.float64], apex: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32]
) -> npt.NDArray[np.float64]:
    """(t,) six times the volume between each triangle and its apex, above 0 where it turns outward."""
    a, b, c = (points[triangles[:, n]] - apex for n in range(3))
    return np.asarray(np.einsum("ij,ij->i", a, np.cross(b, c)))


def _check(
    path: str,
    faces: Faces,
    cell_of_face: npt.NDArray[np.intp],
    triangles: tuple[npt.NDArray[np.intp], npt.NDArray[np.float64]],
    inward: npt.NDArray[np.bool_],
) -> None:
    """Do the faces of every cell close, and does each, turned outward, look away from the centre?

    Directed edges get scrambled numbers that cancel between an edge and its reverse. Once all faces are turned, their
    sum over a cell is 0 only where every edge has two faces (but for one chance in 2^64): they close.
    """
    ahead = faces.corners[_following(faces.sizes)]
    low, high = np.minimum(faces.corners, ahead), np.maximum(faces.corners, ahead)
    number = mixed(mixed(low) + high.astype(np.uint64))
    flipped = (faces.corners > ahead) ^ np.repeat(inward, faces.sizes)
    signed = np.where(flipped, np.uint64(0) - number, number)
    starts = _starts(np.bincount(np.repeat(cell_of_face, faces.sizes), minlength=len(faces.counts)))
    open_cells = np.add.reduceat(signed, starts) != 0
    face_of, volumes = triangles
    away = np.bincount(cell_of_face[face_of], np.where(inward[face_of] ^ (volumes < 0), np.abs(volumes), 0))
    whole = np.bincount(cell_of_face[face_of], np.abs(volumes))
    wrong = open_cells | (away > _AWAY * whole)
    if not wrong.any():
        return
    cell = int(np.argmax(wrong))
    mine = slice(*np.searchsorted(np.repeat(cell_of_face, faces.sizes), (cell, cell + 1)).tolist())
    edges = Counter(zip(low[mine].tolist(), high[mine].tolist(), strict=True))
    for (a, b), count in edges.items():
        if count != 2:
            raise InputError(
                f"{path}: {_cell(faces, cell)} is not closed: {count} of its faces meet between points {a:,} and {b:,};"
                " write it again"
            )
    raise FieldError(
        f"{path}: {_cell(faces, cell)} cannot be split at its centre, which does not see all of its faces;"
        " split it into tetrahedra"
    )


def _cell(faces: Faces, cell: int) -> str:
    singular = {"polyhedra": "polyhedron"}.get(faces.name, faces.name.removesuffix("s"))
    return f"{singular} {faces.numbers[cell]:,}"
