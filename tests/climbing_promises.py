"""Whether a climbed surface keeps its promises, told against marching cubes on the same volume."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.measurements import measure
from isocore.surface import Surface
from isocore.volume import Volume


def compare(
    volume: Volume,
    isovalue: float,
    *,
    block_size: int = 16,
    capped: bool = False,
    max_error: float = math.inf,
    threads: int = 2,
) -> list[str]:
    """What is broken, in words; nothing if all is well. Checks topology, vertices, threads, counts and the bound.

    Whether loops are cut by area or by the samples' gradient.
    """
    asked = (volume.stored_isovalue(isovalue), volume.inside_is_below, capped)
    marched = _kernels.marching_cubes(volume.samples, *asked)
    broken = []
    for tilted in (False, True):
        climbed = _kernels.climb(volume.samples, *asked, 1, block_size, max_error, tilted=tilted)
        broken += _broken(climbed, marched, max_error)
        if threads > 1:
            again = _kernels.climb(volume.samples, *asked, threads, block_size, max_error, tilted=tilted)
            if any(again[n].tobytes() != climbed[n].tobytes() for n in (0, 1)):
                broken.append(f"{threads} threads give other bytes")
    return broken


def _broken(climbed: Any, marched: Any, max_error: float) -> list[str]:
    vertices, triangles, facts = climbed
    reference_vertices, reference_triangles, faces, cells = marched[:4]
    broken = []
    ours, theirs = (
        measure(Surface(*mesh)) for mesh in ((vertices, triangles), (reference_vertices, reference_triangles))
    )
    for name in ("euler", "components"):
        if getattr(ours, name) != getattr(theirs, name):
            broken.append(f"{name} is {getattr(ours, name)}, not {getattr(theirs, name)}")
    for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges", "degenerate"):
        if getattr(ours, name):
            broken.append(f"{getattr(ours, name)} {name}")
    if (ours.boundary_edges == 0) != (theirs.boundary_edges == 0):
        broken.append("open where marching cubes is closed, or the other way round")
    if len(vertices) and not np.isin(_whole(vertices), _whole(reference_vertices)).all():
        broken.append("a vertex is not marching cubes'")
    if len(np.unique(triangles)) != len(vertices):
        broken.append("a vertex is not used")
    if (facts.ambiguous_faces, facts.ambiguous_cells) != (faces, cells):
        broken.append("another number of ambiguous faces or cells")
    if len(triangles) > len(reference_triangles):
        broken.append("more triangles than marching cubes")
    if facts.error_voxels.max > max_error:
        broken.append(f"an error of {facts.error_voxels.max}")
    return broken


def _whole(vertices: npt.NDArray[Any]) -> npt.NDArray[np.void]:
    rows = np.ascontiguousarray(vertices)
    return rows.view(np.dtype((np.void, rows.dtype.itemsize * 3))).ravel()
