"""Cells that a file marks as not its own, or as not to be drawn, and how they are told from the others.

VTK's `vtkGhostType` holds bits of each cell and of each point. Older files have `vtkGhostLevels`, VisIt writes
`avtGhostZones`: there, any number but 0 marks a ghost.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError

GHOST_TYPE = "vtkGhostType"
#: Names of arrays that mark cells, and the bits that count: duplicate (1), refined (8) and hidden (32) of VTK's.
OF_CELLS = {GHOST_TYPE: 1 | 8 | 32, "vtkGhostLevels": ~0, "avtGhostZones": ~0}
#: Of a point, and of a cell.
HIDDEN_POINT, HIDDEN_CELL = 2, 32


def ghost_cells(path: str, name: str, marks: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """(c,) True for the cells that the array `name` marks."""
    _check(path, name, marks)
    return np.asarray((marks & marks.dtype.type(OF_CELLS[name] & np.iinfo(marks.dtype).max)) != 0)


def hidden_points(path: str, marks: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """(n,) True for the points that `vtkGhostType` hides. Duplicate points are as good as any."""
    _check(path, GHOST_TYPE, marks)
    return np.asarray((marks & marks.dtype.type(HIDDEN_POINT)) != 0)


def cells_at(
    hidden: npt.NDArray[np.bool_], starts: npt.NDArray[np.int64], connectivity: npt.NDArray[Any]
) -> npt.NDArray[np.bool_]:
    """(c,) True for the cells that name a hidden point. Numbers of no point count as not hidden."""
    corners = connectivity[: starts[-1]]
    inside = (corners >= 0) & (corners < len(hidden))
    at = np.zeros(len(corners) + 1, np.int64)
    np.cumsum(inside & hidden[np.where(inside, corners, 0).astype(np.intp)], out=at[1:])
    return np.asarray(at[starts[1:]] > at[starts[:-1]])


def _check(path: str, name: str, marks: npt.NDArray[Any]) -> None:
    if marks.dtype.kind not in "iu":
        raise InputError(f"{path}: array {name!r} holds {marks.dtype.name} numbers, not bits; write it again")
