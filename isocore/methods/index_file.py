"""The index on disk: written beside the mesh, refused when the mesh or its field has changed, or when it is damaged.

A file is one line of magic, one line of JSON, one line with the CRC-32 of that JSON, and the arrays' bytes one after
the other, little-endian, as the JSON's "arrays" lists them. "mesh" is a hash of all that the index was made from,
"checksum" the CRC-32 of the arrays. A checksum tells damage, not intent: so each number is held against the mesh too,
here as far as shapes and bounds go, and record by record in kernels/thinning/mesh/check_index.cpp.
"""

from __future__ import annotations

import hashlib
import json
import math
import zlib
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, reading
from isocore.methods.mesh_index import IndexPart, MeshIndex

SUFFIX = ".isoindex"
_MAGIC = b"isocore thinning index 4\n"
_LONGEST_HEADER = 1 << 16
_ARRAYS = {"records": "<i4", "skeleton": "<i4", "low": "<f8", "high": "<f8"}
#: How a refusal of an index ends.
AGAIN = "write it again with `isocore index`"


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

    header: dict[str, Any] = {"mesh": mesh_hash(mesh), "field": mesh.field_name}
    arrays: list[npt.NDArray[Any]] = []
    for kind, part in (("tets", index.tets), ("hexes", index.hexes)):
        numbers = {f.name: getattr(part, f.name) for f in fields(part) if f.name not in _ARRAYS}
        own = {name: np.ascontiguousarray(getattr(part, name), dtype) for name, dtype in _ARRAYS.items()}
        header[kind] = {**numbers, "arrays": {name: array.shape for name, array in own.items()}}
        arrays += own.values()
    arrays.append(np.ascontiguousarray(index.original, "<i4"))
    header["points"] = len(index.original)
    header["checksum"] = _checksum(arrays)
    text = json.dumps(header).encode()
    with whole_file(path) as file:
        file.write(_MAGIC + text + b"\n%08x\n" % zlib.crc32(text))
        for array in arrays:
            file.write(array.data)


