"""Find the arrays of a VTU file without reading them.

A VTU file is XML around large blocks of numbers, and appended raw blocks are not XML at all. Only the tags go
through the XML parser, one at a time; the text between them is remembered as a pair of byte offsets.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import prod
from mmap import mmap
from xml.parsers import expat

from isocore.errors import InputError

UNSTRUCTURED, IMAGE = "UnstructuredGrid", "ImageData"
#: First and last indices along each axis.
Extent = tuple[int, int, int, int, int, int]
SECTIONS = ("PointData", "CellData", "Points", "Cells")
_TAG = re.compile(rb"""<(?:[^<>"']++|"[^"<]*+"|'[^'<]*+')*+>""")
_TEXT = re.compile(rb"\S")


class UnusualLayout(Exception):
    """Legal XML that the tag scan does not follow before it is written plainly."""


@dataclass(frozen=True, slots=True)
class ArrayTag:
    """One <DataArray>: what it holds and where its numbers are.

    offset: into the appended data, or None. text: (first, end) byte offsets of the inline data.
    """

    name: str
    type: str
    components: int
    format: str
    offset: int | None
    text: tuple[int, int]


@dataclass(slots=True)
class Piece:
    """One <Piece>: the sizes it promises and its arrays by section. extent: of an image, its first and last indices."""

    points: int
    cells: int
    extent: Extent = (0, 0, 0, 0, 0, 0)
    arrays: dict[str, list[ArrayTag]] = field(default_factory=lambda: {name: [] for name in SECTIONS})

    def named(self, section: str, *names: str) -> list[ArrayTag]:
        """The first array of each name that is there: of several time steps, the first."""
        found = {tag.name: tag for tag in reversed(self.arrays[section]) if tag.name in names}
        return list(found.values())


@dataclass(slots=True)
class Layout:
    """What the tags say. appended: (encoding, byte offset behind the underscore), or None.

    grid: attributes of the tag around the pieces, which place an image in the world.
    """

    version: tuple[int, int] = (0, 1)
    byte_order: str = "LittleEndian"
    header_type: str = "UInt32"
    compressor: str = ""
    pieces: list[Piece] = field(default_factory=list)
    appended: tuple[str, int] | None = None
    grid: dict[str, str] = field(default_factory=dict)


class _Scan:
    """Builds a Layout from the start and end tags it is told of."""

    def __init__(self, path: str, kind: str) -> None:
        self.path, self.kind = path, kind
        self.layout = Layout()
        self.open: list[tuple[str, dict[str, str]]] = []
        self.runs: list[tuple[int, int]] = []
        self.appended: str | None = None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.open.append((tag, attributes))
        if len(self.open) == 1:
            self._root(tag, attributes)
        elif tag == self.kind:
            self.layout.grid = attributes
        elif tag == "Piece":
            self.layout.pieces.append(self._piece(attributes))
        elif tag == "DataArray":
            self.runs = []
        elif tag == "AppendedData":
            self.appended = attributes.get("encoding", "base64")

    def end(self, tag: str) -> None:
        _, attributes = self.open.pop()
        section = self.open[-1][0] if self.open else ""
        if tag == "DataArray" and section in SECTIONS and self.layout.pieces:
            self.layout.pieces[-1].arrays[section].append(self._array(attributes, section))

    def text(self, first: int, end: int) -> None:
        if self.open and self.open[-1][0] == "DataArray":
            self.runs.append((first, end))

    def _root(self, tag: str, attributes: dict[str, str]) -> None:
        if tag != "VTKFile":
            raise InputError(
                f"{self.path}: is not a VTK file (its first tag is <{tag}>); a .vtu starts with <VTKFile>"
            )
        kind = attributes.get("type", "")
        if kind != self.kind:
            what = f"{self.path}: holds a VTK {kind or 'object of no type'}, not an {self.kind}"
            raise InputError(f"{what}; convert it to one" + " with cells that fill space" * (self.kind == UNSTRUCTURED))
        layout = self.layout
        if match := re.match(r"\s*(\d{1,9})\.(\d{1,9})", attributes.get("version", "")):
            layout.version = int(match[1]), int(match[2])
        layout.byte_order = attributes.get("byte_order", layout.byte_order)
        layout.header_type = attributes.get("header_type", layout.header_type)
        layout.compressor = attributes.get("compressor", "")
        if layout.byte_order not in ("LittleEndian", "BigEndian"):
            raise InputError(
                f"{self.path}: byte_order {layout.byte_order!r} is unknown; LittleEndian or BigEndian"
            )
        if layout.header_type not in ("UInt32", "UInt64"):
            raise InputError(f"{self.path}: header_type {layout.header_type!r} is unknown; UInt32 or UInt64")

    def _piece(self, attributes: dict[str, str]) -> Piece:
        if self.kind == UNSTRUCTURED:
            return Piece(self._count(attributes, "NumberOfPoints"), self._count(attributes, "NumberOfCells"))
        extent = extent_of(self.path, attributes.get("Extent", ""))
        sizes = [high - low + 1 for low, high in zip(extent[::2], extent[1::2], strict=True)]
        return Piece(prod(sizes), prod(max(1, size - 1) for size in sizes), extent)

    def _array(self, attributes: dict[str, str], section: str) -> ArrayTag:
        name = attributes.get("Name", section)
        where = f"array {name!r}: "
        if len(self.runs) > 1:
            raise UnusualLayout(f"{where}text in several parts")
        components = attributes.get("NumberOfComponents", "").strip()
        default = 3 if section == "Points" else 1
        return ArrayTag(
            name=name,
            type=attributes.get("type", ""),
            components=self._count(attributes, "NumberOfComponents", where) if components else default,
            format=attributes.get("format", "ascii"),
            offset=self._count(attributes, "offset", where) if "offset" in attributes else None,
            text=self.runs[0] if self.runs else (0, 0),
        )

    def _count(self, attributes: dict[str, str], name: str, where: str = "") -> int:
        given = attributes.get(name, "").strip()
        text = given.removeprefix("+").lstrip()
        if not text.isascii() or not text.isdigit() or len(text) > 18:
            raise InputError(f"{self.path}: {where}{name} is {given!r}, not a count; write the file again")
        return int(text)


def extent_of(path: str, text: str) -> Extent:
    """First and last index along each axis; InputError where these are not six numbers that ascend in pairs."""
    words = text.split()
    numbers = [int(word) for word in words if re.fullmatch(r"[+-]?\d{1,9}", word, re.ASCII)]
    if len(numbers) != 6 or len(words) != 6 or any(numbers[n] > numbers[n + 1] for n in (0, 2, 4)):
        raise InputError(f"{path}: has the extent {text[:60]!r}, not three pairs of indices; write it again")
    a, b, c, d, e, f = numbers
    return a, b, c, d, e, f


def scan(path: str, data: mmap | bytes, kind: str = UNSTRUCTURED) -> Layout:
    """The layout of the VTU file mapped as `data`, or of another kind of VTK's XML files.

    Raises InputError where its tags are not what they should be.
    """
    if data[:2] in (b"\xff\xfe", b"\xfe\xff", b"<\0", b"\0<"):
        raise UnusualLayout("UTF-16")
    seen = _Scan(path, kind)
    parser = expat.ParserCreate()
    parser.StartElementHandler = seen.start
    parser.EndElementHandler = seen.end
    position = 0
    try:
        for first, end in _tags(path, data):
            if _TEXT.search(data, position, first) is not None:
                seen.text(position, first)
            position = end
            if data[first : first + 4] != b"<!--":
                parser.Parse(data[first:end])
            if seen.appended is not None:
                seen.layout.appended = (seen.appended, _behind_underscore(path, data, end))
                return seen.layout
        parser.Parse(b"", True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        if not position:
            raise InputError(
                f"{path}: is not XML, so not a .vtu; check that it is what its suffix says"
            ) from error
        raise InputError(
            f"{path}: its XML is broken near byte {position:,} ({reason}); copy it again"
        ) from error
    return seen.layout


def _tags(path: str, data: mmap | bytes) -> Iterator[tuple[int, int]]:
    """(first, end) of every tag and comment in turn."""
    position = 0
    while (first := data.find(b"<", position)) >= 0:
        head = data[first : first + 9]
        if head == b"<![CDATA[" or head == b"<!DOCTYPE":
            raise UnusualLayout(head.decode("ascii"))
        if head.startswith(b"<!--"):
            position = data.find(b"-->", first) + 3
            if position < 3:
                raise InputError(f"{path}: ends inside a comment; copy it again")
        else:
            match = _TAG.match(data, first)
            if match is None:
                raise InputError(f"{path}: is broken near byte {first:,}: a tag is not closed; copy it again")
            position = match.end()
        yield first, position


def _behind_underscore(path: str, data: mmap | bytes, end: int) -> int:
    found = _TEXT.search(data, end)
    if found is None or found.group() != b"_":
        raise InputError(f"{path}: its appended data does not start with an underscore; copy it again")
    return found.end()
