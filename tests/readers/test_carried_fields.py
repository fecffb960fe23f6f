"""What a file's other fields become on their way to the field that carries them: joined, split, placed on a grid."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cell_shapes import block
from legacy_files import structured, write_grid
from vtu_files import Mesh, write

import isocore
from isocore.errors import IsocoreError
from isocore.readers import ReadOptions, read
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtk_pieces import PieceData

BLOOD = Path(__file__).parents[3] / "shared" / "data" / "simulation" / "blood_vessels" / "T0000000500.pvtu"
SLOPE, START = np.array([1.5, -2.25, 0.75]), 3.0
SHAPE = (6, 5, 7)


def linear(places: Any) -> Any:
    return np.asarray(places, np.float64) @ SLOPE + START


def mesh_of(letters: str) -> Mesh:
    """A box of cells with a field to contour, a linear one, and each cell's box."""
    points, cells = block(np.full((3, 3, 3), letters))
    boxes = np.array([[*points[ids].min(axis=0), *points[ids].max(axis=0)] for _, ids in cells])
    return Mesh(points, cells, {"r": (points**2).sum(axis=1), "heat": linear(points)}, {"box": boxes})


def assert_carried(field: Any, isovalue: float) -> None:
    surface = isocore.extract(field, isovalue, backend="mc")
    assert len(surface.vertices) > 20
    np.testing.assert_allclose(surface.fields["heat"], linear(surface.vertices), rtol=0, atol=2e-5)
    around = surface.fields["box"]
    assert (around[:, :3] <= surface.vertices + 1e-6).all() and (around[:, 3:] >= surface.vertices - 1e-6).all()


@pytest.mark.parametrize("number", [41, 42])
def test_cells_that_are_split_at_their_centres_carry(tmp_path, number):
    """Convex point sets and polyhedra: a centre has the mean, a vertex the value of the cell around it."""
    mesh = mesh_of("h")
    faces = [[ids[i] for i in face] for _, ids in mesh.cells for face in _SIDES]
    arrays = {}
    if number == 42:
        streams = [[6, *(n for face in faces[6 * k : 6 * k + 6] for n in (4, *face))] for k in range(len(mesh.cells))]
        arrays = {
            "faces": np.concatenate(streams).astype(np.int64),
            "faceoffsets": np.cumsum([len(stream) for stream in streams]),
        }
    cells = [(number, ids) for _, ids in mesh.cells]
    path = write(tmp_path / "a.vtu", replace(mesh, cells=cells, cell_arrays=arrays))
    field = read(path, ReadOptions(field="r", carry=("heat", "box")))
    assert len(field.points) > len(mesh.points)
    assert_carried(field, 5.3)


_SIDES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


@pytest.mark.parametrize("mode", ["ASCII", "BINARY"])
def test_legacy_files_carry(tmp_path, mode):
    """Unstructured grids, as text and in bytes."""
    mesh = mesh_of("p")
    path = write_grid(tmp_path / "a.vtk", mesh, "5.1", mode, of_cells=mesh.cell_fields)
    field = read(path, ReadOptions(field="r", carry=("all",)))
    assert [one.name for one in field.carried] == ["heat", "box"]
    assert_carried(field, 5.3)


