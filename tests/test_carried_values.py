"""Surfaces carry other fields: the values at their vertices, along the edge that each of them lies on."""

from __future__ import annotations

import numpy as np
import pytest
from cell_shapes import block
from curved_cells import KINDS, box
from vtu_files import Mesh, write

import isocore
from isocore import Volume
from isocore.carried import CarriedField
from isocore.errors import FieldError, OptionError
from isocore.readers import ReadOptions, read

SLOPE, START = np.array([1.5, -2.25, 0.75]), 3.0
AFFINE = np.array([[0.7, 0.1, 0, -31], [0, -0.9, 0.2, 10], [0.05, 0, 1.3, 100], [0, 0, 0, 1.0]])
N = 20


def linear(places):
    """A field that is linear in space."""
    return np.asarray(places, np.float64) @ SLOPE + START


def ball(**kwargs) -> tuple[Volume, np.ndarray]:
    """A volume, -distance from its middle, and where its samples lie, (n, n, n, 3)."""
    index = np.stack(np.meshgrid(*[np.arange(N)] * 3, indexing="ij"), axis=-1)
    samples = -np.linalg.norm(index - [9.3, 9.7, 10.1], axis=-1)
    volume = Volume.from_array(np.asfortranarray(samples.astype(np.float32)), affine=AFFINE, **kwargs)
    return volume, index @ AFFINE[:3, :3].T + AFFINE[:3, 3]


ASKED = (
    {"backend": "mc"}, {"backend": "asc"}, {"backend": "thinning"}, {"backend": "mc", "cap": True},
    {"backend": "mc", "smooth": 10}, {"backend": "mc", "topology": "trilinear"}, {"triangles": 100},
    {"backend": "mc", "simplify": True, "max_error": 0.3}, {"keep_largest": 1},
)  # fmt: skip


@pytest.mark.parametrize("isovalue", [-6.0, -11.0])
@pytest.mark.parametrize("asked", ASKED, ids=str)
def test_a_linear_field_of_a_volume_is_exact_at_every_vertex(asked, isovalue):
    """Whatever was done to the vertices: coarser, capped, smoothed, fewer pieces; scalars and vectors."""
    volume, places = ball()
    surface = isocore.extract(volume, isovalue, carry={"heat": linear(places), "place": places}, **asked)
    assert len(surface.vertices) > 20
    assert surface.fields["heat"].dtype == surface.fields["place"].dtype == np.float64
    np.testing.assert_allclose(surface.fields["heat"], linear(surface.vertices), rtol=0, atol=5e-5)
    np.testing.assert_allclose(surface.fields["place"], surface.vertices, rtol=0, atol=2e-5)


def test_stored_numbers_are_scaled():
    """As slope and intercept of the carried volume say; 16 bits give float32."""
    volume, places = ball()
    stored = np.asfortranarray(np.round(100 * linear(places)).astype(np.int16))
    other = Volume(stored, slope=0.01, intercept=2.0, affine=AFFINE)
    heat = isocore.extract(volume, -6, backend="mc", carry={"heat": other}).fields["heat"]
    surface = isocore.extract(volume, -6, backend="mc")
    assert heat.dtype == np.float32
    np.testing.assert_allclose(heat, linear(surface.vertices) + 2, rtol=0, atol=0.006)


def test_what_is_not_finite_has_no_say_where_another_end_has_a_value():
    """Fields often end where the surface is: the value at the end of the edge that has one."""
    volume, _ = ball()
    heat = np.where(volume.samples >= -6, 7.0, np.nan)
    found = isocore.extract(volume, -6, backend="mc", carry={"heat": heat}).fields["heat"]
    np.testing.assert_array_equal(found, 7.0)
    nothing = isocore.extract(volume, -6, backend="mc", carry={"heat": np.full((N, N, N), np.nan)}).fields["heat"]
    assert np.isnan(nothing).all()


@pytest.mark.parametrize("backend", ["mc", "thinning"])
@pytest.mark.parametrize("kind", ["hex8", "wedge6", "mixed", *KINDS])
def test_fields_of_a_mesh_are_exact_and_cells_are_those_of_the_vertex(tmp_path, kind, backend):
    """A linear field of the points, also along curved edges; and a cell's field is that of a cell around the vertex."""
    if kind in KINDS:
        mesh, _ = box(kind, 3)
    else:
        letters = {"hex8": "h", "wedge6": "/", "mixed": ""}[kind]
        shape = np.full((3, 3, 3), letters or "h")
        if kind == "mixed":
            shape[0], shape[1, 1] = "/", "p"
        points, cells = block(shape)
        mesh = Mesh(points / 3, cells)
    places = np.asarray(mesh.points, np.float64)
    corners = [places[list(ids)] for _, ids in mesh.cells]
    boxes = np.array([[*nodes.min(axis=0), *nodes.max(axis=0)] for nodes in corners])
    fields = {"r": (places**2).sum(axis=1), "heat": linear(places), "place": places}
    path = write(tmp_path / "a.vtu", Mesh(mesh.points, mesh.cells, fields, {**mesh.cell_fields, "box": boxes}))
    field = read(path, ReadOptions(field="r", carry=("heat", "place", "box")))
    for isovalue in (0.7, 1.6):
        surface = isocore.extract(field, isovalue, backend=backend, normals=True)
        assert len(surface.vertices) > 20
        assert list(surface.fields) == ["heat", "place", "box"]
        np.testing.assert_allclose(surface.fields["heat"], linear(surface.vertices), rtol=0, atol=2e-6)
        np.testing.assert_allclose(surface.fields["place"], surface.vertices, rtol=0, atol=2e-7)
        around = surface.fields["box"]
        if not kind.startswith("hex72"):  # whose nodes the test's file lists in the older order
            assert (around[:, :3] <= surface.vertices + 1e-6).all()
            assert (around[:, 3:] >= surface.vertices - 1e-6).all()


