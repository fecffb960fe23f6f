"""From the arrays of VTK's unstructured grid to a CellMesh, whatever file they come from.

The arrays are those of VTK's data model: points, cells as types, offsets and connectivity, and one field.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError, InputError
from isocore.readers.cell_splitting import split_cells
from isocore.readers.vtk_cells import CORNERS, FLAT, SOLID, Corners, Shape, corners, count_cells
from isocore.readers.vtk_fields import FieldInfo, averaged, scalar


@dataclass(frozen=True, slots=True)
class PieceData:
    """The arrays of one piece as they are in the file.

    points: (n, 3), any number type. types, offsets: (c,) integers of each cell, offsets where it ends.
    connectivity: point numbers of all cells, one cell after the other.
    values: flat, the components of each point, or of each cell, together.
    """

    points: npt.NDArray[Any]
    types: npt.NDArray[Any]
    offsets: npt.NDArray[Any]
    connectivity: npt.NDArray[Any]
    values: npt.NDArray[Any]


def assembled(path: str, pieces: Iterable[PieceData], field: FieldInfo, component: int | None) -> CellMesh:
    """One mesh of all pieces, with one value per point; component None is the magnitude of `field`.

    Raises InputError where the arrays contradict each other, FieldError where they cannot be contoured; each
    message starts with `path`.
    """
    return _joined(path, [_checked(path, piece, field, component) for piece in pieces], field)


@dataclass(frozen=True, slots=True)
class _Part:
    """One piece, checked. points: (n, 3) float64. values: (n,) of the points. counts: cells by VTK type."""

    points: npt.NDArray[np.float64]
    values: npt.NDArray[Any]
    cells: list[Corners]
    counts: dict[int, int]


def _checked(path: str, piece: PieceData, field: FieldInfo, component: int | None) -> _Part:
    counts = count_cells(path, piece.types)
    points = np.array(piece.points, dtype=np.float64)
    if not np.isfinite(points).all():
        raise InputError(f"{path}: some of its points have coordinates that are not finite; write it again")
    cells = corners(path, (piece.types, piece.offsets, piece.connectivity), counts, len(points))
    values = scalar(piece.values, field.components, component)
    if field.of == "cells":
        values = averaged(values, [(block.cells, values[block.numbers]) for block in cells], len(points))
    return _Part(points, values, cells, counts)


def _joined(path: str, parts: list[_Part], field: FieldInfo) -> CellMesh:
    """All parts as one mesh, with what is neither tetrahedron nor hexahedron split."""
    counts = reduce(Counter.__add__, (Counter(part.counts) for part in parts))
    warnings = _cell_warnings(path, counts)
    split = split_cells(*(_cells(path, parts, shape) for shape in ("tet", "hex", "wedge", "pyramid")))
    if not len(split.tets) and not len(split.hexes):
        raise FieldError(
            f"{path}: each of its {split.collapsed:,} cells is collapsed to nothing; write it again"
        )
    values = _one([part.values for part in parts])
    if split.collapsed:
        warnings.append(
            f"{split.collapsed:,} cells name a corner twice; they were split by the corners they have left,"
            " or dropped where those enclose nothing"
        )
    if split.beside:
        warnings.append(
            f"{split.beside:,} hexahedra hang together through faces with wedges, pyramids or collapsed"
            " cells; they were split into tetrahedra too, so that the surface stays closed"
        )
    if len(parts) > 1:
        warnings.append(f"{len(parts)} pieces were joined, but not their points: the surface has seams there")
    if field.of == "cells":
        warnings.append(f"{field.name} is a cell field; each point got the mean of its cells, which blurs it")
    infinite = values.size - int(np.count_nonzero(np.isfinite(values)))
    if infinite:
        warnings.append(f"{infinite:,} of {values.size:,} values of {field.name} are not finite and outside")
    return CellMesh(
        _one([part.points for part in parts]),
        split.tets,
        split.hexes,
        values,
        field_name=field.name,
        cell_counts=_by_name(counts),
        warnings=tuple(warnings),
    )


def _cells(path: str, parts: list[_Part], shape: Shape) -> npt.NDArray[np.int32]:
    """(m, k) all cells of one shape, numbered over all parts."""
    first = 0
    found = []
    for part in parts:
        for block in part.cells:
            if block.kind.shape == shape:
                found.append(block.cells + np.int32(first) if first else block.cells)
        first += len(part.points)
        if first > np.iinfo(np.int32).max:
            raise FieldError(f"{path}: holds more than 2,147,483,647 points; cut it into several files")
    return _one(found) if found else np.empty((0, CORNERS[shape]), np.int32)


def _one(arrays: list[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """The arrays behind each other; a single one as it is."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _by_name(counts: Counter[int]) -> dict[str, int]:
    named: Counter[str] = Counter()
    for number, count in counts.items():
        named[SOLID[number].name if number in SOLID else FLAT[number]] += count
    return dict(named)


def _cell_warnings(path: str, counts: Counter[int]) -> list[str]:
    """Of cells left out or straightened; FieldError where no cell fills space."""
    flat = [f"{count:,} {FLAT[number]}" for number, count in counts.items() if number in FLAT]
    if len(flat) == len(counts):
        raise FieldError(
            f"{path}: holds only surface cells ({', '.join(flat)}); contouring needs cells that fill space"
        )
    warnings = [f"{cells} enclose nothing and were left out" for cells in flat]
    for number, count in counts.items():
        if number in SOLID and SOLID[number].curved:
            warnings.append(
                f"{count:,} {SOLID[number].name} were reduced to their corners;"
                " the values between the corners are not used"
            )
    return warnings
