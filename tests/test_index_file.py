"""The index on disk: the same as in memory, and refused when anything it was made from has changed."""

from __future__ import annotations

import json
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshes
import numpy as np
import pytest

from isocore.cell_mesh import CellMesh
from isocore.errors import InputError
from isocore.extraction import Outlook
from isocore.job import Options
from isocore.methods.index_file import index_path, load_index, save_index
from isocore.methods.thinning import build_index, prepare_thinning, ready_index


@pytest.fixture
def mesh() -> CellMesh:
    tets = meshes.mesh_of(np.ones((4, 4, 4), bool))
    tets = meshes.with_values(tets, np.sin(tets.points).sum(axis=1))
    return replace(tets, field_name="wave")


@pytest.fixture
def path(tmp_path: Path, mesh: CellMesh) -> Path:
    path = index_path(tmp_path / "mesh.vtu")
    save_index(path, build_index(mesh), mesh)
    return path


def test_it_lies_beside_the_mesh() -> None:
    """mesh.vtu.isoindex."""
    assert index_path(Path("a/mesh.vtu")) == Path("a/mesh.vtu.isoindex")


def test_a_loaded_index_walks_as_a_built_one(path: Path, mesh: CellMesh) -> None:
    """Same bytes of vertices and triangles, same counts."""
    built, loaded = ready_index(mesh, build_index(mesh)), ready_index(mesh, load_index(path, mesh))
    for isovalue in meshes.isovalues(mesh, 5):
        one, other = built.propagate(isovalue), loaded.propagate(isovalue)
        assert all(np.array_equal(a, b) for a, b in zip(one[:2], other[:2], strict=True))
        assert one[2:4] == other[2:4]


def test_writing_twice_gives_the_same_bytes(path: Path, mesh: CellMesh) -> None:
    """No time, no path inside."""
    before = path.read_bytes()
    save_index(path, build_index(mesh), mesh)
    assert path.read_bytes() == before


@pytest.mark.parametrize("what", ["values", "points", "cells", "type"])
def test_a_changed_mesh_is_refused(path: Path, mesh: CellMesh, what: str) -> None:
    """One value, one coordinate, one cell, or the type of the values."""
    points, tets, values = mesh.points.copy(), mesh.tets.copy(), mesh.values.copy()
    if what == "values":
        values[7] += 1e-9
    elif what == "points":
        points[3, 1] += 1e-9
    elif what == "cells":
        tets[5] = tets[5, [1, 2, 0, 3]]
    else:
        values = values.astype(np.float32)
    changed = CellMesh(points, tets, mesh.hexes.copy(), values, field_name="wave")
    with pytest.raises(InputError, match=r"mesh\.vtu\.isoindex: was made before the mesh or its values changed"):
        load_index(path, changed)


def test_an_index_of_another_field_says_so(path: Path, mesh: CellMesh) -> None:
    """The message names both fields."""
    other = CellMesh(mesh.points, mesh.tets, mesh.hexes, mesh.values + 1, field_name="pressure")
    with pytest.raises(InputError, match="was made for the field wave, not for pressure"):
        load_index(path, other)


@pytest.mark.parametrize("damage", ["cut", "flipped", "foreign", "empty", "header"])
def test_a_damaged_index_is_refused(path: Path, mesh: CellMesh, damage: str) -> None:
    """One line that starts with the path, whatever is wrong with the bytes."""
    content = bytearray(path.read_bytes())
    if damage == "cut":
        content = content[:-100]
    elif damage == "flipped":
        content[-100] ^= 4
    elif damage == "foreign":
        content[:7] = b"<?xml v"
    elif damage == "empty":
        content = bytearray()
    else:
        content[40] ^= 64
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"mesh\.vtu\.isoindex: ") as refusal:
        load_index(path, mesh)
    assert "\n" not in str(refusal.value)


def test_convert_uses_a_matching_index_and_says_when_it_does_not(path: Path, mesh: CellMesh) -> None:
    """With it a single isovalue repays; a changed mesh is thinned anew, with a warning."""
    outlook = Outlook(index=path, isovalues=1)
    assert prepare_thinning(mesh, Options(), outlook)(0.3).warnings == ()
    changed = meshes.with_values(mesh, mesh.values * 2)
    warnings = prepare_thinning(changed, Options(), outlook)(0.3).warnings
    assert any("thinned anew" in warning for warning in warnings)


