"""Carried fields in files, read by somebody else's readers; what is refused; and what a batch does with them."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import meshio
import nibabel
import numpy as np
import pytest
from cell_shapes import block
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti
from vtu_files import Mesh, write

import isocore
from isocore import convert_files
from isocore.colormaps import COLORMAPS, parse_colormap
from isocore.errors import OptionError
from isocore.surface import Surface
from isocore.writers.colormaps import colormap, coloured
from isocore.writers.names import column_names

SLOPE, START = np.array([1.5, -2.25, 0.75]), 3.0


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in (*arguments, "--no-progress", "-q")])


def linear(places: Any) -> Any:
    return np.asarray(places, np.float64) @ SLOPE + START


@pytest.fixture
def scan(tmp_path: Path) -> Path:
    """A ball, and beside it heat.nii, which is linear in space."""
    index = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), axis=-1)
    write_nifti(tmp_path / "heat.nii", linear(index))
    return write_nifti(tmp_path / "scan.nii", ball())


@pytest.fixture
def flow(tmp_path: Path) -> Path:
    """A mesh with a field to contour, scalars and a vector of points, and a number of each cell."""
    points, cells = block(np.full((4, 4, 4), "h"))
    fields = {"p": np.linalg.norm(points - 2.1, axis=1), "T [K]": linear(points), "U": points[:, :3]}
    return write(tmp_path / "flow.vtu", Mesh(points, cells, fields, {"cell": np.arange(len(cells), dtype=np.int32)}))


def test_ply_has_a_property_for_each_column(flow, tmp_path):
    """Under a name that is safe; linear fields are exact in the file, float64 ones as double."""
    assert run(flow, "--field", "p", "-i", 1.3, "-o", tmp_path / "a.ply", "--carry", "all").exit_code == 0
    mesh = meshio.read(tmp_path / "a.ply")
    assert {"T_K", "U_x", "U_y", "U_z", "cell"} <= mesh.point_data.keys()
    assert mesh.point_data["T_K"].dtype == np.float64
    np.testing.assert_allclose(mesh.point_data["T_K"], linear(mesh.points), rtol=0, atol=2e-6)
    for n, axis in enumerate("xyz"):
        np.testing.assert_allclose(mesh.point_data[f"U_{axis}"], mesh.points[:, n], rtol=0, atol=1e-6)
    assert b"comment field T_K: T [K]\n" in (tmp_path / "a.ply").read_bytes()


def test_a_volumes_file_is_carried_into_ply(scan, tmp_path):
    """Under the file's name, whether the surface is simplified, capped, of a few pieces or moved."""
    more = ("--carry", tmp_path / "heat.nii", "--offset", "1,2,3", "--cap", "--keep-largest", 1)
    assert run(scan, "-i", 40, "-o", tmp_path / "a.ply", *more).exit_code == 0
    mesh = meshio.read(tmp_path / "a.ply")
    assert len(mesh.points) > 20
    np.testing.assert_allclose(mesh.point_data["heat"], linear(mesh.points + np.array([1, 2, 3])), rtol=0, atol=2e-5)


