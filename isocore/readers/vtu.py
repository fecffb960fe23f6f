"""Read a VTU file, an unstructured grid in VTK's XML format, as a CellMesh.

Every encoding VTK writes is decoded here, from the mapped file and only the arrays that are needed. XML that the
tag scan does not follow (UTF-16, CDATA, entities, comments inside the numbers) is left to meshio.
"""

from __future__ import annotations

import os
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.cell_splitting import split_cells
from isocore.errors import FieldError, InputError, reading
from isocore.readers.vtu_cells import FLAT, SOLID, Corners, Shape, corners, count_cells
from isocore.readers.vtu_fields import FieldChoice, FieldInfo, averaged, choose, scalar, value_warnings
from isocore.readers.vtu_layout import UnusualLayout, scan
from isocore.readers.vtu_source import MappedSource, Source

Pathlike = os.PathLike[str] | str


def read_vtu(path: Pathlike, options: FieldChoice) -> CellMesh:
    """The mesh in the file `path` with the field that `options` choose."""
    name = os.fspath(path)
    with reading(path):
        source = _open(name)
        field = choose(name, source.fields, options)
        return _assemble(name, source, field, options.component)


def point_fields(path: Pathlike) -> tuple[FieldInfo, ...]:
    """The point fields the file offers, without reading their numbers."""
    with reading(path):
        return tuple(field for field in _open(os.fspath(path)).fields if field.of == "points")


def cell_fields(path: Pathlike) -> tuple[FieldInfo, ...]:
    """The cell fields the file offers; one of them is averaged to the points when it is chosen."""
    with reading(path):
        return tuple(field for field in _open(os.fspath(path)).fields if field.of == "cells")


def _open(path: str) -> Source:
    with Path(path).open("rb") as file:
        head = file.read(64)
        if not head:
            raise InputError(f"{path}: is empty; copy it again")
        if head.startswith(b"# vtk DataFile"):
            raise InputError(f"{path}: is a legacy VTK file under the suffix of an XML one; convert it to .vtu")
        data = mmap(file.fileno(), 0, access=ACCESS_READ)
    try:
        layout = scan(path, data)
    except UnusualLayout as unusual:
        from isocore.readers.vtu_meshio import MeshioSource

        return MeshioSource(path, str(unusual))
    return MappedSource(path, data, layout)


def _assemble(path: str, source: Source, field: FieldInfo, component: int | str | None) -> CellMesh:
    """Piece after piece into one mesh, then split what is neither tetrahedron nor hexahedron."""
    points, values, found = [], [], []
    counts: dict[int, int] = {}
    first = pieces = 0
    for pieces, piece in enumerate(source.pieces(field), 1):
        of_piece = count_cells(path, piece.types)
        solid = corners(path, (piece.types, piece.offsets, piece.connectivity), of_piece, len(piece.points))
        counts = {number: counts.get(number, 0) + of_piece.get(number, 0) for number in counts | of_piece}
        one = scalar(piece.values, field, component)
        values.append(one if field.of == "points" else _to_points(one, solid, len(piece.points)))
        points.append(np.array(piece.points, dtype=np.float64))
        found += [(block.kind.shape, block.cells + np.int32(first) if first else block.cells) for block in solid]
        first += len(piece.points)
    warnings = _cell_warnings(path, counts)
    split = split_cells(*(_joined(found, shape) for shape in ("tet", "hex", "wedge", "pyramid")))
    found.clear()
    if not len(split.tets) and not len(split.hexes):
        raise FieldError(f"{path}: all of its {split.collapsed:,} cells are collapsed to nothing; check its corners")
    if split.collapsed:
        warnings.append(f"{split.collapsed:,} cells name a corner twice; they were split by the corners they have left,"
                        " or dropped where none enclose anything")
    if split.beside:
        warnings.append(f"{split.beside:,} hexahedra hang together through faces with wedges, pyramids or collapsed"
                        " cells and were split into tetrahedra with them, so that the surface stays closed")
    if pieces > 1:
        warnings.append(f"{pieces} pieces were joined, their shared points kept apart: the surface has seams there")
    if field.of == "cells":
        warnings.append(f"{field.name} is a cell field; each point got the mean of its cells, which blurs it")
    all_points, all_values = _one(points), _one(values)
    if not np.isfinite(all_points).all():
        raise InputError(f"{path}: some of its points have coordinates that are not finite; write it again")
    names = {number: SOLID[number].name if number in SOLID else FLAT[number] for number in counts}
    totals = {name: sum(counts[n] for n in counts if names[n] == name) for name in names.values()}
    return CellMesh(all_points, split.tets, split.hexes, all_values, field_name=field.name, cell_counts=totals,
                    warnings=(*warnings, *value_warnings(field.name, all_values)))


def _to_points(values: npt.NDArray[Any], solid: list[Corners], points: int) -> npt.NDArray[Any]:
    return averaged(values, [(block.cells, values[block.numbers]) for block in solid], points)


def _joined(found: list[tuple[Shape, npt.NDArray[np.int32]]], shape: Shape) -> npt.NDArray[np.int32]:
    of_shape = [cells for kind, cells in found if kind == shape]
    return _one(of_shape) if of_shape else np.empty((0, {"tet": 4, "hex": 8, "wedge": 6, "pyramid": 5}[shape]), np.int32)


def _one(arrays: list[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """The arrays behind each other; a single one as it is."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _cell_warnings(path: str, counts: dict[int, int]) -> list[str]:
    """Of cells left out or straightened; FieldError where no cell fills space."""
    flat = {number: count for number, count in counts.items() if number in FLAT}
    if len(flat) == len(counts):
        listed = ", ".join(f"{count:,} {FLAT[number]}" for number, count in flat.items())
        raise FieldError(f"{path}: holds only surface cells or less ({listed}); contouring needs cells that fill space")
    warnings = [f"{count:,} {FLAT[number]} enclose nothing and were left out" for number, count in flat.items()]
    warnings += [f"{count:,} {SOLID[number].name} were reduced to their corners; the values between them are not used"
                 for number, count in counts.items() if number in SOLID and SOLID[number].curved]
    return warnings
