"""One line per output, as people read it: shared by the screen and by Markdown."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from isocore.report.record import BatchReport, RunReport

HEADINGS = ("file", "isovalue", "triangles", "reference", "ratio", "seconds", "ref. s", "watertight", "status")
#: Headings of numbers, which are set to the right.
RIGHT = frozenset(("isovalue", "triangles", "reference", "ratio", "seconds", "ref. s"))


def summary_rows(batch: BatchReport) -> list[tuple[str, ...]]:
    """The table on screen, without its headings."""
    return [summary_row(run) for run in batch.outputs]


def summary_row(run: RunReport) -> tuple[str, ...]:
    """One output's cells, in the order of HEADINGS."""
    surface, reference, ratio = run.surface, run.reference, run.ratio
    watertight = surface and surface.watertight
    return (
        PurePath(run.output or run.source).name if run.output != "-" else PurePath(run.source).name,
        run.asked.asked if run.isovalue is None else f"{run.isovalue:.6g}",
        count(surface and surface.triangles),
        count(reference and reference.triangles),
        number(ratio and ratio.triangles, ".2f"),
        number(own_seconds(run), ".3f"),
        number(reference and reference.seconds, ".3f"),
        "" if watertight is None else "yes" if watertight else "no",
        f"{run.status}, missed" if run.missed else run.status,
    )


def own_seconds(run: RunReport) -> float | None:
    """Seconds to compare with the reference's: prepare and extract."""
    if run.surface is None or run.seconds is None:
        return None
    return run.seconds.prepare + run.seconds.extract


def totals_line(batch: BatchReport) -> str:
    """The sums in one sentence."""
    totals = batch.totals
    parts = [f"{totals[status]} {status}" for status in ("done", "empty", "skipped", "failed") if totals[status]]
    if totals["missed"]:
        parts.append(f"{totals['missed']} missed a requirement")
    return f"{', '.join(parts) or 'nothing to do'}: {count(totals['triangles'])} triangles, {totals['seconds']:.2f} s"


def count(value: Any) -> str:
    """1,234,567 or nothing."""
    return "" if value is None else f"{value:,}"


def number(value: Any, form: str) -> str:
    """A number in this form or nothing."""
    return "" if value is None else format(value, form)
