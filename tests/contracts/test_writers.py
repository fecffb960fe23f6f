"""Every writer: read back by somebody else's reader, the same bytes every time, whole or not at all."""

from __future__ import annotations

import io
import os
import stat
import subprocess
import sys
from pathlib import Path

import meshio
import nibabel
import numpy as np
import pytest
import shapes_mesh
import trimesh
from vtp_files import VtpFile

from isocore import writers
from isocore.errors import OptionError, OutputError
from isocore.surface import Surface
from isocore.writers import FORMATS, WRITERS, write, write_to
from isocore.writers.read_back import READ_BACK, read_mesh

ROOT = Path(__file__).parents[2]


def bytes_of(surface: Surface, format: str, threads: int = 1) -> bytes:
    stream = io.BytesIO()
    write_to(stream, surface, format, threads=threads)
    return stream.getvalue()


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def with_normals(surface: Surface) -> Surface:
    return Surface(surface.vertices, surface.triangles, surface.vertices.copy(), surface.space, surface.unit)


@pytest.fixture
def rough_torus() -> Surface:
    """Coordinates whose digits all count, of many sizes."""
    torus = shapes_mesh.torus(50, 40)
    scale = np.random.default_rng(3).choice([1e-6, 1, 12345], len(torus.vertices))
    return shapes_mesh.surface(torus.vertices * scale[:, None], torus.triangles)


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("normals", [False, True])
def test_another_reader_finds_the_same_mesh(tmp_path, format, normals, rough_torus):
    """Another reader sees every vertex at its place, to the last bit of float32; VTP's is the tests' own."""
    surface = with_normals(rough_torus) if normals else rough_torus
    target = tmp_path / f"mesh.{format}"
    assert write(surface, target) == ()
    if format == "glb":
        (mesh,) = trimesh.load_scene(target, process=False).geometry.values()
        assert np.array_equal(np.asarray(mesh.vertices, np.float32), surface.vertices)
        assert np.array_equal(mesh.faces, surface.triangles)
        assert not normals or np.array_equal(np.asarray(mesh.vertex_normals, np.float32), surface.normals)
        return
    if format == "gii":
        arrays = nibabel.load(target).agg_data()
        assert np.array_equal(arrays[0], surface.vertices) and np.array_equal(arrays[1], surface.triangles)
        assert len(arrays) == 2 + normals and (not normals or np.array_equal(arrays[2], surface.normals))
        return
    if format == "vtp":
        file = VtpFile.of(target)
        assert np.array_equal(file.points["Points"], surface.vertices)
        assert np.array_equal(file.polys, surface.triangles)
        assert not normals or np.array_equal(file.point_data["Normals"], surface.normals)
        return
    mesh = meshio.read(target)
    found = mesh.points.astype(np.float32)[mesh.cells_dict["triangle"]]
    assert np.array_equal(found, surface.vertices[surface.triangles])
    if normals and format == "ply":
        read_back = np.stack([mesh.point_data[n] for n in ("nx", "ny", "nz")], 1)
        assert np.array_equal(read_back, surface.normals)


def test_every_writer_has_its_inverse():
    """Reports show surfaces of all formats."""
    assert set(READ_BACK) == set(WRITERS)


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("normals", [False, True])
@pytest.mark.parametrize("float64", [False, True])
def test_what_is_written_is_read_back(tmp_path, format, normals, float64, rough_torus):
    """Every triangle at its place to the last bit of float32, and the same vertices, in STL of another order."""
    surface = with_normals(rough_torus) if normals else rough_torus
    if float64:
        vertices = surface.vertices.astype(np.float64)
        surface = Surface(vertices, surface.triangles, surface.normals, surface.space, surface.unit)
    write(surface, tmp_path / f"mesh.{format}")
    vertices, triangles = read_mesh(tmp_path / f"mesh.{format}")
    assert triangles.dtype == np.int32 and vertices.shape == surface.vertices.shape
    assert vertices.dtype == np.float64 if format == "obj" or (float64 and format == "ply") else np.float32
    vertices = vertices.astype(np.float32)
    assert np.array_equal(vertices[triangles], surface.vertices[surface.triangles])
    if format != "stl":
        assert np.array_equal(vertices, surface.vertices) and np.array_equal(triangles, surface.triangles)


@pytest.mark.parametrize("format", FORMATS)
def test_an_empty_surface_is_read_back(tmp_path, format):
    """As no vertices and no triangles."""
    empty = shapes_mesh.surface(np.empty((0, 3)), np.empty((0, 3), np.int32))
    write(empty, tmp_path / f"mesh.{format}")
    vertices, triangles = read_mesh(tmp_path / f"mesh.{format}")
    assert vertices.shape == (0, 3) and triangles.shape == (0, 3)


