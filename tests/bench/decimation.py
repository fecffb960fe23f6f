"""Climbing against marching cubes followed by decimation to as many triangles: time, error both ways, topology.

    python tests/bench/decimation.py VOLUME ISOVALUE     (needs fast-simplification, meshoptimizer, scipy)

Distances are measured in voxels, from points sampled on one surface to the nearest of many sampled on the other.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from statistics import median
from time import perf_counter
from typing import Any

import fast_simplification
import meshoptimizer
import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

import isocore
from isocore import _kernels
from isocore.measurements import measure
from isocore.surface import Surface
from isocore.volume import Volume

Mesh = tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]


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


def sampled(mesh: Mesh, count: int = 1_500_000) -> npt.NDArray[np.float64]:
    """Points spread evenly over the area of a mesh."""
    corners = mesh[0][mesh[1]].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(corners), count, p=area / area.sum())
    return np.einsum("tc,tcd->td", rng.dirichlet((1, 1, 1), count), corners[chosen])


def timed(work: Callable[[], Mesh], repeats: int = 3) -> tuple[float, Mesh]:
    """Median seconds and the mesh."""
    mesh = work()
    seconds = []
    for _ in range(repeats):
        start = perf_counter()
        mesh = work()
        seconds.append(perf_counter() - start)
    return median(seconds), mesh


def main() -> None:
    """Print one Markdown table."""
    field = isocore.read(sys.argv[1])
    assert isinstance(field, Volume)
    stored, below = field.stored_isovalue(float(sys.argv[2])), field.inside_is_below

    def march() -> Mesh:
        return _kernels.marching_cubes(field.samples, stored, below)[:2]

    def climb(error: float) -> Mesh:
        return _kernels.climb(field.samples, stored, below, False, 1, 16, error)[:2]

    def decimate(simplify: Callable[[Mesh, int], Mesh], target: int) -> Mesh:
        return simplify(march(), target)

    mc_seconds, reference = timed(march)
    near_reference = cKDTree(np.concatenate([sampled(reference), reference[0]]))
    rows = [("marching cubes", mc_seconds, reference)]
    for error in (float("inf"), 0.5):
        seconds, ours = timed(partial(climb, error))
        rows.append((f"asc, max error {error:g}", seconds, ours))
        for name, simplify in (("fast-simplification", by_fast_simplification), ("meshoptimizer", by_meshoptimizer)):
            target = len(ours[1])
            seconds, other = timed(partial(decimate, simplify, target), 1)
            rows.append((f"mc + {name}", seconds, other))
    print("| method | triangles | seconds | mc to it, max | mean | it to mc, max | components | Euler | non-manifold |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for name, seconds, mesh in rows:
        there = cKDTree(np.concatenate([sampled(mesh), mesh[0]])).query(reference[0], workers=2)[0]
        back = near_reference.query(mesh[0], workers=2)[0]
        m = measure(Surface(*mesh))
        print(
            f"| {name} | {len(mesh[1]):,} | {seconds:.3f} | {there.max():.2f} | {there.mean():.3f} | {back.max():.2f} "
            f"| {m.components:,} | {m.euler:,} | {m.nonmanifold_edges:,} |"
        )


if __name__ == "__main__":
    main()
