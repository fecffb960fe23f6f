"""Simplification: the stage between a method's mesh and its surface, for volumes and meshes alike.

Edges are contracted within a bound on the error, both ways; kernels/simplification/README.md has the papers and rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.choices import Unbounded
from isocore.errors import OptionError
from isocore.extraction import Deviation, Simplification
from isocore.job import Options
from isocore.methods.bounds import DEFAULT_MAX_ERROR, Bound, bound_for, mesh_bound
from isocore.placing import Placing
from isocore.volume import Volume

Mesh = tuple[npt.NDArray[Any], npt.NDArray[np.int32]]
Axes = tuple[float, float, float]

_ONES: Axes = (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class Simplified:
    """A mesh with fewer triangles. kept: of each vertex, its number before; the rest is for the report."""

    vertices: npt.NDArray[Any]
    triangles: npt.NDArray[np.int32]
    kept: npt.NDArray[np.int32]
    error: Deviation
    facts: Simplification
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Simplifier:
    """What is asked of simplification, ready for one mesh after the other.

    bound: in voxels or the volume's unit, or for a mesh in its unit.
    most_triangles: at most so many, 0 where no number was asked for; given: whether a bound was, which then wins.
    spacing: of a volume's voxels; None for a mesh.
    """

    bound: Bound
    given: bool
    most_triangles: int
    spacing: Axes | None
    unit: str
    threads: int

    def __call__(
        self,
        mesh: Mesh,
        reference: Callable[[], Mesh] | None = None,
        placing: Placing | None = None,
    ) -> Simplified:
        """A kernel's mesh with fewer triangles.

        reference: makes the surface that it stands for, if not that itself.
        placing: where its vertices are written, if not where they are. Rounded there, two triangles may meet that were
        apart before; that is rare, so it is looked at, and then simplified again with an eye on it.
        """
        known = mesh if reference is None else reference()
        start = perf_counter()
        if not self.is_bounded and 2 * self.most_triangles > len(mesh[1]):
            mesh = known  # a coarse mesh has an error of its own, which so many triangles need not have
        found, error = self._run(mesh, known)
        if found.unproved and mesh is not known and self.is_bounded:
            mesh = known  # a coarse triangle is too far from the reference, so start from that
            found, error = self._run(mesh, known)
        if placing is not None and self._meets_itself(found, placing):
            found, error = self._run(mesh, known, placing)
        facts = facts_of(len(mesh[1]), found.collapses, found.refused, perf_counter() - start)
        missed = self.missed(len(found.triangles))
        return Simplified(found.vertices, found.triangles, found.kept, error, facts, missed)

    @property
    def is_bounded(self) -> bool:
        """Does a bound hold, whatever number of triangles is asked for?"""
        return math.isfinite(self.bound.distance) and (self.given or not self.most_triangles)

    def _meets_itself(self, found: _kernels.SimplifiedMesh, placing: Placing) -> bool:
        return _kernels.self_intersections(placing(found.vertices, self.threads), found.triangles, self.threads) > 0

    def _run(
        self, mesh: Mesh, reference: Mesh, placing: Placing | None = None
    ) -> tuple[_kernels.SimplifiedMesh, Deviation]:
        if self.spacing is None:
            bound = self.bound.distance if self.is_bounded else math.inf
            cell = _cell(*reference)
            stretch = (1 / cell,) * 3
            found = self._simplify(mesh, reference, bound / cell, stretch, stretch, cell)
            back = found.back_max * cell
            return found, self._deviation(None, _times(found.error, cell), None, back, found.unproved)
        found = self._simplify(mesh, reference, *self.scales(), placing=placing)
        return found, self.volume_deviation(found.error, found.error_other, found.back_max, found.unproved)

    def scales(self) -> tuple[float, Axes, Axes]:
        """Of a volume: the bound, the stretch of index space in which it holds, and the other that is measured in."""
        assert self.spacing is not None
        bound = self.bound.distance if self.is_bounded else math.inf
        longest = max(self.spacing)
        world = (self.spacing[0] / longest, self.spacing[1] / longest, self.spacing[2] / longest)
        return (bound / longest, world, _ONES) if self.bound.in_world else (bound, _ONES, world)

    def volume_deviation(self, error: Axes, other: Axes, back: float, unproved: int) -> Deviation:
        """What a kernel measured of a volume's mesh in these scales, for the report."""
        assert self.spacing is not None
        longest, shortest = max(self.spacing), min(self.spacing)
        if self.bound.in_world:
            back *= longest
            return self._deviation(other, _times(error, longest), back / shortest, back, unproved)
        return self._deviation(error, _times(other, longest), back, back * longest, unproved)

    def _simplify(
        self,
        mesh: Mesh,
        reference: Mesh,
        bound: float,
        stretch: Axes,
        other: Axes,
        cell: float = 1.0,
        placing: Placing | None = None,
    ) -> _kernels.SimplifiedMesh:
        writing = placing.for_kernels() if placing else None
        return _kernels.simplify(
            *mesh, *reference, bound, stretch, other, cell, self.most_triangles, writing, self.threads
        )

    def _deviation(
        self, voxels: Axes | None, world: Axes, back: float | None, back_world: float, unproved: int
    ) -> Deviation:
        """back: no point of the surface lies further away; not said where that is not proved."""
        own = voxels or (None, None, None)
        return Deviation(
            max=own[0],
            mean=own[1],
            rms=own[2],
            max_world=world[0],
            mean_world=world[1],
            rms_world=world[2],
            unit=self.unit,
            bound=self.bound.text if self.is_bounded else "none",
            back_max=None if unproved else back,
            back_max_world=None if unproved else back_world,
        )

    def missed(self, count: int) -> tuple[str, ...]:
        """Where more triangles are left than were asked for: why."""
        if not self.most_triangles or count <= self.most_triangles:
            return ()
        asked = f"--triangles {self.most_triangles:,}: {count:,} are left"
        if self.is_bounded:
            return (f"{asked}, since fewer would break --max-error {self.bound.text}; allow a larger error",)
        return (f"{asked}, since fewer would change the surface's topology or shape",)


