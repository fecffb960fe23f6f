"""How an isovalue is chosen, and why.

choices.py says how one is asked for. Otsu's threshold follows N. Otsu, "A Threshold Selection Method from Gray-Level
Histograms", IEEE Trans. Systems, Man, and Cybernetics 9(1), 1979: the cut that maximises the variance between the two
classes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.choices import Auto, Choice, Number, Otsu, Percentile
from isocore.errors import FieldError
from isocore.histogram import Histogram


@dataclass(frozen=True, slots=True)
class Chosen:
    """An isovalue: how it was asked for, the number, and how that came about."""

    asked: Choice
    isovalue: float
    why: str


def choose(choice: Choice, histogram: Histogram) -> Chosen:
    """The number behind a choice, for these samples. Raises FieldError where the samples offer none."""
    if isinstance(choice, Number):
        return Chosen(choice, choice.value, "given")
    _needs_two_values(histogram)
    if isinstance(choice, Percentile):
        value = histogram.scaled(percentile(histogram, choice.percent))
        return Chosen(choice, value, f"percentile {choice.text[1:]} of the finite samples")
    if isinstance(choice, Otsu):
        return Chosen(choice, histogram.scaled(otsu(histogram)), "Otsu's threshold")
    if is_two_valued(histogram):
        low, high = histogram.range or (0.0, 0.0)
        return Chosen(choice, (low + high) / 2, f"midpoint of the two values {low:g} and {high:g}")
    return Chosen(choice, histogram.scaled(otsu(histogram)), "Otsu's threshold, since none was given")


def _needs_two_values(histogram: Histogram) -> None:
    if not histogram.finite:
        raise FieldError("holds no finite sample, so there is no isovalue to choose; check the file")
    if histogram.minimum == histogram.maximum:
        value = histogram.scaled(histogram.minimum)
        raise FieldError(f"every sample is {value:g}, so there is no isovalue to choose; give one with -i")


def is_two_valued(histogram: Histogram) -> bool:
    """Whether the finite samples take exactly two values."""
    occupied = np.flatnonzero(histogram.counts)
    if len(occupied) != 2 or occupied[0] != 0 or occupied[-1] != len(histogram.counts) - 1:
        return False
    samples = histogram.samples
    ends = int(np.count_nonzero(samples == histogram.minimum)) + int(np.count_nonzero(samples == histogram.maximum))
    return histogram.exact or ends == histogram.finite


def otsu(histogram: Histogram) -> float:
    """Otsu's threshold in the stored scale, halfway between the two classes' nearest occupied bins."""
    occupied = np.flatnonzero(histogram.counts)
    weights = histogram.counts[occupied].astype(np.float64)
    values = _values(histogram, occupied)
    below = np.cumsum(weights)[:-1]
    above = weights.sum() - below
    sums = np.cumsum(weights * values)
    total = sums[-1]
    between = below * above * (sums[:-1] / below - (total - sums[:-1]) / above) ** 2
    cut = int(np.argmax(between))
    if histogram.exact:
        return float(values[cut] + values[cut + 1]) / 2
    upper_edge = histogram.minimum + (occupied[cut] + 1) * histogram.width
    lower_edge = histogram.minimum + occupied[cut + 1] * histogram.width
    return float(upper_edge + lower_edge) / 2


def _values(histogram: Histogram, bins: npt.NDArray[np.intp]) -> npt.NDArray[np.float64]:
    middle = 0.0 if histogram.exact else 0.5
    values: npt.NDArray[np.float64] = (bins + middle) * np.float64(histogram.width) + histogram.minimum
    return values


def percentile(histogram: Histogram, percent: float) -> float:
    """The stored value below which `percent` of the finite samples lie, to the bin of a bin.

    With a negative slope the percentile is counted from the other end, so that it holds for the values.
    """
    share = percent / 100 if histogram.slope > 0 else 1 - percent / 100
    rank = min(int(share * histogram.finite), histogram.finite - 1)
    bin_ = _bin_of_rank(histogram.counts, rank)
    if histogram.exact:
        return histogram.minimum + bin_
    # A sample at the edge of a bin may be counted on either side of it: half a bin more holds it for certain.
    low = max(histogram.minimum, histogram.minimum + (bin_ - 0.5) * histogram.width)
    high = min(histogram.maximum, histogram.minimum + (bin_ + 1.5) * histogram.width)
    finer = _counts(histogram, low, high, len(histogram.counts))
    below = math.nextafter(low, -math.inf)
    before = int(_counts(histogram, histogram.minimum, below, 1)[0]) if low > histogram.minimum else 0
    return low + (_bin_of_rank(finer, rank - before) + 0.5) * (high - low) / len(finer)


def _counts(histogram: Histogram, low: float, high: float, bins: int) -> npt.NDArray[np.uint64]:
    return _kernels.histogram(histogram.samples, low, high, bins, histogram.threads)


def _bin_of_rank(counts: npt.NDArray[np.uint64], rank: int) -> int:
    """The bin that holds the sample of this rank."""
    return int(np.searchsorted(np.cumsum(counts), rank, side="right"))


def suggestions(histogram: Histogram) -> tuple[Chosen, ...]:
    """Isovalues worth trying, the automatic one first; none where all samples are alike."""
    if not histogram.finite or histogram.minimum == histogram.maximum:
        return ()
    first = choose(Auto(), histogram)
    if is_two_valued(histogram):
        return (first,)
    others = [choose(Percentile(percent, f"p{percent}"), histogram) for percent in (50, 90, 99)]
    low = (histogram.range or (0.0, 0.0))[0]
    return (first, *(other for other in others if other.isovalue > low))
