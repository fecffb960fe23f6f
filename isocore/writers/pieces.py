"""What writers share: a surface cut into pieces, so that they need little memory besides it; the text of an offset."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy.typing as npt

from isocore.surface import Point

_ROWS = 1 << 17


def pieces(rows: npt.NDArray[Any]) -> Iterator[npt.NDArray[Any]]:
    """Views of `rows`, in order, each of at most 131,072 rows."""
    for begin in range(0, len(rows), _ROWS):
        yield rows[begin : begin + _ROWS]


def offset_text(offset: Point, between: str = " ") -> str:
    """The three numbers, each with the digits that tell it from its neighbours: 448000 5412000 300."""
    return between.join(repr(float(number)).removesuffix(".0") for number in offset)
