"""One line per output, as people read it: shared by the screen and by Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath
from typing import Any

from isocore.digits import exact, legible
from isocore.measurements import Measurements
from isocore.report.record import BatchReport, RunReport

HEADINGS = ("file", "isovalue", "triangles", "reference", "ratio", "seconds", "own s", "ref. s", "watertight", "status")
#: Headings of numbers, which are set to the right.
RIGHT = frozenset(("isovalue", "triangles", "reference", "ratio", "seconds", "own s", "ref. s"))
#: Headings in the order in which a narrow screen goes without them.
LEAVING = ("ref. s", "own s", "reference", "ratio", "seconds", "watertight", "isovalue", "triangles")


def summary_rows(batch: BatchReport) -> list[tuple[str, ...]]:
    """The table on screen, without its headings. What lies beside its input, as without -d, is named with its path."""
    names = told_apart([run.source if run.output in ("", "-") else run.output for run in batch.outputs])
    named = zip(batch.outputs, names, strict=True)
    return [summary_row(run, run.output if lies_beside(run) else name) for run, name in named]


def lies_beside(run: RunReport) -> bool:
    """Whether the output lies in its input's folder."""
    return run.output not in ("", "-") and PurePath(run.output).parent == PurePath(run.source).parent


def told_apart(paths: Sequence[str]) -> list[str]:
    """Of each path its name; where others end alike, with as many folders before it as tell them apart."""
    parts = {path: PurePath(path).parts or (path,) for path in paths}
    lengths = dict.fromkeys(parts, 1)
    alike = list(parts)
    while alike:
        tails: dict[tuple[str, ...], list[str]] = {}
        for path in alike:
            tails.setdefault(parts[path][-lengths[path] :], []).append(path)
        groups = [group for group in tails.values() if len(group) > 1]
        alike = [path for group in groups for path in group if lengths[path] < len(parts[path])]
        for path in alike:
            lengths[path] += 1
    return [str(PurePath(*parts[path][-lengths[path] :])) for path in paths]


def summary_row(run: RunReport, name: str) -> tuple[str, ...]:
    """One output's cells, in the order of HEADINGS. name: what its file is called among the others."""
    surface, reference, ratio = run.surface, run.reference, run.ratio
    return (
        name,
        isovalue_text(run),
        count(surface and surface.triangles),
        count(reference and reference.triangles),
        number(ratio and ratio.triangles, ".2f"),
        number(run.seconds and run.seconds.total, ".3f"),
        number(own_seconds(run), ".3f"),
        number(reference and reference.seconds, ".3f"),
        "" if surface is None else watertight(surface),
        f"{run.status}, missed" if run.missed else run.status,
    )


def watertight(surface: Measurements) -> str:
    """Whether a surface is closed, in a word; "-" for one without triangles, of which it cannot be said."""
    if not surface.triangles or surface.watertight is None:
        return "-"
    return "yes" if surface.watertight else "no"


def isovalue_text(run: RunReport) -> str:
    """As it was given; one that was chosen by so many digits that it differs from the range's ends."""
    if run.isovalue is None:
        return run.asked.asked
    if run.chosen == "given":
        return exact(run.isovalue)
    ends = [end for end in (run.field and run.field.range) or () if end is not None]  # JSON has no infinities
    return legible(run.isovalue, *ends)[0]


def own_seconds(run: RunReport) -> float | None:
    """Seconds to compare with the reference's; of a run that made no surface there are none."""
    return None if run.surface is None or run.seconds is None else run.seconds.own


def totals_line(batch: BatchReport) -> str:
    """The sums in one sentence."""
    totals = batch.totals
    parts = [f"{totals[status]} {status}" for status in ("done", "empty", "skipped", "failed") if totals[status]]
    if totals["missed"]:
        parts.append(f"{totals['missed']} missed a requirement")
    sums = f"{', '.join(parts) or 'nothing to do'}: {count(totals['triangles'])} triangles, {totals['seconds']:.2f} s"
    written = [run for run in batch.outputs if run.status != "failed"]
    return f"{sums}, beside the input" if written and all(map(lies_beside, written)) else sums


def count(value: Any) -> str:
    """1,234,567 or nothing."""
    return "" if value is None else f"{value:,}"


def number(value: Any, form: str) -> str:
    """A number in this form or nothing."""
    return "" if value is None else format(value, form)
