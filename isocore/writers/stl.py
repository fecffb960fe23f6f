"""STL, binary: one 50-byte record per triangle, its own normal first; no shared vertices, no float64."""

from __future__ import annotations

import struct
from typing import BinaryIO

from isocore import _kernels
from isocore.errors import OutputError
from isocore.surface import Surface
from isocore.writers.pieces import offset_text, pieces


def write_stl(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write all triangles."""
    if len(surface.triangles) >= 2**32:
        raise OutputError(f"STL cannot count {len(surface.triangles):,} triangles; write PLY or VTP")
    stream.write(_header(surface) + struct.pack("<I", len(surface.triangles)))
    for triangles in pieces(surface.triangles):
        stream.write(_kernels.stl_records(surface.vertices, triangles, threads).data)


def _header(surface: Surface) -> bytes:
    """80 bytes that never start with "solid", which would make readers take the file for text."""
    words = ["isocore", "binary STL"]
    if surface.space != "native":
        words.append(f"SPACE={surface.space.upper()}")
    if surface.unit:
        words.append(f"units={surface.unit}")
    if surface.offset is not None:
        words.append(f"offset={offset_text(surface.offset, ',')}")
        if len(" ".join(words)) > 80:  # the digits of a place are of use whole or not at all
            words.pop()
    return " ".join(words).encode("ascii")[:80].ljust(80)
