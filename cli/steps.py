"""Which steps of a series the command line names, by number or by time."""

from __future__ import annotations

import math
import re
from typing import Any

import click

from .param_type import ParamType

#: First, last and stride; None for an end that is not given.
Range = tuple[int | None, int | None, int]


class StepNumbers(ParamType):
    """Which steps of a series, by number: parts as A:B:C, A:B or K, with commas between."""

    name = "A:B:C"

    def convert(
        self, value: Any, parameter: click.Parameter | None, context: click.Context | None
    ) -> tuple[Range, ...]:
        """The parts."""
        return tuple(self._range(part.strip(), parameter, context) for part in str(value).split(","))

    def _range(self, part: str, parameter: click.Parameter | None, context: click.Context | None) -> Range:
        match = re.fullmatch(r"(-?\d{1,9})?(?P<more>:(-?\d{1,9})?(:(?P<stride>\d{1,9})?)?)?", part, re.ASCII)
        if not part or not match or (match["stride"] and not int(match["stride"])):
            self.fail(f"{part}: needs steps as 3, 0:10, 0:10:2 or -1", parameter, context)
        first, last = (None if number is None else int(number) for number in (match[1], match[3]))
        return (first, last if match["more"] else first, int(match["stride"] or 1))


class Times(ParamType):
    """Times of single steps, with commas between."""

    name = "LIST"

    def convert(
        self, value: Any, parameter: click.Parameter | None, context: click.Context | None
    ) -> tuple[float, ...]:
        """The numbers."""
        try:
            times = tuple(float(part) for part in str(value).split(","))
        except ValueError:
            times = (math.nan,)
        if not all(map(math.isfinite, times)):
            self.fail(f"{value}: needs times, as 0.5 or 0,0.5,1", parameter, context)
        return times
