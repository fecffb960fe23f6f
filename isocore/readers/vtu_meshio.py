"""The rare VTU whose XML the tag scan does not follow, through meshio.

meshio parses any XML (UTF-16, CDATA, entities, comments inside the numbers), but keeps the cells of the last
piece only: a file of several pieces is refused rather than read in part.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_mesh import PieceData

#: meshio's names; corners come first and as in VTK (wedges mirrored). What is not here is refused.
TYPES = {
    "tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14, "tetra10": 24, "hexahedron20": 25,
    "wedge15": 26, "pyramid13": 27, "hexahedron27": 29, "wedge12": 31, "wedge18": 32, "hexahedron24": 33,
    "vertex": 1, "line": 3, "triangle": 5, "polygon": 7, "pixel": 8, "quad": 9, "line3": 21, "triangle6": 22,
    "quad8": 23, "quad9": 28,
}  # fmt: skip


class MeshioSource:
    """A file that meshio has read whole: one piece with everything in it."""

    def __init__(self, path: str, reason: str) -> None:
        pieces = _pieces(path)
        if pieces > 1:
            raise InputError(
                f"{path}: has unusual XML ({reason}) and {pieces} pieces; write it again with VTK"
            )
        import meshio

        self.path = path
        with redirect_stderr(io.StringIO()):  # meshio prints what it has to say
            self.mesh: Any = meshio.vtu.read(path)

    @property
    def fields(self) -> tuple[FieldInfo, ...]:
        found = [_info(name, values, of_cells=False) for name, values in self.mesh.point_data.items()]
        found += [_info(name, values[0], of_cells=True) for name, values in self.mesh.cell_data.items()]
        return tuple(found)

    def pieces(self, field: FieldInfo) -> Iterator[PieceData]:
        mesh = self.mesh
        unknown = [block.type for block in mesh.cells if block.type not in TYPES]
        if unknown:
            raise InputError(
                f"{self.path}: holds cells of type {unknown[0]!r}, which cannot be contoured; split them"
                " into tetrahedra first"
            )
        blocks = [(TYPES[block.type], np.asarray(block.data)) for block in mesh.cells]
        values = (
            mesh.point_data[field.name]
            if field.of == "points"
            else np.concatenate(mesh.cell_data[field.name])
        )
        sizes = np.concatenate([np.full(len(data), data.shape[1]) for _, data in blocks])
        yield PieceData(
            points=np.asarray(mesh.points),
            types=np.concatenate([np.full(len(data), number, np.uint8) for number, data in blocks]),
            offsets=np.cumsum(sizes),
            connectivity=np.concatenate([data.ravel() for _, data in blocks]),
            values=np.asarray(values).ravel(),
        )


def _pieces(path: str) -> int:
    """How many pieces the file says it has."""
    names: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, _: names.append(name) if name == "Piece" else None
    with Path(path).open("rb") as file:
        parser.ParseFile(file)
    return len(names)


def _info(name: str, values: npt.NDArray[Any], *, of_cells: bool) -> FieldInfo:
    components = values.shape[1] if values.ndim == 2 else 1
    return FieldInfo(name, components, "cells" if of_cells else "points", values.dtype.name)
