"""The cells of one piece of an unstructured grid of VTK, as corner arrays by shape."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, InputError

Shape = Literal["tet", "hex", "wedge", "pyramid"]
CORNERS: dict[Shape, int] = {"tet": 4, "hex": 8, "wedge": 6, "pyramid": 5}


@dataclass(frozen=True, slots=True)
class Kind:
    """A cell type that fills space: its nodes in the file, and which are its corners, in VTK's order."""

    name: str
    shape: Shape
    nodes: int
    corners: tuple[int, ...]

    @property
    def curved(self) -> bool:
        return self.nodes > len(self.corners)


def _kind(name: str, shape: Shape, nodes: int = 0) -> Kind:
    return Kind(name, shape, nodes or CORNERS[shape], tuple(range(CORNERS[shape])))


SOLID = {
    10: _kind("tetrahedra", "tet"),
    11: Kind("voxels", "hex", 8, (0, 1, 3, 2, 4, 5, 7, 6)),
    12: _kind("hexahedra", "hex"),
    13: _kind("wedges", "wedge"),
    14: _kind("pyramids", "pyramid"),
    24: _kind("quadratic tetrahedra", "tet", 10),
    25: _kind("quadratic hexahedra", "hex", 20),
    26: _kind("quadratic wedges", "wedge", 15),
    27: _kind("quadratic pyramids", "pyramid", 13),
    29: _kind("triquadratic hexahedra", "hex", 27),
    31: _kind("quadratic-linear wedges", "wedge", 12),
    32: _kind("biquadratic wedges", "wedge", 18),
    33: _kind("biquadratic hexahedra", "hex", 24),
    37: _kind("triquadratic pyramids", "pyramid", 19),
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
REFUSED = {
    15: "pentagonal prisms", 16: "hexagonal prisms", 41: "convex point sets", 42: "polyhedra",
    55: "parametric tetrahedra", 56: "parametric hexahedra", 64: "higher-order tetrahedra",
    65: "higher-order wedges", 66: "higher-order pyramids", 67: "higher-order hexahedra",
    71: "Lagrange tetrahedra", 72: "Lagrange hexahedra", 73: "Lagrange wedges", 74: "Lagrange pyramids",
    78: "Bezier tetrahedra", 79: "Bezier hexahedra", 80: "Bezier wedges", 81: "Bezier pyramids",
}  # fmt: skip
_CHUNK = 1 << 16  # rows narrowed at a time: they stay in the cache


@dataclass(frozen=True, slots=True)
class Corners:
    """Cells of one type. cells: (m, k) int32. numbers: which cells of the piece they are."""

    kind: Kind
    cells: npt.NDArray[np.int32]
    numbers: npt.NDArray[np.intp] | slice


def count_cells(path: str, types: npt.NDArray[Any]) -> dict[int, int]:
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
        if number not in SOLID and number not in FLAT:
            raise InputError(
                f"{path}: holds {count:,} cells of type {number}, which VTK does not define; write it again"
            )
    return counts


def _small(path: str, types: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    if types.min() < 0 or types.max() > 255:
        raise InputError(f"{path}: a cell type is outside 0 to 255; copy the file again")
    return types.astype(np.uint8, copy=False)


def corners(
    path: str,
    arrays: tuple[npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any]],
    counts: dict[int, int],
    points: int,
) -> list[Corners]:
    """The corners of every cell that fills space, by type, numbers checked against `points`.

    arrays: (types, offsets, connectivity), in any integer type and byte order.
    """
    types, offsets, connectivity = arrays
    for name, array in (("types", types), ("offsets", offsets), ("connectivity", connectivity)):
        if array.dtype.kind not in "iu":
            raise InputError(
                f"{path}: array {name!r} holds {array.dtype.name} numbers, not integers; write it again"
            )
    starts = _starts(path, offsets, connectivity)
    sizes = starts[1:] - starts[:-1]
    if len(sizes) and sizes.min() < 0:
        fall = int(np.argmax(sizes < 0))
        raise InputError(
            f"{path}: the offsets fall at cell {fall:,}; they have to grow, so copy the file again"
        )
    found = []
    for number in counts:
        if number in SOLID:
            kind = SOLID[number]
            numbers = slice(0, len(types)) if len(counts) == 1 else _where(types, number)
            _check_sizes(path, kind, sizes[numbers])
            rows = _rows(kind, starts, numbers, connectivity)
            found.append(Corners(kind, _narrow(path, rows, kind, points), numbers))
    return found


def _starts(path: str, offsets: npt.NDArray[Any], connectivity: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """Where each cell starts in the connectivity, and where the last one ends."""
    starts = np.empty(len(offsets) + 1, np.int64)
    starts[0] = 0
    starts[1:] = offsets
    if starts[-1] > len(connectivity):
        raise InputError(
            f"{path}: needs {int(starts[-1]):,} corners, its connectivity holds {len(connectivity):,};"
            " copy the file again"
        )
    return starts


def _where(types: npt.NDArray[Any], number: int) -> npt.NDArray[np.intp] | slice:
    """The cells of one type: a slice where they stand together."""
    numbers = np.flatnonzero(types == number)
    first, last = int(numbers[0]), int(numbers[-1])
    return slice(first, last + 1) if last - first + 1 == len(numbers) else numbers


def _check_sizes(path: str, kind: Kind, sizes: npt.NDArray[np.int64]) -> None:
    for size in (int(sizes.min()), int(sizes.max())):
        if size != kind.nodes:
            raise InputError(
                f"{path}: one of its {kind.name} has {size:,} points instead of {kind.nodes}; copy it again"
            )


def _rows(
    kind: Kind,
    starts: npt.NDArray[np.int64],
    numbers: npt.NDArray[np.intp] | slice,
    connectivity: npt.NDArray[Any],
) -> npt.NDArray[Any]:
    """(m, nodes) of the connectivity."""
    rows: npt.NDArray[Any]
    if isinstance(numbers, slice):
        rows = connectivity[starts[numbers.start] : starts[numbers.stop]].reshape(-1, kind.nodes)
    else:
        rows = connectivity[starts[numbers][:, None] + np.arange(kind.nodes)]
    return rows


def _narrow(path: str, rows: npt.NDArray[Any], kind: Kind, points: int) -> npt.NDArray[np.int32]:
    """The corners of `rows` as int32; InputError where one names no point."""
    straight = kind.corners == tuple(range(kind.nodes))
    native = rows.dtype.newbyteorder("=")
    unsigned = np.dtype(f"u{native.itemsize}")
    cells = np.empty((len(rows), len(kind.corners)), np.int32)
    for first in range(0, len(rows), _CHUNK):
        part = rows[first : first + _CHUNK] if straight else rows[first : first + _CHUNK, kind.corners]
        part = np.ascontiguousarray(part, native)
        if part.view(unsigned).max() >= points:  # a negative number is a large one here
            outside = part[(part < 0) | (part >= points)][0]
            raise InputError(
                f"{path}: one of its {kind.name} names point {outside:,}, but there are {points:,};"
                " copy the file again"
            )
        cells[first : first + _CHUNK] = part
    return cells
