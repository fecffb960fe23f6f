"""Read a VTU file, an unstructured grid in VTK's XML format, as a CellMesh.

Here XML and its encodings end: the arrays of each piece go to vtk_mesh.py, which knows cells and fields but no
file format. Only the arrays that are needed are decoded, appended ones straight from the disk. XML that the tag scan
does not follow (UTF-16, CDATA, entities, comments inside the numbers) is written plainly first.
"""

from __future__ import annotations

import os

from isocore.cell_mesh import CellMesh
from isocore.errors import reading
from isocore.readers.options import ReadOptions
from isocore.readers.vtk_carried import carried_fields
from isocore.readers.vtk_fields import FieldInfo, choose, component_of
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtu_opening import opened
from isocore.readers.vtu_source import StoredSource

Pathlike = os.PathLike[str] | str


def read_vtu(path: Pathlike, options: ReadOptions) -> CellMesh:
    """The mesh in the file `path` with the field that `options` choose."""
    name = os.fspath(path)
    with reading(path):
        source = open_vtu(name)
        field = choose(name, source.fields, options)
        component = component_of(name, field, options.component)
        carried = carried_fields(name, source.fields, field, options.carry)
        pieces = source.pieces(field, carried)
        return assembled(name, pieces, field, component, options.mesh, options.ignore, carried)


def vtu_fields(path: Pathlike) -> tuple[FieldInfo, ...]:
    """The fields the file offers, those of points first, without reading their numbers."""
    with reading(path):
        return tuple(sorted(open_vtu(os.fspath(path)).fields, key=lambda field: field.of != "points"))


def open_vtu(path: str) -> StoredSource:
    """The file's fields and pieces, its tags read and none of its numbers."""
    return StoredSource(opened(path))
