"""What thinning claims, checked the slow way: gluing by union-find, homology by rank over Z2, triangles as sets."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh

HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
HEX_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TET_EDGES = list(combinations(range(4), 2))
TET_FACES = list(combinations(range(4), 3))


def triangle_set(
    vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int32]
) -> Counter[tuple[tuple[float, ...], ...]]:
    """The triangles by their corners' coordinates, each turned so that its least corner comes first."""
    corners = vertices[triangles].tolist()
    turned: Counter[tuple[tuple[float, ...], ...]] = Counter()
    for triangle in corners:
        a, b, c = (tuple(corner) for corner in triangle)
        turned[min((a, b, c), (b, c, a), (c, a, b))] += 1
    return turned


class Glued:
    """A mesh of one kind of cell, glued along the faces that exactly two cells share, and at its points.

    simplices[d][cell]: the numbers of a cell's vertices (d = 0), edges (1) and faces (2) in the glued mesh.
    boundary[d][n]: the (d - 1)-dimensional elements around element n, for d = 1, 2.
    """

    def __init__(self, mesh: CellMesh) -> None:
        self.cells = (mesh.tets if len(mesh.tets) else mesh.hexes).tolist()
        tets = len(mesh.tets) > 0
        edges, faces = (TET_EDGES, TET_FACES) if tets else (HEX_EDGES, HEX_FACES)
        self.parent: dict[tuple[int, frozenset[int]], tuple[int, frozenset[int]]] = {}
        owners: dict[frozenset[int], list[int]] = {}
        for number, cell in enumerate(self.cells):
            for face in faces:
                owners.setdefault(frozenset(cell[n] for n in face), []).append(number)
        for points, cells in owners.items():
            if len(cells) == 2:
                inside = [
                    frozenset(self.cells[cells[0]][n] for n in part)
                    for part in [*[(n,) for n in range(len(self.cells[0]))], *edges, *faces]
                ]
                for part in inside:
                    if part <= points:
                        self._unite((cells[0], part), (cells[1], part))
        numbers: list[dict[tuple[int, frozenset[int]], int]] = [{}, {}, {}]
        self.simplices: list[list[set[int]]] = [[], [], []]
        self.boundary: list[dict[int, set[int]]] = [{}, {}, {}]
        self.vertices: list[list[int]] = []  # of every cell, in the order of its corners
        for number, cell in enumerate(self.cells):
            parts = [[frozenset([p]) for p in cell]]
            parts += [[frozenset(cell[n] for n in part) for part in kind] for kind in (edges, faces)]
            for d, kind in enumerate(parts):
                named = []
                for part in kind:
                    root = self._named(number, part)
                    named.append(numbers[d].setdefault(root, len(numbers[d])))
                self.simplices[d].append(set(named))
                if d == 0:
                    self.vertices.append(named)
                for part, name in zip(kind, named, strict=True) if d else ():
                    lower = [p for p in parts[d - 1] if p < part]
                    self.boundary[d][name] = {numbers[d - 1][self._named(number, p)] for p in lower}

    def _named(self, cell: int, part: frozenset[int]) -> tuple[int, frozenset[int]]:
        """A point is one vertex, whichever cells meet there; edges and faces are those that gluing makes one."""
        return (-1, part) if len(part) == 1 else self._find((cell, part))

    def _find(self, item: tuple[int, frozenset[int]]) -> tuple[int, frozenset[int]]:
        while item in self.parent:
            item = self.parent[item]
        return item

    def _unite(self, a: tuple[int, frozenset[int]], b: tuple[int, frozenset[int]]) -> None:
        a, b = self._find(a), self._find(b)
        if a != b:
            self.parent[b] = a

    def touched(self, cells: list[int]) -> list[set[int]]:
        """Vertices, edges and faces of some cells."""
        return [set().union(*(kind[cell] for cell in cells)) for kind in self.simplices]

    def components(self, cells: list[int]) -> list[set[int]]:
        """The vertex sets of the connected components of some closed cells."""
        found: list[set[int]] = []
        for cell in cells:
            merged = set(self.simplices[0][cell])
            apart = []
            for component in found:
                if component & merged:
                    merged |= component
                else:
                    apart.append(component)
            found = [*apart, merged]
        return found

    def lost_loops(self, kept: list[int]) -> int:
        """Dimension of H1(M, S; Z2): 0 iff the kept cells S carry every loop of M and join no two components."""
        inside = self.touched(kept)
        ranks = []
        for d in (1, 2):
            rows = [
                sum(1 << n for n in below - inside[d - 1])
                for name, below in self.boundary[d].items()
                if name not in inside[d]
            ]
            ranks.append(_rank(rows))
        free_edges = sum(name not in inside[1] for name in self.boundary[1])
        return free_edges - ranks[0] - ranks[1]


def _rank(rows: list[int]) -> int:
    """Over Z2; a row is a bit mask."""
    pivots: dict[int, int] = {}
    for row in rows:
        while row:
            top = row.bit_length()
            if top not in pivots:
                pivots[top] = row
                break
            row ^= pivots[top]
    return len(pivots)
