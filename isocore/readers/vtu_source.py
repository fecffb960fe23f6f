"""Where the arrays of a VTU file come from: the file's bytes, decoded one by one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy.typing as npt

from isocore.errors import FieldError, InputError
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_ghosts import GHOST_TYPE, OF_CELLS
from isocore.readers.vtk_pieces import PieceData
from isocore.readers.vtk_polyhedra import FaceLists, FourArrays
from isocore.readers.vtu_arrays import DTYPES, ArrayReader
from isocore.readers.vtu_layout import ArrayTag, Piece

#: Arrays of polyhedra since VTK 9.4.
_LISTED = ("face_connectivity", "face_offsets", "polyhedron_to_faces", "polyhedron_offsets")


class NoCells(FieldError):
    """A file without cells, which is as good as any among the pieces of a mesh."""


class StoredSource:
    """A file whose arrays are decoded here."""

    def __init__(self, arrays: ArrayReader) -> None:
        self.path = arrays.path
        self.arrays = arrays
        self.full = [piece for piece in arrays.layout.pieces if piece.points and piece.cells]
        if not self.full:
            raise NoCells(f"{arrays.path}: holds no cells, so there is nothing to contour")

    @property
    def fields(self) -> tuple[FieldInfo, ...]:
        """Of the first piece; the others have to hold the one that is chosen."""
        arrays = self.full[0].arrays
        found = [FieldInfo(tag.name, tag.components, "points", tag.type) for tag in arrays["PointData"]]
        found += [FieldInfo(tag.name, tag.components, "cells", tag.type) for tag in arrays["CellData"]]
        return tuple({(f.of, f.name): f for f in found if f.type in DTYPES and f.components}.values())

    def pieces(self, field: FieldInfo, carried: Sequence[FieldInfo] = ()) -> Iterator[PieceData]:
        """Of each piece its cells, the values of `field`, and those of `carried`."""
        read = self.arrays.read
        for piece in self.full:
            yield PieceData(
                path=self.path,
                points=read(self._tag(piece, "Points", None), 3 * piece.points).reshape(-1, 3),
                types=read(self._tag(piece, "Cells", "types"), piece.cells),
                offsets=read(self._tag(piece, "Cells", "offsets"), piece.cells),
                connectivity=read(self._tag(piece, "Cells", "connectivity")),
                values=self._values(piece, field),
                carried=tuple(self._values(piece, one) for one in carried),
                ghosts=tuple((tag.name, read(tag, piece.cells)) for tag in piece.named("CellData", *OF_CELLS)),
                hidden=next((read(tag, piece.points) for tag in piece.named("PointData", GHOST_TYPE)), None),
                faces=FaceLists(
                    self._maybe(piece, "faces"), self._maybe(piece, "faceoffsets"), self._listed(piece)
                ),
                degrees=next(
                    (
                        read(tag, 3 * piece.cells).reshape(-1, 3)
                        for tag in piece.named("CellData", "HigherOrderDegrees")
                        if tag.components == 3
                    ),
                    None,
                ),
                weights=next((read(tag, piece.points) for tag in piece.named("PointData", "RationalWeights")), None),
                old=self.arrays.layout.version < (2, 1),
            )

    def _values(self, piece: Piece, field: FieldInfo) -> npt.NDArray[Any]:
        values = self._tag(piece, "PointData" if field.of == "points" else "CellData", field.name)
        tuples = piece.points if field.of == "points" else piece.cells
        if values.components != field.components:
            raise InputError(
                f"{self.path}: field {field.name!r} has {field.components} components in one piece"
                f" and {values.components} in another; write it again"
            )
        return self.arrays.read(values, tuples * field.components)

    def _maybe(self, piece: Piece, name: str) -> npt.NDArray[Any] | None:
        return next((self.arrays.read(tag) for tag in piece.named("Cells", name)), None)

    def _listed(self, piece: Piece) -> FourArrays | None:
        points, ends, faces, cell_ends = (self._maybe(piece, name) for name in _LISTED)
        if points is None or ends is None or faces is None or cell_ends is None:
            return None
        return points, ends, faces, cell_ends

    def _tag(self, piece: Piece, section: str, name: str | None) -> ArrayTag:
        """The first array of that name: of several time steps, the first."""
        for tag in piece.arrays[section]:
            if name is None or tag.name == name:
                return tag
        number = self.full.index(piece) + 1
        wanted = f"array {name!r}" if name else "coordinates"
        raise InputError(
            f"{self.path}: has no {wanted} in <{section}> of piece {number}; write the file again"
        )
