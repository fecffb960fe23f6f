"""The index on disk: the same as in memory, and refused when anything it was made from has changed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

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
        assert one[2:] == other[2:]


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
