"""PLY, binary little-endian: float32 coordinates, or double where the surface is float64."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.surface import Point, Surface
from isocore.writers.names import column_names
from isocore.writers.pieces import offset_text, pieces

#: Of a part without a colour beside others that have one.
_GREY = (200, 200, 200)
#: What PLY and its readers mean something else by.
_TAKEN = ("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "alpha", "vertex_indices")
_RGB = ("red", "green", "blue")


def write_ply(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write vertices, normals, fields and triangles, and of parts what they have: colours, labels, isovalues."""
    fields = column_names(surface.fields, _TAKEN)
    colours = _colours(surface)
    of_faces = _of_faces(surface)
    properties = [f"property {_NAMES[dtype]} {name}" for name, dtype in _field_columns(surface, fields)]
    properties += [f"property uchar {name}" for name in _RGB if colours is not None]
    more = [f"property {_NAMES[values.dtype.str[1:]]} {name}" for name, values in of_faces.items()]
    comments = [f"comment field {' '.join(columns)}: {name}" for name, columns in fields.items() if columns != [name]]
    comments = [line.encode("ascii", "backslashreplace").decode() for line in comments]
    elements = (*comments, *_elements(surface, properties), *more)
    stream.write(_header(surface.space, surface.unit, surface.offset, elements))
    _write_vertices(stream, surface, fields, colours)
    if not of_faces:
        for triangles in pieces(surface.triangles):
            stream.write(_kernels.ply_faces(triangles, threads).data)
        return
    face: Any = [("count", "u1"), ("corners", "<i4", 3), *((name, values.dtype) for name, values in of_faces.items())]
    for begin, triangles in _numbered(surface.triangles):
        faces = np.empty(len(triangles), np.dtype(face))
        faces["count"], faces["corners"] = 3, triangles
        for name, values in of_faces.items():
            faces[name] = values[begin : begin + len(triangles)]
        stream.write(faces.data)


_NAMES = {"f4": "float", "f8": "double", "i4": "int", "u1": "uchar"}


def _write_vertices(
    stream: BinaryIO, surface: Surface, fields: dict[str, list[str]], colours: npt.NDArray[np.uint8] | None
) -> None:
    place = surface.vertices.dtype.newbyteorder("<")
    columns = _field_columns(surface, fields)
    if surface.normals is None and not columns and colours is None:
        stream.write(surface.vertices.astype(place, copy=False).data)
        return
    row: Any = [("place", place, 3)]
    row += [("normal", "<f4", 3)] if surface.normals is not None else []
    row += [(name, f"<{dtype}") for name, dtype in columns]
    row += [("colour", "u1", 3)] if colours is not None else []
    for begin, vertices in _numbered(surface.vertices):
        some = slice(begin, begin + len(vertices))
        rows = np.empty(len(vertices), np.dtype(row))
        rows["place"] = vertices
        if surface.normals is not None:
            rows["normal"] = surface.normals[some]
        for name, values in surface.fields.items():
            for n, column in enumerate(fields[name]):
                rows[column] = values[some] if values.ndim == 1 else values[some, n]
        if colours is not None:
            rows["colour"] = colours[some]
        stream.write(rows.data)


def _field_columns(surface: Surface, fields: dict[str, list[str]]) -> list[tuple[str, str]]:
    """Each column of each field, and its type."""
    return [(column, surface.fields[name].dtype.str[1:]) for name in fields for column in fields[name]]


def _numbered(rows: npt.NDArray[Any]) -> Iterator[tuple[int, npt.NDArray[Any]]]:
    """As pieces, with the number of the first row."""
    begin = 0
    for some in pieces(rows):
        yield begin, some
        begin += len(some)


def _colours(surface: Surface) -> npt.NDArray[np.uint8] | None:
    """(v, 3) of the vertices' own, or of their parts; None where nothing has one."""
    if surface.colours is not None:
        return surface.colours
    if not any(part.colour for part in surface.parts):
        return None
    each = np.array([part.colour or _GREY for part in surface.parts], np.uint8)
    return np.repeat(each, [part.vertices for part in surface.parts], axis=0)


def _of_faces(surface: Surface) -> dict[str, npt.NDArray[Any]]:
    """What parts say of their triangles."""
    parts, counts = surface.parts, [part.triangles for part in surface.parts]
    found: dict[str, npt.NDArray[Any]] = {}
    if any(part.label is not None for part in parts):
        # Labels of 32 bits without a sign do not all fit into an int.
        fits = all(-(2**31) <= (part.label or 0) < 2**31 for part in parts)
        found["label"] = np.repeat(np.array([part.label or 0 for part in parts], "<i4" if fits else "<f8"), counts)
    if any(part.isovalue is not None for part in parts):
        isovalues = np.array([np.nan if part.isovalue is None else part.isovalue for part in parts], "<f8")
        found["isovalue"] = np.repeat(isovalues, counts)
    return found


def write_ply_points(
    stream: BinaryIO,
    points: npt.NDArray[Any],
    name: str,
    values: npt.NDArray[Any],
    *,
    space: str,
    unit: str,
    offset: Point | None = None,
) -> None:
    """Write points (n, 3) with a value each, the scalar property `name` (n,); all float32."""
    row: Any = np.dtype([("place", "<f4", 3), ("value", "<f4")])
    rows = np.empty(len(points), row)
    rows["place"], rows["value"] = points, values
    properties = (f"property float {each}" for each in ("x", "y", "z", name))
    stream.write(_header(space, unit, offset, (f"element vertex {len(rows)}", *properties)))
    stream.write(rows.data)


def _header(space: str, unit: str, offset: Point | None, elements: Iterable[str]) -> bytes:
    """The lines before the data. elements: each element and each property, as PLY writes them."""
    lines = ["ply", "format binary_little_endian 1.0"]
    if space != "native":
        lines.append(f"comment SPACE={space.upper()}")
    if unit:
        lines.append(f"comment units {unit}")
    if offset is not None:
        lines.append(f"comment offset {offset_text(offset)}")
    return "".join(f"{line}\n" for line in (*lines, *elements, "end_header")).encode("ascii")


def _elements(surface: Surface, more: Iterable[str]) -> Iterator[str]:
    """Vertices with their places, normals and `more` properties; faces."""
    real = "float" if surface.vertices.dtype == np.float32 else "double"
    yield f"element vertex {len(surface.vertices)}"
    yield from (f"property {real} {axis}" for axis in "xyz")
    if surface.normals is not None:
        yield from (f"property float n{axis}" for axis in "xyz")
    yield from more
    yield f"element face {len(surface.triangles)}"
    yield "property list uchar int vertex_indices"
