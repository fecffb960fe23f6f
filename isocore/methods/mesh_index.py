"""The index of a mesh: what thinning a field once leaves behind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, slots=True, eq=False)
class IndexPart:
    """The index of all cells of one kind; kernels/thinning/mesh/records.hpp says what a record holds.

    records: (m, 8) int32 for tetrahedra, (m, 14) for hexahedra.
    skeleton: (s,) int32, cells; low, high: (s,) float64, low ascending: the isovalues a skeleton cell holds.
    extrema: vertices that are a local minimum or maximum.
    classes: skeleton cells by the number of their face neighbours among the skeleton, from 0 to 6.
    crowded_faces, crowded_cells: faces that more than two cells share, and three of the cells at the first.
    collapsed_cells, collapsed_cell: cells that name a point twice, and the first of them, or -1.
    """

    records: npt.NDArray[np.int32]
    skeleton: npt.NDArray[np.int32]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]
    extrema: int
    classes: tuple[int, ...]
    crowded_faces: int
    crowded_cells: tuple[int, int, int]
    collapsed_cells: int
    collapsed_cell: int


@dataclass(frozen=True, slots=True, eq=False)
class MeshIndex:
    """What thinning knows of one field on one mesh.

    original: (p,) int32, the mesh's id of every point as the records number them.
    """

    tets: IndexPart
    hexes: IndexPart
    original: npt.NDArray[np.int32]

    @property
    def parts(self) -> tuple[IndexPart, IndexPart]:
        return self.tets, self.hexes

    @property
    def extrema(self) -> int:
        return sum(part.extrema for part in self.parts)

    @property
    def skeleton_cells(self) -> int:
        return sum(len(part.skeleton) for part in self.parts)

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        arrays = [a for part in self.parts for a in (part.records, part.skeleton, part.low, part.high)]
        return sum(array.nbytes for array in (*arrays, self.original))
