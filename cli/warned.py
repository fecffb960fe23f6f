"""Warnings of many files: one line for each kind, at the end; which file has which, the report says."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from isocore.errors import READER_LEFT, printable

if TYPE_CHECKING:
    from isocore.report import RunReport

#: What a kind of warning about a surface says of many: its beginning in one record, and the sentence for all.
OF_MANY = (
    ("the surface is open where it meets the volume's border", "are open at the border; --cap closes them"),
    ("no surface at isovalue", "are empty; `isocore info FILE` shows which isovalues make sense"),
)
_NUMBER = r"[-+]?\d[\d,]*(\.\d+)?(e[-+]?\d+)?"


@dataclass(slots=True)
class _Kind:
    """Warnings that differ in numbers and paths only."""

    first: str
    texts: set[str] = field(default_factory=set)
    outputs: int = 0
    sources: set[str] = field(default_factory=set)


class Warned:
    """The warnings so far, by their kind."""

    def __init__(self) -> None:
        self._kinds: dict[str, _Kind] = {}
        self._surfaces = 0
        self._sources: set[str] = set()

    def add(self, run: RunReport) -> None:
        """Take note of a run's warnings; what an earlier run said of a surface that is up to date is not said again."""
        if run.status == "skipped":
            return
        self._sources.add(run.source)
        self._surfaces += run.surface is not None
        for warning in dict.fromkeys(warnings_of(run)):
            kind = self._kinds.setdefault(_kind(warning, run), _Kind(f"{run.source}: {warning}"))
            kind.texts.add(warning)
            kind.outputs += 1
            kind.sources.add(run.source)

    def lines(self) -> list[str]:
        """One line for each kind, in the order in which they came up."""
        return [f"isocore: warning: {printable(self._line(kind))}" for kind in self._kinds.values()]

    @property
    def several(self) -> bool:
        """Whether a line stands for more than one file or surface, so that there are details to look up."""
        return any((kind.outputs > 1 and len(kind.texts) > 1) or len(kind.sources) > 1 for kind in self._kinds.values())

    def _line(self, kind: _Kind) -> str:
        if kind.outputs == 1:
            return kind.first
        for begin, sentence in OF_MANY:
            if any(text.startswith(begin) for text in kind.texts):
                return f"{_share(kind.outputs, self._surfaces)} surfaces {sentence}"
        if len(kind.sources) > 1:
            others = f"{len(kind.sources) - 1} more of {len(self._sources)} inputs"
        elif len(kind.texts) > 1:
            others = f"{kind.outputs - 1} more of {self._surfaces} surfaces"
        else:
            return kind.first
        return f"{kind.first} ({'the same' if len(kind.texts) == 1 else 'the like'} for {others})"


def _share(some: int, of: int) -> str:
    return f"all {of}" if some == of else f"{some} of {of}"


def warnings_of(run: RunReport) -> list[str]:
    """A run's warnings; that a surface is empty is one."""
    return [*run.warnings, run.message] if run.status == "empty" else list(run.warnings)


def _kind(warning: str, run: RunReport) -> str:
    """The warning without its numbers and paths."""
    for path in filter(None, (run.source, run.output)):
        warning = warning.replace(path, "")
    return re.sub(_NUMBER, "0", warning, flags=re.IGNORECASE)


def is_unread(run: RunReport) -> bool:
    """Was it on its way through stdout when whoever read that left? Nothing is said of it: they know."""
    return run.status == "failed" and run.output == "-" and run.message.endswith(READER_LEFT)


def said_at_once(run: RunReport) -> list[str]:
    """What does not wait for the end: a failure, and every requirement that is missed."""
    lines = [f"isocore: {printable(run.message)}"] if run.status == "failed" and not is_unread(run) else []
    return lines + [f"isocore: {printable(run.output)}: misses {printable(miss)}" for miss in run.missed]