def load_index(path: Path, mesh: CellMesh) -> MeshIndex:
    """The index in `path`. Raises InputError if it is damaged, or was made from something else than `mesh`."""
    with reading(path), path.open("rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise InputError(f"{path}: is not an index of this version; {AGAIN}")
        try:
            header = _header(file)
            if header["mesh"] != mesh_hash(mesh):
                raise InputError(f"{path}: {_what_changed(header, mesh)}; {AGAIN}")
            return _index(file, header, mesh)
        except (ValueError, LookupError, TypeError, AttributeError) as error:
            why = f" ({error})" if isinstance(error, _Damage) else ""
            raise InputError(f"{path}: is damaged{why}; {AGAIN}") from error


class _Damage(ValueError):
    """What is wrong with the index, in our words."""


def _header(file: BinaryIO) -> dict[str, Any]:
    text, checksum = file.readline(_LONGEST_HEADER), file.readline(16)
    if checksum != b"%08x\n" % zlib.crc32(text[:-1]):
        raise _Damage("its header has another checksum")
    header: dict[str, Any] = json.loads(text)
    return header


def _what_changed(header: dict[str, Any], mesh: CellMesh) -> str:
    if header["field"] != mesh.field_name:
        return f"was made for the field {header['field'] or 'without a name'}, not for {mesh.field_name}"
    return "was made before the mesh or its values changed"


def _index(file: BinaryIO, header: dict[str, Any], mesh: CellMesh) -> MeshIndex:
    """The arrays behind a header that was made from `mesh`; ValueError where any number cannot be what it should."""
    tets, hexes = _shapes(header["tets"], mesh.tets), _shapes(header["hexes"], mesh.hexes)
    points = _count(header["points"], len(mesh.points))
    wanted = [(name, shape) for part in (tets, hexes) for name, shape in part.items()]
    wanted_bytes = 4 * points + sum(math.prod(shape) * np.dtype(_ARRAYS[name]).itemsize for name, shape in wanted)
    held_bytes = Path(file.name).stat().st_size - file.tell()
    if held_bytes != wanted_bytes:
        raise _Damage(f"its arrays take {held_bytes:,} bytes, not {wanted_bytes:,}")
    found = [_read(file, name, shape) for name, shape in wanted]
    original = np.fromfile(file, "<i4", points)
    if _checksum([*found, original]) != header["checksum"]:
        raise _Damage("its arrays have another checksum")
    if points and not 0 <= original.min() <= original.max() < len(mesh.points):
        raise _Damage("it names a point that the mesh has not")
    parts = []
    for kind, cells, arrays in (("tets", mesh.tets, found[:4]), ("hexes", mesh.hexes, found[4:])):
        named: dict[str, Any] = dict(zip(_ARRAYS, arrays, strict=True))
        parts.append(IndexPart(**named, **_numbers(header[kind], cells, len(mesh.points))))
    return MeshIndex(parts[0], parts[1], original)


def is_of(index: MeshIndex, mesh: CellMesh) -> bool:
    """Whether the index has the mesh's cells, and its skeleton their values, each cell once.

    `index` names only what is there. Whether the skeleton holds enough of the cells only thinning itself could tell.
    """
    mixed = np.arange(1, len(mesh.points) + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    mixed ^= mixed >> np.uint64(29)
    renumbered = mixed[index.original]
    for part, cells in ((index.tets, mesh.tets), (index.hexes, mesh.hexes)):
        if _sum_of(renumbered, part.records[:, : cells.shape[1]]) != _sum_of(mixed, cells):
            return False
        if len(np.unique(part.skeleton)) != len(part.skeleton):
            return False
    heights = np.where(np.isfinite(mesh.values), mesh.values.astype(np.float64), -np.inf)[index.original]
    return all(
        np.array_equal(end(heights[part.records[part.skeleton, :corners]], axis=1, initial=start), stated)
        for part, corners in ((index.tets, 4), (index.hexes, 8))
        for end, start, stated in ((np.min, np.inf, part.low), (np.max, -np.inf, part.high))
    )


def _sum_of(mixed: npt.NDArray[np.uint64], cells: npt.NDArray[np.int32]) -> int:
    """The same for the same cells in any order, and hardly ever for others. mixed: a number for each point."""
    sums = np.zeros(len(cells), np.uint64)
    for corner in cells.T:
        sums += mixed[corner]
    sums *= np.uint64(0xBF58476D1CE4E5B9)
    sums ^= sums >> np.uint64(31)
    return int(sums.sum(dtype=np.uint64))


def _shapes(part: dict[str, Any], cells: npt.NDArray[np.int32]) -> dict[str, tuple[int, ...]]:
    """The shapes of the arrays of all `cells` (m, k) of one kind, whatever the file says of them."""
    columns = {4: 8, 8: 14}[cells.shape[1]]
    skeleton = _count(part["arrays"]["skeleton"][0], len(cells))
    shapes = {"records": (len(cells), columns), "skeleton": (skeleton,), "low": (skeleton,), "high": (skeleton,)}
    if part["arrays"] != {name: list(shape) for name, shape in shapes.items()}:
        raise _Damage("its arrays have other shapes than the mesh asks for")
    return shapes


def _numbers(part: dict[str, Any], cells: npt.NDArray[np.int32], points: int) -> dict[str, Any]:
    """The numbers of one kind of cell that are no arrays, each between the bounds that it can have."""
    faces = len(cells) * (4 if cells.shape[1] == 4 else 6)
    (*crowded,) = part["crowded_cells"]
    classes = tuple(_count(number, len(cells)) for number in part["classes"])
    if len(crowded) != 3 or len(classes) != 7:
        raise _Damage("it counts other things than an index does")
    return {
        "extrema": _count(part["extrema"], cells.size + points),
        "classes": classes,
        "crowded_faces": _count(part["crowded_faces"], faces),
        "crowded_cells": tuple(_count(cell, len(cells), least=-1) for cell in crowded),
        "collapsed_cells": _count(part["collapsed_cells"], len(cells)),
        "collapsed_cell": _count(part["collapsed_cell"], len(cells), least=-1),
    }


def _count(number: object, most: int, *, least: int = 0) -> int:
    if type(number) is not int or not least <= number <= most:
        raise _Damage("a number of its header is out of bounds")
    return number


def _read(file: BinaryIO, name: str, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    return np.fromfile(file, _ARRAYS[name], math.prod(shape)).reshape(shape)


def _checksum(arrays: Iterable[npt.NDArray[Any]]) -> int:
    checksum = 0
    for array in arrays:
        checksum = zlib.crc32(array.data, checksum)
    return checksum
