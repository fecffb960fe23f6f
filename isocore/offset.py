"""The point that vertices are written about, for coordinates too far from the origin for float32 or nine digits.

All outputs of one input share it, so that they fit each other; the report and the files name it. A volume is moved
before it is contoured, which costs nothing and loses no digit; a mesh's index knows its points, so of a mesh the
surface is moved.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.choices import About
from isocore.extraction import Field
from isocore.late import late
from isocore.placing import coordinate_type
from isocore.surface import Point, Surface
from isocore.volume import Volume

#: Whether float32 will do for a mesh: its methods are not imported where a volume is read.
_single_precision: Callable[..., bool] = late("methods.marching_cells", "single_precision")


def offset_of(field: Field, asked: About | None) -> Point | None:
    """The point asked for. `auto` is the origin while float32 is fine there, else a round point amid the field."""
    if asked is None:
        return None
    if asked.point is not None:
        return asked.point
    if isinstance(field, CellMesh):
        low, high = np.array(_kernels.bounds(field.points)).reshape(2, 3)
        is_fine = _single_precision(field)
    else:
        corners = np.array([np.zeros(3), np.array(field.shape) - 1.0])
        low, high = _world_box(field, corners)
        is_fine = coordinate_type(corners.astype(np.float32), field.affine[:3]) is np.float32
    return (0.0, 0.0, 0.0) if is_fine else _round_point(low, high)


def moved_field(field: Field, offset: Point | None) -> Field:
    """A volume whose world is measured from `offset`; a mesh stays as it is."""
    if offset is None or not isinstance(field, Volume):
        return field
    affine = np.array(field.affine)
    affine[:3, 3] -= offset
    return replace(field, affine=affine)


def moved_surface(surface: Surface, field: Field, offset: Point | None) -> Surface:
    """The surface of that field, measured from `offset`: float32 where its steps are fine there."""
    if offset is None or not any(offset):
        return surface
    if isinstance(field, CellMesh):
        vertices = surface.vertices - np.array(offset)
        single = _single_precision(field, offset)
        surface = replace(surface, vertices=vertices.astype(np.float32) if single else vertices)
    return replace(surface, offset=offset)


def _world_box(volume: Volume, corners: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Lowest and highest corner (2, 3) of the box in the world around a box (2, 3) in index space."""
    linear, origin = volume.affine[:3, :3], volume.affine[:3, 3]
    ends = linear[None] * corners[:, None, :]
    return np.stack([ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)]) + origin


def _round_point(low: npt.NDArray[Any], high: npt.NDArray[Any]) -> Point:
    """The middle of the box, in steps of the power of ten that its longest side holds."""
    longest = float((high - low).max())
    digits = -math.floor(math.log10(longest)) if longest > 0 and math.isfinite(longest) else 0
    x, y, z = (round(number, digits) + 0.0 for number in ((low + high) / 2).tolist())
    return x, y, z
