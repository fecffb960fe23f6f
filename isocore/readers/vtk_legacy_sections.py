"""What stands where in a legacy VTK file: its grid and its arrays, found by keywords, none of their numbers read."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import prod

from isocore.errors import FieldError, InputError
from isocore.readers.vtk_legacy_arrays import Cursor, Located, plain_name

Arrays = dict[str, tuple[Located, int]]  # an array and its components, by name
KINDS = ("UNSTRUCTURED_GRID", "STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS")
#: Attributes of one array each, and how many components it has; 0 where the line says.
_ATTRIBUTES = {
    "SCALARS": 0, "VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "TEXTURE_COORDINATES": 0, "GLOBAL_IDS": 1,
    "PEDIGREE_IDS": 1, "EDGE_FLAGS": 1,
}  # fmt: skip
_MOST_COMPONENTS = 1 << 20


@dataclass(slots=True)
class Sections:
    """The grid, in the words of the format, and the arrays of its points and cells.

    cells: (stream,) of earlier files, (offsets, connectivity) since version 5.1. axes: of a rectilinear grid.
    """

    kind: str
    dimensions: tuple[int, int, int] = (0, 0, 0)
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    spacing: tuple[float, ...] = (1.0, 1.0, 1.0)
    points: Located | None = None
    axes: list[Located] = field(default_factory=list)
    cells: tuple[Located, ...] = ()
    types: Located | None = None
    of_points: Arrays = field(default_factory=dict)
    of_cells: Arrays = field(default_factory=dict)

    @property
    def counts(self) -> tuple[int, int]:
        """Points and cells."""
        if self.kind == "UNSTRUCTURED_GRID":
            return (self.points.count // 3 if self.points else 0), self.types.count if self.types else 0
        return prod(self.dimensions), prod(max(1, n - 1) for n in self.dimensions)


def sections(cursor: Cursor) -> Sections:
    """All of the file, keyword by keyword. Raises InputError where one is unknown or numbers are missing."""
    words = cursor.words()
    while words and words[0].upper() == "FIELD":  # of the whole data set; newer files have it behind the next line
        _field(cursor, words, {}, None)
        words = cursor.words()
    if len(words) < 2 or words[0].upper() != "DATASET":
        raise _unexpected(cursor, words, "DATASET")
    kind = words[1].upper()
    if kind == "POLYDATA":
        raise FieldError(f"{cursor.path}: holds only surface cells (POLYDATA); contouring needs cells that fill space")
    if kind not in KINDS:
        raise InputError(f"{cursor.path}: holds a {kind[:40]}, which is none of {', '.join(KINDS)}; write it as one")
    found = Sections(kind)
    target: tuple[Arrays, int] | None = None
    while words := cursor.words():
        key = words[0].upper()
        if key in ("POINT_DATA", "CELL_DATA"):
            at_points = key == "POINT_DATA"
            tuples, expected = _count(cursor, words, 1), found.counts[not at_points]
            if tuples != expected:
                raise InputError(
                    f"{cursor.path}: {key} is for {tuples:,} of them, there are {expected:,}; write the file again"
                )
            target = (found.of_points if at_points else found.of_cells), tuples
        elif key == "METADATA":
            _skip_block(cursor)
        elif target is None:
            _grid(cursor, words, found)
        else:
            _attribute(cursor, words, *target)
    _check_complete(cursor, found)
    return found


def _grid(cursor: Cursor, words: list[str], found: Sections) -> None:
    key = words[0].upper()
    if key == "FIELD":
        _field(cursor, words, {}, None)
    elif key == "POINTS":
        found.points = cursor.skip("POINTS", _word(cursor, words, 2), 3 * _count(cursor, words, 1))
    elif key == "CELLS":
        count, size = _count(cursor, words, 1), _count(cursor, words, 2)
        start, following = cursor.place, cursor.words()
        if following and following[0].upper() == "OFFSETS":
            offsets = cursor.skip("OFFSETS", _word(cursor, following, 1), count)
            following = cursor.words()
            if not following or following[0].upper() != "CONNECTIVITY":
                raise _unexpected(cursor, following, "CONNECTIVITY")
            found.cells = offsets, cursor.skip("CONNECTIVITY", _word(cursor, following, 1), size)
        else:
            cursor.place = start
            found.cells = (cursor.skip("CELLS", "int", size),)
    elif key == "CELL_TYPES":
        found.types = cursor.skip("CELL_TYPES", "int", _count(cursor, words, 1))
    elif key == "DIMENSIONS":
        found.dimensions = tuple(_count(cursor, words, n) for n in (1, 2, 3))  # type: ignore[assignment]
    elif key in ("ORIGIN", "SPACING", "ASPECT_RATIO"):
        numbers = tuple(_number(cursor, words, n) for n in (1, 2, 3))
        if key == "ORIGIN":
            found.origin = numbers
        else:
            found.spacing = numbers
    elif key in ("X_COORDINATES", "Y_COORDINATES", "Z_COORDINATES"):
        found.axes.append(cursor.skip(key, _word(cursor, words, 2), _count(cursor, words, 1)))
    else:
        raise _unexpected(cursor, words, "a keyword of the format")


def _attribute(cursor: Cursor, words: list[str], arrays: Arrays, tuples: int) -> None:
    key = words[0].upper()
    if key == "FIELD":
        _field(cursor, words, arrays, tuples)
    elif key == "LOOKUP_TABLE":
        cursor.skip("LOOKUP_TABLE", "unsigned_char" if cursor.binary else "float", 4 * _count(cursor, words, 2))
    elif key == "COLOR_SCALARS":
        components = _count(cursor, words, 2)
        kind = "unsigned_char" if cursor.binary else "float"
        _keep(cursor, arrays, words, kind, (tuples, components))
    elif key in _ATTRIBUTES:
        components, kind = _ATTRIBUTES[key], _word(cursor, words, 3 if key == "TEXTURE_COORDINATES" else 2)
        if key == "SCALARS":
            components = _count(cursor, words, 3) if len(words) > 3 else 1
            place = cursor.place
            if not cursor.at("LOOKUP_TABLE") or len(cursor.words()) != 2:
                cursor.place = place
        elif key == "TEXTURE_COORDINATES":
            components = _count(cursor, words, 2)
        _keep(cursor, arrays, words, kind, (tuples, components))
    else:
        raise _unexpected(cursor, words, "a keyword of the format")


def _keep(cursor: Cursor, arrays: Arrays, words: list[str], kind: str, size: tuple[int, int]) -> None:
    """The first array of a name is kept. size: tuples and components."""
    name = plain_name(_word(cursor, words, 1))
    if size[1] > _MOST_COMPONENTS:
        raise InputError(f"{cursor.path}: array {name!r} has {size[1]:,} components; write the file again")
    found = cursor.skip(name, kind, size[0] * size[1])
    if size[1]:
        arrays.setdefault(name, (found, size[1]))


def _field(cursor: Cursor, words: list[str], arrays: Arrays, tuples: int | None) -> None:
    """Arrays with headers of their own; tuples: how many each has to have, None for those of the data set."""
    for _ in range(_count(cursor, words, 2)):
        header = cursor.words()
        while header and header[0].upper() == "METADATA":
            _skip_block(cursor)
            header = cursor.words()
        if header == ["NULL_ARRAY"]:
            continue
        size = _count(cursor, header, 2), _count(cursor, header, 1)
        if tuples is not None and size[0] != tuples:
            name = plain_name(header[0])
            raise InputError(f"{cursor.path}: array {name!r} has {size[0]:,} tuples, not {tuples:,}; write it again")
        _keep(cursor, arrays, ["", *header], _word(cursor, header, 3), size)


def _skip_block(cursor: Cursor) -> None:
    """Lines up to an empty one."""
    while cursor.place < len(cursor.data):
        end = cursor.data.find(b"\n", cursor.place)
        end = len(cursor.data) if end < 0 else end
        line = cursor.data[cursor.place : min(end, cursor.place + 16)]
        cursor.place = end + 1
        if not line.strip():
            return


def _check_complete(cursor: Cursor, found: Sections) -> None:
    points, missing = found.counts[0], ""
    if found.kind == "UNSTRUCTURED_GRID":
        missing = next((name for name in ("points", "cells", "types") if not getattr(found, name)), "")
    elif not points:
        missing = "dimensions"
    elif found.kind == "STRUCTURED_GRID" and (found.points is None or found.points.count != 3 * points):
        missing = "points"
    elif found.kind == "RECTILINEAR_GRID" and tuple(axis.count for axis in found.axes) != found.dimensions:
        missing = "coordinates"
    if missing:
        raise InputError(f"{cursor.path}: lacks the {missing} of its {found.kind}; copy it again")


def _word(cursor: Cursor, words: list[str], n: int) -> str:
    if n >= len(words):
        raise InputError(f"{cursor.path}: its line {' '.join(words)[:60]!r} is cut short; copy it again")
    return words[n]


def _count(cursor: Cursor, words: list[str], n: int) -> int:
    word = _word(cursor, words, n)
    if not word.isascii() or not word.removeprefix("+").isdigit() or len(word) > 18:
        raise InputError(f"{cursor.path}: has {word[:40]!r} in its line {' '.join(words)[:60]!r}, not a count")
    return int(word)


def _number(cursor: Cursor, words: list[str], n: int) -> float:
    try:
        return float(_word(cursor, words, n))
    except ValueError:
        raise InputError(f"{cursor.path}: has no number in its line {' '.join(words)[:60]!r}; write it again") from None


def _unexpected(cursor: Cursor, words: list[str], wanted: str) -> InputError:
    found = repr(" ".join(words)[:40]) if words else "the end of the file"
    behind = f", behind {cursor.last}" if cursor.last else ""
    return InputError(f"{cursor.path}: has {found} where {wanted} is expected{behind}; copy the file again")
