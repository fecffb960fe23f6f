"""The table of the climbing paper for the user's own volume: triangles, time and error by block size and error bound.

Poston, Wong, Heng, Computer Graphics Forum 17(3), 1998, section 5 compares block sizes with marching cubes; we add what
an error bound costs, the error as it was measured, and what simplification makes of it within the same bound: from
climbing's mesh and from marching cubes', since section 6 has the coarse mesh as the better start; and from a mesh whose
loops were cut by area and not by the gradient, which section 4 asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from statistics import median
from time import perf_counter
from typing import Literal, TypeAlias, TypeVar

from isocore import _kernels
from isocore.benches.thinning import Table
from isocore.choices import BLOCK_SIZES, parse_max_error
from isocore.digits import exact
from isocore.errors import FieldError
from isocore.job import Options
from isocore.methods.bounds import Bound, bound_for
from isocore.methods.climbing import DEFAULT_BLOCK_SIZE
from isocore.methods.normals import Mesh, volume_normals
from isocore.volume import Volume

#: Max, mean and rms, in voxels.
Deviation: TypeAlias = tuple[float, float, float]
Row: TypeAlias = tuple[str | int | float, ...]
Found = TypeVar("Found")

#: What simplification starts from: climbing's mesh with loops cut by the gradient or by area, or marching cubes' mesh.
Start = Literal["gradient", "area", "mc"]
_STARTS: tuple[Start, ...] = ("gradient", "area", "mc")
MAX_ERRORS = ("none", "1", "0.5", "0.25", "0.1")
_COLUMNS = (
    "block size",
    "max error",
    "triangles",
    "mc / asc",
    "seconds",
    "asc / mc",
    "error max",
    "error mean",
    "error rms",
    "degrees",
    "simplified",
    "simplified seconds",
    "simplified max",
    "simplified back",
    "simplified degrees",
    "cut by area",
    "cut by area seconds",
    "cut by area degrees",
    "mc simplified",
    "mc simplified seconds",
)
_LEAVING = (
    "cut by area seconds",
    "cut by area degrees",
    "cut by area",
    "mc simplified seconds",
    "mc simplified",
    "degrees",
    "simplified degrees",
    "error rms",
    "error mean",
    "simplified back",
    "simplified max",
    "simplified seconds",
    "asc / mc",
    "mc / asc",
    "seconds",
    "simplified",
)


@dataclass(frozen=True, slots=True)
class Simplified:
    """What simplification leaves within a bound; seconds: with those of the mesh that it starts from; both errors.

    degrees: the mean angle between a triangle and the gradients at its corners.
    """

    triangles: int
    seconds: float
    error_max: float
    back_max: float
    degrees: float


@dataclass(frozen=True, slots=True)
class Run:
    """One way to draw the surface. seconds: the median; error: max, mean and rms in voxels; degrees as above.

    simplified: within the same bound, from this mesh with its loops cut by the gradient, from this mesh, and from
    marching cubes'; None without a bound.
    """

    block_size: int
    max_error: str
    triangles: int
    seconds: float
    error: Deviation
    degrees: float
    simplified: Simplified | None = None
    area_simplified: Simplified | None = None
    mc_simplified: Simplified | None = None


@dataclass(frozen=True, slots=True)
class ClimbingBench:
    """All runs on one volume at one isovalue, beside marching cubes."""

    isovalue: float
    mc_triangles: int
    mc_seconds: float
    runs: tuple[Run, ...]

    def table(self) -> Table:
        """The runs, one a row."""
        cubes = f"marching cubes {self.mc_triangles:,} triangles, {self.mc_seconds:.4g} s"
        title = f"Isovalue {exact(self.isovalue)}: {cubes}"
        return Table(title, _COLUMNS, tuple(self._row(run) for run in self.runs), _LEAVING)

    def _row(self, run: Run) -> Row:
        fewer, slower = self.mc_triangles / max(run.triangles, 1), run.seconds / self.mc_seconds
        figures = (round(x, 4) for x in (run.seconds, slower, *run.error, run.degrees))
        own: Row = (run.block_size, run.max_error, run.triangles, round(fewer, 2), *figures)
        if run.simplified is None or run.area_simplified is None or run.mc_simplified is None:
            return (*own, *("-",) * 10)
        here, area, cubes = run.simplified, run.area_simplified, run.mc_simplified
        rest = (here.seconds, here.error_max, here.back_max, here.degrees)
        return (
            *own,
            *(here.triangles, *(round(x, 4) for x in rest)),
            *(area.triangles, round(area.seconds, 4), round(area.degrees, 4)),
            *(cubes.triangles, round(cubes.seconds, 4)),
        )


def volume_bench(
    volume: Volume,
    isovalue: float,
    *,
    block_sizes: Sequence[int] = BLOCK_SIZES,
    max_errors: Sequence[str] = MAX_ERRORS,
    threads: int = 1,
    repeats: int = 3,
) -> ClimbingBench:
    """Every block size without a bound, then every bound at the default block size.

    Raises FieldError where marching cubes draws nothing, OptionError for a bound that makes no sense.
    """
    stored, below = volume.stored_isovalue(isovalue), volume.inside_is_below

    def march() -> int:
        return len(_kernels.marching_cubes(volume.samples, stored, below, False, threads).triangles)

    def degrees(mesh: Mesh) -> float:
        found = volume_normals(volume, mesh, Options(threads=threads), measured=True).degrees
        return found.mean if found else math.nan

    def climb(size: int, bound: Bound) -> tuple[Mesh, Deviation]:
        climbed = _kernels.climb(
            volume.samples, stored, below, False, threads, size, bound.distance, bound.in_world, volume.spacing
        )
        return (climbed.vertices, climbed.triangles), climbed.facts.error_voxels

    def simplify(bound: Bound, start: Start) -> _kernels.SimplifiedMesh:
        marched = _kernels.marching_cubes(volume.samples, stored, below, False, threads)
        mesh = (marched.vertices, marched.triangles)
        given = (volume.samples, stored, below, False, threads, DEFAULT_BLOCK_SIZE, bound.distance)
        if start == "mc":
            return _kernels.simplify(*mesh, *mesh, bound.distance, threads=threads)
        coarse = _kernels.climb(*given, measured=False, tilted=start == "gradient")[:2]
        return _kernels.simplify(*coarse, *mesh, bound.distance, threads=threads)

    def simplified(bound: Bound, start: Start) -> Simplified:
        seconds, found = _median_of(partial(simplify, bound, start), repeats)
        turned = degrees((found.vertices, found.triangles))
        return Simplified(len(found.triangles), seconds, found.error[0], found.back_max, turned)

    mc_seconds, mc_triangles = _median_of(march, repeats)
    if mc_triangles == 0:
        raise FieldError(f"isovalue {exact(isovalue)} draws no surface; choose another with -i")
    plans = [(size, "none") for size in block_sizes]
    plans += [(DEFAULT_BLOCK_SIZE, text) for text in max_errors if text != "none"]
    runs = []
    for size, text in plans:
        bound = bound_for(volume, parse_max_error(text))
        seconds, (mesh, error) = _median_of(partial(climb, size, bound), repeats)
        fewer = [simplified(bound, start) for start in _STARTS] if text != "none" else []
        runs.append(Run(size, text, len(mesh[1]), seconds, error, degrees(mesh), *fewer))
    return ClimbingBench(isovalue, mc_triangles, mc_seconds, tuple(runs))


def _median_of(work: Callable[[], Found], repeats: int) -> tuple[float, Found]:
    """Median seconds after one warm-up, and what the work returned."""
    result = work()
    seconds = []
    for _ in range(repeats):
        start = perf_counter()
        result = work()
        seconds.append(perf_counter() - start)
    return median(seconds), result


def render_csv(table: Table) -> str:
    """Headings and rows, separated by commas."""
    return "".join(",".join(map(str, row)) + "\n" for row in (table.columns, *table.rows))


def render_markdown(table: Table) -> str:
    """The title in bold, then a table with numbers to the right."""
    lines = [f"**{table.title}**", "", "| " + " | ".join(table.columns) + " |"]
    lines.append("|" + "---:|" * len(table.columns))
    for row in table.rows:
        lines.append("| " + " | ".join(f"{x:,}" if isinstance(x, int) else str(x) for x in row) + " |")
    return "\n".join(lines) + "\n"
