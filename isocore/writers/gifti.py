"""GIFTI: an XML file of arrays, vertices in RAS millimetres, as programs of brain imaging read it.

"GIFTI Surface Data Format", version 1.0, 2011. Arrays are base64 without further packing, whose bytes would depend on
the library that packs.
"""

from __future__ import annotations

from base64 import b64encode
from dataclasses import replace
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore.surface import Part, Surface
from isocore.volume import to_ras
from isocore.writers.pieces import pieces

_HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<!DOCTYPE GIFTI SYSTEM "http://www.nitrc.org/frs/download.php/115/gifti.dtd">\n'
    '<GIFTI Version="1.0" NumberOfDataArrays="{arrays}">\n<MetaData/>\n{labels}\n'
)
_ARRAY = (
    '<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{type}" ArrayIndexingOrder="RowMajorOrder"'
    ' {sizes} Encoding="Base64Binary" Endian="LittleEndian" ExternalFileName=""'
    ' ExternalFileOffset="">\n{meta}\n{more}<Data>'
)
_NAME = "<MetaData><MD><Name><![CDATA[Name]]></Name><Value><![CDATA[{}]]></Value></MD></MetaData>"
_COLOURS = ("Red", "Green", "Blue")
_NO_META = "<MetaData/>"
_PLACE = (
    "<CoordinateSystemTransformMatrix>\n<DataSpace><![CDATA[NIFTI_XFORM_{own}]]></DataSpace>\n"
    "<TransformedSpace><![CDATA[NIFTI_XFORM_{world}]]></TransformedSpace>\n"
    "<MatrixData>\n1 0 0 {x}\n0 1 0 {y}\n0 0 1 {z}\n0 0 0 1\n</MatrixData>\n</CoordinateSystemTransformMatrix>\n"
)


def write_gifti(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write vertices, triangles, normals and fields, these as float32 with their names.

    A surface in LPS or LAS is turned to RAS; one of no known space stays.
    """
    turn = to_ras(surface.space)
    if turn is not None:
        offset = None if surface.offset is None else tuple((turn[:3, :3] @ surface.offset).tolist())
        placed = surface.placed(turn, space="ras", threads=threads)
        surface = replace(placed, parts=surface.parts, offset=offset)
    arrays: list[tuple[str, str, npt.NDArray[Any], str, str]] = [
        ("POINTSET", "<f4", surface.vertices, _place(surface), _NO_META),
        ("TRIANGLE", "<i4", surface.triangles, "", _NO_META),
    ]
    if surface.normals is not None:
        arrays.append(("VECTOR", "<f4", surface.normals, "", _NO_META))
    labelled = [part for part in surface.parts if part.label is not None]
    if labelled and len(labelled) == len(surface.parts):
        of_vertices = np.repeat([part.label or 0 for part in labelled], [part.vertices for part in labelled])
        arrays.append(("LABEL", "<i4", of_vertices, "", _NO_META))
    for name, values in surface.fields.items():
        with np.errstate(over="ignore"):  # beyond float32 it is an infinity
            rows = values.astype("<f4")
        arrays.append(("SHAPE" if rows.ndim == 1 else "NONE", "<f4", rows, "", _NAME.format(_cdata(name))))
    stream.write(_HEAD.format(arrays=len(arrays), labels=_label_table(labelled)).encode())
    for intent, kind, rows, more, meta in arrays:
        name = "INT32" if kind == "<i4" else "FLOAT32"
        sizes = " ".join(f'Dim{axis}="{size}"' for axis, size in enumerate(rows.shape))
        sizes = f'Dimensionality="{rows.ndim}" {sizes}'
        stream.write(_ARRAY.format(intent=intent, type=name, sizes=sizes, more=more, meta=meta).encode())
        for piece in pieces(rows):  # of a number of bytes that 3 divides, so that their texts join
            stream.write(b64encode(np.ascontiguousarray(piece, dtype=kind).data))
        stream.write(b"</Data>\n</DataArray>\n")
    stream.write(b"</GIFTI>\n")


def _place(surface: Surface) -> str:
    """Which world the vertices are in, and how they get there from the point that they are measured from."""
    world = "SCANNER_ANAT" if surface.space == "ras" else "UNKNOWN"
    x, y, z = (repr(number).removesuffix(".0") for number in surface.offset or (0.0, 0.0, 0.0))
    return _PLACE.format(own="UNKNOWN" if surface.offset else world, world=world, x=x, y=y, z=z)


def _cdata(text: str) -> str:
    """What can stand in a CDATA section."""
    return "".join(c for c in text if c.isprintable() and not "\ud800" <= c <= "\udfff").replace("]]>", "] ]>")


def _label_table(parts: list[Part]) -> str:
    """The labels' names and colours, each once."""
    rows = []
    for part in {part.label: part for part in parts}.values():
        colour = "".join(
            f' {name}="{value / 255:.6g}"' for name, value in zip(_COLOURS, part.colour or (), strict=False)
        )
        name = _cdata(part.name)
        rows.append(f'<Label Key="{part.label}"{colour} Alpha="1"><![CDATA[{name}]]></Label>\n')
    return f"<LabelTable>\n{''.join(rows)}</LabelTable>" if rows else "<LabelTable/>"
