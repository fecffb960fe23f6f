"""What may be asked of label maps, in words: which labels, and in what colour."""

from __future__ import annotations

import re
from typing import NamedTuple

from isocore.errors import OptionError

#: Labels that one map may hold.
MOST_LABELS = 100_000

_LABELS = r"(?P<first>-?\d{1,18})(?:\s*-\s*(?P<last>-?\d{1,18}))?"


class Label(NamedTuple):
    """One label of a label map.

    name: what the file or a table calls it, or "". colour: red, green, blue, 0 to 255. file_name: the name as a part of
    a file's, or `label_17`, and like no other of the same map.
    """

    value: int
    name: str = ""
    colour: tuple[int, int, int] | None = None
    file_name: str = ""

    def __str__(self) -> str:
        return f"label {self.value}"


class Labels(NamedTuple):
    """Which labels of a map are asked for: their numbers, or None for all but the background; text: as written."""

    values: tuple[int, ...] | None
    text: str

    def __str__(self) -> str:
        return self.text


def parse_labels(text: str) -> Labels:
    """`all`, or numbers and ranges with commas: `1,5-9`. Raises OptionError for nonsense."""
    text = text.strip()
    if text.lower() == "all":
        return Labels(None, "all")
    values: dict[int, None] = {}
    for part in text.split(","):
        match = re.fullmatch(_LABELS, part.strip())
        if match is None:
            raise OptionError(f"--labels {text}: is no list of labels; write all, or numbers and ranges as 1,5-9")
        first, last = int(match["first"]), int(match["last"] or match["first"])
        if not 0 <= last - first < MOST_LABELS or len(values) > MOST_LABELS:
            raise OptionError(f"--labels {text}: {part.strip()} must run upwards, over {MOST_LABELS:,} labels at most")
        values.update(dict.fromkeys(range(first, last + 1)))
    return Labels(tuple(values), text)


def parse_colour(text: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of `#rrggbb`. Raises OptionError for nonsense."""
    match = re.fullmatch(r"#?([0-9a-fA-F]{6})", text.strip())
    if match is None:
        raise OptionError(f"--color {text}: is no colour; write it as '#c8a078'")
    red, green, blue = bytes.fromhex(match[1])
    return red, green, blue
