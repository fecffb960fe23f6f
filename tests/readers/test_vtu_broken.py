"""A VTU file that is not what it says is refused in one line that starts with its path."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest
from cell_shapes import block
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from vtu_files import Encoding, Mesh, every_encoding, write

from isocore.errors import FieldError, InputError, IsocoreError
from isocore.readers import ReadOptions, read

POINTS, CELLS = block(np.array(["h", "p", "/"])[:, None, None])
GOOD = Mesh(POINTS, CELLS, {"f": np.linspace(0, 1, len(POINTS))})
RAW = Encoding("appended", header="UInt64")
ZLIB = Encoding("appended", compressor="zlib", header="UInt64")
INLINE = Encoding("binary")


def refusal(path, kind=InputError) -> str:
    """The message, checked to be one line with the path first, without what only a programmer understands."""
    with pytest.raises(kind) as caught:
        read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert not any(word in message for word in ("Traceback", "object", "Error", "buffer", "None"))
    return message


def changed(tmp_path, old: str, new: str, encoding: Encoding = Encoding()) -> str:  # noqa: B008
    path = write(tmp_path / "a.vtu", GOOD, encoding)
    text = path.read_bytes()
    assert old.encode() in text
    path.write_bytes(text.replace(old.encode(), new.encode()))
    return refusal(path)


@pytest.mark.parametrize(
    "content, message",
    [
        (b"", "is empty"),
        (b"hello, no tags here", "is not XML"),
        (b"<html><body/></html>", "is a web page"),
        (b'<VTKFile type="PolyData"></VTKFile>', "is a VTK surface (PolyData)"),
        (b'<VTKFile type="UnstructuredGrid"><UnstructuredGrid>', "no element found"),
        (b'<VTKFile type="UnstructuredGrid"><UnstructuredGrid></VTKFile>', "mismatched tag"),
        (b'<VTKFile type="UnstructuredGrid"><Unstruct', "a tag is not closed"),
        (b'<VTKFile type="UnstructuredGrid"><!-- oops', "ends inside a comment"),
        (
            b'<VTKFile type="UnstructuredGrid" byte_order="MiddleEndian"/>',
            "byte_order 'MiddleEndian' is unknown",
        ),
        (b'<VTKFile type="UnstructuredGrid" header_type="UInt8"/>', "header_type 'UInt8' is unknown"),
        (
            b'<VTKFile type="UnstructuredGrid"><AppendedData encoding="raw">',
            "does not start with an underscore",
        ),
    ],
)
def test_what_is_no_unstructured_grid_is_named(content, message, tmp_path):
    """The message says what it is instead."""
    path = tmp_path / "a.vtu"
    path.write_bytes(content)
    assert message in refusal(path)


def test_a_grid_without_pieces_has_nothing_to_contour(tmp_path):
    """No cells is not a broken file."""
    path = tmp_path / "a.vtu"
    path.write_bytes(b'<VTKFile type="UnstructuredGrid"><UnstructuredGrid/></VTKFile>')
    assert "holds no cells" in refusal(path, FieldError)


@pytest.mark.parametrize(
    "old, new, message",
    [
        ('NumberOfPoints="17"', 'NumberOfPoints="18"', "promises 54"),
        ('NumberOfPoints="17"', 'NumberOfPoints="1000000000000"', "promises 3,000,000,000,000"),
        ('NumberOfPoints="17"', 'NumberOfPoints="-17"', "NumberOfPoints is '-17', not a count"),
        ('NumberOfPoints="17"', "", "NumberOfPoints is '', not a count"),
        ('NumberOfCells="9"', 'NumberOfCells="8"', "promises 8"),
        ('NumberOfCells="9"', 'NumberOfCells="99999999999999"', "promises 99,999,999,999,999"),
        ('Name="connectivity"', 'Name="links"', "has no array 'connectivity'"),
        ('Name="offsets"', 'Name="starts"', "has no array 'offsets'"),
        ('Name="types"', 'Name="kinds"', "has no array 'types'"),
        ('type="Float64" Name="Points"', 'type="String" Name="Points"', "array 'Points' has type 'String'"),
        (
            'type="Int64" Name="connectivity"',
            'type="Float64" Name="connectivity"',
            "'connectivity' holds float64",
        ),
        ('format="appended"', 'format="hex"', "has format 'hex'"),
        ('encoding="raw"', 'encoding="hex"', "appended as 'hex'"),
        ('offset="0"', "", "no appended data for it"),
        ('offset="0"', 'offset="99999999"', "ends early"),
        ('offset="0"', 'offset="8"', "array 'f'"),
        (
            'header_type="UInt64"',
            'header_type="UInt64" compressor="vtkZstdCompressor"',
            "vtkZstdCompressor, which is unknown",
        ),
        ('header_type="UInt64"', 'header_type="UInt64" compressor="vtkZLibDataCompressor"', "ends early"),
        ('byte_order="LittleEndian"', 'byte_order="BigEndian"', "ends early"),
    ],
)
def test_a_lie_in_the_tags_is_refused(old, new, message, tmp_path):
    """Sizes, names, types and places that do not fit the data."""
    assert message in changed(tmp_path, old, new, RAW)


@pytest.mark.parametrize(
    "numbers, message",
    [
        ({"connectivity": -1}, "names point -1, but there are 17"),
        ({"connectivity": 17}, "names point 17, but there are 17"),
        ({"connectivity": 2**40}, "names point 1,099,511,627,776"),
        ({"offsets": 2**40}, "the offsets fall"),
        ({"offsets": -1}, "the offsets fall"),
        ({"offsets": 9}, "has 9 points instead of 8"),
        ({"types": 200}, "cells of type 200"),
    ],
)
def test_cells_that_make_no_sense_are_refused(numbers, message, tmp_path):
    """The first number of one of the three cell arrays is replaced."""
    path = write(tmp_path / "a.vtu", GOOD, RAW)
    data = path.read_bytes()
    ((name, number),) = numbers.items()
    order = ("f", "connectivity", "offsets", "types")
    position = data.index(b"_", data.index(b"<AppendedData")) + 1
    for _ in order[: order.index(name)]:
        position += 8 + struct.unpack_from("<Q", data, position)[0]
    size = 1 if name == "types" else 8
    path.write_bytes(
        data[: position + 8]
        + number.to_bytes(size, "little", signed=number < 0)
        + data[position + 8 + size :]
    )
    assert message in refusal(path)


def test_the_last_offset_beyond_the_connectivity_is_refused(tmp_path):
    """Truncated connectivity with offsets that do not know."""
    path = write(tmp_path / "a.vtu", Mesh(POINTS, [(10, [0, 1, 2, 3])], GOOD.point_fields))
    path.write_bytes(path.read_bytes().replace(b"0 1 2 3\n", b"0 1 2\n"))
    assert "needs 4 corners, its connectivity holds 3" in refusal(path)


@pytest.mark.parametrize("word", ["oops", "1e5", "--", "0x1F"])
def test_a_word_among_the_numbers_is_refused(word, tmp_path):
    """In integers and in floats."""
    path = write(tmp_path / "a.vtu", GOOD)
    text = path.read_text()
    start = text.index("\n", text.index('Name="connectivity"'))
    path.write_text(f"{text[:start]} {word} {text[start:]}")
    assert "array 'connectivity' holds" in refusal(path)


def test_tags_among_the_numbers_are_refused(tmp_path):
    """Comments may stand there, and elements may not."""
    path = write(tmp_path / "a.vtu", GOOD)
    text = path.read_text()
    start = text.index(" ", text.index("\n", text.index('Name="connectivity"')) + 3)
    path.write_text(f"{text[:start]}<b/>{text[start:]}")
    assert refusal(path).endswith("array 'connectivity': text in several parts; write it again")


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, 1e101, -1e300])
def test_coordinates_that_are_not_finite_or_have_no_volume_are_refused(number, tmp_path):
    """There is no place for such a point, or no product of three of its coordinates."""
    points = POINTS.copy()
    points[3, 1] = number
    assert "not finite" in refusal(write(tmp_path / "a.vtu", Mesh(points, CELLS, GOOD.point_fields)))


@pytest.mark.parametrize(
    "number, name",
    [
        (55, "parametric tetrahedra"),
        (67, "higher-order hexahedra"),
    ],
)
def test_cells_that_cannot_be_contoured_are_refused_by_name(number, name, tmp_path):
    """Not one of them is left out silently."""
    mesh = Mesh(POINTS, [*CELLS, (number, [0, 1, 2, 3])], GOOD.point_fields)
    assert f"holds 1 {name}, which cannot be contoured" in refusal(
        write(tmp_path / "a.vtu", mesh), FieldError
    )


def test_a_file_of_surface_cells_only_is_refused_with_what_it_holds(tmp_path):
    """An isosurface needs a volume."""
    mesh = Mesh(POINTS, [(5, [0, 1, 2]), (9, [0, 1, 2, 3]), (9, [1, 2, 3, 4])], GOOD.point_fields)
    message = refusal(write(tmp_path / "a.vtu", mesh), FieldError)
    assert "holds only surface cells (1 triangles, 2 quads)" in message


def test_a_file_of_collapsed_cells_only_is_refused(tmp_path):
    """Nothing is left of a tetrahedron that names one point twice."""
    mesh = Mesh(POINTS, [(10, [0, 1, 2, 2])], GOOD.point_fields)
    assert "collapsed" in refusal(write(tmp_path / "a.vtu", mesh), FieldError)


@pytest.mark.parametrize("encoding", [RAW, ZLIB, INLINE, Encoding("appended", "base64", "lzma")], ids=str)
def test_a_header_that_promises_too_much_reserves_nothing(encoding, tmp_path):
    """10^12 numbers promised, and the address space for 1 GiB: the answer is a refusal, not a crash."""
    path = write(tmp_path / "a.vtu", GOOD, encoding)
    data = path.read_bytes()
    if encoding is not ZLIB:
        data = data.replace(b'NumberOfPoints="17"', b'NumberOfPoints="1000000000000"')
    else:
        position = data.index(b"_", data.index(b"<AppendedData")) + 1
        data = data[: position + 8] + struct.pack("<2Q", 10**12, 10**12) + data[position + 24 :]
    path.write_bytes(data)
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + (1 << 30), limits[1]))
    try:
        message = refusal(path)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)
    assert "memory" not in message


@pytest.mark.parametrize("wanted", [1, 8, 128, 144, 200])
@pytest.mark.parametrize("compressor", ["zlib", "lzma"])
def test_a_part_that_inflates_to_another_size_is_refused(compressor, wanted, tmp_path):
    """The first field's only part has 136 bytes; its header says otherwise."""
    path = write(tmp_path / "a.vtu", GOOD, Encoding("appended", compressor=compressor, header="UInt64"))
    data = path.read_bytes()
    position = data.index(b"_", data.index(b"<AppendedData")) + 1
    assert struct.unpack_from("<3Q", data, position) == (1, 256, 136)
    path.write_bytes(data[: position + 16] + struct.pack("<Q", wanted) + data[position + 24 :])
    assert f"array 'f' inflates to another size than the {wanted} bytes promised" in refusal(path)


