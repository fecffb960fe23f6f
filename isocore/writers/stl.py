"""STL, binary: one 50-byte record per triangle, its own normal first; no shared vertices, no float64."""

from __future__ import annotations

import struct
from typing import BinaryIO

import numpy as np

from isocore import _kernels
from isocore.errors import OutputError
from isocore.surface import Surface
from isocore.writers.pieces import merge_warning, pieces


def write_stl(stream: BinaryIO, surface: Surface, threads: int) -> tuple[str, ...]:
    """Write all triangles; warns if float32 lets vertices of a float64 surface fall together."""
    if len(surface.triangles) >= 2**32:
        raise OutputError(f"STL cannot count {len(surface.triangles):,} triangles; write PLY")
    stream.write(_header(surface) + struct.pack("<I", len(surface.triangles)))
    for triangles in pieces(surface.triangles):
        stream.write(_kernels.stl_records(surface.vertices, triangles, threads).data)
    if surface.vertices.dtype == np.float32:
        return ()
    return merge_warning(surface.vertices, surface.vertices.astype(np.float32), "STL keeps float32 only")


def _header(surface: Surface) -> bytes:
    """80 bytes that never start with "solid", which would make readers take the file for text."""
    words = ["isocore", "binary STL"]
    if surface.space != "native":
        words.append(f"SPACE={surface.space.upper()}")
    if surface.unit:
        words.append(f"units={surface.unit}")
    return " ".join(words).encode("ascii")[:80].ljust(80)
