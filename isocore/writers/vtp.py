"""VTP, VTK's XML file of a surface: arrays appended in bytes, as they are or packed by zlib.

"VTK File Formats", section "XML File Formats": an XML head that says of each array where it begins behind the
underscore; there its length in bytes and its bytes, or the number and the sizes of its packed blocks, and these.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, BinaryIO
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

from isocore.errors import printable
from isocore.surface import Surface
from isocore.writers.pieces import offset_text, pieces

_TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64"}
_HEAD = (
    '<?xml version="1.0"?>\n'
    '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64"{}>\n'
)
#: Bytes that are packed at a time, and how hard, as VTK does by default.
_BLOCK, _LEVEL = 1 << 20, 5
_PIECE = (
    '<Piece NumberOfPoints="{points}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{polys}">\n'
)


@dataclass(frozen=True, slots=True)
class _Array:
    """One array of the file: its place in the XML, and its rows."""

    name: str
    rows: npt.NDArray[Any]


def write_vtp(
    stream: BinaryIO, surface: Surface, threads: int, *, compress: bool = False, time: float | None = None
) -> None:
    """Write vertices, triangles, normals and fields; of parts their isovalues and labels, as data of the cells.

    compress: pack arrays by zlib, whose bytes depend on the library. time: of the step of a series.
    """
    sections = _sections(surface)
    packed = [[_packed(array.rows, threads) for array in arrays] for arrays in sections.values()] if compress else []
    stream.write(_HEAD.format(' compressor="vtkZLibDataCompressor"' * compress).encode())
    lines = ["<PolyData>\n", *_field_data(surface, time)]
    lines.append(_PIECE.format(points=len(surface.vertices), polys=len(surface.triangles)))
    offset = 0
    for number, (tag, arrays) in enumerate(sections.items()):
        lines.append(f"<{tag}{_marked(tag, surface)}>\n")
        for place, array in enumerate(arrays):
            lines.append(_described(array, offset))
            offset += sum(map(len, packed[number][place])) if compress else 8 + array.rows.nbytes
        lines.append(f"</{tag}>\n")
    lines.append('</Piece>\n</PolyData>\n<AppendedData encoding="raw">\n_')
    stream.write("".join(lines).encode("utf-8", "replace"))
    for number, arrays in enumerate(sections.values()):
        for place, array in enumerate(arrays):
            for block in packed[number][place] if compress else _plain(array.rows):
                stream.write(block)
    stream.write(b"\n</AppendedData>\n</VTKFile>\n")


def _sections(surface: Surface) -> dict[str, list[_Array]]:
    """The arrays of the file, by their place in the XML, in its order."""
    normals = [] if surface.normals is None else [_Array("Normals", surface.normals)]
    fields = [_Array(name, values) for name, values in _named(surface.fields, {one.name for one in normals})]
    corners = surface.triangles.reshape(-1)
    narrow = len(corners) < 2**31
    ends = np.arange(3, len(corners) + 1, 3, dtype=np.int32 if narrow else np.int64)
    return {
        "PointData": normals + fields,
        "CellData": _of_cells(surface),
        "Points": [_Array("Points", surface.vertices)],
        "Polys": [_Array("connectivity", corners), _Array("offsets", ends)],
    }


def _named(fields: Mapping[str, npt.NDArray[Any]], taken: set[str]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Fields by names that are not taken yet: a number behind those that are."""
    for name, values in fields.items():
        own, number = name, 1
        while own in taken:
            number += 1
            own = f"{name}_{number}"
        taken.add(own)
        yield own, values


def _of_cells(surface: Surface) -> list[_Array]:
    """What parts say of their triangles."""
    parts, counts, found = surface.parts, [part.triangles for part in surface.parts], []
    if any(part.isovalue is not None for part in parts):
        isovalues = [np.nan if part.isovalue is None else part.isovalue for part in parts]
        found.append(_Array("isovalue", np.repeat(np.array(isovalues, np.float64), counts)))
    if any(part.label is not None for part in parts):
        labels = [0 if part.label is None else part.label for part in parts]
        found.append(_Array("label", np.repeat(np.array(labels, np.int64), counts)))
    return found


def _field_data(surface: Surface, time: float | None) -> Iterator[str]:
    """What is said of the whole: the time of a step, space, unit, the point that vertices are measured from."""
    yield "<FieldData>\n"
    if time is not None:
        yield _numbers("TimeValue", repr(float(time)), 1)
    if surface.offset is not None:
        yield _numbers("offset", offset_text(surface.offset), 3)
    for name, text in (("space", surface.space), ("unit", surface.unit)):
        if text and text != "native":
            codes = " ".join(str(byte) for byte in text.encode())
            yield f'<Array type="String" Name="{name}" NumberOfTuples="1" format="ascii">{codes} 0</Array>\n'
    yield "</FieldData>\n"


def _numbers(name: str, text: str, components: int) -> str:
    sizes = f'NumberOfComponents="{components}" NumberOfTuples="1"'
    return f'<DataArray type="Float64" Name="{name}" {sizes} format="ascii">{text}</DataArray>\n'


def _marked(tag: str, surface: Surface) -> str:
    """Which of the point data are the normals, and which a program shows first."""
    if tag != "PointData":
        return ""
    scalar = next((name for name, values in surface.fields.items() if values.ndim == 1), None)
    normals = "" if surface.normals is None else ' Normals="Normals"'
    return normals if scalar is None or scalar == "Normals" else f" Scalars={quoteattr(printable(scalar))}{normals}"


def _described(array: _Array, offset: int) -> str:
    rows = array.rows
    components = f' NumberOfComponents="{rows.shape[1]}"' if rows.ndim == 2 else ""
    kind = _TYPES[rows.dtype.str[1:]]
    name = quoteattr(printable(array.name))
    return f'<DataArray type="{kind}" Name={name}{components} format="appended" offset="{offset}"/>\n'


def _little(rows: npt.NDArray[Any]) -> Iterator[npt.NDArray[Any]]:
    for some in pieces(rows):
        yield np.ascontiguousarray(some, dtype=rows.dtype.newbyteorder("<"))


def _plain(rows: npt.NDArray[Any]) -> Iterator[bytes | memoryview]:
    """The length in bytes, then the bytes."""
    yield np.array([rows.nbytes], "<u8").tobytes()
    yield from (some.data for some in _little(rows))


def _packed(rows: npt.NDArray[Any], threads: int) -> list[bytes]:
    """The number of blocks, their size, that of the last if it is another, and what each became; then the blocks."""
    whole = memoryview(b"".join(some.tobytes() for some in _little(rows)))
    blocks = [whole[first : first + _BLOCK] for first in range(0, len(whole), _BLOCK)]
    found = _each_packed(blocks, threads)
    head = [len(blocks), _BLOCK, len(whole) % _BLOCK, *map(len, found)]
    return [np.array(head, "<u8").tobytes(), *found]


def _each_packed(blocks: Iterable[memoryview], threads: int) -> list[bytes]:
    with ThreadPoolExecutor(max(1, threads)) as pool:
        return list(pool.map(lambda block: zlib.compress(block, _LEVEL), blocks))
