"""Blocks of cells that fill a box: hexahedra, wedges, pyramids, in any mixture whose faces fit."""

from __future__ import annotations

from typing import Any

import numpy as np

HEX, WEDGE, PYRAMID, TET = 12, 13, 14, 10
_UNIT = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
_SIDES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))
_HALVES = {"/": ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)), "\\": ((0, 1, 3, 4, 5, 7), (1, 2, 3, 5, 6, 7))}


def block(kinds: Any, renumbered: Any = None) -> tuple[Any, list[tuple[int, list[int]]]]:
    """Points and cells of a box of unit cubes. kinds: (nx, ny, nz) of "h" (a hexahedron), "p" (six pyramids).

    A column whose lowest kind is "/" or "\\" is all wedges, cut that way. renumbered: a random generator.
    """
    kinds = np.asarray(kinds)
    size = tuple(n + 1 for n in kinds.shape)
    points = [tuple(map(float, index)) for index in np.ndindex(size)]
    cells: list[tuple[int, list[int]]] = []
    for index in np.ndindex(kinds.shape):
        ids = [int(np.ravel_multi_index(tuple(np.add(index, corner)), size)) for corner in _UNIT]
        column = kinds[index[0], index[1], 0]
        if column in _HALVES:
            cells += [(WEDGE, [ids[i] for i in half]) for half in _HALVES[column]]
        elif kinds[index] == "p":
            cells += [(PYRAMID, [*(ids[i] for i in side), len(points)]) for side in _SIDES]
            points.append(tuple(float(i) + 0.5 for i in index))
        else:
            cells.append((HEX, ids))
    array = np.array(points)
    if renumbered is not None:
        new = renumbered.permutation(len(array))
        shuffled = np.empty_like(array)
        shuffled[new] = array
        array, cells = shuffled, [(kind, [int(new[i]) for i in ids]) for kind, ids in cells]
    return array, cells


def of_kind(cells: list[tuple[int, list[int]]], kind: int) -> Any:
    """(m, k) int32 of the cells of one type."""
    corners = {HEX: 8, WEDGE: 6, PYRAMID: 5, TET: 4}[kind]
    rows = [ids for number, ids in cells if number == kind]
    return np.array(rows, np.int32).reshape(-1, corners)


def volume_of_tets(points: Any, tets: Any) -> Any:
    """(m,) volumes without sign."""
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    return np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)) / 6
