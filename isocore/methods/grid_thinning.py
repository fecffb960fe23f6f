"""Volume thinning where the cells are those of a voxel volume: hexahedra that need no adjacency.

Follows Itoh, Yamaguchi, Koyamada, IEEE TVCG 7(1), 2001, as isocore/methods/thinning.py does for meshes.
"""

from __future__ import annotations

from threading import Lock
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.extraction import Extract, Extraction, Options
from isocore.methods.marching_cubes import placed_surface
from isocore.volume import Volume

#: Past this share of the vertices, extrema are noise: the skeleton grows with them, and the walk saves little.
NOISE = 0.05
# The longest axis whose index coordinates float32 keeps apart, as in marching cubes.
_LONGEST_FOR_FLOAT32 = 8192


def prepare_grid_thinning(volume: Volume, options: Options) -> Extract:
    """Thin the volume now; then walk for every isovalue."""
    walker = GridWalker(volume, capped=options.cap)
    advice = walker.advice()

    def extract(isovalue: float) -> Extraction:
        vertices, triangles, facts = walker.propagate(volume.stored_isovalue(isovalue), options.threads)
        return Extraction(placed_surface(volume, vertices, triangles, options), facts, advice)

    return extract


class GridWalker:
    """A thinned volume, ready to walk; one call at a time, since calls share the marks they leave and take back.

    With capped the volume counts as surrounded by a layer of outside samples.
    """

    def __init__(self, volume: Volume, *, capped: bool) -> None:
        self._samples = volume.samples
        self._how = (volume.inside_is_below, capped)
        skeleton, low, high, extrema = _kernels.thin_grid(volume.samples, *self._how)
        self._skeleton = (skeleton, low, high)
        layers = 1 if capped else -1
        cells = int(np.prod([size + layers for size in volume.shape]))
        self._place = np.zeros(cells, np.int32)
        self._known = {"cells": cells, "extrema": extrema, "skeleton": len(skeleton)}
        self._one_at_a_time = Lock()

    def propagate(
        self, stored: float, threads: int
    ) -> tuple[npt.NDArray[Any], npt.NDArray[np.int32], dict[str, dict[str, int]]]:
        """stored isovalue -> vertices in index space, triangles, facts: the surface of marching cubes."""
        kernel: Any = _kernels.propagate_grid
        with self._one_at_a_time:
            found = kernel(self._samples, *self._skeleton, self._place, stored, *self._how, threads)
        vertices, triangles, seeds, visited, faces, cells = found
        if max(self._samples.shape) <= _LONGEST_FOR_FLOAT32:
            vertices = vertices.astype(np.float32)
        search = {**self._known, "seeds": seeds, "visited": visited, "intersected": visited}
        return vertices, triangles, {"search": search, "ambiguous": {"faces": faces, "cells": cells}}

    def advice(self) -> tuple[str, ...]:
        """Thinning seldom pays on volumes, whose full scan takes 64 cells at a time; on noise it never does."""
        share = self._known["extrema"] / self._known["cells"]
        if share > NOISE:
            return (
                f"the field is noise to thinning: {self._known['extrema']:,} extrema, and a skeleton of "
                f"{self._known['skeleton']:,} of {self._known['cells']:,} cells; choose -b mc",
            )
        return ("a volume's full scan takes 64 cells at a time and is faster as a rule: choose -b mc",)
