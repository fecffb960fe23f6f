"""Masks and label maps, and what one isovalue makes of them.

A mask takes two values; only midway between them does a surface leave both sides their half of each crossed edge. A
label map holds the numbers of regions: between label 3 and label 7 lies 5, which means nothing.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isocore.digits import exact, legible
from isocore.extraction import Field
from isocore.histogram import Histogram
from isocore.isovalue import Chosen, is_two_valued, middle
from isocore.labels import Label
from isocore.volume import Volume

#: A mask's isovalue nearer to one of its values than this share of the way is hardly meant.
_TOO_NEAR = 0.1
#: Of neighbours that are no background, so many are equal in a label map; in images it is less than half.
_EQUAL_NEIGHBOURS = 0.65
#: From so many values on, borders must jump over some: those of a smooth image in few grey levels do not.
_FEW_LABELS, _JUMPS = 6, 0.2
_FEWEST_PAIRS = 30
#: Layers and rows that are looked at, two by two.
_LAYERS, _ROWS = 8, 16


def label_count(field: Field, spread: Histogram) -> int:
    """How many values a volume takes that looks like a label map, with its background; 0 for any other field.

    It does where its samples are whole numbers, of three values or more, and constant over regions: looked at in a few
    hundred rows.
    """
    if not isinstance(field, Volume) or not (field.slope.is_integer() and field.intercept.is_integer()):
        return 0
    if not spread.finite or is_two_valued(spread) or spread.minimum == spread.maximum:
        return 0
    rows = _rows(field.samples)
    with np.errstate(invalid="ignore"):  # of signalling NaN
        if rows.dtype.kind == "f" and not ((rows == np.floor(rows)) | np.isnan(rows)).all():
            return 0
    if spread.exact and not spread.apart:
        values, background = int(np.count_nonzero(spread.counts)), spread.low + int(np.argmax(spread.counts))
    else:
        found, counts = np.unique(rows, return_counts=True)
        values, background = len(found), float(found[np.argmax(counts)])
    if values < 3:
        return 0
    seen, most_jumps = 0, 0.0
    for axis in (0, 2, 4):
        pairs, equal, jumps = _neighbours(rows, axis, background)
        if equal < _EQUAL_NEIGHBOURS:
            return 0
        seen, most_jumps = seen + pairs, max(most_jumps, jumps)
    return values if seen >= _FEWEST_PAIRS and (values < _FEW_LABELS or most_jumps >= _JUMPS) else 0


def _rows(samples: npt.NDArray[np.generic]) -> npt.NDArray[np.generic]:
    """(nx, rows, 2, layers, 2): whole rows, in pairs of neighbours along j and k."""
    _, ny, nz = samples.shape
    most = ((ny, _ROWS), (nz, _LAYERS))
    j, k = (np.linspace(0, size - 2, min(size - 1, count)).astype(int) for size, count in most)
    pairs = np.arange(2)
    taken = samples[:, (j[:, None] + pairs).ravel()[:, None], (k[:, None] + pairs).ravel()]
    found: npt.NDArray[np.generic] = taken.reshape(samples.shape[0], len(j), 2, len(k), 2)
    return found


def _neighbours(rows: npt.NDArray[np.generic], axis: int, background: float) -> tuple[int, float, float]:
    """Pairs along an axis without background; the share of equal ones, and among the others of those further than 1."""
    before = (slice(None),) * axis
    first, second = rows[(*before, slice(None, -1))], rows[(*before, slice(1, None))]
    inside = (first != background) & (second != background)
    differ = inside & (first != second)
    pairs, differing = int(np.count_nonzero(inside)), int(np.count_nonzero(differ))
    if not pairs:
        return 0, 1.0, 0.0
    with np.errstate(invalid="ignore"):
        steps = np.abs(first[differ].astype(np.float64) - second[differ].astype(np.float64))
    return pairs, 1 - differing / pairs, float(np.mean(steps > 1)) if differing else 1.0


def isovalue_warnings(chosen: Chosen, spread: Histogram, labels: int) -> tuple[str, ...]:
    """What an isovalue makes of a mask or of a label map, and what to ask for instead; nothing where labels are.

    labels: what label_count says of the field.
    """
    isovalue = chosen.isovalue
    if isinstance(chosen.asked, Label):
        return ()
    if labels:
        return (_of_labels(isovalue, labels),)
    ends = spread.kept_range
    if ends is None or not ends[0] < isovalue <= ends[1] or not is_two_valued(spread):
        return ()
    low, high = ends
    share = (isovalue - low) / (high - low)
    if _TOO_NEAR < share < 1 - _TOO_NEAR:
        return ()
    low_text, high_text = legible(low, high)
    taken, beside = ("too little", high_text) if share > 0.5 else ("too much", low_text)
    return (
        f"the samples are a mask of {low_text} and {high_text}, and isovalue {exact(isovalue)} puts the surface onto "
        f"the samples that are {beside}, so that it encloses {taken}: -i {exact(middle(low, high))} lies midway, "
        "and --smooth 20 takes the steps out",
    )


def _of_labels(isovalue: float, labels: int) -> str:
    """The warning for one isovalue across a label map."""
    return (
        f"the samples look like labels ({labels:,} values, constant over regions): isovalue {exact(isovalue)} makes "
        "one body of all labels from there on, without borders between them, and their numbers move its surface; "
        "--labels all makes a surface of each label"
    )
