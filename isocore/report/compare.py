"""Two reports side by side, and limits that the later one must keep.

A limit is `key>+P%` or `key<-P%` (against the earlier report), or `key>N`, `key<N` (on its own). A key is that of a
record, dotted; `triangles` and `seconds` stand for `surface.triangles` and prepare with extract.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from isocore.errors import OptionError
from isocore.report.keys import run_as_dict
from isocore.report.record import BatchReport, RunReport
from isocore.report.summary import own_seconds, told_apart

_LIMIT = re.compile(r"(?P<key>[\w.]+)\s*(?P<sense>[<>])\s*(?P<number>[+-]?\d+(\.\d*)?(e[+-]?\d+)?)\s*(?P<percent>%?)")
_SHORT = {"triangles": "surface.triangles", "vertices": "surface.vertices"}
HEADINGS = ("file", "isovalue", "triangles", "then", "change", "seconds", "then", "change", "status")


@dataclass(frozen=True, slots=True)
class Limit:
    """What makes a comparison fail."""

    text: str
    key: str
    above: bool
    number: float
    percent: bool

    def broken_by(self, old: RunReport | None, new: RunReport) -> str:
        """What breaks the limit, or nothing; what one of the two reports does not know breaks none."""
        value, before = value_of(new, self.key), None if old is None else value_of(old, self.key)
        if value is None or (self.percent and before is None):
            return ""
        bound = self.number if before is None or not self.percent else before * (1 + self.number / 100)
        if not (value > bound if self.above else value < bound):
            return ""
        now = f"{PurePath(new.output).name} at {new.asked.asked}: {self.key} is {value:,.6g}"
        return f"{now}, was {before:,.6g} ({self.text})" if before is not None else f"{now} ({self.text})"


def parse_limit(text: str) -> Limit:
    """A limit as it was typed. Raises OptionError where it is none."""
    match = _LIMIT.fullmatch(text.strip())
    if not match:
        raise OptionError(f"--fail-if {text}: is no limit; write one as 'triangles>+2%' or 'surface.boundary_edges>0'")
    return Limit(text, match["key"], match["sense"] == ">", float(match["number"]), bool(match["percent"]))


def value_of(run: RunReport, key: str) -> float | None:
    """The number under a dotted key; None where the record has none."""
    if key == "seconds":
        return own_seconds(run)
    value: Any = run_as_dict(run)
    for part in _SHORT.get(key, key).split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return float(value) if isinstance(value, (int, float)) else None


def paired(old: BatchReport, new: BatchReport) -> Iterator[tuple[RunReport | None, RunReport]]:
    """The runs of the later report, each with the earlier one of the same input, isovalue and volume."""
    earlier = {_identity(run): run for run in old.outputs}
    by_name = {(PurePath(run.source).name, *_identity(run)[1:]): run for run in old.outputs}
    for run in new.outputs:
        same = earlier.get(_identity(run))
        yield same or by_name.get((PurePath(run.source).name, *_identity(run)[1:])), run


def _identity(run: RunReport) -> tuple[Any, ...]:
    return run.source, run.asked.asked, run.asked.volume


def broken_limits(old: BatchReport, new: BatchReport, limits: list[Limit]) -> list[str]:
    """One line per limit and output that breaks it. What failed now and did not then always counts."""
    lines = []
    for before, run in paired(old, new):
        if run.status == "failed" and before is not None and before.status != "failed":
            lines.append(f"{run.message} (was {before.status})")
        lines += [line for limit in limits if (line := limit.broken_by(before, run))]
    return lines


def comparison_rows(old: BatchReport, new: BatchReport) -> list[tuple[str, ...]]:
    """The table on screen, in the order of HEADINGS."""
    rows = []
    names = told_apart([run.output for run in new.outputs])
    for name, (before, run) in zip(names, paired(old, new), strict=True):
        cells = [name, run.asked.asked]
        for key, form in (("triangles", ",.0f"), ("seconds", ".4f")):
            value, then = value_of(run, key), None if before is None else value_of(before, key)
            cells += ["" if number is None else format(number, form) for number in (value, then)]
            cells.append(f"{(value / then - 1) * 100:+.1f}%" if value is not None and then else "")
        rows.append((*cells, run.status if before is not None else f"{run.status}, new"))
    return rows
