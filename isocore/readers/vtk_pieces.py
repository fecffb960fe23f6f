"""The pieces of an unstructured grid: each checked for itself, then all of them under one numbering of points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.errors import FieldError, InputError
from isocore.readers.vtk_cells import Block, CellArrays, blocks, count_cells
from isocore.readers.vtk_convex import CONVEX_SET, convex_sets
from isocore.readers.vtk_faces import Faces, prisms, ragged
from isocore.readers.vtk_fields import FieldInfo, columns, scalar
from isocore.readers.vtk_ghosts import cells_at, ghost_cells, hidden_points
from isocore.readers.vtk_polyhedra import POLYHEDRON, FaceLists, polyhedra
from isocore.readers.vtk_types import FACETED
from isocore.volume import FARTHEST


@dataclass(frozen=True, slots=True)
class PieceData:
    """The arrays of one piece as they are in the file.

    points: (n, 3), any number type. types, offsets: (c,) integers of each cell, offsets where it ends.
    connectivity: point numbers of all cells, one cell after the other.
    values: flat, the components of each point, or of each cell, together. carried: further fields, alike.
    ghosts: marks of cells by the array's name; hidden: marks of points by `vtkGhostType`. faces: of polyhedra.
    degrees: (c, 3) of Lagrange and Bezier cells along their axes; weights: (n,) of rational Bezier cells.
    old: the file is older than version 2.1 of VTK's. path: of the piece, where it has a file of its own.
    """

    points: npt.NDArray[Any]
    types: npt.NDArray[Any]
    offsets: npt.NDArray[Any]
    connectivity: npt.NDArray[Any]
    values: npt.NDArray[Any]
    ghosts: tuple[tuple[str, npt.NDArray[Any]], ...] = ()
    hidden: npt.NDArray[Any] | None = None
    faces: FaceLists = FaceLists()  # noqa: RUF009
    degrees: npt.NDArray[Any] | None = None
    weights: npt.NDArray[Any] | None = None
    old: bool = False
    path: str = ""
    carried: tuple[npt.NDArray[Any], ...] = ()


@dataclass(frozen=True, slots=True)
class Ragged:
    """Cells of any number of points: their points, how many each has, and which cells of the piece they are."""

    corners: npt.NDArray[np.int32]
    counts: npt.NDArray[np.int64]
    numbers: npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Part:
    """One piece, checked, or all of them. counts: cells by VTK type, without ghosts.

    points: (n, 3) float64. values: (n,) of the points, or one for each cell. Both may be the file's own bytes: where
    most points are soon joined with others, a copy would be for nothing.
    ragged: the points of the cells of `faces`, which splits them.
    weights: (n,) of rational Bezier cells' control points, or None. cells: how many the file has.
    carried: (n, k) or, of cells, (c, k) of each further field; of_cells: which of them are of cells.
    """

    points: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    blocks: list[Block]
    faces: list[Faces]
    ragged: list[Ragged]
    counts: dict[int, int]
    ghosts: int
    weights: npt.NDArray[Any] | None = None
    cells: int = 0
    carried: tuple[npt.NDArray[Any], ...] = ()
    of_cells: tuple[bool, ...] = ()


def checked(
    path: str, piece: PieceData, field: FieldInfo, component: int | None, carried: Sequence[FieldInfo] = ()
) -> Part:
    """One piece without its ghosts. carried: further fields. Raises InputError, FieldError."""
    path = piece.path or path
    points = np.require(piece.points, np.float64, ("C", "A"))
    if points.size and not (points.min() >= -FARTHEST and points.max() <= FARTHEST):  # NaN is neither
        raise InputError(
            f"{path}: some of its points have coordinates that are not finite, or beyond {FARTHEST:g}; write it again"
        )
    arrays = CellArrays.checked(path, (piece.types, piece.offsets, piece.connectivity))
    arrays = replace(arrays, keep=_kept(path, piece, arrays), degrees=piece.degrees, old=piece.old)
    types = arrays.types if arrays.keep is None else arrays.types[arrays.keep]
    counts = count_cells(path, types)
    faces = [_faces(arrays, number, piece, points) for number in counts if number in FACETED]
    values = scalar(piece.values, field.components, component)
    of_cells = field.of == "cells"
    listed = of_cells or any(one.of == "cells" for one in carried)
    part = Part(
        points,
        values,
        blocks(arrays, counts, len(points)),
        faces,
        [Ragged(*ragged(arrays, one.numbers, len(points), one.name), one.numbers) for one in faces * listed],
        counts,
        len(arrays.types) - len(types),
        piece.weights,
        len(arrays.types),
        tuple(columns(rows, one) for rows, one in zip(piece.carried, carried, strict=True)),
        tuple(one.of == "cells" for one in carried),
    )
    return _of_own_points(part, of_cells) if part.ghosts else part


def _kept(path: str, piece: PieceData, arrays: CellArrays) -> npt.NDArray[np.bool_] | None:
    """(c,) False for ghosts; None where there are none."""
    ghosts = np.zeros(len(arrays.types), np.bool_)
    for name, marks in piece.ghosts:
        ghosts |= ghost_cells(path, name, marks)
    if piece.hidden is not None and (hidden := hidden_points(path, piece.hidden)).any():
        ghosts |= cells_at(hidden, arrays.starts, arrays.connectivity)
    return ~ghosts if ghosts.any() else None


def _faces(arrays: CellArrays, number: int, piece: PieceData, points: npt.NDArray[np.float64]) -> Faces:
    if number == POLYHEDRON:
        return polyhedra(arrays, piece.faces, len(points))
    return convex_sets(arrays, points) if number == CONVEX_SET else prisms(arrays, number, len(points))


def _of_own_points(part: Part, of_cells: bool) -> Part:
    """Without the points that only ghosts name: what stands there may never have been computed."""
    used = used_points(part)
    number = np.cumsum(used, dtype=np.int32) - np.int32(1)
    part = renumbered(part, number)
    values = part.values if of_cells else part.values[used]
    weights = None if part.weights is None else part.weights[used]
    carried = of_points(part, lambda rows: rows[used])
    return replace(part, points=part.points[used], values=values, weights=weights, carried=carried)


def of_points(
    part: Part, change: Callable[[npt.NDArray[Any]], npt.NDArray[Any]]
) -> tuple[npt.NDArray[Any], ...]:
    """The carried fields, those of points changed."""
    return tuple(rows if cells else change(rows) for rows, cells in zip(part.carried, part.of_cells, strict=True))


def used_points(part: Part) -> npt.NDArray[np.bool_]:
    """(n,) True for the points that a cell which fills space names."""
    used = np.zeros(len(part.points), np.bool_)
    for block in part.blocks:
        used[block.cells.ravel()] = True
    for faces in part.faces:
        used[faces.corners] = True
    for cells in part.ragged:
        used[cells.corners] = True
    return used


def renumbered(part: Part, number: npt.NDArray[np.int32]) -> Part:
    """The cells with the new number of each point."""

    def anew(corners: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        return _kernels.renumbered(corners.ravel(), number).reshape(corners.shape)

    return replace(
        part,
        blocks=[replace(block, cells=anew(block.cells)) for block in part.blocks],
        faces=[replace(faces, corners=anew(faces.corners)) for faces in part.faces],
        ragged=[replace(cells, corners=anew(cells.corners)) for cells in part.ragged],
    )


def together(path: str, parts: list[Part]) -> Part:
    """All parts as one; cells and points of later ones follow those of earlier ones."""
    if len(parts) == 1:
        return parts[0]
    first_point = first_cell = 0
    moved = []
    for part in parts:
        moved.append(_moved(part, first_point, first_cell))
        first_point += len(part.points)
        first_cell += part.cells
        if first_point > np.iinfo(np.int32).max:
            raise FieldError(f"{path}: holds more than 2,147,483,647 points; cut it into several files")
    return Part(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.values for part in parts]),
        [block for part in moved for block in part.blocks],
        [faces for part in moved for faces in part.faces],
        [cells for part in moved for cells in part.ragged],
        {},
        sum(part.ghosts for part in parts),
        _all_weights(parts),
        first_cell,
        tuple(np.concatenate(rows) for rows in zip(*(part.carried for part in parts), strict=True)),
        parts[0].of_cells,
    )


def _all_weights(parts: list[Part]) -> npt.NDArray[Any] | None:
    """Of all points, 1 where a part has none; None where none has any."""
    if all(part.weights is None for part in parts):
        return None
    return np.concatenate([np.ones(len(part.points)) if part.weights is None else part.weights for part in parts])


def _moved(part: Part, first_point: int, first_cell: int) -> Part:
    """With higher numbers of points and cells."""
    step = np.int32(first_point)

    def later(numbers: npt.NDArray[np.intp] | slice) -> npt.NDArray[np.intp] | slice:
        if isinstance(numbers, slice):
            return slice(numbers.start + first_cell, numbers.stop + first_cell)
        return numbers + first_cell

    return replace(
        part,
        blocks=[replace(one, cells=one.cells + step, numbers=later(one.numbers)) for one in part.blocks],
        faces=[replace(one, corners=one.corners + step) for one in part.faces],
        ragged=[replace(one, corners=one.corners + step, numbers=one.numbers + first_cell) for one in part.ragged],
    )