@pytest.mark.parametrize("chosen", ["r", "of_cells"])
def test_images_carry_what_lies_at_points_and_amid_cells(tmp_path, chosen):
    """Whichever is contoured: points are interpolated, also around samples amid cells; cells have their value."""
    i, j, k = np.indices(SHAPE)
    points = np.stack((i, j, k), axis=-1)
    middles = np.stack(np.indices(np.array(SHAPE) - 1), axis=-1) + 0.5
    of_points = {"r": np.linalg.norm(points - 2.6, axis=-1), "heat": linear(points)}
    of_cells = {"of_cells": np.linalg.norm(middles - 2.6, axis=-1), "warm": linear(middles)}
    flat = [{name: a.ravel(order="F") for name, a in part.items()} for part in (of_points, of_cells)]
    (tmp_path / "a.vtk").write_bytes(structured("STRUCTURED_POINTS", "BINARY", SHAPE, *flat))
    field = read(tmp_path / "a.vtk", ReadOptions(field=chosen, carry=("heat", "warm")))
    surface = isocore.extract(field, 1.7, backend="mc")
    places = (surface.vertices - field.affine[:3, 3]) / np.diag(field.affine)[:3] + (0.5 if chosen == "of_cells" else 0)
    np.testing.assert_allclose(surface.fields["heat"], linear(places), rtol=0, atol=2e-5)
    if chosen == "of_cells":
        np.testing.assert_allclose(surface.fields["warm"], linear(places), rtol=0, atol=2e-5)
    else:
        reach = np.abs(SLOPE).sum() / 2 + 1e-5
        assert (np.abs(surface.fields["warm"] - linear(places)) <= reach).all()
        assert np.isin(surface.fields["warm"], of_cells["warm"]).all()


def test_joined_points_carry_one_value(tmp_path):
    """The mean of those that differ, with a warning; what is NaN on one side is NaN."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], np.float64)
    tets = np.array([(0, 1, 2, 3), (1, 2, 3, 4)])
    values = np.array([0, 1, 2, 3, 1 + 4, 2, 3, 9], np.float64)
    piece = PieceData(
        corners[tets.ravel()], np.array([10, 10], np.uint8), np.array([4, 8]), np.arange(8),
        np.array([0, 0, 0, 0, 0, 0, 0, 1.0]), carried=(values, np.array([7, 8])),
    )  # fmt: skip
    infos = (FieldInfo("T", 1, "points", "Float64"), FieldInfo("part", 1, "cells", "Int64"))
    mesh = assembled("a.vtu", [piece], FieldInfo("u", 1, "points", "Float64"), 0, carried=infos)
    assert mesh.carried[0].values.tolist() == [0, 3, 2, 3, 9]
    assert mesh.carried[1].values.tolist() == [7, 8] and mesh.carried[1].values.dtype == np.int64
    assert any("T, which is carried, is discontinuous: at 1 points" in warning for warning in mesh.warnings)
    assert set(isocore.extract(mesh, 0.5, backend="mc").fields["part"]) == {8}


def test_pieces_keep_the_numbers_of_their_cells():
    """The cells of a second piece follow those of the first, whatever is contoured."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], np.float64)
    numbers = (np.array([10], np.uint8), np.array([4]), np.arange(4))
    pieces = [
        PieceData(corners + np.array([3 * n, 0, 0]), *numbers, np.array([0.0, 1, 1, 1]), carried=(np.array([n + 1.0]),))
        for n in range(3)
    ]
    infos = (FieldInfo("part", 1, "cells", "Float64"),)
    mesh = assembled("a.pvtu", pieces, FieldInfo("u", 1, "points", "Float64"), 0, carried=infos)
    surface = isocore.extract(mesh, 0.5, backend="mc")
    np.testing.assert_array_equal(surface.fields["part"], 1 + np.floor(surface.vertices[:, 0] / 3))


def test_a_mesh_does_not_carry_files(tmp_path):
    """And says what it could."""
    path = write(tmp_path / "a.vtu", mesh_of("h"))
    with pytest.raises(IsocoreError, match="to carry \\(a mesh carries fields of its own file\\); it holds for points"):
        read(path, ReadOptions(field="r", carry=(str(path),)))


@pytest.mark.skipif(not BLOOD.exists(), reason="needs the shared data beside the checkout")
def test_a_real_mesh_in_pieces_carries_all():
    """Vectors and scalars of cells: every vertex has the value of some cell."""
    field = read(BLOOD, ReadOptions(field="density", carry=("all",)))
    surface = isocore.extract(field, 0.3, backend="mc")
    assert {"velocity", "shearstress"} <= surface.fields.keys()
    cells = next(one for one in field.carried if one.name == "velocity").values
    known = {row.tobytes() for row in cells}
    assert surface.fields["velocity"].shape == (len(surface.vertices), 3)
    assert all(row.tobytes() in known for row in surface.fields["velocity"].astype(cells.dtype))
