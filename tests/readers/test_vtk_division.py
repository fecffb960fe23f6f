"""Curved cells are divided through all their nodes: space stays filled, faces meet, surfaces follow the curve."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from cell_shapes import volume_of_tets
from curved_cells import KINDS, box
from vtu_files import Mesh, write

from isocore import extract, measure
from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError
from isocore.readers import ReadOptions, read
from isocore.readers.options import MeshOptions
from isocore.readers.vtk_bases import basis
from isocore.readers.vtk_cells import CellArrays, blocks
from isocore.readers.vtk_division import divided
from isocore.readers.vtk_lattices import hex_nodes, tet_nodes, wedge_nodes

#: Straight cells that each kind becomes.
PARTS = {
    "tet10": 8, "hex20": 8, "wedge15": 8, "pyramid13": 10, "hex27": 8, "wedge12": 4, "wedge18": 8, "hex24": 8,
    "pyramid19": 28, "tet71-2": 8, "tet71-15": 24, "tet71-3": 27, "tet71-5": 125, "hex72-2": 8, "hex72-3": 27,
    "hex72-124": 8, "wedge73-2": 8, "wedge73-21": 24, "wedge73-4": 64, "wedge73-31": 9, "pyramid74-2": 10,
}  # fmt: skip
SIMULATION = Path(__file__).parents[3] / "shared" / "data" / "simulation"
CORNERS = ReadOptions(field="u", mesh=MeshOptions(corners=True))


def quadratic(p: np.ndarray) -> np.ndarray:
    x, y, z = p.T
    return x * x + 2 * y * y + 3 * z * z + x * y - y * z + 0.3 * x


def smooth(p: np.ndarray) -> np.ndarray:
    x, y, z = p.T
    return np.sin(2 * x + 0.3) * np.cos(1.5 * y) + np.exp(z * x) * 0.7 + z * z * y


def curved(points: np.ndarray) -> np.ndarray:
    """A box with bent sides."""
    x, y, z = points.T
    return np.stack((x + 0.1 * np.sin(2 * y + z), y + 0.08 * np.cos(2 * x), z + 0.1 * x * y), axis=1)


def file_of(tmp_path: Path, mesh: Mesh, field=quadratic) -> Path:
    fields = {"u": field(np.asarray(mesh.points))}
    path = write(tmp_path / "a.vtu", Mesh(mesh.points, mesh.cells, fields, mesh.cell_fields))
    path.write_text(path.read_text().replace('version="1.0" byte_order', 'version="2.2" byte_order'))
    return path


@pytest.mark.parametrize("name", KINDS)
def test_a_box_of_curved_cells_stays_filled_and_meets_face_to_face(name, tmp_path):
    """Every inner face has two cells, also where the middle of a side had to be computed by both."""
    mesh, form = box(name, 2)
    field = quadratic if min(form.degrees) > 1 else lambda points: points @ (1.0, 2.0, 3.0)
    read_back = read(file_of(tmp_path, mesh, field), ReadOptions(field="u"))
    assert sum(len(cells) for cells in form.cells.values()) + 4 * len(form.octahedra) == PARTS[name]
    triangles = Counter(tuple(sorted(np.delete(tet, n).tolist())) for tet in read_back.tets for n in range(4))
    sides = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    quads = Counter(tuple(sorted(hexa[list(side)].tolist())) for hexa in read_back.hexes for side in sides)
    for face, used in (triangles | quads).items():
        at = read_back.points[list(face)]
        outer = np.isclose(at, 0, atol=1e-9).all(axis=0) | np.isclose(at, 1, atol=1e-9).all(axis=0)
        assert used == (1 if outer.any() else 2), face
    volumes = volume_of_tets(read_back.points, read_back.tets)
    assert (volumes > 1e-9).all()
    hexahedra = len(read_back.hexes) * 0.125 / max(1, len(form.cells.get("hex", ())))
    assert volumes.sum() + hexahedra == pytest.approx(1)
    np.testing.assert_allclose(read_back.values, field(read_back.points), atol=1e-12)
    assert read_back.connectivity.divided_cells == len(mesh.cells) and read_back.warnings == ()


@pytest.mark.parametrize("name", [name for name in KINDS if "31" not in name and "12" not in name])
@pytest.mark.parametrize("backend", ["mc", "thinning"])
def test_the_surface_of_a_quadratic_field_passes_through_it_exactly(name, backend, tmp_path):
    """Every vertex lies on it, not only between the nodes: the field along an edge is known half way, too."""
    path = file_of(tmp_path, box(name, 2)[0])
    surface = extract(read(path, ReadOptions(field="u")), 1.7, backend=backend)
    assert measure(surface).triangles > 20 and measure(surface).nonmanifold_edges == 0
    between = np.abs(quadratic(surface.vertices.astype(float)) - 1.7)
    assert np.sort(between)[: int(0.95 * len(between))].max() < 2e-6
    assert between.max() < 6e-3  # a vertex keeps 2^-10 of an edge away from its ends


@pytest.mark.parametrize("name", ["tet10", "hex20", "hex27", "wedge15", "pyramid13", "tet71-3", "wedge73-21", "hex24"])
def test_vertices_converge_with_the_third_power_where_corners_give_the_second(name, tmp_path):
    """Four refinements of a box with bent sides, and a field that is no polynomial."""
    errors: dict[bool, list[float]] = {True: [], False: []}
    for n in (2, 4, 8, 16) if name != "tet71-3" else (2, 4, 8):
        mesh, _ = box(name, n, warp=curved)
        path = file_of(tmp_path, mesh, smooth)
        for corners, options in ((True, CORNERS), (False, ReadOptions(field="u"))):
            found = read(path, options)
            vertices = extract(CellMesh(found.points, found.tets, found.hexes, found.values, curved=found.curved), 1.3)
            at = np.asarray(vertices.vertices, float)
            errors[corners].append(float(np.sqrt(np.mean((smooth(at) - 1.3) ** 2))))
    divided_rate, corner_rate = (np.log2(errors[c][-2] / errors[c][-1]) for c in (False, True))
    assert divided_rate > 2.7 and 1.7 < corner_rate < 2.4, errors
    assert errors[False][-1] < errors[True][-1] / 10


def test_corners_alone_are_read_on_request(tmp_path):
    """As straight cells, with a warning."""
    mesh = read(file_of(tmp_path, box("hex27", 1)[0]), CORNERS)
    assert len(mesh.hexes) == 1 and mesh.curved == ()
    assert mesh.warnings == (
        "1 triquadratic hexahedra were reduced to their corners, as --corners asks; the values between the corners"
        " are not used",
    )


def test_nodes_that_fit_no_degree_leave_the_corners(tmp_path):
    """Eleven points are too many for a tetrahedron of degree two and too few for three."""
    points = np.random.default_rng(1).normal(size=(11, 3))
    mesh = read(write(tmp_path / "a.vtu", Mesh(points, [(71, list(range(11)))], {"u": points[:, 0]})))
    assert mesh.tets.tolist() == [[0, 1, 2, 3]]
    assert "since no degree has their number of points" in mesh.warnings[0]


def test_neighbours_of_different_kinds_share_the_middle_of_their_side(tmp_path):
    """One has it in the file, the other would compute it: it is one point."""
    mesh, _ = box("hex27", 2)
    cells = [(25, ids[:20]) if n % 2 else (29, ids) for n, (_, ids) in enumerate(mesh.cells)]
    cells[0] = (33, cells[0][1][:24])
    read_back = read(file_of(tmp_path, Mesh(mesh.points, cells)), ReadOptions(field="u"))
    used = np.unique(read_back.hexes)
    assert len(read_back.hexes) == 64 and len(used) == 125
    assert len(np.unique(np.round(read_back.points[used], 9), axis=0)) == 125


@pytest.mark.parametrize("number, shape, degree", [(78, "tet", 3), (79, "hex", 2), (80, "wedge", 2), (79, "hex", 3)])
@pytest.mark.parametrize("rational", [False, True])
def test_bezier_cells_are_evaluated_at_their_nodes(number, shape, degree, rational, tmp_path):
    """Control points that stand for a polynomial give its nodes; weights bend a line into a circle."""
    nodes = {"tet": tet_nodes, "hex": lambda n: hex_nodes(n, n, n), "wedge": lambda n: wedge_nodes(n, n)}[shape](degree)
    at = np.array(nodes) / degree
    lagrange = curved(at)
    weights = 1 + 0.5 * np.random.default_rng(2).random(len(at)) if rational else np.ones(len(at))
    matrix = basis(shape, (degree,) * 3, at)
    # Where (matrix @ (w c)) / (matrix @ w) is to be the node, w c solves a linear system.
    control = np.linalg.solve(matrix, lagrange * (matrix @ weights)[:, None]) / weights[:, None]
    values = np.linalg.solve(matrix, smooth(lagrange) * (matrix @ weights)) / weights
    fields = {"u": values} | ({"RationalWeights": weights} if rational else {})
    mesh = read(write(tmp_path / "a.vtu", Mesh(control, [(number, list(range(len(at))))], fields)))
    np.testing.assert_allclose(mesh.points[: len(at)], lagrange, atol=1e-12)
    np.testing.assert_allclose(mesh.values[: len(at)], smooth(lagrange), atol=1e-12)
    assert mesh.connectivity.divided_cells == 1 and mesh.field_name == "u"


def test_a_quarter_of_a_cylinder_is_a_rational_cell(tmp_path):
    """The textbook's weights: all nodes of the bent sides lie on circles."""
    radii = np.array([1.0, 1.5, 2.0])
    arc = np.array([(1, 0), (1, 1), (0, 1)])
    w = np.array([1, np.sqrt(0.5), 1])
    nodes = np.array(hex_nodes(2, 2, 2))
    control = np.column_stack((radii[nodes[:, 0], None] * arc[nodes[:, 1]], nodes[:, 2]))
    fields = {"u": control[:, 2], "RationalWeights": w[nodes[:, 1]]}
    mesh = read(write(tmp_path / "a.vtu", Mesh(control, [(79, list(range(27)))], fields)))
    np.testing.assert_allclose(np.hypot(*mesh.points[:, :2].T), radii[nodes[:, 0]], atol=1e-12)


