"""Read a VTU file, an unstructured grid in VTK's XML format, as a CellMesh.

Every encoding VTK writes is decoded here, from the mapped file and only the arrays that are needed. XML that
the tag scan does not follow (UTF-16, CDATA, entities, comments inside the numbers) is left to meshio.
"""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass
from functools import reduce
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError, InputError, reading
from isocore.readers.cell_splitting import split_cells
from isocore.readers.vtu_cells import CORNERS, FLAT, SOLID, Corners, Shape, corners, count_cells
from isocore.readers.vtu_fields import FieldChoice, FieldInfo, averaged, choose, component_of, scalar
from isocore.readers.vtu_layout import UnusualLayout, scan
from isocore.readers.vtu_source import MappedSource, PieceData, Source

Pathlike = os.PathLike[str] | str


def read_vtu(path: Pathlike, options: FieldChoice) -> CellMesh:
    """The mesh in the file `path` with the field that `options` choose."""
    name = os.fspath(path)
    with reading(path):
        source = _open(name)
        field = choose(name, source.fields, options)
        component = component_of(name, field, options.component)
        parts = [_checked(name, piece, field, component) for piece in source.pieces(field)]
        return _joined(name, parts, field)


def vtu_fields(path: Pathlike) -> tuple[FieldInfo, ...]:
    """The fields the file offers, those of points first, without reading their numbers."""
    with reading(path):
        return tuple(sorted(_open(os.fspath(path)).fields, key=lambda field: field.of != "points"))


def _open(path: str) -> Source:
    with Path(path).open("rb") as file:
        head = file.read(64)
        if not head:
            raise InputError(f"{path}: is empty; copy it again")
        if head.startswith(b"# vtk DataFile"):
            raise InputError(
                f"{path}: is a legacy VTK file under the suffix of an XML one; convert it to .vtu"
            )
        data = mmap(file.fileno(), 0, access=ACCESS_READ)
    try:
        layout = scan(path, data)
    except UnusualLayout as unusual:
        from isocore.readers.vtu_meshio import MeshioSource

        return MeshioSource(path, str(unusual))
    return MappedSource(path, data, layout)


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