def facts_of(before: int, collapses: int, refused: Sequence[int], seconds: float) -> Simplification:
    """What a kernel counted, for the report. before: triangles; refused: edges by rule, in the kernel's order."""
    link, shape, outward, back, crossing = refused
    return Simplification(
        triangles_before=before,
        collapses=collapses,
        refused_link=link,
        refused_shape=shape,
        refused_outward=outward,
        refused_back=back,
        refused_crossing=crossing,
        seconds=seconds,
    )


def volume_simplifier(volume: Volume, options: Options, *, default: bool = False) -> Simplifier | None:
    """What is asked for a volume; None where nothing is. default: whether it is done unless it is refused."""
    given = options.max_error is not None
    bound = bound_for(volume, options.max_error or DEFAULT_MAX_ERROR)
    if not _wanted(options, default and math.isfinite(bound.distance)):
        return None
    spacing = (float(volume.spacing[0]), float(volume.spacing[1]), float(volume.spacing[2]))
    return Simplifier(bound, given, options.triangles or 0, spacing, volume.unit, options.threads)


def mesh_simplifier(mesh: CellMesh, options: Options) -> Simplifier | None:
    """What is asked for a mesh; None where nothing is. A mesh has no bound of its own, as cells differ in size."""
    if not _wanted(options, False):
        return None
    if options.max_error is None and not options.triangles:
        raise OptionError("--simplify: needs --max-error, in the mesh's unit, or --triangles")
    bound = mesh_bound(mesh, options.max_error or Unbounded())
    return Simplifier(bound, options.max_error is not None, options.triangles or 0, None, mesh.unit, options.threads)


def _wanted(options: Options, default: bool) -> bool:
    if options.triangles is not None and options.triangles < 1:
        raise OptionError(f"--triangles {options.triangles}: must be 1 or more")
    if options.simplify is False and options.triangles:
        raise OptionError(f"--triangles {options.triangles}: does not go with --no-simplify; leave one out")
    if options.simplify and not options.triangles and isinstance(options.max_error, Unbounded):
        raise OptionError("--simplify: needs a bound or --triangles; --max-error none is neither")
    if options.triangles or options.simplify is not None:
        return bool(options.triangles or options.simplify)
    return default


def _times(numbers: Axes, factor: float) -> Axes:
    return numbers[0] * factor, numbers[1] * factor, numbers[2] * factor


def _cell(vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32]) -> float:
    """How long the sides of some triangles are, on average: a cell of the grid that they are found by."""
    some = vertices[triangles[:: max(1, len(triangles) // 10_000)]].astype(np.float64)
    sides = np.linalg.norm(some - np.roll(some, 1, axis=1), axis=2)
    length = float(sides.mean()) if sides.size else 0.0
    return length if length > 0 else 1.0
