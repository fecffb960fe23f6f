"""OBJ: text with nine significant digits, vertices counted from one."""

from __future__ import annotations

import re
from typing import BinaryIO

from isocore import _kernels
from isocore.surface import Part, Surface
from isocore.writers.pieces import offset_text, pieces


def write_obj(stream: BinaryIO, surface: Surface, threads: int, materials: str = "") -> None:
    """Write vertices, normals if any, triangles; each part as an object.

    materials: the name of the file beside that holds the parts' colours, or "".
    """
    stream.write(_header(surface).encode("ascii"))
    if materials:
        stream.write(f"mtllib {materials}\n".encode())
    for vertices in pieces(surface.vertices):
        stream.write(_kernels.format_rows("v", vertices, threads))
    if surface.normals is not None:
        for normals in pieces(surface.normals):
            stream.write(_kernels.format_rows("vn", normals, threads))
    begin = 0
    for part in surface.parts or (None,):
        end = len(surface.triangles) if part is None else begin + part.triangles
        if part is not None:
            stream.write(f"o {one_word(part.name)}\n".encode())
        if part is not None and materials:
            stream.write(f"usemtl {_material(part)}\n".encode())
        for triangles in pieces(surface.triangles[begin:end]):
            stream.write(_kernels.format_faces(triangles, surface.normals is not None, threads))
        begin = end


def write_materials(stream: BinaryIO, surface: Surface) -> None:
    """The colours of a surface's parts, as an OBJ file's `mtllib` names them."""
    stream.write(b"# isocore\n")
    for part in surface.parts:
        red, green, blue = (channel / 255 for channel in part.colour or (200, 200, 200))
        stream.write(f"newmtl {_material(part)}\nKd {red:.6g} {green:.6g} {blue:.6g}\n".encode())


def _material(part: Part) -> str:
    return one_word(part.name) if part.label is None else f"label_{part.label}"


def one_word(name: str) -> str:
    """A name without blanks and line ends, which would end it."""
    return re.sub(r"\s+", "_", name.strip()) or "surface"


def _header(surface: Surface) -> str:
    lines = ["# isocore"]
    if surface.space != "native":
        lines.append(f"# SPACE={surface.space.upper()}")
    if surface.unit:
        lines.append(f"# vertex coordinates are measured in units, where 1 unit = 1.000000 {surface.unit}")
    if surface.offset is not None:
        lines.append(f"# offset {offset_text(surface.offset)}: the point that coordinates are measured from")
    return "\n".join([*lines, ""])

