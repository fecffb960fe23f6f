"""Where the nodes of a curved cell lie: points of a lattice, in VTK's order, and the straight cells between them.

A node is three integers: steps along the axes of a hexahedron, the last one up for wedges and pyramids; for triangles
and tetrahedra steps from corner 0 towards the other corners.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise, product

Node = tuple[int, int, int]
Cells = list[tuple[Node, ...]]


def hex_nodes(p: int, q: int, r: int, *, old: bool = False) -> list[Node]:
    """Nodes of a hexahedron of these degrees. old: before version 2.1 of VTK's files two upright edges were swapped."""
    x, y, z = range(1, p), range(1, q), range(1, r)
    found = [(i * p, j * q, k * r) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    for k in (0, r):
        found += [(i, 0, k) for i in x] + [(p, j, k) for j in y] + [(i, q, k) for i in x] + [(0, j, k) for j in y]
    upright = ((0, 0), (p, 0), (0, q), (p, q)) if old else ((0, 0), (p, 0), (p, q), (0, q))
    found += [(i, j, k) for i, j in upright for k in z]
    found += [(i, j, k) for i in (0, p) for k in z for j in y]
    found += [(i, j, k) for j in (0, q) for k in z for i in x]
    found += [(i, j, k) for k in (0, r) for j in y for i in x]
    return found + [(i, j, k) for k in z for j in y for i in x]


def wedge_nodes(n: int, m: int) -> list[Node]:
    """Nodes of a wedge of degree n in its triangles and m between them."""
    steps, z = range(1, n), range(1, m)
    sides = ([(i, 0) for i in steps], [(n - i, i) for i in steps], [(0, n - i) for i in steps])
    inner = [(i, j) for j in steps for i in range(1, n - j)]
    corners = ((0, 0), (n, 0), (0, n))
    found = [(i, j, k) for k in (0, m) for i, j in corners]
    found += [(i, j, k) for k in (0, m) for side in sides for i, j in side]
    found += [(i, j, k) for i, j in corners for k in z]
    found += [(i, j, k) for k in (0, m) for i, j in inner]
    found += [(i, j, k) for side in sides for k in z for i, j in side]
    return found + [(i, j, k) for k in z for i, j in inner]


def tet_nodes(n: int) -> list[Node]:
    """Nodes of a tetrahedron of degree n: corners, edges, faces and what is inside, which is a tetrahedron again."""
    return [(b, c, d) for _, b, c, d in _tet(n)]


def pyramid_nodes(n: int) -> list[Node]:
    """Nodes of a pyramid of degree 1 or 2, the middle of the base last."""
    corners = [(0, 0, 0), (n, 0, 0), (n, n, 0), (0, n, 0), (0, 0, n)]
    if n == 1:
        return corners
    return [*corners, (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (1, 1, 0)]


def _tet(n: int) -> list[tuple[int, int, int, int]]:
    """Steps from all four corners' opposite faces: the weights of the corners, whose sum is n."""
    if n <= 0:
        return [(0, 0, 0, 0)] * (n == 0)
    found = [_weights({corner: n}) for corner in range(4)]
    for a, b in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)):
        # The third edge runs from corner 2 to corner 0.
        start, end = (b, a) if (a, b) == (0, 2) else (a, b)
        found += [_weights({start: n - step, end: step}) for step in range(1, n)]
    for corners in ((0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)):
        found += [
            _weights({corner: weight + 1 for corner, weight in zip(corners, inner, strict=True)})
            for inner in _triangle(n - 3)
        ]
    inside = [(a + 1, b + 1, c + 1, d + 1) for a, b, c, d in _tet(n - 4)]
    return found + inside


def _triangle(n: int) -> list[tuple[int, int, int]]:
    if n <= 0:
        return [(0, 0, 0)] * (n == 0)
    steps = range(1, n)
    found = [(n, 0, 0), (0, n, 0), (0, 0, n)]
    found += [(n - s, s, 0) for s in steps] + [(0, n - s, s) for s in steps] + [(s, 0, n - s) for s in steps]
    return found + [(a + 1, b + 1, c + 1) for a, b, c in _triangle(n - 3)]


def _weights(of: dict[int, int]) -> tuple[int, int, int, int]:
    return of.get(0, 0), of.get(1, 0), of.get(2, 0), of.get(3, 0)


def hex_cells(p: int, q: int, r: int) -> Cells:
    """The hexahedra of the lattice."""
    return [
        tuple((i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)))
        for k, j, i in product(range(r), range(q), range(p))
    ]


def wedge_cells(n: int, m: int) -> Cells:
    """The wedges of the lattice: n * n triangles, m times."""
    upright = [((i, j), (i + 1, j), (i, j + 1)) for j in range(n) for i in range(n - j)]
    turned = [((i + 1, j), (i + 1, j + 1), (i, j + 1)) for j in range(n) for i in range(n - j - 1)]
    return [
        tuple((i, j, k + up) for up in (0, 1) for i, j in triangle) for k in range(m) for triangle in upright + turned
    ]


def tet_cells(n: int) -> tuple[Cells, Cells]:
    """The tetrahedra of the lattice, and its octahedra, opposite corners one after the other.

    Each face of the cell is cut into n * n triangles, so neighbours agree.
    """
    tets: Cells = []
    octahedra: Cells = []
    for i, j, k in product(range(n), repeat=3):
        x, y, z = (i + 1, j, k), (i, j + 1, k), (i, j, k + 1)
        xy, xz, yz = (i + 1, j + 1, k), (i + 1, j, k + 1), (i, j + 1, k + 1)
        if i + j + k < n:
            tets.append(((i, j, k), x, y, z))
        if i + j + k < n - 1:
            octahedra.append((x, yz, y, xz, z, xy))
        if i + j + k < n - 2:
            tets.append((xy, xz, yz, (i + 1, j + 1, k + 1)))
    return tets, octahedra


def pyramid_cells(n: int) -> tuple[Cells, Cells]:
    """The pyramids of the lattice, whose layers shrink upward, and the tetrahedra between them."""
    pyramids: Cells = []
    tets: Cells = []

    def square(i: int, j: int, k: int) -> tuple[Node, ...]:
        return (i, j, k), (i + 1, j, k), (i + 1, j + 1, k), (i, j + 1, k)

    for k in range(n):
        m = n - k
        pyramids += [(*square(i, j, k), (i, j, k + 1)) for j in range(m) for i in range(m)]
        pyramids += [(*square(i, j, k + 1), (i + 1, j + 1, k)) for j in range(m - 1) for i in range(m - 1)]
        for a in range(m - 1):
            for b in range(m):
                tets.append(((a + 1, b, k), (a + 1, b + 1, k), (a, b, k + 1), (a + 1, b, k + 1)))
                tets.append(((b, a + 1, k), (b + 1, a + 1, k), (b, a, k + 1), (b, a + 1, k + 1)))
    return pyramids, tets


def ring(corners: Iterable[int], edges: dict[tuple[int, int], int]) -> list[tuple[int, int]]:
    """The sides of a face through the middles of its edges, each as two nodes in turn."""
    turn = list(corners)
    nodes: list[int] = []
    for a, b in pairwise([*turn, turn[0]]):
        nodes += [a, edges[min(a, b), max(a, b)]]
    return list(pairwise([*nodes, nodes[0]]))
