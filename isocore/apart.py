"""Samples that lie apart from all others: fill values, and outliers by orders of magnitude.

They are set aside where an isovalue is chosen from how the samples are spread, and where that is drawn: one value of
1e20 would leave everything else in a single bin. A group at the end of the range is set aside

* where it is one known fill value, or the lowest number of its type, and the gap beside it is at least half as wide as
  the range of all others;
* where it is at least 1e5 and at least 1000 times as large as any other, and is either one to four values or at most
  one sample in a hundred; a single negative value below others that are not negative may also be smaller than 1e5;
* where it is a handful of samples that lie 1000 times as far out as all others are spread.

What is left must hold two different values. -1024 beside -1000, the background of a mask, a few bright voxels or a
heavy tail are none of these.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels

#: Written for "nothing here" by common programs; as stored or as scaled.
_FILL_VALUES = (-999.0, -999.25, -9999.0, -32767.0, -99999.0, -999999.0, 1e20, 1e30, -1e30, 9.969209968386869e36)
_FACTOR = 1000.0
_LARGE = 1e5
_MOST_VALUES = 4
_MOST_STEPS = 8


@dataclass(frozen=True, slots=True)
class Apart:
    """A group of samples that was set aside, by its smallest and largest value, scaled; count: how many they are."""

    low: float
    high: float
    count: int


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """Samples between two ends, in the stored scale, both of which occur.

    samples: (n,) as stored, in memory order. counts: (bins,) of those from low to high, in equal bins.
    """

    samples: npt.NDArray[Any]
    low: float
    high: float
    counts: npt.NDArray[np.uint64]
    slope: float
    intercept: float
    threads: int

    def within(self, low: float, high: float) -> _kernels.Within:
        """The samples from low to high, as far as these ends allow."""
        return _kernels.extent_between(self.samples, max(low, self.low), min(high, self.high), self.threads)

    def ends_around_zero(self, size: float) -> tuple[float, float]:
        """The stored samples whose values are `size` below and above zero, in rising order."""
        low, high = sorted((value - self.intercept) / self.slope for value in (-size, size))
        return low, high

    def around_zero(self, size: float) -> _kernels.Within:
        """The samples whose absolute value, scaled, is at most `size`."""
        return self.within(*self.ends_around_zero(size))

    def above(self, value: float) -> _kernels.Within:
        """The samples above a value."""
        return self.within(math.nextafter(value, math.inf), self.high)

    def below(self, value: float) -> _kernels.Within:
        """The samples below a value."""
        return self.within(self.low, math.nextafter(value, -math.inf))

    def scaled(self, stored: float) -> float:
        """The value of a stored sample."""
        return self.slope * stored + self.intercept

    def size(self, *stored: float) -> float:
        """The largest absolute value of these, scaled."""
        return max(abs(self.scaled(value)) for value in stored)


def without_far(spread: Spread) -> tuple[float, float] | None:
    """The ends of the samples that are left when those that lie apart are set aside; None where none does."""
    if not spread.low < spread.high:
        return None
    ends = _without_fill_value(spread) or _without_large(spread) or _without_rare(spread)
    ends = ends or _without_handful(spread)
    return ends if ends is not None and ends[0] < ends[1] else None


def _without_fill_value(spread: Spread) -> tuple[float, float] | None:
    """Without the fill value at one of the ends."""
    for end in (spread.low, spread.high):
        if not _is_fill_value(end, spread):
            continue
        rest = spread.above(end) if end == spread.low else spread.below(end)
        gap = min(abs(end - rest.minimum), abs(end - rest.maximum))
        if rest.minimum < rest.maximum and gap >= 0.5 * (rest.maximum - rest.minimum):
            return rest.minimum, rest.maximum
    return None


def _is_fill_value(stored: float, spread: Spread) -> bool:
    kind = spread.samples.dtype
    if kind.itemsize > 1 and kind.kind == "i" and stored == np.iinfo(kind).min:
        return True
    if kind.kind == "f" and abs(stored) == np.finfo(kind).max:
        return True
    scaled = spread.scaled(stored)
    rounded = np.float32 if kind == np.float32 else float
    return any(stored == rounded(value) or scaled == value for value in _FILL_VALUES)


def _without_large(spread: Spread) -> tuple[float, float] | None:
    """Without the few values that are large by orders of magnitude beside all others."""
    largest = spread.size(spread.low, spread.high)
    if _surely_none_large(spread, largest / _FACTOR):
        return None
    near = spread.around_zero(largest / _FACTOR)
    under, over = spread.below(near.minimum), spread.above(near.maximum)
    if not near.minimum < near.maximum or not under.samples + over.samples:
        return None
    nearest = min(spread.size(end) for side, end in ((under, under.maximum), (over, over.minimum)) if side.samples)
    if nearest < _FACTOR * spread.size(near.minimum, near.maximum):
        return None
    few = _values_of(spread, under) + _values_of(spread, over) <= _MOST_VALUES
    if (nearest >= _LARGE and few) or _one_negative(spread, under, near, over):
        return near.minimum, near.maximum
    return None


def _one_negative(spread: Spread, under: _kernels.Within, near: _kernels.Within, over: _kernels.Within) -> bool:
    """Whether what lies beyond `near` is one negative value, and `near` holds none."""
    lower, upper = (under, over) if spread.slope > 0 else (over, under)
    if upper.samples or lower.minimum != lower.maximum or spread.scaled(lower.minimum) >= 0:
        return False
    return min(spread.scaled(near.minimum), spread.scaled(near.maximum)) >= 0


def _surely_none_large(spread: Spread, size: float) -> bool:
    """Whether the bins alone tell: samples larger than this lie in too many of them."""
    half = spread.high / 2 - spread.low / 2  # a whole range may be larger than any double
    if not half:
        return True
    bins = len(spread.counts)
    first, last = ((edge / 2 - spread.low / 2) / half * bins for edge in spread.ends_around_zero(size))
    occupied = np.flatnonzero(spread.counts)
    return int(np.count_nonzero((occupied + 1 < first) | (occupied > last + 1))) > _MOST_VALUES


def _values_of(spread: Spread, side: _kernels.Within) -> int:
    """How many different values a side holds, counted up to one more than matters."""
    values, seen = 0, side
    while seen.samples and values <= _MOST_VALUES:
        values += 1
        seen = spread.within(math.nextafter(seen.minimum, math.inf), side.maximum)
    return values


def _without_rare(spread: Spread) -> tuple[float, float] | None:
    """Without at most one sample in a hundred that are large by orders of magnitude, however many values they are."""
    bulk = _bulk(spread, int(spread.counts.sum()) // 100)
    if bulk is None:
        return None
    low, high = bulk
    for _ in range(_MOST_STEPS):
        near = spread.around_zero(_FACTOR * spread.size(low, high))
        if (near.minimum, near.maximum) == (low, high):
            break
        low, high = min(low, near.minimum), max(high, near.maximum)
    under, over = spread.below(low), spread.above(high)
    nearest = [spread.size(end) for side, end in ((under, under.maximum), (over, over.minimum)) if side.samples]
    return (low, high) if nearest and min(nearest) >= max(_LARGE, _FACTOR * spread.size(low, high)) else None


def _without_handful(spread: Spread) -> tuple[float, float] | None:
    """Without a handful of samples that lie far out by the width of all others."""
    total = int(spread.counts.sum())
    bulk = _bulk(spread, min(max(8, total // 100_000), total // 100))
    if bulk is None or not 0 < (bulk[1] - bulk[0]) * _FACTOR < math.inf:
        return None
    reach = _FACTOR * (bulk[1] - bulk[0])
    rest = spread.within(bulk[0] - reach, bulk[1] + reach)
    return (rest.minimum, rest.maximum) if rest.samples < total else None


def _bulk(spread: Spread, rare: int) -> tuple[float, float] | None:
    """The ends of all samples but `rare` ones on either side; None where these are too wide for any to be far out."""
    total = int(spread.counts.sum())
    if not rare:
        return None
    before = np.cumsum(spread.counts)
    ranks = (rare, total - 1 - rare)
    first, last = (int(np.searchsorted(before, rank, side="right")) for rank in ranks)
    if (last - first - 1) * _FACTOR >= len(spread.counts):
        return None
    low, high = (
        _kernels.sample_of_rank(spread.samples, spread.low, spread.high, rank, spread.threads).value for rank in ranks
    )
    return low, high
