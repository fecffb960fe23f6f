"""Two reports side by side: which outputs belong together, what became of them, and which limits that breaks."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from pathlib import PurePath

from isocore.report.limits import Limit, value_of
from isocore.report.record import BatchReport, RunReport
from isocore.report.summary import told_apart

HEADINGS = ("file", "isovalue", "triangles", "then", "change", "seconds", "then", "change", "status")


@dataclass(frozen=True, slots=True)
class Comparison:
    """pairs: the later report's runs, each with its earlier one, if any; gone: runs of the earlier report alone."""

    pairs: tuple[tuple[RunReport | None, RunReport], ...]
    gone: tuple[RunReport, ...]

    @property
    def share_nothing(self) -> bool:
        """Whether no output is in both."""
        return all(before is None for before, _ in self.pairs)


def compared(old: BatchReport, new: BatchReport) -> Comparison:
    """Pair the runs that made the same surface, by ever fewer of the facts that say so; no run is paired twice.

    What tells most is tried first: the same input, output, isovalue, volume and step. Then the output may lie
    elsewhere, then the input, of which three, two and one of the last names must agree. Facts that two runs of a
    report share decide nothing. Of two runs of one output in a report the later counts.
    """
    earlier, later = _latest(old), _latest(new)
    found: dict[int, int] = {}
    taken: set[int] = set()
    for facts in _FACTS:
        places = _alone(later, facts)
        for key, place in _alone(earlier, facts).items():
            if key in places and place not in taken and places[key] not in found:
                found[places[key]] = place
                taken.add(place)
    pairs = tuple((earlier[found[n]] if n in found else None, run) for n, run in enumerate(later))
    return Comparison(pairs, tuple(run for n, run in enumerate(earlier) if n not in taken))


def _latest(batch: BatchReport) -> list[RunReport]:
    return list({_FACTS[0](run): run for run in batch.outputs}.values())


def _alone(runs: list[RunReport], facts: Callable[[RunReport], Hashable]) -> dict[Hashable, int]:
    """The places of runs whose facts no other run has, found a partner or not: `T1.nii` of many folders names none."""
    groups: dict[Hashable, list[int]] = {}
    for place, run in enumerate(runs):
        groups.setdefault(facts(run), []).append(place)
    return {key: places[0] for key, places in groups.items() if len(places) == 1}


def _tail(names: int) -> Callable[[RunReport], Hashable]:
    """The surface, and so many of its input's last names."""
    return lambda run: (PurePath(run.source).parts[-names:], *_surface(run), PurePath(run.output).name)


def _surface(run: RunReport) -> tuple[Hashable, ...]:
    given = run.asked.options
    return run.asked.asked, run.asked.volume, run.asked.step, run.backend, None if given is None else given.format


_FACTS: tuple[Callable[[RunReport], Hashable], ...] = (
    lambda run: (run.source, run.output, run.asked.asked, run.asked.volume, run.asked.step),
    lambda run: (run.source, *_surface(run), PurePath(run.output).name),
    lambda run: (run.source, *_surface(run)),
    lambda run: (run.source, run.asked.asked, run.asked.volume, run.asked.step),
    _tail(3),
    _tail(2),
    _tail(1),
    lambda run: (PurePath(run.source).name, run.asked.asked, run.asked.volume, run.asked.step),
)


def faults(found: Comparison, limits: list[Limit]) -> list[str]:
    """One line for each thing that is worse than before. What fails now and did not then always counts.

    With limits, so do an output that is gone or became empty, and a limit that nothing could be held against.
    """
    lines = []
    for before, run in found.pairs:
        if run.status == "failed" and (before is None or before.status != "failed"):
            lines.append(f"{run.message} ({'new' if before is None else f'was {before.status}'})")
        elif limits and before is not None and run.is_empty and before.triangles:
            lines.append(f"{_name(run)}: is empty, had {before.triangles:,} triangles")
    if limits:
        lines += [f"{_name(run)}: is gone, was {run.status}" for run in found.gone if run.status != "failed"]
        lines += ["the reports share no output, so nothing was compared"] if found.share_nothing else []
    for limit in limits:
        lines += _broken(limit, found)
    return lines


def _broken(limit: Limit, found: Comparison) -> list[str]:
    """What breaks one limit."""
    pairs = [(before, run) for before, run in found.pairs if run.status != "failed"]
    broken = [f"{_name(run)}: {what}" for before, run in pairs if (what := limit.broken_by(before, run))]
    held = (value_of(run, limit.key) for before, run in pairs if before is not None or not limit.percent)
    if broken or found.share_nothing or any(value is not None for value in held):
        return broken
    return [f"{limit.text}: no output has {limit.key} in both reports, so nothing was held against it"]


def _name(run: RunReport) -> str:
    return f"{PurePath(run.output).name} at {run.asked.asked}"


def comparison_rows(found: Comparison) -> list[tuple[str, ...]]:
    """The table on screen, in the order of HEADINGS; what is gone stands at its end."""
    both: list[tuple[RunReport | None, RunReport | None]] = [*found.pairs, *((run, None) for run in found.gone)]
    names = told_apart([run.output for _, run in found.pairs] + [run.output for run in found.gone])
    rows = []
    for name, (before, run) in zip(names, both, strict=True):
        shown = run or before
        cells = [name, "" if shown is None else shown.asked.asked]
        for key, form in (("triangles", ",.0f"), ("seconds", ".3f")):
            value, then = (None if one is None else value_of(one, key) for one in (run, before))
            cells += ["" if number is None else format(number, form) for number in (value, then)]
            cells.append(f"{(value / then - 1) * 100:+.1f}%" if value is not None and then else "")
        status = "gone" if run is None else run.status
        rows.append((*cells, f"{status}, new" if before is None else status))
    return rows