def glb_arrays(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The document, and the arrays of its first primitive by attribute."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    found = {}
    for name, number in document["meshes"][0]["primitives"][0]["attributes"].items():
        accessor = document["accessors"][number]
        start = 28 + length + document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        columns = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        dtype = {5126: "<f4", 5123: "<u2"}[accessor["componentType"]]
        found[name] = np.frombuffer(data, dtype, accessor["count"] * columns, start).reshape(-1, columns)
    return document, found


def test_glb_has_colours_and_the_numbers_themselves(scan, tmp_path):
    """Linear colours of 16 bits, from the table; the report says what they stand for."""
    report = tmp_path / "r.json"
    more = ("--carry", tmp_path / "heat.nii", "--colormap", "Turbo", "--color-range", "10:20", "--report", report)
    assert run(scan, "-i", 40, "-o", tmp_path / "a.glb", *more).exit_code == 0
    document, arrays = glb_arrays(tmp_path / "a.glb")
    np.testing.assert_allclose(arrays["_heat"][:, 0], linear(arrays["POSITION"]), rtol=0, atol=2e-5)
    share = np.clip(np.floor((arrays["_heat"][:, 0].astype(float) - 10) / 10 * 256), 0, 255).astype(int)
    srgb = colormap("turbo")[share] / 255
    wanted = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    off = np.abs(arrays["COLOR_0"][:, :3] / 65535 - wanted).max(axis=1)
    assert (off < 1e-4).mean() > 0.98  # float32 beside float64 may choose the next colour
    assert document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [1, 1, 1, 1]
    record = json.loads(report.read_text())["outputs"][0]
    assert record["colors"] == {"by": "heat", "colormap": "turbo", "range": [10, 20]}
    assert record["carried"][0]["name"] == "heat"
    low, high = record["carried"][0]["range"]
    assert low == pytest.approx(arrays["_heat"].min()) and high == pytest.approx(arrays["_heat"].max())


def test_ply_is_coloured_where_a_map_is_asked_for(flow, tmp_path):
    """By the field that is named, a vector by its length."""
    more = ("--carry", "U", "--carry", "T [K]", "--colormap", "gray", "--color-by", "U")
    assert run(flow, "--field", "p", "-i", 1.3, "-o", tmp_path / "a.ply", *more).exit_code == 0
    data = meshio.read(tmp_path / "a.ply").point_data
    length = np.sqrt(sum(data[f"U_{axis}"] ** 2 for axis in "xyz"))
    order = np.argsort(length)
    red = data["red"].astype(np.uint8)[order].astype(int)  # meshio takes uchar for a signed one
    assert red[0] == 0 and red[-1] == 255 and (np.diff(red) >= 0).all()


def test_gifti_has_an_array_of_each_field(scan, tmp_path):
    """As float32, with its name."""
    assert run(scan, "-i", 40, "-o", tmp_path / "a.gii", "--carry", tmp_path / "heat.nii").exit_code == 0
    image = nibabel.load(tmp_path / "a.gii")
    points = image.agg_data("pointset")
    heat = next(array for array in image.darrays if array.meta.get("Name") == "heat")
    np.testing.assert_allclose(heat.data, linear(points), rtol=0, atol=2e-5)


@pytest.mark.parametrize("format_", ["obj", "stl"])
def test_formats_without_fields_say_so_and_carry_none(scan, tmp_path, format_):
    """Once, as a warning; the bytes are those without --carry."""
    report = tmp_path / "r.json"
    more = ("-i", 40, "--report", report)
    assert run(scan, "-o", tmp_path / f"a.{format_}", *more).exit_code == 0
    assert run(scan, "-o", tmp_path / f"b.{format_}", *more, "--carry", tmp_path / "heat.nii").exit_code == 0
    assert (tmp_path / f"a.{format_}").read_bytes() == (tmp_path / f"b.{format_}").read_bytes()
    (warning,) = json.loads(report.read_text())["outputs"][0]["warnings"]
    assert warning.startswith(f"{format_.upper()} holds no fields, so --carry adds none")


def test_a_field_that_is_not_there_is_answered_with_those_that_are(flow, scan, tmp_path):
    """One line; the batch goes on."""
    found = run(flow, scan, "--field", "p", "-i", 1.3, "-d", tmp_path / "out", "--carry", "T")
    assert found.exit_code == 1
    assert "flow.vtu: has no field 'T' to carry; it holds for points: p, T [K], U; for cells: cell" in found.stderr
    assert "scan.nii: --carry T: is no field of the file" in found.stderr


@pytest.mark.parametrize(
    ("make", "why"),
    [
        (lambda path: write_nifti(path, ball(11)), "has 11x11x11 samples, the volume has 12x12x12"),
        (lambda path: path.write_bytes(b"junk" * 200), "other.nii"),
        (lambda path: write_nifti(path, np.zeros((12, 12, 12, 2))), "holds 2 volumes; choose one with --volume"),
        (lambda path: nibabel.save(nibabel.Nifti1Image(ball(), np.diag([1, 1, 1.01, 1])), path), "lies elsewhere"),
    ],
)
def test_a_volume_on_another_grid_is_refused(scan, tmp_path, make, why):
    """With what differs; nothing is resampled."""
    make(tmp_path / "other.nii")
    found = run(scan, "-i", 40, "-o", tmp_path / "a.ply", "--carry", tmp_path / "other.nii")
    assert found.exit_code == 1 and why in found.stderr
    assert not (tmp_path / "a.ply").exists()


def test_of_several_volumes_the_one_of_the_same_number_is_carried(tmp_path):
    """Time series of two kinds go step by step."""
    both = np.stack([ball(), ball(radius=3.0)], axis=-1)
    scan = write_nifti(tmp_path / "scan.nii", both)
    write_nifti(tmp_path / "other.nii", np.stack([np.full((12,) * 3, 1.0), np.full((12,) * 3, 2.0)], axis=-1))
    more = ("--volume", "all", "-d", tmp_path / "out", "--carry", tmp_path / "other.nii")
    assert run(scan, "-i", 40, *more).exit_code == 0
    for n in range(2):
        assert set(meshio.read(tmp_path / "out" / f"scan_v{n}.ply").point_data["other"]) == {n + 1.0}


def test_each_input_carries_the_file_that_is_named_after_it(tmp_path):
    """In its folder, by its stem; one without such a file is a failed row, and the others go on."""
    for n, name in enumerate(("a", "b", "c")):
        write_nifti(tmp_path / name / "t1.nii", ball())
        if name != "b":
            write_nifti(tmp_path / name / "t1_heat.nii", np.full((12, 12, 12), float(n)))
    inputs = [tmp_path / name / "t1.nii" for name in ("a", "b", "c")]
    more = ("-d", tmp_path / "out", "--name", "{parent}", "--carry", "{folder}/{stem}_heat.nii")
    found = run(*inputs, "-i", 40, *more)
    assert found.exit_code == 1 and "t1_heat.nii: is no field of the file" in found.stderr
    for name, value in (("a", 0.0), ("c", 2.0)):
        assert set(meshio.read(tmp_path / "out" / f"{name}.ply").point_data["t1_heat"]) == {value}


def test_labels_carry_too_and_keep_their_colours(tmp_path):
    """Each label's surface has the values along its own vertices, also where smoothing moved them."""
    index = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), axis=-1)
    labels = np.where(ball() > 50, np.where(index[..., 0] > 5, 2, 1), 0).astype(np.uint8)
    scan = write_nifti(tmp_path / "scan.nii", labels)
    write_nifti(tmp_path / "heat.nii", linear(index))
    more = ("--labels", "all", "--smooth", 5, "--carry", tmp_path / "heat.nii")
    assert run(scan, *more, "-o", tmp_path / "a.glb").exit_code == 0
    _, arrays = glb_arrays(tmp_path / "a.glb")
    assert "COLOR_0" not in arrays
    np.testing.assert_allclose(arrays["_heat"][:, 0], linear(arrays["POSITION"]), rtol=0, atol=2e-5)
    assert run(scan, *more, "--colormap", "hot", "-o", tmp_path / "a.glb").exit_code == 0
    assert "COLOR_0" in glb_arrays(tmp_path / "a.glb")[1]