def test_weights_that_add_up_to_nothing_are_refused(tmp_path):
    """There is no place for such a node."""
    nodes = np.array(hex_nodes(2, 2, 2), float)
    fields = {"u": nodes[:, 0], "RationalWeights": np.zeros(27)}
    with pytest.raises(FieldError, match="the weights of its Bezier hexahedra add up to nothing"):
        read(write(tmp_path / "a.vtu", Mesh(nodes, [(79, list(range(27)))], fields)))


def test_nodes_stand_in_the_order_of_vtk():
    """Written down from VTK 9.7 itself."""
    assert "".join(map(str, np.ravel(tet_nodes(4)[22:]))) == "101201102121112211011012021110120210111"
    assert "".join(map(str, np.ravel(hex_nodes(2, 3, 2)[8:]))) == (
        "100210220130010020102212222132012022001201231031011021211221101131110120112122111121"
    )
    assert "".join(map(str, np.ravel(wedge_nodes(3, 2)[6:]))) == (
        "100200210120020010102202212122022012001301031110112101201211121021011111"
    )


@pytest.mark.parametrize("version, swapped", [("1.0", True), ("2.1", False), ("2.2", False)])
def test_lagrange_hexahedra_of_older_files_have_two_edges_swapped(version, swapped, tmp_path):
    """VTK changed their order with version 2.1 of the format."""
    mesh, _ = box("hex72-2", 1)
    ids = mesh.cells[0][1]
    if swapped:
        ids = [*ids[:18], ids[19], ids[18], *ids[20:]]
    path = file_of(tmp_path, Mesh(mesh.points, [(72, ids)]))
    path.write_text(path.read_text().replace('version="2.2" byte_order', f'version="{version}" byte_order'))
    read_back = read(path, ReadOptions(field="u"))
    spans = np.ptp(read_back.points[read_back.hexes], axis=1)
    np.testing.assert_allclose(spans, 0.5)


