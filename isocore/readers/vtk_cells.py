"""The cells of one piece of an unstructured grid of VTK, as arrays of point numbers by type."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, InputError
from isocore.readers.vtk_types import HIGHER, NAMES, REFUSED, SOLID, Kind

_FIRST_BEZIER = 75
_HIGHEST = 1 << 10  # degree that is believed
_CHUNK = 1 << 16  # rows narrowed at a time: they stay in the cache

Integers = npt.NDArray[Any]


@dataclass(frozen=True, slots=True)
class CellArrays:
    """Types, offsets (where each cell ends) and connectivity, checked; `starts` has a last entry for the end.

    keep: (c,) bool, cells that count, or None where all do. degrees: (c, 3) of Lagrange and Bezier cells along their
    axes, or None. old: the file is older than version 2.1.
    """

    path: str
    types: Integers
    starts: npt.NDArray[np.int64]
    connectivity: Integers
    keep: npt.NDArray[np.bool_] | None = None
    degrees: npt.NDArray[Any] | None = None
    old: bool = False

    @classmethod
    def checked(cls, path: str, arrays: tuple[Integers, Integers, Integers]) -> CellArrays:
        """From (types, offsets, connectivity), in any integer type and byte order."""
        types, offsets, connectivity = arrays
        for name, array in (("types", types), ("offsets", offsets), ("connectivity", connectivity)):
            if array.dtype.kind not in "iu":
                raise InputError(
                    f"{path}: array {name!r} holds {array.dtype.name} numbers, not integers; write it again"
                )
        return cls(path, types, _starts(path, offsets, connectivity), connectivity)

    def where(self, number: int) -> npt.NDArray[np.intp] | slice:
        """The cells of one type that count: a slice where they stand together."""
        chosen = self.types == number if self.keep is None else (self.types == number) & self.keep
        numbers = np.flatnonzero(chosen)
        first, last = int(numbers[0]), int(numbers[-1])
        return slice(first, last + 1) if last - first + 1 == len(numbers) else numbers


@dataclass(frozen=True, slots=True)
class Block:
    """Cells of one type and one number of points. cells: (m, k) int32. numbers: which cells of the piece they are.

    number: of the type. degrees: of Lagrange and Bezier cells along their axes, where the file says.
    old: the nodes of Lagrange hexahedra stand as in files before version 2.1.
    """

    kind: Kind
    cells: npt.NDArray[np.int32]
    numbers: npt.NDArray[np.intp] | slice
    number: int
    degrees: tuple[int, int, int] | None = None
    old: bool = False

    @property
    def bezier(self) -> bool:
        """Are its points control points, which the cell need not pass through?"""
        return self.number >= _FIRST_BEZIER

    @property
    def corners(self) -> npt.NDArray[np.int32]:
        return self.cells[:, : self.kind.corners]


def by_corners(block: Block) -> Block:
    """The straight cells between the corners."""
    kind = replace(block.kind, nodes=block.kind.corners)
    return replace(block, kind=kind, cells=np.ascontiguousarray(block.corners))


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
            found.append(Block(kind, narrowed(arrays, numbers, kind, points), numbers, number))
        elif number in HIGHER:
            found += _higher(arrays, number, points)
    return found


def _higher(arrays: CellArrays, number: int, points: int) -> list[Block]:
    """The cells of a type of any degree, by how many points they have."""
    every = np.arange(len(arrays.types))[arrays.where(number)]
    sizes = arrays.starts[every + 1] - arrays.starts[every]
    alike = [sizes] if arrays.degrees is None else [*arrays.degrees[every].T, sizes]
    order = np.lexsort(alike)
    changes = np.logical_or.reduce([np.diff(key[order]) != 0 for key in alike])
    found = []
    for numbers in np.split(every[order], np.flatnonzero(changes) + 1):
        size = int(arrays.starts[numbers[0] + 1] - arrays.starts[numbers[0]])
        kind = replace(HIGHER[number], nodes=size)
        if size < kind.corners:
            raise InputError(f"{arrays.path}: one of its {kind.name} has {size:,} points, too few; copy it again")
        degrees = None if arrays.degrees is None else _degrees(arrays.degrees[numbers[0]])
        cells = narrowed(arrays, numbers, kind, points)
        found.append(Block(kind, cells, numbers, number, degrees, arrays.old))
    return found


def _degrees(row: npt.NDArray[Any]) -> tuple[int, int, int] | None:
    """Three degrees from 1 on, or None."""
    p, q, r = (int(degree) if 1 <= degree <= _HIGHEST else 0 for degree in row.tolist())
    return (p, q, r) if p and q and r else None


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
