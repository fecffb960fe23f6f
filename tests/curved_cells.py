"""Boxes of curved cells of every kind: straight ones with the nodes of their type, one point for each place."""

from __future__ import annotations

from typing import Any

import numpy as np
from cell_shapes import block
from vtu_files import Mesh

from isocore.readers.vtk_templates import Template, template

#: VTK type, points, degrees along the axes where the file has to say them, and the shape of the cells.
KINDS = {
    "tet10": (24, 10, None, "tet"),
    "hex20": (25, 20, None, "hex"),
    "wedge15": (26, 15, None, "wedge"),
    "pyramid13": (27, 13, None, "pyramid"),
    "hex27": (29, 27, None, "hex"),
    "wedge12": (31, 12, None, "wedge"),
    "wedge18": (32, 18, None, "wedge"),
    "hex24": (33, 24, None, "hex"),
    "pyramid19": (37, 19, None, "pyramid"),
    "tet71-2": (71, 10, None, "tet"),
    "tet71-15": (71, 15, None, "tet"),
    "tet71-3": (71, 20, None, "tet"),
    "tet71-5": (71, 56, None, "tet"),
    "hex72-2": (72, 27, None, "hex"),
    "hex72-3": (72, 64, None, "hex"),
    "hex72-124": (72, 30, (1, 2, 4), "hex"),
    "wedge73-2": (73, 18, None, "wedge"),
    "wedge73-21": (73, 21, None, "wedge"),
    "wedge73-4": (73, 75, None, "wedge"),
    "wedge73-31": (73, 20, (3, 3, 1), "wedge"),
    "pyramid74-2": (74, 14, None, "pyramid"),
}


def straight(shape: str, n: int) -> tuple[Any, Any]:
    """Points and cells, by their corners, of a box of n * n * n cubes from 0 to 1."""
    letter = {"hex": "h", "tet": "h", "wedge": "/", "pyramid": "p"}[shape]
    points, cells = block(np.full((n, n, n), letter))
    corners = np.array([ids for _, ids in cells])
    if shape == "tet":  # six around the diagonal of each cube
        ways = ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1))
        corners = np.concatenate([corners[:, (0, a, b, 6)] for a, b in ways])
    return points / n, corners


def placed(shape: str, corners: Any, at: Any) -> Any:
    """(m, L, 3) where the nodes `at` (L, 3) of a lattice lie in cells whose corners lie at (m, k, 3)."""
    x, y, z = at.T
    if shape == "tet":
        weights = np.stack((1 - x - y - z, x, y, z), axis=1)
    elif shape == "wedge":
        weights = np.stack([w * h for h in (1 - z, z) for w in (1 - x - y, x, y)], axis=1)
    elif shape == "hex":
        sides = ((0, 0), (1, 0), (1, 1), (0, 1))
        line = [(1 - x, x), (1 - y, y), (1 - z, z)]
        weights = np.stack([line[0][i] * line[1][j] * line[2][k] for k in (0, 1) for i, j in sides], axis=1)
    else:  # an affine map of the base's plane and the apex
        base = corners[:, 0]
        a, b = corners[:, 1] - base, corners[:, 3] - base
        up = corners[:, 4] - base - (a + b) / 2
        return base[:, None] + np.einsum("lk,mkx->mlx", at, np.stack((a, b, up), axis=1))
    return np.einsum("lk,mkx->mlx", weights, corners)


def box(name: str, n: int, *, warp: Any = None) -> tuple[Mesh, Template]:
    """A box of curved cells, without fields, and how they are divided. warp: moves all nodes."""
    number, nodes, degrees, shape = KINDS[name]
    points, corners = straight(shape, n)
    form = template(number, nodes, degrees, False)
    assert form is not None
    places = placed(shape, points[corners], form.at[:nodes]) if nodes > corners.shape[1] else points[corners]
    _, first, ids = np.unique(np.round(places.reshape(-1, 3), 9), axis=0, return_index=True, return_inverse=True)
    chosen = places.reshape(-1, 3)[first]
    cells = [(number, row) for row in ids.reshape(-1, nodes).tolist()]
    fields = {} if degrees is None else {"HigherOrderDegrees": np.tile(degrees, (len(cells), 1))}
    return Mesh(chosen if warp is None else warp(chosen), cells, {}, fields), form