@pytest.mark.parametrize("encoding", [e for e in every_encoding() if e.header == "UInt32"], ids=str)
def test_a_file_cut_anywhere_is_refused(encoding, tmp_path):
    """Ten places in every encoding; only what lies behind the last array may be missing."""
    path = write(tmp_path / "a.vtu", GOOD, encoding)
    whole = path.read_bytes()
    end = whole.rindex(b"</AppendedData>") - 1 if encoding.format == "appended" else len(whole) - 12
    for cut in np.linspace(1, end - 1, 10).astype(int):
        path.write_bytes(whole[:cut])
        refusal(path)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    data=st.data(),
    encoding=st.sampled_from([Encoding(), RAW, ZLIB, INLINE, Encoding("binary", compressor="lzma")]),
)
def test_any_damaged_byte_is_read_or_refused_in_one_line(data, encoding, tmp_path):
    """Whatever happens, it is an error of ours or a mesh."""
    path = write(tmp_path / "a.vtu", GOOD, encoding)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place : place + data.draw(st.integers(0, 2))] = data.draw(st.binary(max_size=2))
    path.write_bytes(content)
    try:
        read(path, ReadOptions())
    except IsocoreError as error:
        assert str(error).startswith(f"{path}: ")
        assert "\n" not in str(error)