@pytest.mark.parametrize("format", FORMATS)
def test_what_no_writer_wrote_is_not_read_back(tmp_path, format):
    """A file that is gone, cut, or another program's is no mesh, and no error."""
    path = tmp_path / f"mesh.{format}"
    assert read_mesh(path) is None and read_mesh(tmp_path / "mesh.off") is None
    path.write_bytes(b"v 1 2 x\nf 1 2\n")
    assert read_mesh(path) is None


@pytest.mark.parametrize("normals", [False, True])
def test_a_float64_surface_stays_float64_in_ply(tmp_path, normals):
    """The one format that keeps it."""
    sphere = shapes_mesh.sphere()
    exact = sphere.vertices.astype(np.float64) + 1e6
    write(Surface(exact, sphere.triangles, sphere.vertices if normals else None), tmp_path / "mesh.ply")
    mesh = meshio.read(tmp_path / "mesh.ply")
    assert np.array_equal(mesh.points, exact)
    assert np.array_equal(mesh.cells_dict["triangle"], sphere.triangles)


def test_the_ply_header_says_what_cli_md_promises():
    """Byte for byte."""
    data = bytes_of(with_normals(shapes_mesh.tetrahedron()), "ply")
    header = b"""ply
format binary_little_endian 1.0
comment SPACE=RAS
comment units mm
element vertex 4
property float x
property float y
property float z
property float nx
property float ny
property float nz
element face 4
property list uchar int vertex_indices
end_header
"""
    assert data.startswith(header)
    assert len(data) == len(header) + 4 * 24 + 4 * 13


def test_obj_is_text_with_nine_digits_counted_from_one():
    """Byte for byte."""
    surface = shapes_mesh.surface([[0, 1 / 3, -1e-7], [123456.789, 1, 2], [0, 0, 1e20]], [[0, 1, 2]])
    head = "# isocore\n# SPACE=RAS\n# vertex coordinates are measured in units, where 1 unit = 1.000000 mm\n"
    places = "v 0 0.333333343 -1.00000001e-07\nv 123456.789 1 2\nv 0 0 1.00000002e+20\n"
    assert bytes_of(surface, "obj").decode() == head + places + "f 1 2 3\n"
    lines = bytes_of(with_normals(surface), "obj").decode().splitlines()
    assert lines[-1] == "f 1//1 2//2 3//3"
    assert lines[6] == "vn 0 0.333333343 -1.00000001e-07"


def test_obj_numbers_are_those_of_printf():
    """Any float, of any size."""
    bits = np.random.default_rng(5).integers(0, 2**32, 9000, dtype=np.uint32).view(np.float32)
    values = np.where(np.isfinite(bits), bits, 0).reshape(-1, 3)
    surface = Surface(values, np.zeros((0, 3), np.int32))
    expected = ["v " + " ".join(f"{x:.9g}" for x in row) for row in values.tolist()]
    assert bytes_of(surface, "obj").decode().splitlines()[1:] == expected


def test_stl_has_true_normals_and_never_starts_with_solid():
    """A unit normal that the corners turn around, zero where there is no area."""
    cube = shapes_mesh.cube()
    surface = shapes_mesh.surface(cube.vertices, np.vstack([cube.triangles, [[0, 0, 1]]]))
    data = bytes_of(surface, "stl")
    assert not data.startswith(b"solid")
    assert b"SPACE=RAS" in data[:80]
    assert len(data) == 84 + 13 * 50
    assert int.from_bytes(data[80:84], "little") == 13
    records = np.frombuffer(data[84:], np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]))
    crossed = np.cross(records["p"][:, 1] - records["p"][:, 0], records["p"][:, 2] - records["p"][:, 0])
    assert np.array_equal(records["n"], crossed)
    assert np.array_equal(records["n"][-1], [0, 0, 0])


@pytest.mark.parametrize("format", ["stl", "obj"])
def test_a_format_that_cannot_tell_vertices_apart_says_so(tmp_path, format):
    """float32 and nine digits are too little for a small body far away."""
    sphere = shapes_mesh.sphere()
    far = Surface(sphere.vertices.astype(np.float64) * 0.001 + 1e6, sphere.triangles)
    (warning,) = write(far, tmp_path / f"far.{format}")
    assert warning.startswith(str(tmp_path))
    assert "fall on another" in warning
    assert write(Surface(sphere.vertices.astype(np.float64), sphere.triangles), tmp_path / f"near.{format}") == ()


@pytest.mark.parametrize("format", FORMATS)
def test_same_surface_same_bytes(format):
    """Twice, and with 1, 2 and 4 threads, over more than one piece."""
    torus = with_normals(shapes_mesh.torus(600, 130))
    first = bytes_of(torus, format)
    assert all(bytes_of(torus, format, threads) == first for threads in (1, 2, 4))


