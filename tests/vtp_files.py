"""VTP files read by the letter of "VTK File Formats", without any of our own code."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

_TYPES = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}


@dataclass
class VtpFile:
    """The arrays by their names; polys: (t, 3)."""

    points: dict[str, Any]
    point_data: dict[str, Any]
    cell_data: dict[str, Any]
    field_data: dict[str, Any]
    polys: Any
    marked: dict[str, str]

    @classmethod
    def of(cls, path: Path) -> VtpFile:
        data = path.read_bytes()
        at = data.index(b"<AppendedData")
        start = data.index(b"_", at) + 1
        root = ElementTree.fromstring(data[:at] + b"</VTKFile>")
        assert root.attrib["type"] == "PolyData" and root.attrib["header_type"] == "UInt64"
        packed = root.attrib.get("compressor") == "vtkZLibDataCompressor"
        piece = root.find("PolyData/Piece")
        assert piece is not None
        counts = {"PointData": "NumberOfPoints", "Points": "NumberOfPoints", "CellData": "NumberOfPolys"}

        def section(tag: str) -> dict[str, Any]:
            found = {}
            for array in piece.find(tag) or ():
                raw = _array(data, start + int(array.attrib["offset"]), packed)
                rows = np.frombuffer(raw, _TYPES[array.attrib["type"]])
                if "NumberOfComponents" in array.attrib:
                    rows = rows.reshape(-1, int(array.attrib["NumberOfComponents"]))
                if tag in counts:
                    assert len(rows) == int(piece.attrib[counts[tag]])
                found[array.attrib["Name"]] = rows
            return found

        polys = section("Polys")
        corners = polys["connectivity"].reshape(-1, 3)
        assert len(corners) == int(piece.attrib["NumberOfPolys"])
        assert (polys["offsets"] == 3 * np.arange(1, len(corners) + 1)).all()
        texts = {}
        for one in root.find("PolyData/FieldData") or ():
            words = (one.text or "").split()
            is_text = one.attrib["type"] == "String"
            texts[one.attrib["Name"]] = bytes(map(int, words[:-1])).decode() if is_text else [float(w) for w in words]
        marked = dict(piece.find("PointData").attrib)
        return cls(section("Points"), section("PointData"), section("CellData"), texts, corners, marked)


def _array(data: bytes, at: int, packed: bool) -> bytes:
    if not packed:
        (size,) = struct.unpack_from("<Q", data, at)
        return data[at + 8 : at + 8 + size]
    count, block, last = struct.unpack_from("<3Q", data, at)
    sizes = struct.unpack_from(f"<{count}Q", data, at + 24)
    at += 24 + 8 * count
    found = []
    for n, size in enumerate(sizes):
        found.append(zlib.decompress(data[at : at + size]))
        assert len(found[-1]) == (last if n == count - 1 and last else block)
        at += size
    return b"".join(found)
