"""The bound on a surface's error, as it was asked for, in the terms of the kernels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from isocore.cell_mesh import CellMesh
from isocore.choices import MILLIMETRES, MaxError, Unbounded, Voxels
from isocore.errors import OptionError
from isocore.volume import Volume

DEFAULT_MAX_ERROR = Voxels(0.5, "0.5")


@dataclass(frozen=True, slots=True)
class Bound:
    """How far the reference's vertices may lie from the surface; simplification bounds also the way back.

    distance: at most this; in voxels, or with `in_world` in the volume's unit once each index axis is stretched by
        its spacing. Of a mesh in its own unit. Infinite without a bound.
    text: as the user would write it.
    """

    distance: float
    in_world: bool
    text: str


def bound_for(volume: Volume, asked: MaxError) -> Bound:
    """The bound on the surface's error in index space. Raises OptionError where the volume lacks the bound's unit.

    Voxels are counted along the index axes, whatever their spacing. World units are measured in the world: each axis
    is stretched by its spacing, and where the axes are not at right angles the bound shrinks so that it still holds.
    """
    if isinstance(asked, Unbounded):
        return Bound(math.inf, False, asked.text)
    if isinstance(asked, Voxels):
        return Bound(asked.distance, False, asked.text)
    if not volume.unit:
        raise OptionError(
            f"--max-error {asked}: the volume does not say its unit; give the error in voxels, or the volume a spacing"
        )
    if volume.unit not in MILLIMETRES:
        raise OptionError(f"--max-error {asked}: the volume is in {volume.unit}; give the error in voxels")
    directions = np.asarray(volume.affine)[:3, :3] / np.asarray(volume.spacing)
    stretch = max(1.0, float(np.linalg.norm(directions, 2)) * (1 - 1e-12))
    distance = asked.distance * MILLIMETRES[asked.unit] / MILLIMETRES[volume.unit]
    return Bound(distance / stretch, True, asked.text)


def mesh_bound(mesh: CellMesh, asked: MaxError) -> Bound:
    """The bound in a mesh's own unit, which a bare number is in. Raises OptionError where the mesh lacks the unit."""
    if isinstance(asked, Unbounded):
        return Bound(math.inf, True, asked.text)
    if isinstance(asked, Voxels):
        return Bound(asked.distance, True, asked.text)
    if mesh.unit not in MILLIMETRES:
        raise OptionError(f"--max-error {asked}: the mesh does not say its unit; give the error as a number alone")
    return Bound(asked.distance * MILLIMETRES[asked.unit] / MILLIMETRES[mesh.unit], True, asked.text)
