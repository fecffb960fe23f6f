"""The index on disk: written beside the mesh, refused when the mesh or its field has changed.

A file is one line of magic, one line of JSON (its own length known from the newline), and the arrays' bytes one after
the other, little-endian, as the JSON's "arrays" lists them. "mesh" is a hash of all that the index was made from.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from dataclasses import fields
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, reading
from isocore.methods.mesh_index import IndexPart, MeshIndex

SUFFIX = ".isoindex"
_MAGIC = b"isocore thinning index 2\n"
_LONGEST_HEADER = 1 << 16
_ARRAYS = {"records": "<i4", "skeleton": "<i4", "low": "<f8", "high": "<f8"}


def index_path(mesh_path: Path) -> Path:
    """Where the index of a mesh file lies: mesh.vtu.isoindex."""
    return mesh_path.with_name(mesh_path.name + SUFFIX)


def mesh_hash(mesh: CellMesh) -> str:
    """Hash of everything an index depends on: points, cells, values and their types."""
    digest = hashlib.blake2b(digest_size=16)
    for array in (mesh.points, mesh.tets, mesh.hexes, mesh.values):
        digest.update(f"{array.dtype.name}{array.shape}".encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def save_index(path: Path, index: MeshIndex, mesh: CellMesh) -> None:
    """Write the index whole or not at all."""
    from isocore.whole_file import whole_file

    header: dict[str, Any] = {"mesh": mesh_hash(mesh), "field": mesh.field_name, "edges": index.edges}
    arrays: list[npt.NDArray[Any]] = []
    checksum = 0
    for kind, part in (("tets", index.tets), ("hexes", index.hexes)):
        numbers = {f.name: getattr(part, f.name) for f in fields(part) if f.name not in _ARRAYS}
        shapes = {}
        for name, dtype in _ARRAYS.items():
            array = np.ascontiguousarray(getattr(part, name), dtype)
            shapes[name] = array.shape
            checksum = zlib.crc32(array.data, checksum)
            arrays.append(array)
        header[kind] = {**numbers, "arrays": shapes}
    original = np.ascontiguousarray(index.original, "<i4")
    header["points"] = len(original)
    checksum = zlib.crc32(original.data, checksum)
    arrays.append(original)
    header["checksum"] = checksum
    with whole_file(path) as file:
        file.write(_MAGIC + json.dumps(header).encode() + b"\n")
        for array in arrays:
            file.write(array.data)


def load_index(path: Path, mesh: CellMesh) -> MeshIndex:
    """The index in `path`. Raises InputError if it is damaged, or was made from something else than `mesh`."""
    with reading(path), path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise InputError(f"{path}: is not an index of this version; write it again with `isocore index`")
        header = json.loads(file.readline(_LONGEST_HEADER))
        if header["mesh"] != mesh_hash(mesh):
            raise InputError(f"{path}: {_what_changed(header, mesh)}; write it again with `isocore index`")
        checksum = 0
        parts = []
        for kind in ("tets", "hexes"):
            numbers = header[kind]
            arrays = {name: _read(file, dtype, numbers["arrays"][name]) for name, dtype in _ARRAYS.items()}
            for array in arrays.values():
                checksum = zlib.crc32(array.data, checksum)
            del numbers["arrays"]
            tuples = {name: tuple(value) for name, value in numbers.items() if isinstance(value, list)}
            parts.append(IndexPart(**{**arrays, **numbers, **tuples}))
        original = _read(file, "<i4", [header["points"]])
        if zlib.crc32(original.data, checksum) != header["checksum"]:
            raise InputError(f"{path}: is damaged; write it again with `isocore index`")
        return MeshIndex(parts[0], parts[1], original, int(header["edges"]))


def _what_changed(header: dict[str, Any], mesh: CellMesh) -> str:
    if header["field"] != mesh.field_name:
        return f"was made for the field {header['field'] or 'without a name'}, not for {mesh.field_name}"
    return "was made before the mesh or its values changed"


def _read(file: BinaryIO, dtype: str, shape: list[int]) -> npt.NDArray[Any]:
    count = int(np.prod(shape, dtype=np.int64))
    array = np.fromfile(file, dtype, count)
    if len(array) != count:
        raise InputError(f"{file.name}: ends early; write it again with `isocore index`")
    return array.reshape(shape)
