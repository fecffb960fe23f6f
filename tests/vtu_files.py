"""A small VTU writer of our own, able to write every encoding the format allows, and some that lie."""

from __future__ import annotations

import base64
import lzma
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

TYPE_NAMES = {"i": "Int", "u": "UInt", "f": "Float"}
COMPRESSORS = {
    "zlib": ("vtkZLibDataCompressor", zlib.compress),
    "lzma": ("vtkLZMADataCompressor", lzma.compress),
}
PART = 256  # bytes inflated per compressed part: small, so that test meshes have several


@dataclass(frozen=True)
class Mesh:
    """Points (n, 3), cells as (type, corners) rows, fields (tuples, ...) by name; cell_arrays: more of <Cells>."""

    points: Any
    cells: list[tuple[int, list[int]]]
    point_fields: dict[str, Any] = field(default_factory=dict)
    cell_fields: dict[str, Any] = field(default_factory=dict)
    cell_arrays: dict[str, Any] = field(default_factory=dict)

    def with_field(self, name: str, values: Any) -> Mesh:
        return replace(self, point_fields={**self.point_fields, name: np.asarray(values)})


@dataclass(frozen=True)
class Encoding:
    """format: ascii, binary or appended. joint: base64 header and bytes in one go, as VTK does not."""

    format: str = "ascii"
    appended: str = "raw"
    compressor: str = ""
    header: str = "UInt32"
    byte_order: str = "LittleEndian"
    joint: bool = False

    def __str__(self) -> str:
        return "-".join(
            str(part)
            for part in (
                self.format,
                self.appended,
                self.compressor or "plain",
                self.header,
                self.byte_order,
                "joint" if self.joint else "apart",
            )
        )

    def dtype(self, dtype: Any) -> np.dtype[Any]:
        return np.dtype(dtype).newbyteorder("<" if self.byte_order == "LittleEndian" else ">")

    def block(self, values: Any, *, base64_text: bool) -> bytes:
        """One array as a block: header and bytes, compressed, in base64 if asked for."""
        payload = values.astype(self.dtype(values.dtype)).tobytes()
        header = [len(payload)]
        if self.compressor:
            parts = [payload[i : i + PART] for i in range(0, len(payload), PART)]
            packed = [COMPRESSORS[self.compressor][1](part) for part in parts]
            header = [len(parts), PART, len(payload) % PART, *(len(part) for part in packed)]
            payload = b"".join(packed)
        head = np.array(header, self.dtype(self.header.lower())).tobytes()
        if not base64_text:
            return head + payload
        if self.joint:
            return base64.b64encode(head + payload)
        return base64.b64encode(head) + base64.b64encode(payload)


def every_encoding() -> list[Encoding]:
    """Each format with each compressor, header type and byte order it can have."""
    found = [Encoding()]
    for header in ("UInt32", "UInt64"):
        for order in ("LittleEndian", "BigEndian"):
            for compressor in ("", "zlib", "lzma"):
                found.append(Encoding("appended", "raw", compressor, header, order))
                for joint in (False, True):
                    found.append(Encoding("binary", "", compressor, header, order, joint))
                    found.append(Encoding("appended", "base64", compressor, header, order, joint))
    return found


def write(path: Path, meshes: Mesh | list[Mesh], encoding: Encoding = Encoding(), **types: str) -> Path:
    """The meshes as the pieces of one file. types: dtype of points, connectivity, offsets, types."""
    blocks: list[bytes] = []
    pieces = [meshes] if isinstance(meshes, Mesh) else meshes
    body = "".join(_piece(mesh, encoding, blocks, types) for mesh in pieces)
    compressor = f' compressor="{COMPRESSORS[encoding.compressor][0]}"' if encoding.compressor else ""
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0"'
        f' byte_order="{encoding.byte_order}" header_type="{encoding.header}"{compressor}>\n'
        f"<UnstructuredGrid>\n{body}</UnstructuredGrid>\n"
    ).encode()
    if encoding.format == "appended":
        start = f'<AppendedData encoding="{encoding.appended}">\n_'.encode()
        text += start + b"".join(blocks) + b"\n</AppendedData>\n"
    path.write_bytes(text + b"</VTKFile>\n")
    return path


def _piece(mesh: Mesh, encoding: Encoding, blocks: list[bytes], types: dict[str, str]) -> str:
    def array(name: str, values: Any) -> str:
        return _array(name, np.asarray(values), encoding, blocks)

    corners = np.array(
        [corner for _, cell in mesh.cells for corner in cell], types.get("connectivity", "int64")
    )
    offsets = np.cumsum([len(cell) for _, cell in mesh.cells]).astype(types.get("offsets", "int64"))
    numbers = np.array([number for number, _ in mesh.cells], types.get("types", "uint8"))
    points = np.asarray(mesh.points, types.get("points", "float64"))
    of_points = "".join(array(name, values) for name, values in mesh.point_fields.items())
    of_cells = "".join(array(name, values) for name, values in mesh.cell_fields.items())
    cells = array("connectivity", corners) + array("offsets", offsets) + array("types", numbers)
    cells += "".join(array(name, values) for name, values in mesh.cell_arrays.items())
    return (
        f'<Piece NumberOfPoints="{len(mesh.points)}" NumberOfCells="{len(mesh.cells)}">\n'
        f"<PointData>\n{of_points}</PointData>\n<CellData>\n{of_cells}</CellData>\n"
        f"<Points>\n{array('Points', points)}</Points>\n<Cells>\n{cells}</Cells>\n</Piece>\n"
    )


def _array(name: str, values: Any, encoding: Encoding, blocks: list[bytes]) -> str:
    kind = f"{TYPE_NAMES[values.dtype.kind]}{8 * values.dtype.itemsize}"
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    tag = f'<DataArray type="{kind}" Name="{name}"{components} format="{encoding.format}"'
    if encoding.format == "appended":
        offset = sum(map(len, blocks))
        blocks.append(encoding.block(values, base64_text=encoding.appended == "base64"))
        return f'{tag} offset="{offset}"/>\n'
    if encoding.format == "ascii":
        words = " ".join(repr(number) for number in values.ravel().tolist())
        return f"{tag}>\n  {words}\n</DataArray>\n"
    return f"{tag}>\n  {encoding.block(values, base64_text=True).decode()}\n</DataArray>\n"
