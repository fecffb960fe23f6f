"""Cutting a surface into pieces, so that a writer needs little memory besides the surface itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

_ROWS = 1 << 17


def pieces(rows: npt.NDArray[Any]) -> Iterator[npt.NDArray[Any]]:
    """Views of `rows`, in order, each of at most 131,072 rows."""
    for begin in range(0, len(rows), _ROWS):
        yield rows[begin : begin + _ROWS]


def merge_warning(before: npt.NDArray[Any], after: npt.NDArray[Any], cause: str) -> tuple[str, ...]:
    """Say how many vertices fall on another one when `before` (v, 3) is rounded to `after` (v, 3)."""
    lost = _distinct(before) - _distinct(after)
    if not lost:
        return ()
    return (
        f"{cause}, so {lost:,} of {len(before):,} vertices fall on another one and programs that weld "
        "by position find holes; write PLY, which keeps float64",
    )


def _distinct(rows: npt.NDArray[Any]) -> int:
    ordered = rows[np.lexsort(rows.T)]
    return len(rows) and 1 + int((ordered[1:] != ordered[:-1]).any(axis=1).sum())
