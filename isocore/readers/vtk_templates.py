"""How a curved cell of each kind is divided into straight ones through all its nodes.

What a cell lacks of a full lattice of degree two comes from its shape functions: the middle of a side with eight nodes
is half the sum of its edges' middles less a quarter of the sum of its corners (serendipity, e.g. O. Zienkiewicz,
R. Taylor, "The Finite Element Method", ch. 6), the middle of a hexahedron follows from those of its sides by
transfinite interpolation (W. Gordon, C. Hall, 1973).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from math import isqrt

import numpy as np
import numpy.typing as npt

from isocore.readers.vtk_lattices import (
    Cells,
    Node,
    hex_cells,
    hex_nodes,
    pyramid_cells,
    pyramid_nodes,
    ring,
    tet_cells,
    tet_nodes,
    wedge_cells,
    wedge_nodes,
)
from isocore.readers.vtk_types import Shape

Local = npt.NDArray[np.intp]
Degrees = tuple[int, int, int]
_NONE: Local = np.empty((0, 0), np.intp)


@dataclass(frozen=True, slots=True)
class Template:
    """One way to divide a cell. Numbers are places among its nodes: those of the file, then `sides`, then the middle.

    shape, degrees: of the lattice; at: (L, 3) where each node lies in it, from 0 to 1.
    sides: (s, 8) middles of sides that the file lacks: corners in turn, then the edges between them.
    known: (n, 5) sides with a middle in the file: their corners and that middle.
    middle: (6, 12, 8 nodes) sides, edges and corners that the middle of a hexahedron comes from, or none.
    cells: the straight cells, by shape. octahedra: (o, 6), opposite corners one after the other.
    """

    shape: Shape
    degrees: Degrees
    at: npt.NDArray[np.float64]
    cells: dict[Shape, Local]
    octahedra: Local = field(default_factory=lambda: _NONE)
    sides: Local = field(default_factory=lambda: np.empty((0, 8), np.intp))
    known: Local = field(default_factory=lambda: np.empty((0, 5), np.intp))
    middle: tuple[Local, Local, Local] | None = None


@lru_cache(maxsize=64)
def template(number: int, nodes: int, degrees: Degrees | None, old: bool) -> Template | None:
    """For a VTK cell type of `nodes` points; None where no degree has that many.

    degrees: along its axes, where the file says. old: the file is older than version 2.1.
    """
    if number in (24, 71, 78):
        n = degrees[0] if degrees else _root(nodes, lambda n: (n + 1) * (n + 2) * (n + 3) // 6)
        if nodes == 15 and n in (None, 2):
            return _tet_15()
        return None if n is None or len(tet_nodes(n)) != nodes else _tet(n)
    if number in (25, 29, 33):
        return _hex((2, 2, 2), nodes)
    if number in (72, 79):
        n = _root(nodes, lambda n: (n + 1) ** 3)
        found = degrees or (None if n is None else (n, n, n))
        if found is None or (found[0] + 1) * (found[1] + 1) * (found[2] + 1) != nodes:
            return None
        return _hex(found, nodes, old and number == 72)
    if number in (26, 31, 32):
        return _wedge(2, 1 if nodes == 12 else 2, nodes)
    if number in (73, 80):
        n = degrees[0] if degrees else _root(nodes, lambda n: (n + 1) ** 2 * (n + 2) // 2)
        m = degrees[2] if degrees else n
        if nodes == 21 and (n, m) in ((None, None), (2, 2)):
            return _wedge_21()
        return None if n is None or m is None or (n + 1) * (n + 2) // 2 * (m + 1) != nodes else _wedge(n, m, nodes)
    return {5: _pyramid(1, 5), 13: _pyramid(2, 13), 14: _pyramid(2, 14), 19: _pyramid_19()}.get(nodes)


def _root(nodes: int, count: object) -> int | None:
    """The degree of so many nodes."""
    assert callable(count)
    n = 1
    while n <= isqrt(nodes) and count(n) < nodes:
        n += 1
    return n if count(n) == nodes else None


def _numbers(nodes: Iterable[Node], cells: Cells) -> Local:
    place = {node: number for number, node in enumerate(nodes)}
    return np.array([[place[node] for node in cell] for cell in cells], np.intp).reshape(len(cells), -1 if cells else 0)


def _tet(n: int) -> Template:
    nodes = tet_nodes(n)
    tets, octahedra = tet_cells(n)
    return Template("tet", (n, n, n), np.array(nodes) / n, {"tet": _numbers(nodes, tets)}, _numbers(nodes, octahedra))


def _hex(degrees: Degrees, given: int, old: bool = False) -> Template:
    nodes = hex_nodes(*degrees, old=old)
    cells: dict[Shape, Local] = {"hex": _numbers(nodes, hex_cells(*degrees))}
    at = np.array(nodes) / degrees
    sides = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
    if degrees != (2, 2, 2):
        return Template("hex", degrees, at, cells)
    eight = [_with_edges(nodes, side) for side in sides]
    lacking = max(0, given - 20)  # sides the file has, of six; the middle is its 27th node
    known = np.array([[*sides[n], 20 + n] for n in range(min(lacking, 6))], np.intp).reshape(-1, 5)
    middle = (np.arange(20, 26), np.arange(8, 20), np.arange(8)) if given < 27 else None
    computed = np.array(eight[lacking:], np.intp).reshape(-1, 8)
    return Template("hex", degrees, at, cells, sides=computed, known=known, middle=middle)


def _wedge(n: int, m: int, given: int) -> Template:
    nodes = wedge_nodes(n, m)
    cells: dict[Shape, Local] = {"wedge": _numbers(nodes, wedge_cells(n, m))}
    at = np.array(nodes) / (n, n, m)
    if (n, m) != (2, 2):
        return Template("wedge", (n, n, m), at, cells)
    sides = [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
    if given == 15:
        eight = np.array([_with_edges(nodes, side) for side in sides])
        return Template("wedge", (2, 2, 2), at, cells, sides=eight)
    return Template("wedge", (2, 2, 2), at, cells, known=np.array([[*side, 15 + n] for n, side in enumerate(sides)]))


def _pyramid(n: int, given: int) -> Template:
    nodes = pyramid_nodes(n)
    pyramids, tets = pyramid_cells(n)
    cells: dict[Shape, Local] = {"pyramid": _numbers(nodes, pyramids)}
    if n > 1:
        cells["tet"] = _numbers(nodes, tets)
    # A layer shrinks about its middle, so what is said of a side holds: its nodes lie at the middles of its edges.
    at = np.array([((i + k / 2) / n, (j + k / 2) / n, k / n) for i, j, k in nodes])
    if given == 13:
        return Template("pyramid", (2, 2, 2), at, cells, sides=np.array([_BASE_8]))
    known = np.array([[0, 1, 2, 3, 13]]) if n == 2 else np.empty((0, 5), np.intp)
    return Template("pyramid", (n, n, n), at, cells, known=known)


_BASE_8 = (0, 1, 2, 3, 5, 6, 7, 8)
_PYRAMID_EDGES = {(0, 1): 5, (1, 2): 6, (2, 3): 7, (0, 3): 8, (0, 4): 9, (1, 4): 10, (2, 4): 11, (3, 4): 12}


def _pyramid_19() -> Template:
    """Every side around its own middle, seen from the middle of the cell."""
    squares = [(0, 5, 13, 8, 18), (5, 1, 6, 13, 18), (13, 6, 2, 7, 18), (8, 13, 7, 3, 18)]
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    tets = [(a, b, 14 + n, 18) for n, face in enumerate(faces) for a, b in ring(face, _PYRAMID_EDGES)]
    at = [((i + k / 2) / 2, (j + k / 2) / 2, k / 2) for i, j, k in pyramid_nodes(2)]
    at += [(0.5, 1 / 6, 1 / 3), (5 / 6, 0.5, 1 / 3), (0.5, 5 / 6, 1 / 3), (1 / 6, 0.5, 1 / 3), (0.5, 0.5, 0.25)]
    cells: dict[Shape, Local] = {"pyramid": np.array(squares), "tet": np.array(tets)}
    return Template("pyramid", (2, 2, 2), np.array(at), cells, known=np.array([[0, 1, 2, 3, 13]]))


def _tet_15() -> Template:
    edges = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}
    faces = [(0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)]
    tets = [(a, b, 10 + n, 14) for n, face in enumerate(faces) for a, b in ring(face, edges)]
    at = np.array(tet_nodes(2)) / 2
    at = np.concatenate((at, [at[list(face)].mean(axis=0) for face in faces], at[:4].mean(axis=0)[None]))
    return Template("tet", (2, 2, 2), at, {"tet": np.array(tets)})


def _wedge_21() -> Template:
    edges = {(0, 1): 6, (1, 2): 7, (0, 2): 8, (3, 4): 9, (4, 5): 10, (3, 5): 11, (0, 3): 12, (1, 4): 13, (2, 5): 14}
    tets = [(a, b, 15 + n, 20) for n, face in enumerate(((0, 1, 2), (3, 4, 5))) for a, b in ring(face, edges)]
    sides = [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
    squares = []
    for n, side in enumerate(sides):
        turn = [a for a, _ in ring(side, edges)]
        squares += [(turn[2 * i], turn[2 * i + 1], 17 + n, turn[2 * i - 1], 20) for i in range(4)]
    at = np.array(wedge_nodes(2, 2)[:15]) / 2
    middles = [at[list(face)].mean(axis=0) for face in ((0, 1, 2), (3, 4, 5), *sides, range(6))]
    cells: dict[Shape, Local] = {"pyramid": np.array(squares), "tet": np.array(tets)}
    known = np.array([[*side, 17 + n] for n, side in enumerate(sides)])
    return Template("wedge", (2, 2, 2), np.concatenate((at, middles)), cells, known=known)


def _with_edges(nodes: list[Node], side: tuple[int, ...]) -> list[int]:
    """The corners of a side, then the middles of its edges."""
    place = {node: number for number, node in enumerate(nodes)}
    middles = []
    for a, b in zip(side, (*side[1:], side[0]), strict=True):
        (ai, aj, ak), (bi, bj, bk) = nodes[a], nodes[b]
        middles.append(place[(ai + bi) // 2, (aj + bj) // 2, (ak + bk) // 2])
    return [*side, *middles]
