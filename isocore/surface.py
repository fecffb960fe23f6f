"""A surface: triangles in the world, ready to be measured and written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.volume import Space


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A triangle mesh, counter-clockwise seen from outside.

    vertices: (v, 3) float32, world (float64 where float32 would move a vertex by more than 1e-3 voxel).
    triangles: (t, 3) int32, indices into vertices.
    normals: (v, 3) float32, unit length, pointing outside; or None.
    space, unit: as in Volume.
    """

    vertices: npt.NDArray[Any]
    triangles: npt.NDArray[np.int32]
    normals: npt.NDArray[np.float32] | None = None
    space: Space = "native"
    unit: str = ""

    def __post_init__(self) -> None:
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or self.vertices.dtype.name not in ("float32", "float64"):
            raise ValueError("vertices must be (v, 3) float32 or float64")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3 or self.triangles.dtype != np.int32:
            raise ValueError("triangles must be (t, 3) int32")
        if self.normals is not None and (self.normals.shape != self.vertices.shape or self.normals.dtype != np.float32):
            raise ValueError("normals must be (v, 3) float32")
        for array in (self.vertices, self.triangles, self.normals):
            if array is not None:
                array.flags.writeable = False
