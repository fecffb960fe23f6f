"""The report as a table: one output per row, a nested key as `surface.triangles`."""

from __future__ import annotations

import csv
import io
from typing import Any

from isocore.digits import exact
from isocore.report.keys import run_as_dict
from isocore.report.record import BatchReport
from isocore.report.texts import shown

_PARTS = {
    "": "source output status message missed warnings sha256 bytes kind shape dtype spacing space unit volume step time"
    " field",
    " ": "range nonfinite ignored isovalue asked chosen backend backend_chosen",
    "surface": "triangles vertices components boundary_edges nonmanifold_edges nonmanifold_vertices euler watertight",
    "surface ": "area volume degenerate self_intersections",
    "reference": "name triangles vertices seconds",
    "ratio": "triangles seconds",
    "error": "max mean rms max_world mean_world rms_world normal_degrees.mean normal_degrees.p95 normal_degrees.max",
    "search": "cells extrema skeleton visited intersected",
    "ambiguous": "faces cells",
    "seconds": "read prepare extract normals measure write total own",
    "  ": "peak_rss_bytes",
}
#: A cell that begins with one of these is a formula to a spreadsheet.
_FORMULA = tuple("=+-@\t\r\n\uff1d\uff0b\uff0d\uff20")
COLUMNS = [f"{part.strip()}.{key}".lstrip(".") for part, keys in _PARTS.items() for key in keys.split()]


def render_csv(batch: BatchReport) -> str:
    """Comma separated, quoted where needed, lines ended as RFC 4180 asks.

    A text that a spreadsheet would run as a formula gets an apostrophe before it, which spreadsheets take for "text".
    """
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    for run in batch.outputs:
        record = run_as_dict(run)
        writer.writerow([_text(_at(record, column)) for column in COLUMNS])
    return text.getvalue()


def _at(record: dict[str, Any], column: str) -> Any:
    value: Any = record
    for key in column.split("."):
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _text(value: Any) -> str:
    """The cell, harmless: only texts, and lists of them, are anybody else's words."""
    text = shown(_cell(value))
    foreign = isinstance(value, str) or (isinstance(value, list) and isinstance(next(iter(value), None), str))
    return f"'{text}" if foreign and text.startswith(_FORMULA) else text


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        separator = "; " if value and isinstance(value[0], str) else " "
        return separator.join(_cell(item) for item in value)
    return exact(value) if isinstance(value, float) else str(value)
