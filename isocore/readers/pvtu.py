"""Read a PVTU file: a mesh in pieces, each of which is a VTU file that it names.

Only one piece is mapped at a time: there may be more of them than a process may keep open. A mesh of all pieces is
made in vtk_mesh.py, which joins the points where they meet.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError, reading
from isocore.readers.listing import beside, elements, refuse_missing
from isocore.readers.options import ReadOptions
from isocore.readers.vtk_carried import carried_fields
from isocore.readers.vtk_fields import FieldInfo, choose, component_of
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtk_pieces import PieceData
from isocore.readers.vtu import open_vtu
from isocore.readers.vtu_source import NoCells

_NAMED = 5  # fields that a warning names


class PiecesSource:
    """The VTU files of a mesh, in their order, as if they were the pieces of one file."""

    def __init__(self, path: str, files: list[Path]) -> None:
        self.path = path
        refuse_missing(path, files, "pieces")
        self.files: list[Path] = []
        common: dict[tuple[str, str], FieldInfo] = {}
        partial: set[str] = set()
        for file in files:
            found: dict[tuple[str, str], FieldInfo] = {}
            try:
                found.update(((field.of, field.name), field) for field in open_vtu(os.fspath(file)).fields)
            except NoCells:
                continue
            if not self.files:
                common = found
            kept = {key: field for key, field in common.items() if _alike(field, found.get(key))}
            partial |= {name for _, name in (common.keys() | found.keys()) - kept.keys()}
            common = kept
            self.files.append(file)
        if not self.files:
            raise NoCells(f"{path}: none of its {len(files):,} pieces holds a cell, so there is nothing to contour")
        self.fields = tuple(common.values())
        self.partial = sorted(partial)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of fields that not all pieces hold."""
        if not self.partial:
            return ()
        more = f" and {len(self.partial) - _NAMED:,} more" if len(self.partial) > _NAMED else ""
        names = ", ".join(self.partial[:_NAMED])
        return (f"its pieces hold different fields; {names}{more} cannot be chosen, since not all of them hold it",)

    def pieces(self, field: FieldInfo, carried: Sequence[FieldInfo] = ()) -> Iterator[PieceData]:
        """Those of each file in turn."""
        for file in self.files:
            with reading(file):
                yield from open_vtu(os.fspath(file)).pieces(field, carried)


def read_pvtu(path: Path, options: ReadOptions) -> CellMesh:
    """The mesh of all pieces with the field that `options` choose."""
    with reading(path):
        return read_pieces(PiecesSource(os.fspath(path), pvtu_pieces(path)), options)


def read_pieces(source: PiecesSource, options: ReadOptions) -> CellMesh:
    """The mesh of some VTU files."""
    field = choose(source.path, source.fields, options)
    component = component_of(source.path, field, options.component)
    carried = carried_fields(source.path, source.fields, field, options.carry)
    pieces = source.pieces(field, carried)
    mesh = assembled(source.path, pieces, field, component, options.mesh, options.ignore, carried)
    return replace(mesh, warnings=source.warnings + mesh.warnings)


def pvtu_fields(path: Path) -> tuple[FieldInfo, ...]:
    """The fields that all pieces hold, those of points first."""
    with reading(path):
        fields = PiecesSource(os.fspath(path), pvtu_pieces(path)).fields
        return tuple(sorted(fields, key=lambda field: field.of != "points"))


def pvtu_files(path: Path) -> tuple[Path, ...]:
    """The pieces that are there."""
    return tuple(file for file in pvtu_pieces(path) if file.is_file())


def _alike(field: FieldInfo, other: FieldInfo | None) -> bool:
    return other is not None and field.components == other.components


def pvtu_pieces(path: Path) -> list[Path]:
    """The files that a .pvtu names, in its order; InputError where it is none or names none."""
    tags = elements(path, "PUnstructuredGrid", "lists the pieces of an unstructured grid")
    found = [beside(path, attributes.get("Source", "").strip()) for tag, attributes in tags if tag == "Piece"]
    if not found:
        raise FieldError(f"{path}: names no pieces, so there is nothing to contour")
    return found
