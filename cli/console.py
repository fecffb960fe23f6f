"""The screen: the only file that imports rich, and only where there is a terminal to draw on."""

from __future__ import annotations

import os
import re
import sys
from contextlib import suppress
from threading import Lock
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TextIO

import click

from isocore.errors import printable

if TYPE_CHECKING:
    from isocore.job import Job
    from isocore.report import BatchReport

#: What GitHub reads as a command: two colons that begin a line, and an older form anywhere.
_COMMAND = r"^\s*::|##\["

#: A run shorter than this shows no progress bar.
_PATIENCE_SECONDS = 1.0
_BAR_WIDTH = 20
#: What stands before the name of the input at work: the bar, two counts, two times.
_BEFORE_NAME = _BAR_WIDTH + 30


class Progress:
    """A live bar on stderr, once a run has taken longer than a second; nothing where stderr is no terminal.

    While it is there, lines for people go through `say`, which puts them above it.
    """

    def __init__(self, total: int, *, wanted: bool) -> None:
        self._wanted = wanted and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._total = total
        self._done = 0
        self._names: list[str] = []
        self._bar: Any = None
        self._task: Any = None
        self._timer: Any = None
        self._lock = Lock()

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
        self.stop()

    def stop(self) -> None:
        """Take the bar away for good."""
        self._wanted = False
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        with self._lock:
            if self._bar is not None:
                with suppress(OSError):
                    self._bar.stop()
                self._bar = None

    def at(self, jobs: list[Job]) -> None:
        """Say what is being worked on."""
        self._names = [printable(job.source.name) for job in jobs]
        self._update()

    def step(self) -> None:
        """One more is done."""
        self._done += 1
        self._update()

    def say(self, text: str) -> None:
        """A line for people: above the bar where there is one. The terminal breaks it where it is too long."""
        with self._lock:
            if self._bar is None:
                say(text)
            else:
                self._bar.console.print(printable(text), markup=False, highlight=False, emoji=False, soft_wrap=True)

    def _update(self) -> None:
        with self._lock:
            if self._bar is not None:
                self._bar.update(self._task, completed=self._done, label=self._label())

    def _label(self) -> str:
        """The first input at work, in the room that the bar leaves, and how many others there are."""
        more = f" and {len(self._names) - 1} more" if len(self._names) > 1 else ""
        room = (screen_width(sys.__stderr__ or sys.stderr) or 80) - _BEFORE_NAME - len(more)
        from .table import shortened  # late: nobody waits for it who only wants help

        return shortened(self._names[:1] or [""], max(room, 10))[0] + more

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        with self._lock:
            if not self._wanted:
                return
            columns = (BarColumn(_BAR_WIDTH), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn())
            name = TextColumn("{task.fields[label]}", markup=False)
            screen = Console(stderr=True, emoji=False)
            bar = Bar(*columns, name, console=screen, transient=True, redirect_stdout=False)
            self._task = bar.add_task("", total=self._total, completed=self._done, label=self._label())
            bar.start()
            self._bar = bar


def say(text: str, **style: Any) -> None:
    """One line for people, on stderr, whatever names of files and fields it holds.

    Where stderr leads nowhere any more (a full disk, a connection that was closed) the work goes on without.
    """
    line = unarmed(printable(text))
    with suppress(OSError):
        click.echo(styled(line, **style) if style else line, err=True)


def tell(text: str, **style: Any) -> None:
    """One line of results, on stdout, which gives a name's bytes back also where they are no text."""
    line = unarmed(printable(text, stray=True))
    click.echo(styled(line, **style) if style else line)


def unarmed(text: str) -> str:
    """The line, so that GitHub takes it for no command of its own, whatever names it holds; as it is elsewhere."""
    if os.environ.get("GITHUB_ACTIONS") != "true":
        return text
    return re.sub(_COMMAND, lambda found: found[0].replace(":", "\\x3a", 1).replace("[", "\\x5b"), text)


def screen_width(stream: TextIO) -> int | None:
    """Columns of the terminal behind a stream, or as COLUMNS says; None where there is no terminal to fit into."""
    if not stream.isatty():
        return None
    if (asked := os.environ.get("COLUMNS", "")).isdecimal() and int(asked):
        return int(asked)
    try:
        return os.get_terminal_size(stream.fileno()).columns or None
    except (OSError, ValueError):
        return None


def styled(text: str, **style: Any) -> str:
    """The text in a style, unless NO_COLOR is set; click takes it away again where there is no terminal."""
    return text if os.environ.get("NO_COLOR") else click.style(text, **style)


def say_table(batch: BatchReport, *, as_result: bool = False) -> None:
    """One line per output, in the width of the terminal, then their sums; red where something went wrong.

    as_result: on stdout, since it is what was asked for.
    """
    from isocore.report.summary import HEADINGS, LEAVING, RIGHT, summary_rows, totals_line

    from .table import columns_of, set_table

    put, stream = (tell, sys.stdout) if as_result else (say, sys.stderr)
    columns = columns_of(HEADINGS, RIGHT, LEAVING, shrinks=HEADINGS[0])
    headings, *lines = set_table(columns, summary_rows(batch), screen_width(stream))
    put(headings, bold=True)
    for line, run in zip(lines, batch.outputs, strict=True):
        put(line, **({"fg": "red"} if run.status == "failed" or run.missed else {}))
    put(totals_line(batch))
