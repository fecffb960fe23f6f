"""Which field is contoured, and as which numbers."""

from __future__ import annotations

import numpy as np
import pytest
from cell_shapes import block
from vtu_files import Encoding, Mesh, write

from isocore.errors import FieldError, OptionError
from isocore.readers import ReadOptions, read
from isocore.readers.vtk_fields import magnitudes

POINTS, CELLS = block(np.full((2, 1, 1), "h"))
N = len(POINTS)


def mesh_with(**fields) -> Mesh:
    return Mesh(POINTS, CELLS, {name: np.asarray(values) for name, values in fields.items()})


def test_the_only_field_needs_no_name(tmp_path):
    """Nothing to choose."""
    mesh = read(write(tmp_path / "a.vtu", mesh_with(p=np.arange(N) / 4)))
    assert mesh.field_name == "p"
    np.testing.assert_array_equal(mesh.values, np.arange(N) / 4)


def test_several_fields_are_named_in_the_refusal(tmp_path):
    """One line to copy a name from."""
    path = write(tmp_path / "flow.vtu", mesh_with(p=np.zeros(N), T=np.zeros(N), velocity=np.zeros((N, 3))))
    with pytest.raises(OptionError) as refusal:
        read(path)
    assert str(refusal.value) == f"{path}: holds 3 point fields (p, T, velocity); choose one with --field"


def test_a_name_that_is_not_there_is_answered_with_those_that_are(tmp_path):
    """A typo should not need a second look at the file."""
    path = write(tmp_path / "a.vtu", Mesh(POINTS, CELLS, {"p": np.zeros(N)}, {"part": np.zeros(2)}))
    with pytest.raises(OptionError, match="has no field 'P'; it holds for points: p; for cells: part"):
        read(path, ReadOptions(field="P"))


def test_what_vtk_leaves_behind_is_no_candidate_but_can_be_named(tmp_path):
    """Ghost flags and original ids come with every filter."""
    path = write(tmp_path / "a.vtu", mesh_with(p=np.ones(N), vtkOriginalPointIds=np.arange(N)))
    assert read(path).field_name == "p"
    assert read(path, ReadOptions(field="vtkOriginalPointIds")).values[3] == 3


def test_no_field_at_all_is_a_field_error(tmp_path):
    """Read, but nothing to contour."""
    path = write(tmp_path / "a.vtu", mesh_with())
    with pytest.raises(FieldError, match="holds no point or cell field"):
        read(path)


@pytest.mark.parametrize("component", ["0", "2", "magnitude"])
def test_a_vector_gives_the_component_asked_for(component, tmp_path):
    """Counted from 0, or their length."""
    vectors = np.random.default_rng(0).normal(size=(N, 3)).astype(np.float32)
    path = write(tmp_path / "a.vtu", mesh_with(v=vectors), Encoding("appended", byte_order="BigEndian"))
    values = read(path, ReadOptions(component=component)).values
    assert values.dtype == np.float32
    if component == "magnitude":
        np.testing.assert_allclose(values, np.linalg.norm(vectors, axis=1), rtol=1e-6)
    else:
        np.testing.assert_array_equal(values, vectors[:, int(component)])


@pytest.mark.parametrize(
    "component, message",
    [
        (None, "has 3 components; choose --component 0 to 2, or magnitude"),
        ("3", "has no component 3"),
        ("-1", "has no component -1"),
        ("x", "has no component x"),
    ],
)
def test_a_vector_without_a_component_it_has_is_refused(component, message, tmp_path):
    """The message says which there are."""
    path = write(tmp_path / "a.vtu", mesh_with(v=np.zeros((N, 3))))
    with pytest.raises(OptionError, match=message):
        read(path, ReadOptions(component=component))


