"""Where a surface could have been drawn in two ways, shown instead of hidden.

A cell face whose corners are alternately inside and outside does not say which corners belong together. We decide by
the saddle of the bilinear interpolation (Nielson, Hamann, "The Asymptotic Decider", IEEE Visualization 1991): its
distance from the isovalue says how close the decision was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.volume import Volume


@dataclass(frozen=True, slots=True, eq=False)
class Ambiguities:
    """The ambiguous faces of a volume at one isovalue, each once.

    points: (n, 3) float64, world: the saddle of each face.
    distances: (n,) float64, scaled value of the saddle minus the isovalue; not below 0 where the inside was joined.
    space, unit: as in Volume.
    """

    points: npt.NDArray[np.float64]
    distances: npt.NDArray[np.float64]
    space: str
    unit: str


def find_ambiguities(volume: Volume, isovalue: float, *, threads: int = 1) -> Ambiguities:
    """The ambiguous faces of the volume's own cells; capping adds none."""
    faces = _kernels.ambiguities(volume.samples, volume.stored_isovalue(isovalue), volume.inside_is_below, threads)
    points = faces.places @ volume.affine[:3, :3].T + volume.affine[:3, 3]
    return Ambiguities(points, faces.distances * abs(volume.slope), volume.space, volume.unit)
