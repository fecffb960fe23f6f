"""The cells of legacy VTK files as types, offsets and connectivity, whichever way the file lists them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, InputError
from isocore.readers.vtk_faces import spread
from isocore.readers.vtk_legacy_arrays import Cursor
from isocore.readers.vtk_legacy_sections import Sections
from isocore.readers.vtk_polyhedra import POLYHEDRON, FaceLists

HEXAHEDRON = 12


@dataclass(frozen=True, slots=True)
class ListedCells:
    """As VTK's data model has them; faces: of polyhedra."""

    types: npt.NDArray[Any]
    offsets: npt.NDArray[np.int64]
    connectivity: npt.NDArray[Any]
    faces: FaceLists


def cells_of(cursor: Cursor, parts: Sections) -> ListedCells:
    """The cells of an unstructured grid."""
    assert parts.types is not None
    types = cursor.read(parts.types)
    types = types.astype(types.dtype.newbyteorder("="))
    if len(parts.cells) == 2:
        starts = cursor.read(parts.cells[0]).astype(np.int64)
        if not len(starts) or starts[0] != 0:
            raise InputError(f"{cursor.path}: its OFFSETS do not begin with 0; copy it again")
        offsets, connectivity = starts[1:], cursor.read(parts.cells[1])
    else:
        offsets, connectivity = _streamed(cursor, cursor.read(parts.cells[0]), len(types))
    if len(offsets) != len(types):
        raise InputError(f"{cursor.path}: lists {len(offsets):,} cells and {len(types):,} types; copy it again")
    return _with_faces(cursor.path, types, offsets, connectivity)


def grid_cells(
    dimensions: tuple[int, int, int],
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Types, offsets and connectivity of the hexahedra between so many points along each axis."""
    nx, ny, _ = dimensions
    k, j, i = np.meshgrid(*(np.arange(n - 1) for n in reversed(dimensions)), indexing="ij")
    first = (i + nx * (j + ny * k)).ravel()
    steps = np.array([0, 1, 1 + nx, nx])
    corners = first[:, None] + np.concatenate((steps, steps + nx * ny))
    return np.full(len(first), HEXAHEDRON, np.uint8), 8 * np.arange(1, len(first) + 1), corners.ravel()


def refuse_flat(path: str, dimensions: tuple[int, int, int]) -> None:
    """FieldError for a grid without cells that fill space."""
    if min(dimensions) < 2:
        held = "x".join(map(str, dimensions))
        raise FieldError(f"{path}: holds a grid of {held} points; contouring needs at least two along each axis")


def _streamed(
    cursor: Cursor, stream: npt.NDArray[Any], cells: int
) -> tuple[npt.NDArray[np.int64], npt.NDArray[Any]]:
    """Offsets and connectivity of a stream of counts, each before so many points."""
    size = int(stream[0]) if len(stream) else 0
    if size > 0 and cells * (size + 1) == len(stream) and (stream[:: size + 1] == size).all():
        return size * np.arange(1, cells + 1), stream.reshape(cells, size + 1)[:, 1:].ravel()
    numbers, place = np.ascontiguousarray(stream, np.int64).data, 0
    counts: list[int] = []
    while place < len(numbers):
        count = numbers[place]
        if not 0 <= count < len(numbers) - place:
            raise InputError(
                f"{cursor.path}: cell {len(counts):,} has {count:,} points, more than are listed; copy it again"
            )
        counts.append(count)
        place += 1 + count
    offsets = np.cumsum(np.array(counts, np.int64))
    keep = np.ones(len(stream), np.bool_)
    keep[offsets - np.array(counts, np.int64) + np.arange(len(counts))] = False
    return offsets, stream[keep]


def _with_faces(
    path: str, types: npt.NDArray[Any], offsets: npt.NDArray[np.int64], connectivity: npt.NDArray[Any]
) -> ListedCells:
    """Polyhedra stand in the connectivity by their faces: these become a stream of their own, their points the cell."""
    polyhedra = np.flatnonzero(types == POLYHEDRON)
    if not len(polyhedra):
        return ListedCells(types, offsets, connectivity, FaceLists())
    counts = np.diff(offsets, prepend=0)
    if (counts < 0).any() or offsets[-1] > len(connectivity):
        raise InputError(f"{path}: its offsets fall, or go beyond the connectivity; copy it again")
    mine = counts[polyhedra]
    stream = connectivity[spread((offsets - counts)[polyhedra], mine)].astype(np.int64)
    ends = np.full(len(types), -1, np.int64)
    ends[polyhedra] = np.cumsum(mine)
    streams = np.split(stream, np.cumsum(mine)[:-1])
    found = {int(cell): _points(part) for cell, part in zip(polyhedra, streams, strict=True)}
    parts = np.split(connectivity[: offsets[-1]], offsets[:-1])
    parts = [found.get(n, part) for n, part in enumerate(parts)]
    return ListedCells(
        types, np.cumsum([len(part) for part in parts]), np.concatenate(parts), FaceLists(stream, ends)
    )


def _points(stream: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """The points of one polyhedron, each once; what is wrong with its faces is found where they are read."""
    numbers, place, counts = stream.tolist(), 1, [0]
    while place < len(numbers):
        counts.append(place)
        place += 1 + max(0, numbers[place])
    return np.unique(np.delete(stream, counts)) if len(stream) else stream