@pytest.mark.parametrize("format", FORMATS)
def test_an_empty_surface_is_a_valid_file(tmp_path, format):
    """With a header, and nothing after it."""
    write(shapes_mesh.empty(), tmp_path / f"empty.{format}")
    data = (tmp_path / f"empty.{format}").read_bytes()
    sign = {"ply": b"element face 0\n", "stl": bytes(4), "obj": b"SPACE=RAS", "glb": b'"scenes":[', "gii": b'Dim0="0"'}
    sign["vtp"] = b'NumberOfPolys="0"'
    assert sign[format] in data
    assert data[80:] == bytes(4) or format != "stl"
    if format == "ply":
        assert len(meshio.read(tmp_path / "empty.ply").points) == 0


def test_a_native_surface_names_no_space():
    """Nothing is claimed that the source did not say."""
    tetrahedron = shapes_mesh.tetrahedron()
    for format in FORMATS:
        data = bytes_of(Surface(tetrahedron.vertices, tetrahedron.triangles), format)
        assert b"SPACE" not in data
        assert b"unit" not in data


def test_missing_folders_are_made_and_old_files_replaced(tmp_path):
    """Nothing else is left in the folder, and the file may be read by whom the umask says."""
    target = tmp_path / "a" / "b" / "mesh.PLY"
    write(shapes_mesh.cube(), target)
    write(shapes_mesh.tetrahedron(), target)
    assert target.read_bytes() == bytes_of(shapes_mesh.tetrahedron(), "ply")
    assert names_in(target.parent) == ["mesh.PLY"]
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(target.stat().st_mode) == 0o666 & ~umask


def test_a_link_stays_a_link(tmp_path):
    """What it points to is replaced."""
    (tmp_path / "real").mkdir()
    (tmp_path / "link.stl").symlink_to(tmp_path / "real" / "mesh.stl")
    write(shapes_mesh.cube(), tmp_path / "link.stl")
    assert (tmp_path / "link.stl").is_symlink()
    assert (tmp_path / "real" / "mesh.stl").stat().st_size == 84 + 12 * 50


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), MemoryError()])
def test_a_failed_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, error):
    """A full disk is an OutputError; an interrupt stays one."""
    target = tmp_path / "mesh.ply"
    target.write_bytes(b"old")

    def fail(stream, surface, threads):
        stream.write(b"half")
        raise error

    monkeypatch.setitem(writers.WRITERS, ".ply", fail)
    with pytest.raises(OutputError if isinstance(error, OSError) else type(error)) as caught:
        write(shapes_mesh.cube(), target)
    if isinstance(error, OSError):
        assert str(caught.value).startswith(str(target))
        assert "No space left" in str(caught.value)
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["mesh.ply"]


@pytest.mark.skipif(sys.platform == "win32", reason="needs a limit on file sizes")
def test_a_file_the_system_cuts_off_is_one_clear_error(tmp_path):
    """A limit on file sizes stands for a full disk: the error comes from the system itself."""
    code = """
import resource, signal, sys
import shapes_mesh
from isocore.errors import OutputError
from isocore.writers import write
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
for format in ("ply", "stl", "obj"):
    try:
        write(shapes_mesh.torus(), sys.argv[1] + "/mesh." + format)
    except OutputError as error:
        print(error)
"""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "tests")}
    command = [sys.executable, "-P", "-c", code, str(tmp_path)]
    run = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    lines = run.stdout.splitlines()
    assert len(lines) == 3
    for line, format in zip(lines, ("ply", "stl", "obj"), strict=True):
        assert line.startswith(f"{tmp_path}/mesh.{format}: cannot be written")
    assert names_in(tmp_path) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_device_is_written_to_and_not_replaced():
    """A full device is an error, and still a device afterwards."""
    with pytest.raises(OutputError, match=r"/dev/full: .*space"):
        write(shapes_mesh.torus(), "/dev/full", "ply")
    assert stat.S_ISCHR(Path("/dev/full").stat().st_mode)


def test_every_format_the_command_offers_has_a_writer():
    """And no writer is kept from it."""
    assert tuple(suffix.removeprefix(".") for suffix in writers.WRITERS) == FORMATS


@pytest.mark.parametrize(
    ("name", "format", "said"),
    [
        ("mesh.vrml", None, ".vrml is not"),
        ("mesh", None, "no suffix"),
        ("mesh.ply", "xyz", "xyz is not"),
        ("mesh.stl.gz", None, ".gz is not"),
    ],
)
def test_an_unknown_format_is_refused_with_those_there_are(tmp_path, name, format, said):
    """Before anything is opened."""
    with pytest.raises(OptionError, match=f"{said}.*obj, ply, stl"):
        write(shapes_mesh.cube(), tmp_path / name, format)
    assert names_in(tmp_path) == []


def test_a_folder_in_the_way_is_refused(tmp_path):
    """As is a file where a folder is needed."""
    (tmp_path / "mesh.ply").mkdir()
    with pytest.raises(OutputError, match="is a folder"):
        write(shapes_mesh.cube(), tmp_path / "mesh.ply")
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="cannot be written"):
        write(shapes_mesh.cube(), tmp_path / "file" / "mesh.ply")
