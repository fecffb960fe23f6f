"""Simplification of label maps: the mesh that all labels share, and what is said of each label."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.extraction import Deviation, Simplification
from isocore.methods.simplifying import Axes, Simplifier, facts_of
from isocore.placing import Placing


@dataclass(frozen=True, slots=True)
class SimplifiedLabels:
    """What simplification did to a map's sheets, the borders between two labels each."""

    found: _kernels.SimplifiedLabels
    simplifier: Simplifier
    seconds: float

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where more triangles are left than were asked for: why."""
        return self.simplifier.missed(self.found.all_after)

    def of(self, rank: int, triangles: int) -> tuple[Deviation, Simplification]:
        """What there is to say about one label, its sheets together. triangles: how many it has now."""
        found = self.found
        own = (found.pairs == rank).any(axis=1)
        error, other = (_together(part[own], found.vertices_before[own]) for part in (found.error, found.error_other))
        back = float(found.back_max[own].max(initial=0))
        refused = [int(count) for count in found.refused[own].sum(axis=0)]
        before = int(found.triangles_before[own].sum())
        collapses = (before - triangles) // 2  # of a closed surface, two triangles vanish with each edge
        facts = facts_of(before, collapses, refused, self.seconds)
        return self.simplifier.volume_deviation(error, other, back, int(found.unproved[own].sum())), facts


def simplify_labels(surfaces: _kernels.LabelSurfaces, simplifier: Simplifier, placing: Placing) -> SimplifiedLabels:
    """Make the triangles of all labels fewer, once for all of them, so that none meet where they are written."""
    start = perf_counter()
    found = surfaces.simplify(
        *simplifier.scales(), simplifier.most_triangles, placing.for_kernels(), simplifier.threads
    )
    return SimplifiedLabels(found, simplifier, perf_counter() - start)


def _together(errors: npt.NDArray[np.float64], vertices: npt.NDArray[np.uint32]) -> Axes:
    """Largest, mean and root mean square of some sheets' distances, of which the largest and two sums are known."""
    count = max(1, int(vertices.sum()))
    return (
        float(errors[:, 0].max(initial=0)),
        float(errors[:, 1].sum()) / count,
        float(np.sqrt(errors[:, 2].sum() / count)),
    )
