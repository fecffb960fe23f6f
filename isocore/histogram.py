"""How a field's samples are spread: the ground on which isovalues are chosen and drawn.

Everything is counted in the stored scale; slope and intercept are applied when a number leaves.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.volume import Volume

#: Bins of a histogram that cannot have one bin per value.
BINS = 4096
#: Integers of at most this range get one bin per value.
EXACT_RANGE = 65536


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
    counts: (bins,) uint64, equal bins from minimum to maximum.
    exact: each bin is one stored value.
    slope, intercept: value = slope * stored + intercept.
    """

    samples: npt.NDArray[Any]
    minimum: float
    maximum: float
    nonfinite: int
    counts: npt.NDArray[np.uint64]
    exact: bool
    slope: float = 1.0
    intercept: float = 0.0
    threads: int = 1

    @property
    def finite(self) -> int:
        """Samples that are finite."""
        return len(self.samples) - self.nonfinite

    @property
    def width(self) -> float:
        """Of a bin, in the stored scale; 1 where every bin is one value."""
        return 1.0 if self.exact else (self.maximum - self.minimum) / len(self.counts)

    @property
    def range(self) -> tuple[float, float] | None:
        """Smallest and largest value, scaled; None without a finite sample."""
        if not self.finite:
            return None
        ends = sorted((self.scaled(self.minimum), self.scaled(self.maximum)))
        return ends[0], ends[1]

    def scaled(self, stored: float) -> float:
        """The value of a stored sample."""
        return self.slope * stored + self.intercept

    def coarse(self, bins: int = 64) -> Bars:
        """At most `bins` equal bins over the range of values, for drawing."""
        if not self.finite:
            return Bars(None, None, ())
        ends = self.range or (0.0, 0.0)
        step = -(-len(self.counts) // bins)
        padded = np.zeros(-(-len(self.counts) // step) * step, np.uint64)
        padded[: len(self.counts)] = self.counts
        counts = padded.reshape(-1, step).sum(axis=1)
        high = self.minimum + len(padded) * self.width
        if self.exact:
            low, high = self.minimum - 0.5, high - 0.5
        else:
            low = self.minimum
        if high <= low:
            return Bars(*ends, tuple(counts.tolist()))
        low, high = self.scaled(low), self.scaled(high)
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
    if minimum > maximum:
        counts = np.zeros(0, np.uint64)
        return Histogram(samples, minimum, maximum, nonfinite, counts, False, slope, intercept, threads)
    span = maximum - minimum
    exact = samples.dtype.kind in "iu" and span < EXACT_RANGE
    bins = int(span) + 1 if exact else BINS
    counts = _kernels.histogram(samples, minimum, maximum, bins, threads)
    return Histogram(samples, minimum, maximum, nonfinite, counts, exact, slope, intercept, threads)
