"""What a format makes of coordinates, before anything is written: the surface that a reader of the file will find.

Reports and gates speak of this surface. Where a format keeps every coordinate, it is the surface itself and nothing is
computed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.choices import Format
from isocore.errors import OutputError
from isocore.surface import Surface
from isocore.writers.pieces import pieces

#: Vertices that move by less than this part of the mean edge are not worth a warning.
_SMALL_MOVE = 1e-3


def rounded(surface: Surface, format: Format, threads: int = 1) -> tuple[Surface, tuple[str, ...]]:
    """The surface with its coordinates as `format` keeps them, and a warning where that moves vertices visibly.

    PLY keeps float32 and float64, OBJ nine significant digits, STL, GLB and GIFTI float32. Raises OutputError where a
    coordinate lies beyond what the format can say.
    """
    round_ = _ROUNDING.get(format)
    if round_ is None or surface.vertices.dtype == np.float32 or not len(surface.vertices):
        return surface, ()
    vertices = round_(surface.vertices, threads)
    if np.array_equal(vertices, surface.vertices):
        return replace(surface, vertices=vertices), ()
    return replace(surface, vertices=vertices), _loss(surface, vertices, format, threads)


def as_read(surface: Surface, format: Format, threads: int = 1) -> Surface:
    """A rounded surface as a reader finds it: STL shares no vertices, so readers join those at one place."""
    if format != "stl":
        return surface
    earliest = _kernels.weld(surface.vertices, threads)
    if not len(earliest):
        return surface
    kept = earliest == np.arange(len(earliest), dtype=np.int32)
    number = np.cumsum(kept, dtype=np.int32) - 1
    return Surface(surface.vertices[kept], number[earliest][surface.triangles], space=surface.space, unit=surface.unit)


def _float32(vertices: npt.NDArray[Any], threads: int) -> npt.NDArray[np.float32]:
    farthest = max(map(abs, _kernels.bounds(vertices)))
    if not farthest <= float(np.finfo(np.float32).max):
        raise OutputError(f"it keeps float32, which ends before coordinates of {farthest:.3g}; write PLY, VTP or OBJ")
    return vertices.astype(np.float32)


#: format -> what it makes of float64 coordinates. PLY keeps them, and every format keeps float32.
_ROUNDING: dict[str, Callable[[npt.NDArray[Any], int], npt.NDArray[Any]]] = {
    "stl": _float32,
    "glb": _float32,
    "gii": _float32,
    "obj": _kernels.nine_digits,
}
_KEEPS = {name: f"{name.upper()} keeps float32 only" for name in ("stl", "glb")}
_KEEPS |= {"gii": "GIFTI keeps float32 only", "obj": "OBJ keeps nine digits"}
_INSTEAD = dict.fromkeys(("stl", "glb", "gii"), "write PLY, VTP or OBJ")
_INSTEAD |= {"obj": "write PLY or VTP, which keep float64"}


def _loss(surface: Surface, after: npt.NDArray[Any], format: Format, threads: int) -> tuple[str, ...]:
    """How far vertices have moved from those of `surface` to `after` (v, 3), and how many are no longer apart."""
    moved, edge = _farthest_move(surface.vertices, after), _mean_edge(surface)
    merged = _merged(after, threads)
    if merged:
        merged -= _merged(surface.vertices, threads)
    if moved <= _SMALL_MOVE * edge and not merged:
        return ()
    unit = f" {surface.unit}" if surface.unit else ""
    share = f", {moved / edge:.2g} times the mean edge ({edge:.3g}{unit})" if edge > 0 else ""
    lost = (
        f"; {merged:,} of {len(after):,} vertices fall on another one, where programs that weld by position find holes"
        if merged
        else ""
    )
    return (
        f"{_KEEPS[format]}, so vertices moved by up to {moved:.3g}{unit}{share}{lost}; "
        f"{_INSTEAD[format]}, or write about a nearer point with --offset auto",
    )


def _farthest_move(before: npt.NDArray[Any], after: npt.NDArray[Any]) -> float:
    """The longest way that a vertex went."""
    squares = 0.0
    for old, new in zip(pieces(before), pieces(after), strict=True):
        way = new.astype(np.float64)
        way -= old
        squares = max(squares, float(np.einsum("ij,ij->i", way, way).max()))
    return float(np.sqrt(squares))


def _mean_edge(surface: Surface) -> float:
    """Over all sides of all triangles."""
    total = 0.0
    for triangles in pieces(surface.triangles):
        corners = surface.vertices[triangles]
        sides = corners - np.roll(corners, 1, axis=1)
        total += float(np.sqrt(np.einsum("ijk,ijk->ij", sides, sides)).sum())
    return total / max(1, 3 * len(surface.triangles))


def _merged(vertices: npt.NDArray[Any], threads: int) -> int:
    """How many vertices share the place of an earlier one."""
    earliest = _kernels.weld(vertices, threads)
    return int((earliest != np.arange(len(earliest), dtype=np.int32)).sum())
