"""What a run has to say about its surface, in words: why it is empty, where it is open."""

from __future__ import annotations

from isocore.digits import exact, legible
from isocore.extraction import LabelFacts
from isocore.field_facts import FieldFacts
from isocore.histogram import Histogram
from isocore.isovalue import Chosen, is_two_valued, middle
from isocore.labels import Label
from isocore.measurements import Measurements


def emptiness(chosen: Chosen, spread: Histogram, label: LabelFacts | None = None) -> str:
    """Why there is no surface; label: what is known of the one that was asked for."""
    if isinstance(chosen.asked, Label):
        if label is not None and label.voxels:
            return f"{chosen.asked} is the background, which has no surface; --background names another"
        return f"no sample is {chosen.asked}"
    if spread.range is None:
        return f"no surface at isovalue {exact(chosen.isovalue)}; no sample is finite"
    low, high = spread.range
    if low == high:
        return f"no surface at isovalue {exact(chosen.isovalue)}; every sample is {exact(low)}"
    value, low_text, high_text = legible(chosen.isovalue, low, high)
    if is_two_valued(spread) and not spread.apart:
        midway = exact(middle(low, high))
        return f"no surface at isovalue {value}; the samples are {low_text} or {high_text}, so ask for -i {midway}"
    return f"no surface at isovalue {value}; the samples lie between {low_text} and {high_text}"


def border(measured: Measurements, known: FieldFacts) -> tuple[str, ...]:
    """A warning where a volume's surface is open, which it is only at the volume's border."""
    edges = measured.boundary_edges
    if known.kind != "volume" or not edges:
        return ()
    return (f"the surface is open where it meets the volume's border ({edges:,} edges); --cap closes it",)
