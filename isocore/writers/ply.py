"""PLY, binary little-endian: float32 coordinates, or double where the surface is float64."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from isocore import _kernels
from isocore.surface import Surface
from isocore.writers.pieces import pieces


def write_ply(stream: BinaryIO, surface: Surface, threads: int) -> tuple[str, ...]:
    """Write vertices, normals where there are any, and triangles."""
    stream.write(_header(surface).encode("ascii"))
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
    return ()


def _header(surface: Surface) -> str:
    real = "float" if surface.vertices.dtype == np.float32 else "double"
    lines = ["ply", "format binary_little_endian 1.0"]
    if surface.space != "native":
        lines.append(f"comment SPACE={surface.space.upper()}")
    if surface.unit:
        lines.append(f"comment units {surface.unit}")
    lines.append(f"element vertex {len(surface.vertices)}")
    lines += [f"property {real} {axis}" for axis in "xyz"]
    if surface.normals is not None:
        lines += [f"property float n{axis}" for axis in "xyz"]
    lines.append(f"element face {len(surface.triangles)}")
    lines.append("property list uchar int vertex_indices")
    lines.append("end_header")
    return "\n".join(lines) + "\n"
