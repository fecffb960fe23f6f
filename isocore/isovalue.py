"""How an isovalue is chosen, and why.

choices.py says how one is asked for. Otsu's threshold follows N. Otsu, "A Threshold Selection Method from Gray-Level
Histograms", IEEE Trans. Systems, Man, and Cybernetics 9(1), 1979: the cut that maximises the variance between the two
classes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from isocore.apart import Apart
from isocore.choices import Auto, Choice, Number, Otsu, Percentile
from isocore.digits import exact, legible
from isocore.errors import FieldError
from isocore.histogram import Histogram
from isocore.labels import Label

#: From this share of the samples on, values that were set aside for Otsu's threshold are named beside a percentile.
_SHARE_THAT_MOVES = 1e-3


class Chosen(NamedTuple):
    """An isovalue: how it was asked for, the number, how that came about, and what its user should know."""

    asked: Choice
    isovalue: float
    why: str
    warnings: tuple[str, ...] = ()


def choose(choice: Choice, histogram: Histogram) -> Chosen:
    """The number behind a choice, for these samples. Raises FieldError where it is too large to be one."""
    chosen = _chosen(choice, histogram)
    if not math.isfinite(chosen.isovalue):
        raise FieldError(f"{choice} is no finite number here: slope and intercept make the samples too large")
    return chosen


def _chosen(choice: Choice, histogram: Histogram) -> Chosen:
    if isinstance(choice, Number):
        return Chosen(choice, choice.value, "given")
    if isinstance(choice, Label):
        return Chosen(choice, choice.value, "a label")
    ends = histogram.range
    if ends is None:
        return Chosen(choice, 0.5, "no sample is finite, so any isovalue is as good")
    if isinstance(choice, Percentile):
        value = percentile(histogram, choice.percent)
        why = f"percentile {choice.text[1:]} of the finite samples"
        return Chosen(choice, value, why, _beside_a_percentile(histogram))
    if ends[0] == ends[1]:
        return Chosen(choice, _for_a_constant(ends[0]), f"every sample is {exact(ends[0])}, so none divides them")
    warnings = tuple(_set_aside(group, histogram) for group in histogram.apart)
    if isinstance(choice, Otsu):
        return Chosen(choice, otsu(histogram), "Otsu's threshold", warnings)
    if is_two_valued(histogram):
        low, high = histogram.kept_range or ends
        why = "midpoint of the two values {} and {}".format(*legible(low, high))
        return Chosen(choice, middle(low, high), why, warnings)
    return Chosen(choice, otsu(histogram), "Otsu's threshold, since none was given", warnings)


def _for_a_constant(value: float) -> float:
    """Where the surface of a mask would lie that is empty, or that fills its volume: capped, the latter has one."""
    return value / 2 if value else 0.5


def middle(low: float, high: float) -> float:
    """Halfway, but above `low` also where no double lies between the two: inside is from the isovalue on."""
    middle = low / 2 + high / 2 if math.isinf(low + high) else (low + high) / 2
    return middle if middle > low else high


def _set_aside(group: Apart, histogram: Histogram) -> str:
    """The warning for a choice that left a group of samples out."""
    low, high = histogram.kept_range or (math.nan, math.nan)
    side = "inside" if group.low > high else "outside"
    others = "all others ({} to {})".format(*legible(low, high))
    told = f"{_share(group, histogram)}, far from {others}: "
    told += (
        "it was set aside to choose the isovalue and counts"
        if group.count == 1
        else ("they were set aside to choose the isovalue and count")
    )
    if group.low == group.high:
        return f"{told} as {side}; if that value means that nothing is there, --ignore {pasted(group.low, histogram)}"
    return f"{told} as {side}; if they are data, give the isovalue with -i"


def _beside_a_percentile(histogram: Histogram) -> tuple[str, ...]:
    """Warnings for groups that lie apart and are large enough to move a percentile, which counts them."""
    return tuple(
        f"{_share(group, histogram)}, far from all others, and percentiles count them"
        + (f"; --ignore {pasted(group.low, histogram)} leaves them out" if group.low == group.high else "")
        for group in histogram.apart
        if group.count >= _SHARE_THAT_MOVES * histogram.finite
    )


def _share(group: Apart, histogram: Histogram) -> str:
    share = 100 * group.count / len(histogram.samples)
    if group.low == group.high:
        values = pasted(group.low, histogram)
    else:
        values = "from {} to {}".format(*legible(group.low, group.high))
    noun = "sample is" if group.count == 1 else "samples are"
    return f"{group.count:,} {noun} {values} ({share:.2g} % of all)"


def pasted(value: float, histogram: Histogram) -> str:
    """A sample's value as short as its type allows, to be pasted into a command."""
    if histogram.samples.dtype == np.float32 and histogram.slope == 1 and histogram.intercept == 0:
        return str(np.float32(value)).removesuffix(".0")
    return exact(value)


def is_two_valued(histogram: Histogram) -> bool:
    """Whether the finite samples that are not set aside take exactly two values."""
    occupied = np.flatnonzero(histogram.counts)
    if len(occupied) != 2 or occupied[0] != 0 or occupied[-1] != len(histogram.counts) - 1:
        return False
    if histogram.exact:
        return True
    ends = histogram.equal_to(histogram.low) + histogram.equal_to(histogram.high)
    return ends == int(histogram.counts.sum())


def otsu(histogram: Histogram) -> float:
    """Otsu's threshold, scaled, halfway between the two classes' nearest occupied bins.

    The cut is sought in numbers of bins, which no sample is too large or too small for.
    """
    occupied = np.flatnonzero(histogram.counts)
    weights = histogram.counts[occupied].astype(np.float64)
    places = occupied.astype(np.float64)
    below = np.cumsum(weights)[:-1]
    above = weights.sum() - below
    sums = np.cumsum(weights * places)
    total = sums[-1]
    between = below * above * (sums[:-1] / below - (total - sums[:-1]) / above) ** 2
    cut = int(np.argmax(between))
    end = 0 if histogram.exact else 1
    ends = (histogram.scaled(histogram.edge(float(place))) for place in (occupied[cut] + end, occupied[cut + 1]))
    lowest = (histogram.kept_range or (0.0, 0.0))[0]
    return max(middle(*sorted(ends)), math.nextafter(lowest, math.inf))


def percentile(histogram: Histogram, percent: float) -> float:
    """The value below which `percent` of the finite samples lie, scaled: exactly what numpy.percentile gives.

    Between two samples it is interpolated linearly (method 7 of Hyndman, Fan, "Sample Quantiles in Statistical
    Packages", The American Statistician 50(4), 1996).
    """
    last = histogram.finite - 1
    position = last * (percent / 100)
    rank = min(int(position), last)
    share = position - rank
    if histogram.slope > 0:
        before, after = histogram.at_rank(rank)
    else:  # the values fall where the samples rise
        after, before = histogram.at_rank(max(last - rank - 1, 0))
        before = after if rank == last else before
    low, high = histogram.scaled(before), histogram.scaled(after)
    step = high - low
    if not share:
        return low
    if not math.isfinite(step):
        return low * (1 - share) + high * share
    # As numpy rounds it: from the nearer end.
    return high - step * (1 - share) if share >= 0.5 else low + step * share


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
