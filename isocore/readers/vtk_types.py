"""The cell types of VTK's data model: which fill space, how many points they have, and what they are called."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Shape = Literal["tet", "hex", "wedge", "pyramid"]
CORNERS: dict[Shape, int] = {"tet": 4, "hex": 8, "wedge": 6, "pyramid": 5}


@dataclass(frozen=True, slots=True)
class Kind:
    """A cell type that fills space. nodes: how many points it has, 0 where that depends on its degree.

    order: where its corners stand in the file, if they are not its first points in VTK's order of a hexahedron.
    """

    name: str
    shape: Shape
    nodes: int
    order: tuple[int, ...] = ()

    @property
    def corners(self) -> int:
        """How many of its points are corners, which come first."""
        return CORNERS[self.shape]

    @property
    def straight(self) -> bool:
        return self.nodes == self.corners


SOLID = {
    10: Kind("tetrahedra", "tet", 4),
    11: Kind("voxels", "hex", 8, (0, 1, 3, 2, 4, 5, 7, 6)),
    12: Kind("hexahedra", "hex", 8),
    13: Kind("wedges", "wedge", 6),
    14: Kind("pyramids", "pyramid", 5),
    24: Kind("quadratic tetrahedra", "tet", 10),
    25: Kind("quadratic hexahedra", "hex", 20),
    26: Kind("quadratic wedges", "wedge", 15),
    27: Kind("quadratic pyramids", "pyramid", 13),
    29: Kind("triquadratic hexahedra", "hex", 27),
    31: Kind("quadratic-linear wedges", "wedge", 12),
    32: Kind("biquadratic wedges", "wedge", 18),
    33: Kind("biquadratic hexahedra", "hex", 24),
    37: Kind("triquadratic pyramids", "pyramid", 19),
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
#: Cells of any degree: a node more on every edge for each degree above the first, corners first.
HIGHER: dict[int, Kind] = {
    71: Kind("Lagrange tetrahedra", "tet", 0), 72: Kind("Lagrange hexahedra", "hex", 0),
    73: Kind("Lagrange wedges", "wedge", 0), 74: Kind("Lagrange pyramids", "pyramid", 0),
    78: Kind("Bezier tetrahedra", "tet", 0), 79: Kind("Bezier hexahedra", "hex", 0),
    80: Kind("Bezier wedges", "wedge", 0), 81: Kind("Bezier pyramids", "pyramid", 0),
}  # fmt: skip
#: Cells known by their faces, which vtk_faces.py finds.
FACETED = {15: "pentagonal prisms", 16: "hexagonal prisms", 41: "convex point sets", 42: "polyhedra"}
REFUSED = {
    55: "parametric tetrahedra", 56: "parametric hexahedra", 64: "higher-order tetrahedra",
    65: "higher-order wedges", 66: "higher-order pyramids", 67: "higher-order hexahedra",
}  # fmt: skip
#: All types that are read or left out, by name.
NAMES = {number: kind.name for number, kind in (SOLID | HIGHER).items()} | FACETED | FLAT
