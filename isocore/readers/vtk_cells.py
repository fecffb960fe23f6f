"""The cells of one piece of an unstructured grid of VTK, as arrays of point numbers by type."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, InputError

Shape = Literal["tet", "hex", "wedge", "pyramid"]
CORNERS: dict[Shape, int] = {"tet": 4, "hex": 8, "wedge": 6, "pyramid": 5}


@dataclass(frozen=True, slots=True)
class Kind:
    """A cell type that fills space. nodes: how many points it has, 0 where that depends on its degree.

    order: where its corners stand in the file, if they are not its first points in VTK's order of a hexahedron.
    """

    name: str
    shape: Shape
    nodes: int
    order: tuple[int, ...] = ()

    @property
    def corners(self) -> int:
        """How many of its points are corners, which come first."""
        return CORNERS[self.shape]

    @property
    def straight(self) -> bool:
        return self.nodes == self.corners


SOLID = {
    10: Kind("tetrahedra", "tet", 4),
    11: Kind("voxels", "hex", 8, (0, 1, 3, 2, 4, 5, 7, 6)),
    12: Kind("hexahedra", "hex", 8),
    13: Kind("wedges", "wedge", 6),
    14: Kind("pyramids", "pyramid", 5),
    24: Kind("quadratic tetrahedra", "tet", 10),
    25: Kind("quadratic hexahedra", "hex", 20),
    26: Kind("quadratic wedges", "wedge", 15),
    27: Kind("quadratic pyramids", "pyramid", 13),
    29: Kind("triquadratic hexahedra", "hex", 27),
    31: Kind("quadratic-linear wedges", "wedge", 12),
    32: Kind("biquadratic wedges", "wedge", 18),
    33: Kind("biquadratic hexahedra", "hex", 24),
    37: Kind("triquadratic pyramids", "pyramid", 19),
}
#: Points, lines and surfaces: they enclose nothing an isosurface could run through.
FLAT = {
    0: "empty cells", 1: "vertices", 2: "vertices", 3: "lines", 4: "polylines", 5: "triangles",
    6: "triangle strips", 7: "polygons", 8: "pixels", 9: "quads", 21: "quadratic lines",
    22: "quadratic triangles", 23: "quadratic quads", 28: "biquadratic quads", 30: "quadratic-linear quads",
    34: "biquadratic triangles", 35: "cubic lines", 36: "quadratic polygons", 51: "parametric curves",
    52: "parametric surfaces", 53: "parametric triangles", 54: "parametric quads", 60: "higher-order lines",
    61: "higher-order triangles", 62: "higher-order quads", 63: "higher-order polygons",
    68: "Lagrange curves", 69: "Lagrange triangles", 70: "Lagrange quads", 75: "Bezier curves",
    76: "Bezier triangles", 77: "Bezier quads",
}  # fmt: skip
#: Cells of any degree: a node more on every edge for each degree above the first, corners first.
HIGHER: dict[int, Kind] = {
    71: Kind("Lagrange tetrahedra", "tet", 0), 72: Kind("Lagrange hexahedra", "hex", 0),
    73: Kind("Lagrange wedges", "wedge", 0), 74: Kind("Lagrange pyramids", "pyramid", 0),
    78: Kind("Bezier tetrahedra", "tet", 0), 79: Kind("Bezier hexahedra", "hex", 0),
    80: Kind("Bezier wedges", "wedge", 0), 81: Kind("Bezier pyramids", "pyramid", 0),
}  # fmt: skip
#: Cells known by their faces, which vtk_faces.py finds.
FACETED = {15: "pentagonal prisms", 16: "hexagonal prisms", 41: "convex point sets", 42: "polyhedra"}
REFUSED = {
    55: "parametric tetrahedra", 56: "parametric hexahedra", 64: "higher-order tetrahedra",
    65: "higher-order wedges", 66: "higher-order pyramids", 67: "higher-order hexahedra",
}  # fmt: skip
#: All types that are read or left out, by name.
NAMES = {number: kind.name for number, kind in (SOLID | HIGHER).items()} | FACETED | FLAT
_CHUNK = 1 << 16  # rows narrowed at a time: they stay in the cache

Integers = npt.NDArray[Any]


@dataclass(frozen=True, slots=True)
class CellArrays:
    """Types, offsets (where each cell ends) and connectivity, checked; `starts` has a last entry for the end.

    keep: (c,) bool, cells that count, or None where all do.
    """

    path: str
    types: Integers
    starts: npt.NDArray[np.int64]
    connectivity: Integers
    keep: npt.NDArray[np.bool_] | None = None

    @classmethod
    def checked(
        cls, path: str, arrays: tuple[Integers, Integers, Integers], keep: npt.NDArray[np.bool_] | None = None
    ) -> CellArrays:
        """From (types, offsets, connectivity), in any integer type and byte order."""
        types, offsets, connectivity = arrays
        for name, array in (("types", types), ("offsets", offsets), ("connectivity", connectivity)):
            if array.dtype.kind not in "iu":
                raise InputError(
                    f"{path}: array {name!r} holds {array.dtype.name} numbers, not integers; write it again"
                )
        return cls(path, types, _starts(path, offsets, connectivity), connectivity, keep)

    def where(self, number: int) -> npt.NDArray[np.intp] | slice:
        """The cells of one type that count: a slice where they stand together."""
        chosen = self.types == number if self.keep is None else (self.types == number) & self.keep
        numbers = np.flatnonzero(chosen)
        first, last = int(numbers[0]), int(numbers[-1])
        return slice(first, last + 1) if last - first + 1 == len(numbers) else numbers


@dataclass(frozen=True, slots=True)
class Block:
    """Cells of one type and one number of points. cells: (m, k) int32. numbers: which cells of the piece they are.

    degrees: of Lagrange and Bezier cells along their axes, where the file says.
    """

    kind: Kind
    cells: npt.NDArray[np.int32]
    numbers: npt.NDArray[np.intp] | slice
    degrees: tuple[int, int, int] | None = None

    @property
    def corners(self) -> npt.NDArray[np.int32]:
        return self.cells[:, : self.kind.corners]


def count_cells(path: str, types: Integers) -> dict[int, int]:
    """Cells by VTK type; FieldError where a type cannot be contoured."""
    counts = {}
    if len(types) and (types == types[0]).all():
        counts = {int(types[0]): len(types)}
    elif len(types):
        histogram = np.bincount(_small(path, types))
        counts = {int(number): int(histogram[number]) for number in np.flatnonzero(histogram)}
    for number, count in counts.items():
        if number in REFUSED:
            raise FieldError(
                f"{path}: holds {count:,} {REFUSED[number]}, which cannot be contoured;"
                " split them into tetrahedra first"
            )
        if number not in NAMES:
            raise InputError(
                f"{path}: holds {count:,} cells of type {number}, which VTK does not define; write it again"
            )
    return counts


def _small(path: str, types: Integers) -> npt.NDArray[np.uint8]:
    if types.min() < 0 or types.max() > 255:
        raise InputError(f"{path}: a cell type is outside 0 to 255; copy the file again")
    return types.astype(np.uint8, copy=False)


def blocks(arrays: CellArrays, counts: dict[int, int], points: int) -> list[Block]:
    """Every cell that fills space and is known by its corners, by type, numbers checked against `points`."""
    found = []
    for number in counts:
        if number in SOLID:
            kind = SOLID[number]
            whole = len(counts) == 1 and arrays.keep is None
            numbers = slice(0, len(arrays.types)) if whole else arrays.where(number)
            _check_sizes(arrays, kind, numbers)
            found.append(Block(kind, narrowed(arrays, numbers, kind, points), numbers))
        elif number in HIGHER:
            found += _higher(arrays, number, points)
    return found


def _higher(arrays: CellArrays, number: int, points: int) -> list[Block]:
    """The cells of a type of any degree, by how many points they have."""
    every = np.arange(len(arrays.types))[arrays.where(number)]
    sizes = arrays.starts[every + 1] - arrays.starts[every]
    order = np.argsort(sizes, kind="stable")
    found = []
    for numbers in np.split(every[order], np.flatnonzero(np.diff(sizes[order])) + 1):
        size = int(arrays.starts[numbers[0] + 1] - arrays.starts[numbers[0]])
        kind = replace(HIGHER[number], nodes=size)
        if size < kind.corners:
            raise InputError(f"{arrays.path}: one of its {kind.name} has {size:,} points, too few; copy it again")
        found.append(Block(kind, narrowed(arrays, numbers, kind, points), numbers))
    return found


def _starts(path: str, offsets: Integers, connectivity: Integers) -> npt.NDArray[np.int64]:
    """Where each cell starts in the connectivity, and where the last one ends."""
    starts = np.empty(len(offsets) + 1, np.int64)
    starts[0] = 0
    starts[1:] = offsets
    if starts[-1] > len(connectivity):
        raise InputError(
            f"{path}: needs {int(starts[-1]):,} corners, its connectivity holds {len(connectivity):,};"
            " copy the file again"
        )
    if len(starts) > 1 and (falls := starts[1:] < starts[:-1]).any():
        raise InputError(
            f"{path}: the offsets fall at cell {int(np.argmax(falls)):,}; they have to grow, so copy the file again"
        )
    return starts


def _check_sizes(arrays: CellArrays, kind: Kind, numbers: npt.NDArray[np.intp] | slice) -> None:
    sizes = (arrays.starts[1:] - arrays.starts[:-1])[numbers]
    for size in (int(sizes.min()), int(sizes.max())):
        if size != kind.nodes:
            raise InputError(
                f"{arrays.path}: one of its {kind.name} has {size:,} points instead of {kind.nodes}; copy it again"
            )


def narrowed(
    arrays: CellArrays, numbers: npt.NDArray[np.intp] | slice, kind: Kind, points: int
) -> npt.NDArray[np.int32]:
    """(m, nodes) the points of cells as int32; InputError where one is none of `points`."""
    if isinstance(numbers, slice):
        rows = arrays.connectivity[arrays.starts[numbers.start] : arrays.starts[numbers.stop]]
        rows = rows.reshape(-1, kind.nodes)
    else:
        rows = arrays.connectivity[arrays.starts[numbers][:, None] + np.arange(kind.nodes)]
    cells = np.empty(rows.shape, np.int32)
    for first in range(0, len(rows), _CHUNK):
        part = rows[first : first + _CHUNK, kind.order] if kind.order else rows[first : first + _CHUNK]
        narrow(arrays.path, part, kind.name, points, cells[first : first + _CHUNK])
    return cells


def narrow(path: str, part: Integers, name: str, points: int, out: npt.NDArray[np.int32]) -> None:
    """Point numbers into `out`; InputError where one is none of `points`."""
    native = part.dtype.newbyteorder("=")
    part = np.ascontiguousarray(part, native)
    if part.size and part.view(f"u{native.itemsize}").max() >= points:  # a negative number is a large one here
        outside = part[(part < 0) | (part >= points)][0]
        raise InputError(
            f"{path}: one of its {name} names point {outside:,}, but there are {points:,}; copy the file again"
        )
    out[:] = part
