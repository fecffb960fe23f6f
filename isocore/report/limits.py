"""Limits that a report must keep, beside an earlier one: `--fail-if`.

A limit is `key>+P%` or `key<-P%` (against the earlier report), or `key>N`, `key<N` (on its own). A key is that of a
record, dotted; `triangles`, `vertices` and `seconds` stand for those of the surface and for `seconds.total`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Any
from weakref import WeakKeyDictionary

from isocore.digits import counted
from isocore.errors import OptionError
from isocore.report.keys import run_as_dict
from isocore.report.record import BatchReport, RunReport

_LIMIT = re.compile(
    r"(?P<key>[^<>\s]+)\s*(?P<sense>[<>])\s*(?P<number>[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)\s*(?P<percent>%?)",
    re.ASCII,
)
_NUMBERS: WeakKeyDictionary[RunReport, dict[str, float]] = WeakKeyDictionary()
_SHORT = {"triangles": "surface.triangles", "vertices": "surface.vertices", "seconds": "seconds.total"}


@dataclass(frozen=True, slots=True)
class Limit:
    """What makes a comparison fail. number: a percentage of the earlier value where `percent`."""

    text: str
    key: str
    above: bool
    number: float
    percent: bool

    def broken_by(self, old: RunReport | None, new: RunReport) -> str:
        """What breaks the limit, or nothing. A number that was known and is not any more breaks it, too."""
        value, before = value_of(new, self.key), None if old is None else value_of(old, self.key)
        if value is None:
            return "" if before is None else f"{self.key} is not known, was {counted(before)[0]} ({self.text})"
        if self.percent and before is None:
            return ""
        bound = self.number if before is None or not self.percent else before + abs(before) * self.number / 100
        if not (value > bound if self.above else value < bound):
            return ""
        if before is None:
            return f"{self.key} is {counted(value)[0]} ({self.text})"
        now, then = counted(value, before)
        return f"{self.key} is {now}, was {then} ({self.text})"


def parse_limit(text: str) -> Limit:
    """A limit as it was typed. Raises OptionError where it is none."""
    match = _LIMIT.fullmatch(text.strip())
    if not match:
        raise OptionError(f"--fail-if {text}: is no limit; write one as 'triangles>+2%' or 'surface.boundary_edges>0'")
    number = float(match["number"])
    if not math.isfinite(number):
        raise OptionError(f"--fail-if {text}: no number is beyond that, so that the limit could never be broken")
    return Limit(text, match["key"], match["sense"] == ">", number, bool(match["percent"]))


def check_limits(limits: list[Limit], *batches: BatchReport) -> None:
    """Raises OptionError where no record has a number under a limit's key, which would never be broken."""
    runs = [run for batch in batches for run in batch.outputs]
    if not runs:
        return
    known = {key for run in runs for key in _numbers_of(run)}
    known |= {short for short, key in _SHORT.items() if key in known}
    for limit in limits:
        if limit.key not in known:
            nearest = max(sorted(known), key=lambda key: _likeness(limit.key, key), default="")
            all_failed = all(run.status == "failed" for run in runs)
            hint = "every run failed" if all_failed else f"the nearest is {nearest}"
            raise OptionError(f"--fail-if {limit.text}: no record has a number {limit.key}; {hint}")


def value_of(run: RunReport, key: str) -> float | None:
    """The number under a dotted key; None where the record has none."""
    value = _numbers_of(run).get(_SHORT.get(key, key))
    return None if value is None else float(value)


def _numbers_of(run: RunReport) -> dict[str, float]:
    """The numbers of a record; kept, since every limit and every column asks for some."""
    numbers = _NUMBERS.get(run)
    if numbers is None:
        numbers = _NUMBERS[run] = dict(_numbers(run_as_dict(run)))
    return numbers


def _numbers(record: dict[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    """Every number in a record under its dotted key; yes and no are 1 and 0."""
    for key, value in record.items():
        if isinstance(value, dict):
            yield from _numbers(value, f"{before}{key}.")
        elif isinstance(value, (int, float)):
            yield f"{before}{key}", value


def _likeness(asked: str, key: str) -> float:
    """How much a key looks like what was asked for, with and without its section."""
    asked, whole = asked.lower().replace("-", "_"), key.lower()
    alone = (asked.rpartition(".")[2], whole.rpartition(".")[2])
    return max(SequenceMatcher(None, asked, whole).ratio(), 0.99 * SequenceMatcher(None, *alone).ratio())