def _forged(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], object]) -> None:
    """Hand `change` the header and the arrays by kind and name; write them back under checksums that hold."""
    magic, text, _, content = path.read_bytes().split(b"\n", 3)
    header, arrays, at = json.loads(text), {}, 0
    for kind in ("tets", "hexes"):
        for name, shape in header[kind]["arrays"].items():
            dtype = np.dtype("<f8" if name in ("low", "high") else "<i4")
            count = int(np.prod(shape))
            arrays[f"{kind} {name}"] = np.frombuffer(content, dtype, count, at).reshape(shape).copy()
            at += count * dtype.itemsize
    arrays["original"] = np.frombuffer(content, "<i4", offset=at).copy()
    change(header, arrays)
    content = b"".join(array.tobytes() for array in arrays.values())
    header["checksum"] = zlib.crc32(content)
    text = json.dumps(header).encode()
    path.write_bytes(b"%b\n%b\n%08x\n%b" % (magic, text, zlib.crc32(text), content))


def _same_surface(path: Path, mesh: CellMesh) -> tuple[str, ...]:
    """The warnings of an extraction beside the index at `path`; its surface has to be that of a new one."""
    expected = prepare_thinning(mesh, Options(), Outlook())
    extract = prepare_thinning(mesh, Options(), Outlook(index=path))
    told: tuple[str, ...] = ()
    for isovalue in meshes.isovalues(mesh, 3):
        found, right = extract(isovalue), expected(isovalue).surface
        told += found.warnings
        assert np.array_equal(found.surface.vertices, right.vertices)
        assert np.array_equal(found.surface.triangles, right.triangles)
    return told


def test_a_header_with_one_other_letter_is_thinned_anew(path: Path, mesh: CellMesh) -> None:
    """Whichever it is: the surface is right, and a warning says why it took longer."""
    whole = path.read_bytes()
    for at in range(whole.find(b"{"), whole.find(b"}}") + 30, 3):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        assert all("thinned anew" in line and "is damaged" in line for line in _same_surface(path, mesh)[:1]), at
        assert _same_surface(path, mesh)


def test_numbers_out_of_bounds_are_refused_whatever_the_checksum_says(path: Path, mesh: CellMesh) -> None:
    """Every number of the header, as a damaged or a hostile file may have it."""
    whole = path.read_bytes()
    for number in (-1, 3, 2**32, 2**63, 1.5, True, None, "98", [], 10**400):
        _forged(path, lambda header, arrays, number=number: header.update(points=number))
        assert "is damaged" in _same_surface(path, mesh)[0], number
        path.write_bytes(whole)
    for key in ("extrema", "classes", "crowded_faces", "crowded_cells", "collapsed_cells", "collapsed_cell", "arrays"):
        for number in (-2, 2**40, [1, 2], None, {"records": [1, 8]}):
            _forged(path, lambda header, arrays, key=key, number=number: header["tets"].update({key: number}))
            assert "is damaged" in _same_surface(path, mesh)[0], (key, number)
            path.write_bytes(whole)


def _moved_corner(arrays: dict[str, Any]) -> None:
    """Another point for all cells around one: each edge still has the same ends wherever it is named."""
    corners = arrays["tets records"][:, :4]
    moved = np.argmin(np.bincount(corners.ravel()))
    corners[corners == moved] = (moved + 20) % (corners.max() + 1)


def _swapped(array: Any) -> None:
    array[:2] = array[1::-1].copy()


@pytest.mark.parametrize(
    "change",
    [
        lambda header, arrays: arrays["original"].__setitem__(3, -1),
        lambda header, arrays: arrays["original"].__setitem__(3, 10**6),
        lambda header, arrays: arrays["tets records"].__setitem__((4, 2), 10**6),
        lambda header, arrays: arrays["tets records"].__setitem__((4, 6), 10**6),
        lambda header, arrays: _moved_corner(arrays),
        lambda header, arrays: arrays["tets skeleton"].__setitem__(0, -1),
        lambda header, arrays: arrays["tets skeleton"].__setitem__(1, arrays["tets skeleton"][0]),
        lambda header, arrays: arrays["tets low"].__setitem__(0, np.nan),
        lambda header, arrays: arrays["tets high"].__setitem__(slice(None), -1e9),
        lambda header, arrays: _swapped(arrays["tets low"]),
        lambda header, arrays: header["tets"]["arrays"].update(records=[8, len(arrays["tets records"])]),
        lambda header, arrays: arrays.update(original=arrays["original"][:-1]),
    ],
)
def test_a_forged_index_is_thinned_anew(path: Path, mesh: CellMesh, change: Any) -> None:
    """Ids that lead nowhere, other shapes under the same bytes, a skeleton of other values: never a wrong surface."""
    _forged(path, change)
    assert "thinned anew" in _same_surface(path, mesh)[0]
