"""OBJ: text with nine significant digits, vertices counted from one."""

from __future__ import annotations

from typing import BinaryIO

from isocore import _kernels
from isocore.surface import Surface
from isocore.writers.pieces import offset_text, pieces


def write_obj(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write vertices, normals if any, triangles."""
    stream.write(_header(surface).encode("ascii"))
    for vertices in pieces(surface.vertices):
        stream.write(_kernels.format_rows("v", vertices, threads))
    if surface.normals is not None:
        for normals in pieces(surface.normals):
            stream.write(_kernels.format_rows("vn", normals, threads))
    for triangles in pieces(surface.triangles):
        stream.write(_kernels.format_faces(triangles, surface.normals is not None, threads))


def _header(surface: Surface) -> str:
    lines = ["# isocore"]
    if surface.space != "native":
        lines.append(f"# SPACE={surface.space.upper()}")
    if surface.unit:
        lines.append(f"# vertex coordinates are measured in units, where 1 unit = 1.000000 {surface.unit}")
    if surface.offset is not None:
        lines.append(f"# offset {offset_text(surface.offset)}: the point that coordinates are measured from")
    return "\n".join([*lines, ""])

