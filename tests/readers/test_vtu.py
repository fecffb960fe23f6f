"""Whatever the encoding, a VTU file gives the mesh that was written into it."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from cell_shapes import block
from vtu_files import Encoding, Mesh, every_encoding, write

from isocore.errors import InputError
from isocore.readers import ReadOptions, read
from isocore.readers.options import MeshOptions
from isocore.readers.vtu import read_vtu, vtu_fields

TET = Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(10, [0, 1, 2, 3])])


def mixed() -> Mesh:
    """Every shape, values that use all their bits, and a second field to pass over."""
    points, cells = block(np.array([["/", "p"], ["h", "\\"]])[:, :, None].repeat(2, axis=2))
    cells.insert(3, (10, [0, 1, 3, 9]))
    values = np.sin(np.arange(len(points)) + 0.5)
    mesh = Mesh(points + 0.1, cells, {"other": np.arange(len(points), dtype=np.int16), "f": values})
    return Mesh(mesh.points, cells, mesh.point_fields, {"part": np.arange(len(cells), dtype=np.int32)})


def read_field(path: Path, name: str = "f", component: str | None = None):
    return read_vtu(path, ReadOptions(field=name, component=component))


def assert_same(mesh, other):
    for name in ("points", "tets", "hexes", "values"):
        ours, theirs = getattr(mesh, name), getattr(other, name)
        assert ours.dtype == theirs.dtype
        np.testing.assert_array_equal(ours, theirs, err_msg=name)
    assert (mesh.cell_counts, mesh.warnings) == (other.cell_counts, other.warnings)


@pytest.mark.parametrize("encoding", every_encoding(), ids=str)
def test_every_encoding_holds_the_same_mesh(encoding, tmp_path):
    """Ascii is the plainest; all others must say the same to the last bit."""
    expected = read_field(write(tmp_path / "ascii.vtu", mixed()))
    assert_same(read_field(write(tmp_path / "other.vtu", mixed(), encoding)), expected)
    np.testing.assert_array_equal(expected.points, mixed().points)
    np.testing.assert_array_equal(expected.values, mixed().point_fields["f"])


@pytest.mark.parametrize("encoding", [e for e in every_encoding() if not (e.joint and e.compressor)], ids=str)
def test_meshio_reads_what_the_test_writer_writes(encoding, tmp_path):
    """Our writer is not only understood by our reader."""
    path = write(tmp_path / "mesh.vtu", TET.with_field("f", np.arange(4.0)), encoding)
    theirs = meshio.vtu.read(path)
    np.testing.assert_array_equal(theirs.points, TET.points)
    np.testing.assert_array_equal(theirs.point_data["f"].ravel(), np.arange(4.0))


@pytest.mark.parametrize(
    "integers", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"]
)
def test_connectivity_may_be_of_any_integer_type(integers, tmp_path):
    """Some programs write UInt64 corners and Int64 types."""
    expected = read_field(write(tmp_path / "a.vtu", mixed()))
    path = write(
        tmp_path / "b.vtu",
        mixed(),
        Encoding("appended", byte_order="BigEndian"),
        connectivity=integers,
        offsets="int32" if integers == "int8" else integers.replace("int8", "int16"),
        types=integers,
    )
    assert_same(read_field(path), expected)


def test_float32_points_become_float64(tmp_path):
    """Nine digits or not, the kernels see float64."""
    path = write(tmp_path / "a.vtu", TET.with_field("f", np.ones(4, np.float32)), points="float32")
    mesh = read_field(path)
    assert mesh.points.dtype == np.float64 and mesh.values.dtype == np.float32


@pytest.mark.parametrize("number, points", [(10, 4), (11, 8), (12, 8), (13, 6), (14, 5), (71, 4), (72, 8), (73, 6)])
def test_every_straight_cell_is_read(number, points, tmp_path):
    """A voxel's corners are put in a hexahedron's order; wedges and pyramids become tetrahedra."""
    places = np.random.default_rng(0).normal(size=(points, 3))
    path = write(tmp_path / "a.vtu", Mesh(places, [(number, list(range(points)))], {"f": places[:, 0]}))
    mesh = read_field(path)
    cells = {8: mesh.hexes, 4: mesh.tets}.get(points, mesh.tets)
    expected = {11: [0, 1, 3, 2, 4, 5, 7, 6]}.get(number, list(range(points)))
    if points in (4, 8):
        assert cells.tolist() == [expected]
    else:
        assert len(cells) == (2 if points == 5 else 3)
    assert mesh.warnings == ()


def test_surface_cells_beside_solid_ones_are_left_out_with_a_warning(tmp_path):
    """Boundary triangles are common in files from mesh generators."""
    mesh = Mesh(TET.points, [(5, [0, 1, 2]), *TET.cells, (5, [1, 2, 3]), (3, [0, 1])], {"f": np.arange(4.0)})
    read_back = read_field(write(tmp_path / "a.vtu", mesh))
    assert read_back.tets.tolist() == [[0, 1, 2, 3]]
    assert read_back.cell_counts == {"lines": 1, "triangles": 2, "tetrahedra": 1}
    assert "2 triangles enclose nothing" in " ".join(read_back.warnings)


def test_pieces_become_one_mesh(tmp_path):
    """Point numbers of the second piece follow those of the first; an empty piece adds nothing."""
    one = TET.with_field("f", np.arange(4.0))
    two = Mesh(
        np.add(TET.points, 2), [(12, [0, 1, 2, 3, 3, 2, 1, 0]), *TET.cells], {"f": np.arange(4.0) + 10}
    )
    path = write(
        tmp_path / "a.vtu", [one, Mesh(np.empty((0, 3)), [], {"f": np.empty(0)}), two], Encoding("binary")
    )
    mesh = read_field(path)
    assert mesh.tets.tolist() == [[0, 1, 2, 3], [4, 5, 6, 7]]
    np.testing.assert_array_equal(mesh.values, [0, 1, 2, 3, 10, 11, 12, 13])
    apart = read_vtu(path, ReadOptions(field="f", mesh=MeshOptions(keep_duplicates=True)))
    assert "the points of 2 pieces were not joined" in " ".join(apart.warnings)


def test_white_space_inside_base64_is_passed_over(tmp_path):
    """Some writers break the lines."""
    path = write(tmp_path / "a.vtu", mixed(), Encoding("binary", compressor="zlib"))
    expected = read_field(path)
    text = path.read_bytes()
    first = text.index(b'Name="f"')
    start = text.index(b">", first) + 20
    path.write_bytes(text[:start] + b"\n\t  " + text[start:])
    assert_same(read_field(path), expected)


UNUSUAL = {
    "utf-16": lambda text: text.replace(
        '<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>'
    ).encode("utf-16"),
    "cdata": lambda text: (
        text.replace(">\n  ", "><![CDATA[", 1).replace("\n</DataArray>", "]]></DataArray>", 1).encode()
    ),
    "doctype": lambda text: text.replace("<VTKFile", "<!DOCTYPE VTKFile>\n<VTKFile", 1).encode(),
    "comment": lambda text: text.replace(" 0.", "<!-- here --> 0.", 2).encode(),
}


@pytest.mark.parametrize("change", UNUSUAL)
def test_unusual_xml_gives_the_same_mesh(change, tmp_path):
    """XML that our scan of the tags does not follow is written plainly first."""
    mesh = Mesh(mixed().points, mixed().cells, {"f": mixed().point_fields["f"]}, mixed().cell_fields)
    path = write(tmp_path / "a.vtu", mesh)
    expected = read_field(path), read_field(path, "part")
    path.write_bytes(UNUSUAL[change](path.read_text()))
    for ours, theirs in zip((read_field(path), read_field(path, "part")), expected, strict=True):
        assert_same(ours, theirs)


def test_unusual_xml_may_have_several_pieces(tmp_path):
    """Two at one place become one."""
    mesh = TET.with_field("f", np.arange(4.0))
    path = write(tmp_path / "a.vtu", [mesh, mesh])
    path.write_bytes(UNUSUAL["doctype"](path.read_text()))
    assert len(read_field(path).points) == 4 and len(read_field(path).tets) == 1


def test_unusual_xml_that_is_broken_is_refused(tmp_path):
    """With the line where it breaks."""
    path = write(tmp_path / "a.vtu", TET.with_field("f", np.arange(4.0)))
    path.write_bytes(UNUSUAL["utf-16"](path.read_text())[:-30])
    with pytest.raises(InputError, match="its XML is broken near line"):
        read_field(path)


def test_comments_and_quotes_do_not_confuse_the_scan(tmp_path):
    """A comment may hold tags, an attribute a closing bracket, a name an entity."""
    path = write(tmp_path / "a.vtu", TET.with_field("f", np.arange(4.0)))
    text = path.read_text().replace(
        "<UnstructuredGrid>", "<!-- <Piece> > -->\n<UnstructuredGrid note='a \"> b'>"
    )
    path.write_text(text.replace('Name="f"', 'Name="p &lt; 1"'))
    assert [field.name for field in vtu_fields(path)] == ["p < 1"]
    assert read(path).field_name == "p < 1"


def test_the_fields_are_listed_without_reading_them(tmp_path):
    """`info` and messages show names and components, also where the numbers are damaged."""
    mesh = TET.with_field("f", np.arange(4.0)).with_field("v", np.zeros((4, 3), np.float32))
    path = write(tmp_path / "a.vtu", Mesh(mesh.points, mesh.cells, mesh.point_fields, {"part": np.arange(1)}))
    path.write_bytes(path.read_bytes().replace(b"0.0 1.0", b"oops"))
    assert [(field.name, field.components, field.of) for field in vtu_fields(path)] == [
        ("f", 1, "points"),
        ("v", 3, "points"),
        ("part", 1, "cells"),
    ]


def test_the_file_is_free_again_when_it_has_been_read(tmp_path):
    """The mesh owns its memory: changing the file afterwards changes nothing."""
    path = write(tmp_path / "a.vtu", mixed(), Encoding("appended"))
    mesh = read_field(path)
    before = mesh.points.copy(), mesh.values.copy(), mesh.tets.copy()
    with path.open("r+b") as file:
        file.write(b"\0" * path.stat().st_size)
    for kept, now in zip(before, (mesh.points, mesh.values, mesh.tets), strict=True):
        np.testing.assert_array_equal(kept, now)