def test_an_output_is_made_again_when_what_it_carries_changed(scan, tmp_path, monkeypatch):
    """--if-changed looks into the carried file, and the depfile names it."""
    more = ("-i", 40, "-o", tmp_path / "a.ply", "--carry", tmp_path / "heat.nii", "--if-changed")
    more += ("--report", tmp_path / "r.json", "--depfile", tmp_path / "a.d")
    statuses = []
    for n in range(3):
        if n == 2:
            write_nifti(tmp_path / "heat.nii", np.zeros((12, 12, 12)))
        assert run(scan, *more).exit_code == 0
        statuses.append(json.loads((tmp_path / "r.json").read_text())["outputs"][0]["status"])
    assert statuses == ["done", "skipped", "done"]
    monkeypatch.chdir(tmp_path)
    assert run(scan, *("heat.nii" if word == tmp_path / "heat.nii" else word for word in more)).exit_code == 0
    assert json.loads((tmp_path / "r.json").read_text())["outputs"][0]["status"] == "skipped"
    assert "heat.nii:\n" in (tmp_path / "a.d").read_text()
    refused = run(scan, "-i", 40, "-o", tmp_path / "heat.nii", "-f", "ply", "--carry", tmp_path / "heat.nii")
    assert refused.exit_code and "is what --carry reads" in str(refused.exception)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--colormap", "viridis"), "--colormap: colours vertices by a field that is carried; add --carry"),
        (("--carry", "a", "--colormap", "virids"), "--colormap virids: is none of viridis plasma"),
        (("--carry", "a", "--color-range", "2:1"), "the smaller first"),
        (("--carry", "a", "--color-range", "1"), "write A:B"),
        (("--carry", "a", "--colormap", "hot", "--color", "#ff0000"), "are two ways to colour a surface"),
        (("--carry", ""), "--carry: is empty"),
    ],
)
def test_nonsense_is_refused_at_once(scan, arguments, message):
    """With exit code 2."""
    found = run(scan, "-i", 40, *arguments)
    assert found.exit_code == 2 and message in found.stderr


