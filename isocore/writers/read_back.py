"""The inverse of the writers: the mesh in a file that one of them wrote. Reports show what was written."""

from __future__ import annotations

import json
import re
import struct
import zlib
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

#: Vertices (v, 3), float32 or float64 as in the file, finite; triangles (t, 3), each corner the number of a vertex.
Mesh = tuple[npt.NDArray[np.floating[Any]], npt.NDArray[np.int32]]

_VTP_TYPES = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}
_PLY_TYPES = {"float": "<f4", "double": "<f8", "uchar": "u1", "int": "<i4"}


def read_mesh(path: Path) -> Mesh | None:
    """Vertices (v, 3) and triangles (t, 3) of a file that isocore wrote; None where it is gone, damaged or another's.

    STL keeps no numbers of vertices: equal places become one vertex, and vertices come in the order of their bytes.
    """
    reader = READ_BACK.get(path.suffix.lower())
    try:
        with np.errstate(all="ignore"):  # what comes of odd numbers is no surface
            return None if reader is None or not path.is_file() else _checked(*reader(path.read_bytes()))
    except (OSError, ValueError, KeyError, IndexError, TypeError, OverflowError, MemoryError, struct.error):
        return None


def _checked(vertices: npt.NDArray[np.floating[Any]], triangles: npt.NDArray[np.int32]) -> Mesh | None:
    """The mesh, if it is one."""
    inside = not triangles.size or (triangles.min() >= 0 and triangles.max() < len(vertices))
    return (vertices, triangles) if inside and np.isfinite(vertices).all() else None


def _read_ply(data: bytes) -> Mesh:
    end = data.index(b"end_header\n") + len(b"end_header\n")
    counts: dict[str, int] = {}
    columns: dict[str, list[Any]] = {}
    element = ""
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            counts[element], columns[element] = int(words[2]), []
        elif words[0] == "property" and words[1] != "list":
            columns[element].append((words[2], _PLY_TYPES[words[1]]))
    rows = np.frombuffer(data, np.dtype(columns["vertex"]), counts["vertex"], end)
    vertices = np.stack([rows[axis] for axis in "xyz"], axis=1)
    face = np.dtype([("count", "u1"), ("corners", "<i4", 3), *columns["face"]])
    faces = np.frombuffer(data, face, counts["face"], end + rows.nbytes)
    if (faces["count"] != 3).any():
        raise ValueError("holds more than triangles")
    return vertices, faces["corners"].astype(np.int32)


def _read_glb(data: bytes) -> Mesh:
    magic, version, _, length, kind = struct.unpack_from("<5I", data)
    if (magic, version, kind) != (0x46546C67, 2, 0x4E4F534A):
        raise ValueError("is no glTF 2.0 file")
    document, body = json.loads(data[20 : 20 + length]), data[20 + length + 8 :]

    def array(number: int, dtype: str, columns: int) -> npt.NDArray[Any]:
        accessor = document["accessors"][number]
        at = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        return np.frombuffer(body, dtype, accessor["count"] * columns, at).reshape(-1, columns)

    vertices, triangles, count = [np.empty((0, 3), np.float32)], [np.empty((0, 3), np.int32)], 0
    for mesh in document.get("meshes", []):
        (primitive,) = mesh["primitives"]
        corners = array(primitive["indices"], "<u4", 1).reshape(-1, 3)
        places = array(primitive["attributes"]["POSITION"], "<f4", 3)
        if corners.size and int(corners.max()) >= len(places):
            raise ValueError("a triangle names a vertex of another part")
        vertices.append(places)
        triangles.append((corners + count).astype(np.int32))
        count += len(places)
    return np.concatenate(vertices), np.concatenate(triangles)


def _read_gifti(data: bytes) -> Mesh:
    found: dict[bytes, npt.NDArray[Any]] = {}
    for head, text in re.findall(rb"<DataArray ([^>]*)>.*?<Data>([^<]*)</Data>", data, re.DOTALL):
        said = dict(re.findall(rb'(\w+)="([^"]*)"', head))
        dtype = "<f4" if said[b"DataType"].endswith(b"FLOAT32") else "<i4"
        found[said[b"Intent"]] = np.frombuffer(b64decode(text, validate=True), dtype)
    vertices, triangles = (found[b"NIFTI_INTENT_" + name].reshape(-1, 3) for name in (b"POINTSET", b"TRIANGLE"))
    return vertices, triangles.astype(np.int32)


def _read_vtp(data: bytes) -> Mesh:
    start = data.index(b'<AppendedData encoding="raw">\n_') + len(b'<AppendedData encoding="raw">\n_')
    head, packed = data[:start].decode(), b"vtkZLibDataCompressor" in data[:200]
    found: dict[str, npt.NDArray[Any]] = {}
    section = ""
    for tag, attributes in re.findall(r"<(\w+)((?: \w+=(?:\"[^\"]*\"|'[^']*'))*)/?>", head):
        said = dict(re.findall(r'(\w+)="([^"]*)"', attributes))
        if tag == "DataArray" and section in ("Points", "Polys"):
            unpack = _vtp_unpacked if packed else _vtp_plain
            found[said["Name"]] = np.frombuffer(unpack(data, start + int(said["offset"])), _VTP_TYPES[said["type"]])
        section = section if tag == "DataArray" else tag
    corners = found["connectivity"].reshape(-1, 3)
    if (found["offsets"] != np.arange(3, 3 * len(corners) + 1, 3)).any():
        raise ValueError("holds more than triangles")
    return found["Points"].reshape(-1, 3), corners.astype(np.int32)


def _vtp_plain(data: bytes, at: int) -> bytes:
    (size,) = struct.unpack_from("<Q", data, at)
    return data[at + 8 : at + 8 + size]


def _vtp_unpacked(data: bytes, at: int) -> bytes:
    count, size, _ = struct.unpack_from("<3Q", data, at)
    sizes = np.frombuffer(data, "<u8", count, at + 24)
    ends = (at + 24 + 8 * count + np.cumsum(sizes)).tolist()
    begins = [end - length for end, length in zip(ends, sizes.tolist(), strict=True)]
    blocks = (data[begin:end] for begin, end in zip(begins, ends, strict=True))
    return b"".join(zlib.decompressobj().decompress(block, size) for block in blocks)


def _read_stl(data: bytes) -> Mesh:
    count = int(np.frombuffer(data, "<u4", 1, 80)[0])
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data, facet, count, 84)["corners"].reshape(-1, 3) + np.float32(0)
    keys = np.ascontiguousarray(corners).view(np.dtype((np.void, 12))).ravel()
    _, first, number = np.unique(keys, return_index=True, return_inverse=True)
    return corners[first].astype(np.float32), number.reshape(-1, 3).astype(np.int32)


def _read_obj(data: bytes) -> Mesh:
    lines = data.splitlines()
    vertices = [line[2:].split() for line in lines if line.startswith(b"v ")]
    faces = [[corner.split(b"/")[0] for corner in line[2:].split()] for line in lines if line.startswith(b"f ")]
    points = np.array(vertices, np.float64).reshape(-1, 3)
    return points, np.array(faces, np.int32).reshape(-1, 3) - 1


#: suffix -> reader of a whole file's bytes: one for each of the writers.
READ_BACK: dict[str, Callable[[bytes], Mesh]] = {
    ".gii": _read_gifti,
    ".glb": _read_glb,
    ".obj": _read_obj,
    ".ply": _read_ply,
    ".stl": _read_stl,
    ".vtp": _read_vtp,
}
