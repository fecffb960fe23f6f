"""The pieces of a surface: which of them are kept, on request, and what that drops.

A piece is a solid: an outer shell with its bubbles, the inner shells that it is the smallest shell around. A solid
inside a bubble is a piece of its own. kernels/surface/pieces/README.md has the words and how shells are told apart.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.choices import MILLIMETRES
from isocore.errors import OptionError
from isocore.extraction import Pieces
from isocore.job import Options
from isocore.piece_sizes import FewestTriangles, SmallestVolume
from isocore.surface import Surface

_Mask = npt.NDArray[np.bool_]


class Kept(NamedTuple):
    """What is left of a surface. whole: all there was.

    facts: None where nothing was asked for. message: why nothing is left, else empty.
    """

    surface: Surface
    whole: Surface
    facts: Pieces | None = None
    warnings: tuple[str, ...] = ()
    message: str = ""

    @property
    def is_whole(self) -> bool:
        """Is nothing dropped?"""
        return self.surface is self.whole


def check_unit(options: Options, unit: str) -> None:
    """Raises OptionError where a volume is asked for and lengths have no unit, or one that is not known."""
    asked = options.min_piece
    if not isinstance(asked, SmallestVolume) or unit in MILLIMETRES:
        return
    known = f"the input is in {unit}" if unit else "the input does not say its unit"
    raise OptionError(f"--min-piece {asked}: {known}; give a number of triangles")


def keep_pieces(surface: Surface, options: Options) -> Kept:
    """The surface without the pieces and bubbles that `options` drop; itself where they ask for nothing.

    Raises OptionError where a volume is asked for and the surface does not know its unit.
    """
    if options.keep_largest is None and options.min_piece is None and not options.fill_bubbles:
        return Kept(surface, surface)
    check_unit(options, surface.unit)
    shells = _kernels.shells(surface.vertices, surface.triangles, options.threads)
    found = _Found.of(shells, _step(surface.vertices))
    large = found.large_enough(options.min_piece, surface.unit)
    chosen = found.largest(large, options.keep_largest)
    left = chosen[found.piece]
    filled = left & found.is_bubble if options.fill_bubbles else np.zeros_like(left)
    swallowed = left & ~filled & _inside(shells.around, filled)
    kept = left & ~filled & ~swallowed
    volumes = np.where(shells.closed, shells.volumes, 0.0)
    smaller = surface if kept.all() else _part(surface, shells.of_vertex, kept)
    facts = Pieces(
        found=int(found.is_outer.sum()),
        kept=int((kept & found.is_outer).sum()),
        dropped=int((found.is_outer & ~left).sum()),
        swallowed=int((swallowed & found.is_outer).sum()),
        bubbles_filled=int(filled.sum()),
        open=int((found.is_outer & ~found.is_closed).sum()),
        triangles_dropped=len(surface.triangles) - len(smaller.triangles),
        vertices_dropped=len(surface.vertices) - len(smaller.vertices),
        volume_dropped=_sum(volumes, ~left),
        volume_filled=_sum(volumes, kept) - _sum(volumes, left) if options.fill_bubbles else 0.0,
    )
    message = "" if kept.any() or not len(kept) else found.why_none(options, surface.unit)
    return Kept(smaller, surface, facts, found.remarks(options), message)


class _Found(NamedTuple):
    """Shells, and of each piece, at its outer shell: is it closed, its triangles, volume and its shells' area.

    piece: of each shell, the outer one of its piece. volume: enclosed between outer shell and bubbles, not negative.
    step: of coordinates, which tell sizes from each other no better than that.
    """

    piece: npt.NDArray[np.int32]
    is_outer: _Mask
    is_closed: _Mask
    triangles: npt.NDArray[np.float64]
    volume: npt.NDArray[np.float64]
    area: npt.NDArray[np.float64]
    step: float

    @classmethod
    def of(cls, shells: _kernels.Shells, step: float) -> _Found:
        piece, count = shells.piece, len(shells.piece)
        return cls(
            piece=piece,
            is_outer=piece == np.arange(count),
            is_closed=shells.closed.astype(bool),
            triangles=_per_piece(piece, shells.triangles),
            volume=np.abs(_per_piece(piece, np.where(shells.closed, shells.volumes, 0.0))),
            area=_per_piece(piece, shells.areas),
            step=step,
        )

    @property
    def is_bubble(self) -> _Mask:
        """Of each shell."""
        return ~self.is_outer

    @property
    def _is_any_open(self) -> bool:
        return bool((self.is_outer & ~self.is_closed).any())

    def large_enough(self, asked: FewestTriangles | SmallestVolume | None, unit: str) -> _Mask:
        """The outer shells of pieces that are; an open one encloses no volume, so none is too small."""
        if asked is None:
            return self.is_outer
        if isinstance(asked, FewestTriangles):
            return self.is_outer & (self.triangles >= asked.triangles)
        smallest = asked.volume * (MILLIMETRES[asked.unit] / MILLIMETRES[unit]) ** 3
        return self.is_outer & (~self.is_closed | (self.volume + self.step * self.area >= smallest))

    def largest(self, candidates: _Mask, number: int | None) -> _Mask:
        """Of the outer shells, those of so many largest pieces: by volume, or by area where one is open."""
        if number is None or int(candidates.sum()) <= number:
            return candidates
        places = np.flatnonzero(candidates)
        if self._is_any_open:
            sizes, doubts = self.area[places], 4 * self.step * np.sqrt(self.triangles * self.area)[places]
        else:
            sizes, doubts = self.volume[places], self.step * self.area[places]
        order = np.argsort(-sizes, kind="stable")
        steps = sizes[order][1:] < (sizes - doubts)[order][:-1]
        ranks = np.empty(len(order), np.int64)
        ranks[order] = np.concatenate([[0], np.cumsum(steps)])
        chosen = np.zeros_like(candidates)
        chosen[places[np.lexsort((places, ranks))[:number]]] = True
        return chosen

    def why_none(self, options: Options, unit: str) -> str:
        """Why no piece is large enough."""
        count, asked = int(self.is_outer.sum()), options.min_piece
        largest = "the only piece" if count == 1 else f"the largest of {count:,} pieces"
        if isinstance(asked, FewestTriangles):
            return f"no piece is left: {largest} has {int(self.triangles.max()):,} triangles, --min-piece is {asked}"
        return f"no piece is left: {largest} encloses {self.volume.max():.4g} {unit}³, --min-piece is {asked}"

    def remarks(self, options: Options) -> tuple[str, ...]:
        """What open pieces do to what was asked for."""
        number = int((self.is_outer & ~self.is_closed).sum())
        if not number:
            return ()
        are, those = ("is", "it") if number == 1 else ("are", "them")
        what = f"{number:,} piece{'s' * (number != 1)} {are} open, so that nothing is enclosed"
        told = []
        if isinstance(options.min_piece, SmallestVolume):
            told.append(f"{what}: --min-piece {options.min_piece} keeps {those}")
        if options.keep_largest is not None and int(self.is_outer.sum()) > options.keep_largest:
            told.append(f"{what}: --keep-largest goes by area")
        return tuple(f"{text}; --cap closes what meets the volume's border" for text in told)


def _step(vertices: npt.NDArray[Any]) -> float:
    """From one coordinate to the next that can be told from it, at the farthest vertex."""
    return float(np.spacing(vertices.dtype.type(max(map(abs, _kernels.bounds(vertices))))))


def _per_piece(piece: npt.NDArray[np.int32], numbers: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """The sum over each piece's shells, at its outer one."""
    sums = np.zeros(len(piece))
    np.add.at(sums, piece, numbers)
    return sums


def _inside(around: npt.NDArray[np.int32], filled: _Mask) -> _Mask:
    """Of each shell: does a filled bubble lie around it, next to it or further out?"""
    inside, at = np.zeros_like(filled), around
    while len(at) and (at >= 0).any():
        inside |= (at >= 0) & filled[at]
        at = np.where(at >= 0, around[at], -1)
    return inside


def _sum(volumes: npt.NDArray[np.float64], which: _Mask) -> float:
    return float(volumes[which].sum())


def _part(surface: Surface, of_vertex: npt.NDArray[np.int32], kept: _Mask) -> Surface:
    """Those shells alone, vertices and triangles in their order; vertices that no triangle uses go."""
    stays = np.append(kept, False)[of_vertex]
    number = np.cumsum(stays, dtype=np.int32) - 1
    a, b, c = (stays[surface.triangles[:, corner]] for corner in range(3))
    triangles = number[surface.triangles[a & b & c]]
    normals = None if surface.normals is None else surface.normals[stays]
    fields = {name: values[stays] for name, values in surface.fields.items()}
    return replace(surface, vertices=surface.vertices[stays], triangles=triangles, normals=normals, fields=fields)
