"""The faces of polyhedra as VTK's files list them, in either of two ways, every number checked.

Messages name the first cell that is wrong, counted from 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.vtk_cells import CellArrays, Integers, narrow
from isocore.readers.vtk_faces import Faces, spread
from isocore.readers.vtk_types import FACETED

POLYHEDRON = 42
_TOGETHER = 64  # faces of all cells read side by side; a cell that has more goes on alone


FourArrays = tuple[Integers, Integers, Integers, Integers]


@dataclass(frozen=True, slots=True)
class FaceLists:
    """The arrays of polyhedra as a file has them.

    Until VTK 9.3, one stream for each polyhedron (how many faces; then of each, how many points and which), and where
    it ends, -1 for other cells: `stream`, `stream_ends`. Since then (`faces`): points of all faces and where each ends,
    faces of all polyhedra and where each cell ends.
    """

    stream: Integers | None = None
    stream_ends: Integers | None = None
    faces: FourArrays | None = None


Lists = tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Integers]


def polyhedra(arrays: CellArrays, lists: FaceLists, points: int) -> Faces:
    """The polyhedra that count."""
    numbers = np.arange(len(arrays.types))[arrays.where(POLYHEDRON)]
    for array in (lists.stream, lists.stream_ends, *(lists.faces or ())):
        if array is not None and array.dtype.kind not in "iu":
            raise InputError(f"{arrays.path}: the faces of its polyhedra are no integers; write it again")
    if lists.faces is not None:
        counts, sizes, corners = _listed(arrays, lists.faces, numbers)
    elif lists.stream is not None and lists.stream_ends is not None:
        counts, sizes, corners = _streamed(arrays, lists.stream, lists.stream_ends, numbers)
    else:
        raise InputError(f"{arrays.path}: lists no faces for its {len(numbers):,} polyhedra; write it again")
    _refuse_first(arrays, numbers, counts < 4, "has fewer than 4 faces")
    _refuse_first(arrays, numbers, _any_of(sizes < 3, counts), "has a face of fewer than 3 points")
    checked = np.empty(len(corners), np.int32)
    narrow(arrays.path, corners, FACETED[POLYHEDRON], points, checked)
    return Faces(FACETED[POLYHEDRON], numbers, counts, sizes, checked)


def _listed(
    arrays: CellArrays, lists: FourArrays, numbers: npt.NDArray[np.intp]
) -> Lists:
    """(faces of each cell, points of each face, all points) of VTK 9.4 and later."""
    points, ends, faces, cell_ends = lists
    if len(cell_ends) != len(arrays.types):
        raise _of_another_length(arrays, "polyhedron_offsets", cell_ends)
    starts, stops = _ranges(arrays, "polyhedron_offsets", cell_ends, len(faces))
    counts = stops[numbers] - starts[numbers]
    mine = faces[spread(starts[numbers], counts)].astype(np.int64)
    face_starts, face_stops = _ranges(arrays, "face_offsets", ends, len(points))
    _refuse_first(
        arrays, numbers, _any_of((mine < 0) | (mine >= len(ends)), counts), "names a face that is not there"
    )
    sizes = face_stops[mine] - face_starts[mine]
    if sizes.sum() > 2 * len(points):  # each face lies between two cells
        raise InputError(f"{arrays.path}: its polyhedra share faces among more than two; write it again")
    return counts, sizes, points[spread(face_starts[mine], sizes)]


def _streamed(arrays: CellArrays, stream: Integers, ends: Integers, numbers: npt.NDArray[np.intp]) -> Lists:
    """The same of the stream of earlier files."""
    if len(ends) != len(arrays.types):
        raise _of_another_length(arrays, "faceoffsets", ends)
    every = np.flatnonzero(arrays.types == POLYHEDRON)
    stops = ends.astype(np.int64)
    starts = np.zeros(len(ends), np.int64)
    starts[every[1:]] = stops[every[:-1]]
    starts, stops = starts[numbers], stops[numbers]
    _refuse_first(arrays, numbers, (starts >= stops) | (starts < 0) | (stops > len(stream)), "has no faces")
    counts = stream[starts].astype(np.int64)
    # A face takes four numbers or more, so a count is known to be wrong before anything is reserved for it.
    too_many = counts >= (stops - starts + 3) // 4  # divided, since a product of any number may be out of range
    _refuse_first(arrays, numbers, (counts < 0) | too_many, "has a wrong count of faces")
    first = np.cumsum(counts) - counts
    sizes, at = np.zeros(int(counts.sum()), np.int64), np.zeros(int(counts.sum()), np.int64)
    place, left = starts + 1, np.arange(len(numbers))
    for face in range(min(_TOGETHER, int(counts.max(initial=0)))):
        left = left[counts[left] > face]
        here = place[left]
        bad = here >= stops[left]
        size = stream[np.where(bad, 0, here)].astype(np.int64)
        bad |= (size < 3) | (size >= stops[left] - here)
        _refuse_first(arrays, numbers[left], bad, "has a face with a wrong count of points")
        sizes[first[left] + face], at[first[left] + face] = size, here + 1
        place[left] = here + 1 + size
    for cell in np.flatnonzero(counts > _TOGETHER).tolist():
        faces = slice(int(first[cell]) + _TOGETHER, int(first[cell] + counts[cell]))
        place[cell] = _alone(stream[: int(stops[cell])], int(place[cell]), sizes[faces], at[faces])
        _refuse_first(arrays, numbers, place < 0, "has a face with a wrong count of points")
    _refuse_first(arrays, numbers, place != stops, "lists more or fewer faces than it says")
    return counts, sizes, stream[spread(at, sizes)]


def _alone(stream: Integers, place: int, sizes: npt.NDArray[np.int64], at: npt.NDArray[np.int64]) -> int:
    """Fill in the faces of one cell; where its stream goes on, or -1 where a face does not fit."""
    numbers = np.ascontiguousarray(stream, np.int64).data
    for face in range(len(sizes)):
        size = numbers[place] if place < len(numbers) else 0
        if size < 3 or place + size >= len(numbers):
            return -1
        sizes[face], at[face] = size, place + 1
        place += 1 + size
    return place


def _ranges(
    arrays: CellArrays, name: str, ends: Integers, most: int
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Where each part starts and ends, of where it ends; parts lie one after the other."""
    stops = ends.astype(np.int64)
    starts = np.concatenate((np.zeros(1, np.int64), stops[:-1]))[: len(stops)]
    if (starts > stops).any() or (len(stops) and stops[-1] > most):
        raise InputError(f"{arrays.path}: array {name!r} falls, or goes beyond what is listed; copy the file again")
    return starts, stops


def _any_of(bad: npt.NDArray[np.bool_], counts: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Per part, is any of its entries bad?"""
    before = np.concatenate(([0], np.cumsum(bad)))
    ends = np.cumsum(counts)
    return np.asarray(before[ends] > before[ends - counts])


def _refuse_first(arrays: CellArrays, numbers: npt.NDArray[np.intp], wrong: npt.NDArray[np.bool_], what: str) -> None:
    if wrong.any():
        raise InputError(f"{arrays.path}: polyhedron {numbers[int(np.argmax(wrong))]:,} {what}; write it again")


def _of_another_length(arrays: CellArrays, name: str, array: Integers) -> InputError:
    return InputError(
        f"{arrays.path}: array {name!r} is for {len(array):,} cells, there are {len(arrays.types):,}; copy it again"
    )
