"""A mesh of cells with one value per point: the other kind of field."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore.carried import CarriedField, CellSources
from isocore.errors import FieldError, printable


@dataclass(frozen=True, slots=True, kw_only=True)
class Connectivity:
    """How the cells of a mesh came to hang together.

    ghost_cells: left out, because the file marks them. repeated_cells: left out, because an earlier piece has them too.
    joined_points: points that coincide with another and were
    joined with it. averaged_points: those that were left where the values of the joined points differ by more than
    rounding, so that their mean was taken; largest_difference: by how much. divided_cells: curved ones, which were
    divided into straight ones.
    """

    ghost_cells: int = 0
    repeated_cells: int = 0
    joined_points: int = 0
    averaged_points: int = 0
    largest_difference: float = 0.0
    divided_cells: int = 0


class CurvedCells(NamedTuple):
    """Cells that were divided into straight ones, and how value and place run between their nodes.

    nodes: (m, L) int32, points of the mesh. pairs: (e, 2) two of a cell's nodes that an edge of a straight cell joins.
    weights: (e, L) float64, of the values (or the places) of all nodes of a cell for that half way between a pair.
    """

    nodes: npt.NDArray[np.int32]
    pairs: npt.NDArray[np.intp]
    weights: npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class CellMesh:
    """Tetrahedra and hexahedra with one value per point.

    points: (n, 3) float64, world.
    tets: (m, 4) int32, corners positively oriented or not: kernels orient them by volume.
    hexes: (h, 8) int32, VTK order: 0-3 around the bottom, 4-7 above them.
    values: (n,) float32 or float64; a non-finite value is outside.
    unit: of the points, "" where the file does not say.
    field_name: the point field the values came from.
    cell_counts: cells of the file by type, before wedges and pyramids were split.
    warnings: what the reader wants its user to know.
    connectivity: what was left out and joined.
    curved: cells that were divided; a surface's vertices follow them between their nodes.
    ignored: how many values are NaN because they were named as such.
    carried: further fields of the points, or of the cells of `sources`, which surfaces get the values of.
    sources: the cells as the file has them, where a field of cells is carried.
    """

    points: npt.NDArray[np.float64]
    tets: npt.NDArray[np.int32]
    hexes: npt.NDArray[np.int32]
    values: npt.NDArray[Any]
    unit: str = ""
    field_name: str = ""
    cell_counts: dict[str, int] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    connectivity: Connectivity = Connectivity()
    curved: tuple[CurvedCells, ...] = ()
    ignored: int = 0
    carried: tuple[CarriedField, ...] = ()
    sources: tuple[CellSources, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.points)
        if self.points.shape != (n, 3) or self.points.dtype != np.float64:
            raise FieldError("points must be (n, 3) float64")
        if self.values.shape != (n,) or self.values.dtype.name not in ("float32", "float64"):
            raise FieldError(f"values must be {n} float32 or float64, one per point")
        for name, cells, corners in (("tets", self.tets, 4), ("hexes", self.hexes, 8)):
            if cells.ndim != 2 or cells.shape[1] != corners or cells.dtype != np.int32:
                raise FieldError(f"{name} must be (m, {corners}) int32")
            if cells.size and (cells.min() < 0 or cells.max() >= n):
                raise FieldError(f"{name} name a point outside 0..{n - 1}")
        if not len(self.tets) and not len(self.hexes):
            raise FieldError("a mesh needs at least one tetrahedron or hexahedron")
        self._check_carried()
        for array in (self.points, self.tets, self.hexes, self.values):
            array.flags.writeable = False
        object.__setattr__(self, "warnings", tuple(map(printable, self.warnings)))

    def _check_carried(self) -> None:
        last = -1
        for source in self.sources:
            if source.nodes.size and (source.nodes.min() < 0 or source.nodes.max() >= len(self.points)):
                raise FieldError(f"sources name a point outside 0..{len(self.points) - 1}")
            last = max(last, int(source.numbers.max(initial=-1)))
        for one in self.carried:
            rows = len(one.values) if one.of == "cells" and len(one.values) > last else -1
            one.check({"points": len(self.points), "cells": rows})

    def __repr__(self) -> str:
        """How large it is, and what its values are."""
        cells = ", ".join(f"{len(c):,} {name}" for name, c in (("tets", self.tets), ("hexes", self.hexes)) if len(c))
        values = f"{self.field_name} {self.values.dtype}".strip()
        return f"CellMesh({len(self.points):,} points, {cells}, {values}{f', {self.unit}' if self.unit else ''})"

    @property
    def cells(self) -> int:
        """Cells that are contoured: tetrahedra and hexahedra."""
        return len(self.tets) + len(self.hexes)
