"""PLY, binary little-endian: float32 coordinates, or double where the surface is float64."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.surface import Point, Surface
from isocore.writers.pieces import offset_text, pieces

#: Of a part without a colour beside others that have one.
_GREY = (200, 200, 200)


def write_ply(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write vertices, normals and triangles, and of parts what they have: colours, labels."""
    if surface.parts:
        _write_parts(stream, surface)
        return
    stream.write(_header(surface.space, surface.unit, surface.offset, _elements(surface)))
    if surface.normals is None:
        stream.write(surface.vertices.astype(surface.vertices.dtype.newbyteorder("<"), copy=False).data)
    else:
        row = np.dtype([("place", surface.vertices.dtype.newbyteorder("<"), 3), ("normal", "<f4", 3)])
        for vertices, normals in zip(pieces(surface.vertices), pieces(surface.normals), strict=True):
            rows = np.empty(len(vertices), row)
            rows["place"], rows["normal"] = vertices, normals
            stream.write(rows.data)
    for triangles in pieces(surface.triangles):
        stream.write(_kernels.ply_faces(triangles, threads).data)


def _write_parts(stream: BinaryIO, surface: Surface) -> None:
    """A colour for every vertex and a label for every triangle, part by part."""
    coloured = any(part.colour for part in surface.parts)
    labelled = any(part.label is not None for part in surface.parts)
    names = ("red", "green", "blue") if coloured else ()
    colours = tuple(f"property uchar {name}" for name in names)
    # Labels of 32 bits without a sign do not all fit into an int.
    fits = all(-(2**31) <= (part.label or 0) < 2**31 for part in surface.parts)
    label = (f"property {'int' if fits else 'double'} label",) if labelled else ()
    vertex, *rest = _elements(surface)
    at = next(n for n, line in enumerate(rest) if line.startswith("element face"))
    stream.write(
        _header(surface.space, surface.unit, surface.offset, (vertex, *rest[:at], *colours, *rest[at:], *label))
    )
    row: Any = [("place", surface.vertices.dtype.newbyteorder("<"), 3)]
    row += [("normal", "<f4", 3)] if surface.normals is not None else []
    row += [("colour", "u1", 3)] if coloured else []
    begin = 0
    for part in surface.parts:
        end = begin + part.vertices
        rows = np.empty(part.vertices, np.dtype(row))
        rows["place"] = surface.vertices[begin:end]
        if surface.normals is not None:
            rows["normal"] = surface.normals[begin:end]
        if coloured:
            rows["colour"] = part.colour or _GREY
        stream.write(rows.data)
        begin = end
    face: Any = [("count", "u1"), ("corners", "<i4", 3)] + ([("label", "<i4" if fits else "<f8")] if labelled else [])
    begin = 0
    for part in surface.parts:
        faces = np.empty(part.triangles, np.dtype(face))
        faces["count"], faces["corners"] = 3, surface.triangles[begin : begin + part.triangles]
        if labelled:
            faces["label"] = 0 if part.label is None else part.label
        stream.write(faces.data)
        begin += part.triangles


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


def _elements(surface: Surface) -> Iterator[str]:
    real = "float" if surface.vertices.dtype == np.float32 else "double"
    yield f"element vertex {len(surface.vertices)}"
    yield from (f"property {real} {axis}" for axis in "xyz")
    if surface.normals is not None:
        yield from (f"property float n{axis}" for axis in "xyz")
    yield f"element face {len(surface.triangles)}"
    yield "property list uchar int vertex_indices"
