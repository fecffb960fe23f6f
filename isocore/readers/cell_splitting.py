"""Split wedges, pyramids and the hexahedra beside them into tetrahedra whose faces agree.

Every quad face is cut from its lowest point number, so the two cells that share it cut it the same way
without knowing of each other. A cell is the cone from its lowest corner over the triangles of the faces that
corner is not on; the faces it is on are then cut from it too, as they have to be.

A hexahedron that stays whole is contoured by another rule on its faces. So whatever hexahedra hang together
through quad faces with a cell that is split are split with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Cells = npt.NDArray[np.int32]
Keys = npt.NDArray[np.uint64]

#: Per shape its faces of four corners, in turn around each, in VTK's corner order.
QUADS = {
    "hex": ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    "wedge": ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "pyramid": ((0, 1, 2, 3),),
    "quad": ((0, 1, 2, 3),),
}
TRIANGLES: dict[str, tuple[tuple[int, int, int], ...]] = {
    "hex": (),
    "wedge": ((0, 1, 2), (3, 4, 5)),
    "pyramid": ((0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
}
_CHUNK = 1 << 14


@dataclass(frozen=True, slots=True)
class SplitCells:
    """What a mesh of four shapes became.

    tets: (m, 4), the ones given first. hexes: (h, 8), those that stayed whole.
    collapsed: cells that named a corner twice. beside: sound hexahedra split for their neighbours' sake.
    """

    tets: Cells
    hexes: Cells
    collapsed: int
    beside: int


def split_cells(
    tets: Cells, hexes: Cells, wedges: Cells, pyramids: Cells, quads: Cells | None = None
) -> SplitCells:
    """Tetrahedra and whole hexahedra that fill the same space and meet face to face as before.

    quads: (q, 4) faces that others cut: the hexahedra at them have to be split.
    """
    cut = np.empty((0, 4), np.int32) if quads is None else quads
    flat = [repeats_a_corner(cells) for cells in (tets, hexes, wedges, pyramids)]
    collapsed = sum(int(np.count_nonzero(mask)) for mask in flat)
    if flat[0].any():
        tets = tets[~flat[0]]
    if not len(wedges) and not len(pyramids) and not len(cut) and not flat[1].any():
        return SplitCells(tets, hexes, collapsed, 0)
    others = [_quad_keys(wedges, "wedge"), _quad_keys(pyramids, "pyramid"), _quad_keys(cut, "quad")]
    split = _hang_together(hexes, flat[1], others)
    parts = [tets, cones(hexes[split], "hex"), cones(wedges, "wedge"), cones(pyramids, "pyramid")]
    return SplitCells(
        np.concatenate(parts), hexes[~split], collapsed, int(np.count_nonzero(split & ~flat[1]))
    )


def repeats_a_corner(cells: Cells) -> npt.NDArray[np.bool_]:
    """(m,) True where a cell names a point twice."""
    result = np.zeros(len(cells), np.bool_)
    for first in range(0, len(cells), _CHUNK):
        columns = np.ascontiguousarray(cells[first : first + _CHUNK].T)
        mask = result[first : first + _CHUNK]
        for a in range(1, len(columns)):
            for b in range(a):
                mask |= columns[a] == columns[b]
    return result


def cones(cells: Cells, shape: str) -> Cells:
    """(t, 4) tetrahedra of (m, k) cells of one shape; those that name a point twice are left out."""
    apex = np.argmin(cells, axis=1)
    found = [np.empty((0, 4), np.int32)]
    for corner in range(cells.shape[1]):
        own = cells[apex == corner]
        top = own[:, corner]
        for face in TRIANGLES[shape]:
            if corner not in face:
                found.append(np.column_stack((top, own[:, face])))
        for quad in QUADS[shape]:
            if corner not in quad:
                found += [np.column_stack((top, triangle)) for triangle in _cut(own[:, quad])]
    tets = np.concatenate(found)
    return tets[~repeats_a_corner(tets)]


def _cut(quads: Cells) -> tuple[Cells, Cells]:
    """The two triangles of each quad, cut from its lowest point."""
    even = (np.argmin(quads, axis=1) % 2 == 0)[:, None]
    first = np.where(even, quads[:, (0, 1, 2)], quads[:, (1, 2, 3)])
    second = np.where(even, quads[:, (0, 2, 3)], quads[:, (1, 3, 0)])
    return first, second


def _hang_together(hexes: Cells, seeds: npt.NDArray[np.bool_], keys: list[Keys]) -> npt.NDArray[np.bool_]:
    """(h,) True for the hexahedra that reach a seed, or a quad of `keys`, through shared quad faces."""
    if not len(hexes):
        return seeds
    split_anyway = len(hexes)  # one number past the hexahedra stands for all that is
    own = np.where(seeds, split_anyway, np.arange(len(hexes)))
    all_keys = np.concatenate([_quad_keys(hexes, "hex"), *keys])
    owner = np.full(len(all_keys), split_anyway)
    owner[: 6 * len(hexes)] = np.repeat(own, 6)
    order = np.argsort(all_keys)
    ordered = all_keys[order]
    same = ordered[1:] == ordered[:-1]
    labels = _components(len(hexes) + 1, owner[order[1:][same]], owner[order[:-1][same]])
    reached: npt.NDArray[np.bool_] = labels[:-1] == labels[-1]
    return seeds | reached


def _quad_keys(cells: Cells, shape: str) -> Keys:
    """(m * quads,) a number for each quad, the same in whatever order its corners are named.

    Two quads that met by chance (once in 2^64 pairs) would only have more hexahedra split than need be.
    """
    keys = mixed(cells)
    sums = [keys[:, a] + keys[:, b] + keys[:, c] + keys[:, d] for a, b, c, d in QUADS[shape]]
    return np.stack(sums, axis=1).ravel()


def mixed(numbers: npt.NDArray[Any]) -> Keys:
    """Scrambled point numbers: sums of four of them are as good as random."""
    keys = numbers.astype(np.uint64) + np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        keys ^= keys >> np.uint64(shift)
        keys *= np.uint64(factor)
    return keys ^ (keys >> np.uint64(31))


def _components(nodes: int, a: npt.NDArray[np.intp], b: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """(nodes,) labels, equal where a chain of pairs (a[i], b[i]) leads from one node to the other.

    A label is a node of its component. Every round hangs roots below lower ones and flattens the trees.
    """
    labels = np.arange(nodes)
    while True:
        low, high = np.minimum(labels[a], labels[b]), np.maximum(labels[a], labels[b])
        apart = low != high
        if not apart.any():
            return labels
        a, b = a[apart], b[apart]
        labels[high[apart]] = low[apart]
        while ((flatter := labels[labels]) != labels).any():
            labels = flatter
