"""Tables as lines of text: numbers stay whole, narrow screens go without some columns, long names lose their head."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from typing import NamedTuple

from isocore.errors import printable

_GAP = "  "
_DOTS = "..."
#: A name is shortened to this before a column has to leave; further only where none is left that may.
_SHORT_NAME = 20
_SHORTEST_NAME = 8
_FEW_WORDS = 24
_INDENT = 4


class Column(NamedTuple):
    """right: set to the right, as numbers are.

    leaves: the place in the order in which columns leave a narrow screen, from 1; 0 for never.
    shrinks: its cells are names, which may be shortened; of one column at most.
    """

    heading: str
    right: bool = False
    leaves: int = 0
    shrinks: bool = False


def columns_of(
    headings: Sequence[str], right: frozenset[str] = frozenset(), leaving: Sequence[str] = (), shrinks: str = ""
) -> list[Column]:
    """Columns by their headings: which are set to the right, which leave and in which order, which one shrinks."""
    order = {heading: place for place, heading in enumerate(leaving, 1)}
    return [Column(name, name in right, order.get(name, 0), name == shrinks) for name in headings]


def set_table(columns: Sequence[Column], rows: Sequence[Sequence[str]], width: int | None = None) -> list[str]:
    """The lines of a table, headings first, none wider than width as far as that can be; None is as wide as it takes.

    A cell that is a number is never cut and never broken. Columns without a word leave before all others.
    """
    cells = [[printable(cell) for cell in row] for row in rows]
    kept = list(range(len(columns)))
    empty = [not any(row[n] for row in cells) for n in kept]
    for leaving in sorted((n for n in kept if columns[n].leaves), key=lambda n: (not empty[n], columns[n].leaves)):
        if width is None or _fits(columns, cells, kept, width, _SHORT_NAME):
            break
        kept.remove(leaving)
    if width is not None:
        _shrink(columns, cells, kept, width)
    wide = [max(cells_of(cell) for cell in (columns[n].heading, *(row[n] for row in cells))) for n in kept]
    return [
        _GAP.join(
            _padded(cell, size, right=columns[n].right)
            for cell, size, n in zip((line[n] for n in kept), wide, kept, strict=True)
        ).rstrip()
        for line in ([column.heading for column in columns], *cells)
    ]


def _room(columns: Sequence[Column], rows: Sequence[Sequence[str]], kept: list[int], width: int) -> int:
    """What the other columns leave to the names."""
    others = [n for n in kept if not columns[n].shrinks]
    taken = sum(max(cells_of(cell) for cell in (columns[n].heading, *(row[n] for row in rows))) for n in others)
    return width - taken - len(_GAP) * (len(kept) - 1)


def _fits(columns: Sequence[Column], rows: Sequence[Sequence[str]], kept: list[int], width: int, short: int) -> bool:
    """Whether all columns have room, the names shortened if need be, but not beyond telling them apart."""
    room = _room(columns, rows, kept, width)
    for n in kept:
        if columns[n].shrinks:
            names = [row[n] for row in rows]
            longest = max((cells_of(name) for name in (columns[n].heading, *names)), default=0)
            return room >= longest or (room >= short and _distinct(shortened(names, room)) == _distinct(names))
    return room >= 0


def _shrink(columns: Sequence[Column], rows: list[list[str]], kept: list[int], width: int) -> None:
    """Shorten the names to the room there is."""
    room = max(_room(columns, rows, kept, width), _SHORTEST_NAME)
    for n in kept:
        if columns[n].shrinks:
            for row, name in zip(rows, shortened([row[n] for row in rows], room), strict=True):
                row[n] = name


def shortened(names: Sequence[str], width: int) -> list[str]:
    """The names, each in at most so many cells of a screen. The head goes first; where that makes different names
    look alike, the middle goes."""
    best = list(names)
    if max(map(cells_of, names), default=0) <= width:
        return best
    rest = max(width - len(_DOTS), 2)
    most = 0
    for head in (0, rest // 3, rest // 2, rest - rest // 3, rest):
        cut = [_without_middle(name, head, rest - head, width) for name in names]
        if _distinct(cut) > most:
            best, most = cut, _distinct(cut)
    return best


def _without_middle(name: str, head: int, tail: int, width: int) -> str:
    if cells_of(name) <= width:
        return name
    if name.isascii():
        return name[:head] + _DOTS + name[len(name) - tail :]
    first, last = "", ""
    for character in name:
        if cells_of(first + character) > head:
            break
        first += character
    for character in reversed(name):
        if cells_of(character + last) > tail:
            break
        last = character + last
    return first + _DOTS + last


def _distinct(names: Sequence[str]) -> int:
    return len(set(names))


def _padded(cell: str, width: int, *, right: bool) -> str:
    space = " " * (width - cells_of(cell))
    return space + cell if right else cell + space


def cells_of(text: str) -> int:
    """How many cells of a screen a text takes: East Asian wide characters take two, combining ones none."""
    if text.isascii():
        return len(text)
    widths = (0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)
    return sum(widths)


def folded(head: str, text: str, width: int | None) -> list[str]:
    """A text after its heading, as lines of at most so many cells: broken between words only, so that numbers stay
    whole, and set under its own beginning as long as there is room for some words."""
    indent = cells_of(head) if width is None or width - cells_of(head) >= _FEW_WORDS else _INDENT
    lines, empty = [head], True
    for word in printable(text).split(" "):
        if not empty and width is not None and cells_of(lines[-1]) + 1 + cells_of(word) > width:
            lines.append(" " * indent + word)
        else:
            lines[-1] += word if empty else f" {word}"
        empty = False
    return lines
