"""How a field's samples are spread: the ground on which isovalues are chosen and drawn.

Everything is counted in the stored scale; slope and intercept are applied when a number leaves. Samples that lie apart
from all others (apart.py) are counted, but in no bin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.apart import Apart, Spread, without_far
from isocore.cell_mesh import CellMesh
from isocore.volume import Volume

#: Bins of a histogram that cannot have one bin per value.
BINS = 4096
#: Integers of at most this range get one bin per value.
EXACT_RANGE = 65536
_MOST_ROUNDS = 16


@dataclass(frozen=True, slots=True)
class Bars:
    """Equal bins for drawing, in the scale of the values. low, high: their ends, None without a finite sample."""

    low: float | None
    high: float | None
    counts: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Histogram:
    """Counts of the finite samples.

    samples: (n,) as stored, in memory order.
    minimum, maximum: of the finite samples, stored scale; minimum > maximum where there is none.
    nonfinite: samples that are NaN or infinite.
    low, high: smallest and largest sample that is not set aside, stored scale.
    counts: (bins,) uint64, equal bins from low to high.
    exact: each bin is one stored value.
    apart: what was set aside, nearest first.
    slope, intercept: value = slope * stored + intercept.
    """

    samples: npt.NDArray[Any]
    minimum: float
    maximum: float
    nonfinite: int
    low: float
    high: float
    counts: npt.NDArray[np.uint64]
    exact: bool
    apart: tuple[Apart, ...] = ()
    slope: float = 1.0
    intercept: float = 0.0
    threads: int = 1

    @property
    def finite(self) -> int:
        """Samples that are finite."""
        return len(self.samples) - self.nonfinite

    @property
    def range(self) -> tuple[float, float] | None:
        """Smallest and largest value, scaled; None without a finite sample."""
        return self._scaled_ends(self.minimum, self.maximum) if self.finite else None

    @property
    def kept_range(self) -> tuple[float, float] | None:
        """Smallest and largest value that is not set aside, scaled; None without a finite sample."""
        return self._scaled_ends(self.low, self.high) if self.finite else None

    def _scaled_ends(self, *stored: float) -> tuple[float, float]:
        low, high = sorted(self.scaled(end) for end in stored)
        return low, high

    def _group(self, side: _kernels.Within) -> Apart:
        return Apart(*self._scaled_ends(side.minimum, side.maximum), side.samples)

    def scaled(self, stored: float) -> float:
        """The value of a stored sample."""
        return self.slope * stored + self.intercept

    def edge(self, number: float) -> float:
        """Where a bin begins, stored scale; a fraction lies inside the bin before. With exact bins: a value."""
        if self.exact:
            return self.low + number
        span, share = self.high - self.low, number / len(self.counts)
        return (
            self.low + number * (span / len(self.counts))
            if math.isfinite(span)
            else (self.low * (1 - share) + self.high * share)
        )

    def equal_to(self, stored: float) -> int:
        """How many samples have this value."""
        return _kernels.extent_between(self.samples, stored, stored, self.threads).samples

    def at_rank(self, rank: int) -> tuple[float, float]:
        """The sample with `rank` finite others before it, and the one after it (the last is its own); stored scale."""
        found = _kernels.sample_of_rank(self.samples, self.minimum, self.maximum, rank, self.threads)
        if rank + 1 < found.below + found.equal or rank + 1 == self.finite:
            return found.value, found.value
        above = math.nextafter(found.value, math.inf)
        return found.value, _kernels.extent_between(self.samples, above, self.maximum, self.threads).minimum

    def coarse(self, bins: int = 64) -> Bars:
        """At most `bins` equal bins over the range of values that are not set aside, for drawing."""
        ends = self.kept_range
        if ends is None:
            return Bars(None, None, ())
        step = -(-len(self.counts) // bins)
        padded = np.zeros(-(-len(self.counts) // step) * step, np.uint64)
        padded[: len(self.counts)] = self.counts
        counts = padded.reshape(-1, step).sum(axis=1)
        if self.low == self.high:
            return Bars(*ends, tuple(counts.tolist()))
        around = 0.5 if self.exact else 0.0
        low, high = self.scaled(self.edge(0) - around), self.scaled(self.edge(len(padded)) - around)
        ordered = counts if low <= high else counts[::-1]
        return Bars(min(low, high), max(low, high), tuple(ordered.tolist()))


def histogram(field: Volume | CellMesh, *, threads: int = 1) -> Histogram:
    """Count the samples of a volume or the values of a mesh."""
    if isinstance(field, Volume):
        samples = field.samples.reshape(-1, order="F")
        slope, intercept = field.slope, field.intercept
    else:
        samples, slope, intercept = field.values, 1.0, 0.0
    minimum, maximum, nonfinite = _kernels.extent(samples, threads)
    whole = Histogram(
        samples, minimum, maximum, nonfinite, minimum, maximum, np.zeros(0, np.uint64), False,
        slope=slope, intercept=intercept, threads=threads,
    )  # fmt: skip
    return whole if minimum > maximum else _without_apart(_counted(whole))


def _counted(spread: Histogram) -> Histogram:
    """The histogram with its bins filled anew, from its low to its high."""
    span = spread.high - spread.low
    exact = spread.samples.dtype.kind in "iu" and span < EXACT_RANGE
    bins = int(span) + 1 if exact else BINS
    counts = _kernels.histogram(spread.samples, spread.low, spread.high, bins, spread.threads)
    return replace(spread, counts=counts, exact=exact)


def _without_apart(spread: Histogram) -> Histogram:
    """The histogram once all that lies apart is set aside: of two fill values the second shows without the first."""
    for _ in range(_MOST_ROUNDS):
        seen = Spread(
            spread.samples, spread.low, spread.high, spread.counts, spread.slope, spread.intercept, spread.threads
        )
        ends = without_far(seen)
        if ends is None:
            break
        groups = [spread._group(side) for side in (seen.below(ends[0]), seen.above(ends[1])) if side.samples]
        spread = _counted(replace(spread, low=ends[0], high=ends[1], apart=(*groups, *spread.apart)))
    return spread