def test_a_colour_by_what_is_not_carried_is_refused(scan, tmp_path):
    """The message lists what is."""
    more = ("--carry", tmp_path / "heat.nii", "--color-by", "cold")
    found = run(scan, "-i", 40, "-o", tmp_path / "a.glb", *more)
    assert found.exit_code == 1 and "--color-by cold: is not carried; carried are heat" in found.stderr


def test_the_same_from_python(scan, tmp_path):
    """With the option's names."""
    asked = {"isovalues": 40, "format": "glb", "carry": tmp_path / "heat.nii", "colormap": "HOT"}
    result = convert_files(scan, tmp_path / "out", **asked)
    (made,) = result.outputs
    assert made.colors is not None and (made.colors.by, made.colors.colormap) == ("heat", "hot")


def test_names_are_safe_and_apart():
    """Whatever a solver calls its fields."""
    fields = {"T [K]": 1, "T (K)": 1, "x": 1, "Größe": 1, "速度": 3, "grad": 9, "U": 2}
    arrays = {name: np.zeros(4) if k == 1 else np.zeros((4, k)) for name, k in fields.items()}
    assert column_names(arrays, ("x", "y")) == {
        "T [K]": ["T_K"],
        "T (K)": ["T_K_2"],
        "x": ["x_2"],
        "Größe": ["Groe"],
        "速度": ["field_x", "field_y", "field_z"],
        "grad": [f"grad_{n}" for n in range(9)],
        "U": ["U_x", "U_y"],
    }


def test_colours_are_those_of_the_table():
    """First, last and middle colour; what is no number is grey; a map without width is its middle."""
    assert len({bytes(colormap(name)) for name in COLORMAPS}) == len(COLORMAPS)
    assert colormap("viridis")[[0, 255]].tolist() == [[68, 1, 84], [253, 231, 37]]
    assert colormap("coolwarm")[[0, 255]].tolist() == [[59, 76, 192], [180, 4, 38]]
    assert (colormap("gray") == np.arange(256)[:, None]).all()
    assert (colormap("jet_r") == colormap("jet")[::-1]).all()
    assert parse_colormap(" RDBU_R ") == "RdBu_r"
    values = np.array([-9.0, 0, 0.5, 1, 9, np.nan, np.inf])
    assert coloured(values, "gray", (0.0, 1.0))[:, 0].tolist() == [0, 0, 128, 255, 255, 128, 128]
    assert coloured(np.ones(2), "gray", (1.0, 1.0))[:, 0].tolist() == [128, 128]
    with pytest.raises(OptionError, match="is none of"):
        parse_colormap("virid")


def test_written_from_python(tmp_path):
    """What `isocore.write` gets it writes, in every format."""
    corners = np.eye(3, dtype=np.float32)
    surface = Surface(corners, np.array([[0, 1, 2]], np.int32), fields={"a": np.arange(3.0), "v": np.eye(3)})
    for suffix in ("ply", "glb", "gii", "obj", "stl"):
        isocore.write(surface, tmp_path / f"a.{suffix}")
    data = meshio.read(tmp_path / "a.ply").point_data
    assert data["a"].tolist() == [0, 1, 2] and data["v_z"].tolist() == [0, 0, 1]