def test_a_scalar_has_no_component_to_choose(tmp_path):
    """But its first, which is itself."""
    path = write(tmp_path / "a.vtu", mesh_with(p=np.zeros(N)))
    assert read(path, ReadOptions(component="0")).field_name == "p"
    with pytest.raises(OptionError, match="one component"):
        read(path, ReadOptions(component="magnitude"))


@pytest.mark.parametrize(
    "stored, largest, expected",
    [
        ("uint8", 255, "float32"),
        ("int32", 2**24, "float32"),
        ("int32", 2**24 + 1, "float64"),
        ("int64", -(2**24) - 1, "float64"),
        ("float32", 0.1, "float32"),
        ("float64", 0.1, "float64"),
    ],
)
def test_values_are_stored_as_exactly_as_they_were(stored, largest, expected, tmp_path):
    """float32 only where it holds each number."""
    values = np.zeros(N, stored)
    values[1] = largest
    mesh = read(write(tmp_path / "a.vtu", mesh_with(p=values), Encoding("binary")))
    assert mesh.values.dtype == expected
    assert mesh.values[1] == values[1]


def test_a_cell_field_is_averaged_to_the_points_with_a_warning(tmp_path):
    """Points between the two cells get the mean, the others their only cell's value."""
    path = write(
        tmp_path / "a.vtu", Mesh(np.vstack((POINTS, [9, 9, 9])), CELLS, {}, {"part": np.array([1.0, 3.0])})
    )
    mesh = read(path)
    expected = np.array([1.0, 2.0, 3.0])[POINTS[:, 0].astype(int)]
    np.testing.assert_array_equal(mesh.values, [*expected, 2.0])
    assert any("part is a cell field" in warning for warning in mesh.warnings)


def test_a_cell_field_of_mixed_cells_stays_with_its_cells(tmp_path):
    """Also where a surface cell stands between them."""
    cells = [(9, CELLS[0][1][:4]), CELLS[0], (9, CELLS[1][1][:4]), CELLS[1]]
    path = write(
        tmp_path / "a.vtu", Mesh(POINTS, cells, {"p": np.zeros(N)}, {"part": np.array([50, 1, 60, 3])})
    )
    values = read(path, ReadOptions(field="part")).values
    np.testing.assert_array_equal(values, np.array([1.0, 2.0, 3.0])[POINTS[:, 0].astype(int)])


def test_values_that_are_not_finite_are_kept_and_counted(tmp_path):
    """They are outside of every isosurface."""
    values = np.arange(N, dtype=float)
    values[[1, 4]] = np.nan, np.inf
    mesh = read(write(tmp_path / "a.vtu", mesh_with(p=values)))
    np.testing.assert_array_equal(mesh.values, values)
    assert any(warning.startswith("2 of 12 values of p are not finite") for warning in mesh.warnings)


def test_a_magnitude_is_found_also_where_its_square_is_no_number():
    """1e200 has no square in float64, 1e300 none in float32: the first is kept, the second infinite."""
    vectors = np.array([[3e200, 4e200], [3.0, 4.0], [1e300, np.nan], [-np.inf, 0.0], [1.7e308, 1.7e308]])
    assert np.allclose(magnitudes(vectors, np.float64), [5e200, 5.0, np.nan, np.inf, np.inf], equal_nan=True)
    assert np.allclose(magnitudes(vectors, np.float32), [np.inf, 5.0, np.nan, np.inf, np.inf], equal_nan=True)


def test_fields_of_cells_are_offered_too(tmp_path):
    """Of several fields of points none is taken; the choice names those of cells as well."""
    mesh = Mesh(np.eye(4, 3), [(10, [0, 1, 2, 3])], {"p": np.arange(4.0), "T": np.arange(4.0)}, {"rho": np.ones(1)})
    path = write(tmp_path / "a.vtu", mesh)
    with pytest.raises(OptionError) as refusal:
        read(path)
    assert str(refusal.value) == f"{path}: holds 2 point fields (p, T) and 1 of cells (rho); choose one with --field"
