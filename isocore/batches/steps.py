"""Which steps of a series are converted, by their numbers or by their times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from isocore.digits import exact
from isocore.errors import OptionError

#: A time that is asked for is that of a step where they differ by less than this part of the larger one.
_ROUNDING = 1e-6
_SHOWN = 4


@dataclass(frozen=True, slots=True)
class StepChoice:
    """ranges: (first, last, stride) of numbers, both ends included, negative ones from the last step; None: the end.

    times: of single steps. Without either, all steps are meant.
    """

    ranges: tuple[tuple[int | None, int | None, int], ...] = ()
    times: tuple[float, ...] = ()

    def of(self, path: Path, times: Sequence[float]) -> list[int]:
        """The numbers of the steps meant, ascending. Raises OptionError where the series has none of a part's."""
        if not self.ranges and not self.times:
            return list(range(len(times)))
        chosen: set[int] = set()
        for first, last, stride in self.ranges:
            found = _numbers(first, last, stride, len(times))
            if not found:
                raise OptionError(f"{path}: has no step that --steps asks for; it holds 0 to {len(times) - 1}")
            chosen.update(found)
        for asked in self.times:
            nearest = min(range(len(times)), key=lambda n: abs(times[n] - asked))
            if abs(times[nearest] - asked) > _ROUNDING * max(abs(asked), abs(times[nearest])):
                raise OptionError(f"{path}: has no step at time {exact(asked)}; it holds {_listed(times)}")
            chosen.add(nearest)
        return sorted(chosen)


def _numbers(first: int | None, last: int | None, stride: int, count: int) -> range:
    start = 0 if first is None else first + count if first < 0 else first
    end = count - 1 if last is None else last + count if last < 0 else last
    return range(max(start, 0), min(end, count - 1) + 1, stride)


def _listed(times: Sequence[float]) -> str:
    """Few times whole, of many the first and the last."""
    if len(times) <= _SHOWN:
        return ", ".join(map(exact, times))
    return f"{len(times):,} steps from {exact(times[0])} to {exact(times[-1])}"