def test_a_cell_of_a_very_high_degree_is_divided_without_its_curve():
    """Nine along each axis: its nodes are enough."""
    mesh, _ = box("hex72-2", 1)
    nodes = np.array(hex_nodes(9, 9, 9), float) / 9
    arrays = CellArrays.checked(
        "any.file", (np.array([72], np.uint8), np.array([len(nodes)]), np.arange(len(nodes)))
    )
    found = divided("any.file", blocks(arrays, {72: 1}, len(nodes)), nodes, nodes[:, 0])
    assert len(found.cells["hex"][0]) == 729 and found.curved == [] and len(mesh.cells) == 1


@pytest.mark.parametrize(
    "name, cells",
    [("QuadraticTetra", 768), ("QuadraticPyramid", 768), ("QuadraticWedge", 384), ("TriQuadraticHexahedron", 56)],
)
@pytest.mark.skipif(not SIMULATION.is_dir(), reason="the real data lies beside the repository, not in it")
def test_real_files_of_quadratic_cells_are_divided(name, cells):
    """Fields of theirs are exact between the nodes, too."""
    field = "material" if name.startswith("Tri") else "Polynomial"
    mesh = read(SIMULATION / f"{name}.vtu", ReadOptions(field=field))
    assert mesh.cells == cells
    if field == "Polynomial":
        assert measure(extract(mesh, 3.0)).triangles > 0
