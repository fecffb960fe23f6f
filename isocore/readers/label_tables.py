"""Names and colours of labels from a file: FreeSurfer's and ITK-SNAP's tables, Slicer's .ctbl, BIDS dseg.tsv, CSV."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path

from isocore.errors import InputError, reading

Colour = tuple[int, int, int]

#: A table longer than this is none.
_MOST_BYTES = 1 << 24
#: FreeSurfer and Slicer: number, name, red, green, blue, and a last column that is alpha or its opposite.
_NAME_FIRST = re.compile(r"\s*(-?\d{1,15})\s+(.+?)\s+(\d+)\s+(\d+)\s+(\d+)(?:\s+\d+)?\s*")
#: ITK-SNAP: number, red, green, blue, alpha, visible, mesh, "name".
_NAME_LAST = re.compile(r'\s*(-?\d{1,15})\s+(\d+)\s+(\d+)\s+(\d+)\s+[\d.]+\s+\d+\s+\d+\s+"(.*)"\s*')
#: Number and name alone.
_NAME_ALONE = re.compile(r"\s*(-?\d{1,15})\s+(\S.*?)\s*")

_NUMBERS = ("index", "label", "labelvalue", "value", "id", "key", "number", "no")
_NAMES = ("name", "label_name", "labelname", "structure", "region", "label", "abbreviation")
_HEX = ("color", "colour", "hex")
_PARTS = (("r", "g", "b"), ("red", "green", "blue"))


@dataclass(frozen=True, slots=True)
class LabelName:
    """What a label is called, and its colour where one is given."""

    name: str
    colour: Colour | None = None


def read_label_table(path: Path) -> dict[int, LabelName]:
    """The labels of a table, by their numbers. Raises InputError, with the path, where nothing is understood."""
    with reading(path):
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"{path}: is too long for a table of names; name another with --names")
        text = path.read_bytes().decode("utf-8-sig", errors="replace")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    found = _columns(lines) or _rows(lines)
    if not found:
        raise InputError(f"{path}: names no label; give a table of numbers and names, such as FreeSurfer's or a .tsv")
    return found


def _columns(lines: list[str]) -> dict[int, LabelName]:
    """A table with a heading, or with commas or semicolons; nothing if it is none."""
    if not lines:
        return {}
    mark = max("\t;,", key=lines[0].count)
    if not lines[0].count(mark):
        return {}
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=mark) if row]
    heading = [cell.lower() for cell in rows[0]]
    number = next((heading.index(name) for name in _NUMBERS if name in heading), None)
    if number is None:
        names = (_plain_row(row) for row in rows)
        return dict(filter(None, names))
    name = next((at for each in _NAMES for at, cell in enumerate(heading) if cell == each and at != number), None)
    if name is None:
        return {}
    found: dict[int, LabelName] = {}
    for row in rows[1:]:
        if len(row) > max(number, name) and (value := _whole(row[number])) is not None and row[name]:
            found[value] = LabelName(row[name], _row_colour(heading, row))
    return found


def _plain_row(row: list[str]) -> tuple[int, LabelName] | None:
    """Number, name, and a colour of three numbers or #rrggbb."""
    if len(row) < 2 or (value := _whole(row[0])) is None or not row[1]:
        return None
    colour = _hex(row[2]) if len(row) == 3 else _triple(row[2:5])
    return value, LabelName(row[1], colour)


def _row_colour(heading: list[str], row: list[str]) -> Colour | None:
    cells = dict(zip(heading, row, strict=False))
    for name in _HEX:
        if (colour := _hex(cells.get(name, ""))) is not None:
            return colour
    for names in _PARTS:
        if (colour := _triple([cells.get(name, "") for name in names])) is not None:
            return colour
    return None


def _rows(lines: list[str]) -> dict[int, LabelName]:
    """A table whose columns stand apart by blanks."""
    found: dict[int, LabelName] = {}
    for line in lines:
        if match := _NAME_LAST.fullmatch(line):
            value, *colour, name = match.groups()
        elif match := _NAME_FIRST.fullmatch(line):
            value, name, *colour = match.groups()
        elif match := _NAME_ALONE.fullmatch(line):
            value, name = match.groups()
            colour = []
        else:
            continue
        found[int(value)] = LabelName(name.strip('"'), _triple(colour))
    return found


def _whole(text: str) -> int | None:
    match = re.fullmatch(r"(-?\d+)(?:\.0*)?", text)
    return int(match[1]) if match and len(match[1]) < 16 else None


def _hex(text: str) -> Colour | None:
    match = re.fullmatch(r"#?([0-9a-fA-F]{6})(?:[0-9a-fA-F]{2})?", text)
    if match is None:
        return None
    red, green, blue = bytes.fromhex(match[1])
    return red, green, blue


def _triple(texts: list[str]) -> Colour | None:
    """Three numbers from 0 to 255, or from 0 to 1 where they are written as fractions."""
    try:
        numbers = [float(text) for text in texts[:3]]
    except ValueError:
        return None
    if len(numbers) != 3 or not all(0 <= number <= 255 for number in numbers):
        return None
    fractions = max(numbers) <= 1 and any("." in text for text in texts[:3])
    red, green, blue = (round(number * 255 if fractions else number) for number in numbers)
    return red, green, blue
