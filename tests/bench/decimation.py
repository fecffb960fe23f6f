"""Ours against marching cubes followed by decimation to as many triangles: time, both errors, topology, crossings.

    python tests/bench/decimation.py VOLUME ISOVALUE   (needs fast-simplification, meshlib, meshoptimizer)

Prints a Markdown table. Distances are in voxels: of each vertex of marching cubes to the surface, exactly, and of some
points of the surface to that of marching cubes. Seconds are those of the processor, so that other work on the machine
matters little; everyone has one thread but meshlib, which takes what it wants.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from statistics import median
from time import process_time
from typing import Any

import fast_simplification
import meshoptimizer
import numpy as np
import numpy.typing as npt
from meshlib import mrmeshnumpy, mrmeshpy

import isocore
from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.measurements import measure
from isocore.surface import Surface
from isocore.volume import Volume

Mesh = tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]
_POINTS = 300_000  # of a surface, whose distances to marching cubes' are measured
_HEADINGS = (
    "method", "triangles", "seconds", "mc to it, max", "mean", "it to mc, max", "components", "Euler",
    "non-manifold edges", "self-intersections", "degrees",
)  # fmt: skip


def used_only(vertices: Any, triangles: Any) -> Mesh:
    """The mesh without vertices that no triangle uses."""
    used, again = np.unique(np.asarray(triangles).ravel(), return_inverse=True)
    return np.ascontiguousarray(vertices[used], np.float32), np.ascontiguousarray(again.reshape(-1, 3), np.int32)


def by_fast_simplification(mesh: Mesh, target: int) -> Mesh:
    """Quadric decimation."""
    return used_only(*fast_simplification.simplify(*mesh, target_count=target))


def by_meshoptimizer(mesh: Mesh, target: int) -> Mesh:
    """Edge collapse of the rendering library."""
    vertices, triangles = mesh
    out = np.zeros(triangles.size, np.uint32)
    count = meshoptimizer.simplify(
        out, triangles.astype(np.uint32).ravel(), vertices, target_index_count=3 * target, target_error=1e9
    )
    return used_only(vertices, out[:count].reshape(-1, 3))


def by_meshlib(mesh: Mesh, target: int) -> Mesh:
    """To as many triangles, or, where the target is 0, as far as a deviation of half a voxel allows by its measure."""
    body = mrmeshnumpy.meshFromFacesVerts(mesh[1], mesh[0])
    settings = mrmeshpy.DecimateSettings()
    settings.maxError = 1e9 if target else 0.5
    if target:
        settings.maxDeletedFaces = len(mesh[1]) - target
    settings.packMesh = True
    mrmeshpy.decimateMesh(body, settings)
    return used_only(mrmeshnumpy.getNumpyVerts(body), mrmeshnumpy.getNumpyFaces(body.topology))


def points_of(mesh: Mesh) -> npt.NDArray[np.float64]:
    """Points spread evenly over the area of a mesh, and its vertices."""
    corners = mesh[0][mesh[1]].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(corners), _POINTS, p=area / area.sum())
    inside = np.einsum("tc,tcd->td", rng.dirichlet((1, 1, 1), _POINTS), corners[chosen])
    return np.ascontiguousarray(np.concatenate([inside, mesh[0].astype(np.float64)]))


def timed(work: Callable[[], Mesh], repeats: int = 3) -> tuple[float, Mesh]:
    """Median seconds of the processor, and the mesh."""
    seconds = []
    for _ in range(repeats):
        start = process_time()
        mesh = work()
        seconds.append(process_time() - start)
    return median(seconds), mesh


def row(name: str, seconds: float, mesh: Mesh, reference: Mesh, volume: Volume) -> tuple[str, ...]:
    """The table's row of one mesh, in index space."""
    there = _kernels.distances_to(mesh[0].astype(np.float64), mesh[1], reference[0].astype(np.float64), 1)
    back = _kernels.distances_to(reference[0].astype(np.float64), reference[1], points_of(mesh), 1)
    found = measure(Surface(*mesh))
    normals = _kernels.gradient_normals(volume.samples, *mesh, volume.inside_is_below, complete=False)
    degrees = _kernels.tilt(*mesh, normals, np.eye(4)[:3].copy())[0]
    counts = (found.components, found.euler, found.nonmanifold_edges, found.self_intersections)
    errors = (f"{there[0]:.2f}", f"{there[1]:.3f}", f"{back[0]:.2f}")
    return name, f"{len(mesh[1]):,}", f"{seconds:.2f}", *errors, *(f"{n:,}" for n in counts), f"{degrees:.1f}"


def main() -> None:
    """Print one Markdown table."""
    volume = isocore.read(sys.argv[1])
    assert isinstance(volume, Volume)
    isovalue = float(sys.argv[2])
    volume = Volume(volume.samples, volume.slope, volume.intercept)  # in index space, where a voxel is 1 long
    stored, below = volume.stored_isovalue(isovalue), volume.inside_is_below

    def march() -> Mesh:
        return _kernels.marching_cubes(volume.samples, stored, below)[:2]

    def draw(simplify: bool) -> Mesh:
        surface = prepare(volume, "asc", Options(simplify=simplify, max_error="0.5"))(isovalue).surface
        return surface.vertices, surface.triangles

    seconds, reference = timed(march)
    rows = [row("marching cubes", seconds, reference, reference, volume)]
    seconds, coarse = timed(lambda: draw(False))
    rows.append(row("asc, --no-simplify", seconds, coarse, reference, volume))
    seconds, ours = timed(lambda: draw(True), 1)
    rows.append(row("asc", seconds, ours, reference, volume))
    peers: tuple[tuple[str, Callable[[Mesh, int], Mesh], int], ...] = (
        ("mc + fast-simplification", by_fast_simplification, len(ours[1])),
        ("mc + meshoptimizer", by_meshoptimizer, len(ours[1])),
        ("mc + meshlib", by_meshlib, len(ours[1])),
        ("mc + meshlib, maxError 0.5", by_meshlib, 0),
    )
    for name, decimate, target in peers:
        seconds, mesh = timed(lambda decimate=decimate, target=target: decimate(march(), target), 1)  # type: ignore[misc]
        rows.append(row(name, seconds, mesh, reference, volume))
    for cells in (_HEADINGS, ("---", *("---:",) * (len(_HEADINGS) - 1)), *rows):
        print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
