"""The thinning paper's tables for a voxel volume, whose cells are cubes: here the octree has its place."""

from __future__ import annotations

from itertools import product
from time import perf_counter

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.benches.rivals import RIVALS, Cells
from isocore.benches.thinning import Table
from isocore.errors import FieldError
from isocore.histogram import histogram
from isocore.volume import Volume

_COLUMNS = ("method", "registered", "visited", "intersected", "visited / intersected", "build s", "search s")
_LEAVING = ("visited / intersected", "registered", "build s")


def grid_bench(volume: Volume, *, isovalues: int = 20, threads: int = 1) -> list[Table]:
    """What every method registers, visits and takes over evenly spaced isovalues.

    The rivals search and do not draw; the walk draws as it goes, so its seconds count both.
    """
    heights = _heights(volume)
    spread = histogram(volume, threads=threads)
    if not spread.low < spread.high:
        raise FieldError("a constant volume has no isosurfaces to time")
    ends = (-spread.high, -spread.low) if volume.inside_is_below else (spread.low, spread.high)
    asked = np.linspace(*ends, isovalues + 2)[1:-1].tolist()
    cells = _cells(heights)
    rows = []
    for rival in RIVALS:
        start = perf_counter()
        search = rival.build(cells)
        built = perf_counter()
        answers = [search.candidates(height) for height in asked]
        visited, found = sum(seen for _, seen in answers), sum(len(ids) for ids, _ in answers)
        seconds = (built - start, perf_counter() - built)
        rows.append(_row(rival.name, search.registered, visited, found, seconds))
    start = perf_counter()
    index = _kernels.GridIndex(volume.samples, volume.inside_is_below)
    built = perf_counter()
    sign = -1 if volume.inside_is_below else 1
    visited = sum(index.propagate(sign * height, threads).visited for height in asked)
    seconds = (built - start, perf_counter() - built)
    rows.append(_row("volume thinning, drawn", index.skeleton_cells, visited, visited, seconds))
    return [Table(f"{len(cells.low):,} cells, {isovalues} isovalues", _COLUMNS, tuple(rows), _LEAVING)]


def _row(
    name: str, registered: int, visited: int, found: int, seconds: tuple[float, float]
) -> tuple[str | int | float, ...]:
    return name, registered, visited, found, round(visited / max(found, 1), 3), *(round(s, 4) for s in seconds)


def _heights(volume: Volume) -> npt.NDArray[np.float64]:
    """(nx, ny, nz), growing towards the inside; what is not finite lies below all isovalues."""
    heights = volume.samples.astype(np.float64)
    if volume.inside_is_below:
        np.negative(heights, out=heights)
    heights[~np.isfinite(heights)] = -np.inf
    return heights


def _cells(heights: npt.NDArray[np.float64]) -> Cells:
    """The ranges of the cubes between eight samples."""
    nx, ny, nz = (size - 1 for size in heights.shape)
    low, high = (np.full((nx, ny, nz), end, order="F") for end in (np.inf, -np.inf))
    for i, j, k in product((0, 1), repeat=3):
        corner = heights[i : nx + i, j : ny + j, k : nz + k]
        np.minimum(low, corner, out=low)
        np.maximum(high, corner, out=high)
    return Cells(low.ravel(order="F"), high.ravel(order="F"), (nx, ny, nz))
