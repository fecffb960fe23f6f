"""The screen: the only file that imports rich, and only where there is a terminal to draw on."""

from __future__ import annotations

import os
import sys
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import click

if TYPE_CHECKING:
    from isocore.job import Job
    from isocore.report import BatchReport, RunReport

#: A run shorter than this shows no progress bar.
_PATIENCE_SECONDS = 1.0


class Progress:
    """A live bar on stderr, once a run has taken longer than a second; nothing where stderr is no terminal."""

    def __init__(self, total: int, *, wanted: bool) -> None:
        self._wanted = wanted and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._total = total
        self._done = 0
        self._label = ""
        self._bar: Any = None
        self._task: Any = None
        self._timer: Any = None

    def __enter__(self) -> Self:
        if self._wanted:
            from threading import Timer

            self._timer = Timer(_PATIENCE_SECONDS, self._show)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._wanted = False
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        if self._bar is not None:
            self._bar.stop()

    def at(self, jobs: list[Job]) -> None:
        """Say what is being worked on."""
        self._label = ", ".join(job.source.name for job in jobs)
        self._update()

    def step(self) -> None:
        """One more is done."""
        self._done += 1
        self._update()

    def _update(self) -> None:
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, label=self._label)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as Bar

        if not self._wanted:
            return
        columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
        bar = Bar(*columns, TextColumn("{task.fields[label]}"), console=Console(stderr=True), transient=True)
        self._task = bar.add_task("", total=self._total, completed=self._done, label=self._label)
        bar.start()
        self._bar = bar


def say(text: str) -> None:
    """A line for people, on stderr."""
    click.echo(text, err=True)


def lines_of(run: RunReport) -> list[str]:
    """What deserves a line at once: a failure, a miss, warnings."""
    lines = [f"isocore: {run.message}"] if run.status == "failed" else []
    lines += [f"isocore: {run.output}: misses {miss}" for miss in run.missed]
    warnings = [*run.warnings, run.message] if run.status == "empty" else run.warnings
    return lines + [f"isocore: warning: {run.source}: {warning}" for warning in warnings]


def say_table(batch: BatchReport) -> None:
    """One line per output; drawn by rich on a terminal, plain otherwise."""
    from isocore.report.summary import HEADINGS, RIGHT, summary_rows, totals_line

    rows = summary_rows(batch)
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.table import Table

        table = Table(box=None, pad_edge=False)
        for heading in HEADINGS:
            table.add_column(heading, justify="right" if heading in RIGHT else "left", overflow="fold")
        for row, run in zip(rows, batch.outputs, strict=True):
            table.add_row(*row, style="red" if run.status == "failed" or run.missed else None)
        Console(stderr=True).print(table)
    else:
        say(plain_table(HEADINGS, rows, RIGHT))
    say(totals_line(batch))


def plain_table(headings: tuple[str, ...], rows: list[tuple[str, ...]], right: frozenset[str]) -> str:
    """Columns set apart by two spaces. right: the headings of those that end in line."""
    widths = [max(len(line[column]) for line in (headings, *rows)) for column in range(len(headings))]

    def line(cells: tuple[str, ...]) -> str:
        set_ = (
            cell.rjust(width) if heading in right else cell.ljust(width)
            for cell, width, heading in zip(cells, widths, headings, strict=True)
        )
        return "  ".join(set_).rstrip()

    return "\n".join(line(cells) for cells in (headings, *rows))
