"""Where an affine puts vertices, and in which type of coordinates that is written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels

Bounds = tuple[float, float, float, float, float, float]

# float32 is enough while its steps are below this part of the shortest voxel edge: half of the distance
# that vertices keep from grid points, so that no two fall together, whichever way the affine turns them.
_COARSEST_STEP = 2.0**-11


@dataclass(frozen=True, slots=True, eq=False)
class Placing:
    """How `place_fresh` places the vertices of a mesh, which need not be at hand: their type is chosen by a box.

    rows: (3, 4) of the affine. dtype: float32 or float64. largest: no coordinate is larger.
    """

    rows: npt.NDArray[np.float64]
    dtype: type
    largest: float

    def __call__(self, vertices: npt.NDArray[Any], threads: int = 1) -> npt.NDArray[Any]:
        """Where (v, 3) vertices are put, as they are rounded when they are written."""
        out: npt.NDArray[Any] = np.empty(vertices.shape, self.dtype)
        _kernels.place(vertices, self.rows, out, threads)
        return out

    def for_kernels(self) -> _kernels.Writing:
        """The same for simplification."""
        step = float(np.spacing(np.array(self.largest, self.dtype)))
        back = float(np.abs(np.linalg.inv(self.rows[:, :3])).sum(axis=1).max())
        return _kernels.Writing(self.rows, self.dtype is np.float32, step * back)


def placing_in(bounds: Bounds, dtype: type, affine: npt.NDArray[np.float64]) -> Placing:
    """How vertices of a type are placed that lie in a box of index space: its low corner, then its high one."""
    rows = np.ascontiguousarray(affine[:3], dtype=np.float64)
    largest = _farthest(bounds, rows)
    return Placing(rows, _type_for(largest, dtype, rows), largest)


def coordinate_type(vertices: npt.NDArray[Any], rows: npt.NDArray[np.float64]) -> type:
    """float32, or float64 where the steps of float32 are too coarse for the shortest voxel edge.

    vertices: in index space, so that a column of `rows` (3, 4) is a voxel edge; float64 ones stay so.
    """
    if not len(vertices) or vertices.dtype == np.float64:
        return vertices.dtype.type
    return _type_for(_farthest(_kernels.bounds(vertices), rows), np.float32, rows)


def _farthest(bounds: Bounds, rows: npt.NDArray[np.float64]) -> float:
    """The largest coordinate of a box that is put somewhere else."""
    low, high = np.array(bounds).reshape(2, 3)
    linear, offset = rows[:, :3], rows[:, 3]
    return float((np.abs(linear @ (low + high) / 2 + offset) + np.abs(linear) @ (high - low) / 2).max())


def _type_for(largest: float, dtype: type, rows: npt.NDArray[np.float64]) -> type:
    if dtype is np.float64 or not largest < float(np.finfo(np.float32).max):
        return np.float64
    shortest = np.sqrt((rows[:, :3] ** 2).sum(axis=0)).min()
    return np.float32 if np.spacing(np.float32(largest)) <= _COARSEST_STEP * shortest else np.float64