def test_a_vertex_amid_a_hexahedron_has_the_value_of_that_one(tmp_path):
    """Not of the neighbour that a vertex of its loop may belong to."""
    points, cells = block(np.full((12, 12, 12), "h"))
    random = np.random.default_rng(5)
    boxes = np.array([[*points[ids].min(axis=0), *points[ids].max(axis=0)] for _, ids in cells])
    mesh = Mesh(points, cells, {"noise": random.random(len(points)), "heat": linear(points)}, {"box": boxes})
    field = read(write(tmp_path / "a.vtu", mesh), ReadOptions(field="noise", carry=("all",)))
    surface = isocore.extract(field, 0.5, backend="mc")
    inside = (np.abs(surface.vertices - np.round(surface.vertices)) > 1e-4).all(axis=1)
    assert inside.sum() > 5
    around = surface.fields["box"]
    assert (around[:, :3] <= surface.vertices + 1e-6).all()
    assert (around[:, 3:] >= surface.vertices - 1e-6).all()
    np.testing.assert_allclose(surface.fields["heat"], linear(surface.vertices), rtol=0, atol=1e-5)


@pytest.mark.parametrize("kind", ["tet10", "hex27", "hex72-2", "wedge15"])
def test_simplification_keeps_each_vertex_and_its_values(tmp_path, kind):
    """Bit for bit, also beside vertices amid a loop, and with normals."""
    mesh, _ = box(kind, 4)
    places = np.asarray(mesh.points)
    fields = {"r": (places**2).sum(axis=1), "heat": np.sin(9 * places).sum(axis=1)}
    path = write(tmp_path / "a.vtu", Mesh(mesh.points, mesh.cells, fields, mesh.cell_fields))
    field = read(path, ReadOptions(field="r", carry=("heat",)))
    whole = isocore.extract(field, 0.8, backend="mc")
    known = dict(zip(map(bytes, whole.vertices), whole.fields["heat"].tolist(), strict=True))
    fewer = isocore.extract(field, 0.8, backend="mc", simplify=True, max_error=0.02, normals=True)
    assert 0 < len(fewer.vertices) < len(whole.vertices)
    assert [known[bytes(vertex)] for vertex in fewer.vertices] == fewer.fields["heat"].tolist()


def test_pieces_that_stay_keep_their_values():
    """The second of two, so that those of the first go."""
    index = np.stack(np.meshgrid(*[np.arange(N)] * 3, indexing="ij"), axis=-1)
    small, large = (np.linalg.norm(index - middle, axis=-1) for middle in ([4, 4, 4], [12, 12, 12]))
    samples = np.asfortranarray(-np.minimum(small / 2, large / 6))
    volume = Volume.from_array(samples, affine=AFFINE)
    heat = linear(index @ AFFINE[:3, :3].T + AFFINE[:3, 3])
    surface = isocore.extract(volume, -1, backend="mc", keep_largest=1, carry={"heat": heat})
    whole = isocore.extract(volume, -1, backend="mc")
    assert 0 < len(surface.vertices) < len(whole.vertices)
    np.testing.assert_allclose(surface.fields["heat"], linear(surface.vertices), rtol=0, atol=5e-5)


def test_the_contoured_field_carried_along_is_the_isovalue():
    """The values know of the same parameter as the place."""
    volume, _ = ball()
    found = isocore.extract(volume, -6, backend="mc", carry={"own": volume}).fields["own"]
    np.testing.assert_allclose(found, -6, rtol=1e-5)


def test_carry_chooses_among_what_a_field_carries():
    """By name; a name that is not there is answered with those that are."""
    volume, places = ball()
    fields = tuple(CarriedField(name, linear(places).reshape(-1, order="F")) for name in ("a", "b"))
    rich = isocore.Volume(volume.samples, affine=AFFINE, carried=fields)
    assert list(isocore.extract(rich, -6).fields) == ["a", "b"]
    assert list(isocore.extract(rich, -6, carry="b").fields) == ["b"]
    assert list(isocore.extract(rich, -6, carry=()).fields) == []
    with pytest.raises(OptionError, match="no field 'c'; the field that is contoured carries a, b"):
        isocore.extract(rich, -6, carry=["c"])


def test_what_does_not_fit_is_refused():
    """Arrays of another shape, volumes of another grid, fields of too few values."""
    volume, _ = ball()
    with pytest.raises(OptionError, match="carry: 'heat' is no array of 20 x 20 x 20 real numbers"):
        isocore.extract(volume, -6, carry={"heat": np.zeros((20, 20, 19))})
    with pytest.raises(OptionError, match="carry: 'heat' lies on another grid"):
        isocore.extract(volume, -6, carry={"heat": Volume.from_array(np.zeros((N, N, N)))})
    with pytest.raises(FieldError, match="heat: holds 3 values for 8,000 points"):
        isocore.Volume(volume.samples, carried=(CarriedField("heat", np.zeros(3)),))


def test_fields_reach_other_libraries():
    """As point data, or attributes of vertices; what is handed out may be changed."""
    volume, places = ball()
    surface = isocore.extract(volume, -6, carry={"heat": linear(places)})
    data = surface.to_meshio().point_data["heat"]
    np.testing.assert_array_equal(data, surface.fields["heat"])
    data[:] = 0
    mesh = pytest.importorskip("trimesh") and surface.to_trimesh()
    np.testing.assert_array_equal(mesh.vertex_attributes["heat"], surface.fields["heat"])
