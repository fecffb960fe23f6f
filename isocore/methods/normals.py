"""Vertex normals from a field's gradient, and how far triangles are turned from it: the climbing paper's criterion.

Poston, Wong, Heng, Computer Graphics Forum 17(3), 1998, section 4, rejects triangles by that angle; we report it.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.extraction import Angles
from isocore.job import Options
from isocore.volume import Volume

Mesh = tuple[npt.NDArray[Any], npt.NDArray[np.int32]]

_SAME_PLACE = np.eye(4)[:3]


class Normals(NamedTuple):
    """What was asked for of both, else None, and the seconds that each took.

    vertices: (v, 3) float32, in the frame of the mesh.
    """

    vertices: npt.NDArray[np.float32] | None
    degrees: Angles | None
    seconds: float
    seconds_degrees: float


def volume_normals(volume: Volume, mesh: Mesh, options: Options, *, measured: bool) -> Normals:
    """Of a mesh in index space, from the samples. measured: whether the angles are asked for; those of the world."""
    if not options.normals and not measured:
        return Normals(None, None, 0.0, 0.0)
    start = perf_counter()
    below = volume.inside_is_below
    found = _kernels.gradient_normals(volume.samples, *mesh, below, options.threads, complete=False)
    return _normals(mesh, found, np.ascontiguousarray(volume.affine[:3]), options, measured, start)


def mesh_normals(
    field: CellMesh, isovalue: float, edges: npt.NDArray[np.int32], mesh: Mesh, options: Options, *, measured: bool
) -> Normals:
    """Of a mesh's surface, from the gradients of the cells around its vertices. edges: those that they lie on."""
    if not options.normals and not measured:
        return Normals(None, None, 0.0, 0.0)
    start = perf_counter()
    cells = (field.points, field.tets, field.hexes, field.values)
    found = _kernels.mesh_normals(*cells, isovalue, edges, *mesh, options.threads, complete=False)
    return _normals(mesh, found, _SAME_PLACE, options, measured, start)


def angles(
    mesh: Mesh, normals: npt.NDArray[np.float32], affine: npt.NDArray[np.float64], threads: int
) -> Angles | None:
    """Between triangles and the normals at their corners, once both go through `affine` (3, 4); None without any.

    normals: (v, 3) float32; corners where they are NaN are left out.
    """
    mean, p95, largest, count = _kernels.tilt(*mesh, normals, affine, threads)
    return Angles(mean=mean, p95=p95, max=largest) if count else None


def _normals(
    mesh: Mesh,
    found: npt.NDArray[np.float32],
    affine: npt.NDArray[np.float64],
    options: Options,
    measured: bool,
    start: float,
) -> Normals:
    """found: NaN where the field says nothing. The angles are those to the field alone."""
    gathered = perf_counter()
    degrees = angles(mesh, found, affine, options.threads) if measured else None
    seconds_degrees = perf_counter() - gathered
    if not options.normals:
        return Normals(None, degrees, 0.0, perf_counter() - start)
    _kernels.complete_normals(*mesh, found)
    return Normals(found, degrees, perf_counter() - start - seconds_degrees, seconds_degrees)
