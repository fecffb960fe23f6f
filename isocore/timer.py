"""Seconds per stage of a job, for its records."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Literal, TypeAlias

from isocore.report.sections import Seconds

Stage: TypeAlias = Literal["read", "prepare", "extract", "normals", "measure", "write"]


class Timer:
    """`with timer("read"):` adds the block's seconds to a stage, also where the block fails."""

    def __init__(self) -> None:
        self._seconds: dict[Stage, float] = {}

    @contextmanager
    def __call__(self, stage: Stage) -> Iterator[None]:
        start = perf_counter()
        try:
            yield
        finally:
            self._seconds[stage] = self._seconds.get(stage, 0.0) + (perf_counter() - start)

    def add(self, seconds: float, stage: Stage) -> None:
        """Count seconds that a stage took before there was this timer."""
        self._seconds[stage] = self._seconds.get(stage, 0.0) + seconds

    def move(self, seconds: float, from_: Stage, to: Stage) -> None:
        """Count seconds of one stage for another."""
        self._seconds[from_] = self._seconds.get(from_, 0.0) - seconds
        self._seconds[to] = self._seconds.get(to, 0.0) + seconds

    def taken(self) -> Seconds:
        """The seconds since the last call: what a job pays once stands in its first record only."""
        seconds, self._seconds = self._seconds, {}
        return Seconds(**seconds, total=sum(seconds.values()))
