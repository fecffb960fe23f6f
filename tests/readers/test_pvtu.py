"""A mesh in several files is one mesh: its surface has no seams, and missing pieces are one clear line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cell_shapes import block
from click.testing import CliRunner
from isocore.cli.convert import convert
from vtu_files import Mesh, write

from isocore import extract, measure
from isocore.errors import InputError, IsocoreError, OptionError
from isocore.readers import ReadOptions, files_of, read
from isocore.readers.pvtu import pvtu_fields

BLOOD = Path(__file__).parents[3] / "shared" / "data" / "simulation" / "blood_vessels"


def whole() -> Mesh:
    """A box of hexahedra around a sphere, with a field of points and one of cells."""
    points, cells = block(np.full((6, 6, 6), "h"))
    radius = np.linalg.norm(points - 3, axis=1)
    of_cells = np.array([radius[ids].mean() for _, ids in cells])
    return Mesh(points, cells, {"u": radius}, {"c": of_cells})


def parts(mesh: Mesh, count: int) -> list[Mesh]:
    """The mesh cut into pieces along x, each with points of its own."""
    middles = np.array([np.asarray(mesh.points)[ids].mean(axis=0)[0] for _, ids in mesh.cells])
    found = []
    for n in range(count):
        mine = np.flatnonzero((middles * count / 6).astype(int) == n)
        used = np.unique([mesh.cells[i][1] for i in mine])
        number = {old: new for new, old in enumerate(used.tolist())}
        cells = [(mesh.cells[i][0], [number[p] for p in mesh.cells[i][1]]) for i in mine]
        found.append(
            Mesh(
                np.asarray(mesh.points)[used],
                cells,
                {name: values[used] for name, values in mesh.point_fields.items()},
                {name: values[mine] for name, values in mesh.cell_fields.items()},
            )
        )
    return found


def write_pvtu(path: Path, pieces: list[str]) -> Path:
    body = "".join(f'<Piece Source="{name}"/>' for name in pieces)
    path.write_text(
        '<?xml version="1.0"?><VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">'
        f'<PUnstructuredGrid GhostLevel="0"><PPoints/>{body}</PUnstructuredGrid></VTKFile>'
    )
    return path


def in_pieces(folder: Path, count: int = 3) -> Path:
    """A .pvtu and its pieces in a folder below."""
    (folder / "run").mkdir()
    names = [f"run/{n}.vtu" for n in range(count)]
    for name, part in zip(names, parts(whole(), count), strict=True):
        write(folder / name, part)
    return write_pvtu(folder / "run.pvtu", names)


@pytest.mark.parametrize("field", ["u", "c"])
def test_the_surface_of_pieces_is_that_of_the_whole(field, tmp_path):
    """Also of a field of cells, whose means know the cells of both pieces."""
    options = ReadOptions(field=field)
    ours = read(in_pieces(tmp_path), options)
    theirs = read(write(tmp_path / "whole.vtu", whole()), options)
    ours, theirs = (extract(mesh, 2.2, backend="mc") for mesh in (ours, theirs))
    np.testing.assert_array_equal(np.unique(ours.vertices, axis=0), np.unique(theirs.vertices, axis=0))
    assert measure(ours).watertight and measure(ours).triangles == measure(theirs).triangles


def test_cells_that_two_pieces_have_without_a_mark_count_once(tmp_path):
    """A layer of overlap is no wall inside the surface, nor does it weigh twice in the mean of a field of cells."""
    path = in_pieces(tmp_path, 2)
    one, two = parts(whole(), 2)
    low = [n for n, (_, ids) in enumerate(two.cells) if two.points[ids][:, 0].max() < 4.5]
    points = np.concatenate((one.points, two.points))
    cells = one.cells + [(two.cells[n][0], [p + len(one.points) for p in two.cells[n][1]]) for n in low]
    of_points = {"u": np.concatenate((one.point_fields["u"], two.point_fields["u"]))}
    of_cells = {"c": np.concatenate((one.cell_fields["c"], two.cell_fields["c"][low]))}
    write(tmp_path / "run" / "0.vtu", Mesh(points, cells, of_points, of_cells))
    for field in ("u", "c"):
        ours = read(path, ReadOptions(field=field))
        theirs = read(write(tmp_path / "whole.vtu", whole()), ReadOptions(field=field))
        assert ours.connectivity.repeated_cells == len(low) == 36 and len(ours.hexes) == 216
        assert "36 cells are those of an earlier piece once more; they were left out" in ours.warnings
        ours, theirs = (measure(extract(mesh, 2.2, backend="mc")) for mesh in (ours, theirs))
        assert ours.watertight and ours.triangles == theirs.triangles


def test_a_missing_piece_is_one_line(tmp_path):
    """It names the first, and how many there are."""
    path = in_pieces(tmp_path)
    (tmp_path / "run" / "1.vtu").unlink()
    with pytest.raises(InputError) as caught:
        read(path, ReadOptions(field="u"))
    assert str(caught.value) == f"{path}: one of its 3 pieces is missing, {tmp_path / 'run' / '1.vtu'}; copy it there"
    (tmp_path / "run" / "2.vtu").unlink()
    with pytest.raises(InputError, match="2 of its 3 pieces are missing, the first is"):
        read(path, ReadOptions(field="u"))


def test_a_damaged_piece_is_named(tmp_path):
    """After the file that lists it."""
    path = in_pieces(tmp_path)
    piece = tmp_path / "run" / "2.vtu"
    piece.write_bytes(piece.read_bytes()[:-200])
    with pytest.raises(InputError) as caught:
        read(path, ReadOptions(field="u"))
    assert str(caught.value).startswith(f"{path}: {piece}: ")


def test_a_piece_without_cells_adds_nothing(tmp_path):
    """A rank that had nothing to do."""
    path = in_pieces(tmp_path, 2)
    write(tmp_path / "run" / "none.vtu", Mesh(np.empty((0, 3)), []))
    write_pvtu(path, ["run/0.vtu", "run/none.vtu", "run/1.vtu"])
    assert len(read(path, ReadOptions(field="u")).hexes) == 216
    write_pvtu(path, ["run/none.vtu"])
    with pytest.raises(IsocoreError, match="none of its 1 pieces holds a cell"):
        read(path)


def test_fields_that_not_all_pieces_hold_are_left_out_with_a_warning(tmp_path):
    """The common ones can be chosen, others are named."""
    path = in_pieces(tmp_path, 2)
    second = parts(whole(), 2)[1]
    more = {**second.point_fields, "extra": second.point_fields["u"]}
    write(tmp_path / "run" / "1.vtu", Mesh(second.points, second.cells, more))
    assert [field.name for field in pvtu_fields(path)] == ["u"]
    warning = "its pieces hold different fields; c, extra cannot be chosen, since not all of them hold it"
    assert read(path).warnings[0] == warning
    with pytest.raises(OptionError, match="has no field 'extra'; it holds for points: u"):
        read(path, ReadOptions(field="extra"))


@pytest.mark.parametrize(
    "text, message",
    [
        ('<VTKFile type="PTable"><Piece Source="a"/></VTKFile>', "holds a VTK PTable; a .pvtu lists the pieces"),
        ('<VTKFile type="UnstructuredGrid"/>', "holds no cells, so there is nothing to contour"),
        ("<html/>", "starts with <html>"),
        ('<VTKFile type="PUnstructuredGrid"/>', "names no pieces"),
        ('<VTKFile type="PUnstructuredGrid"><Piece/></VTKFile>', "names the file '', which no file is called"),
        ('<VTKFile type="PUnstructuredGrid"><Piece Source="a">', "its XML is broken near line 1"),
    ],
)
def test_what_lists_no_pieces_is_refused(text, message, tmp_path):
    """In one line that starts with the path."""
    path = tmp_path / "a.pvtu"
    path.write_text(text)
    with pytest.raises(IsocoreError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value) or "is a web page" in str(caught.value)


def test_pieces_are_found_from_windows_names_too(tmp_path):
    """And all files are known as the mesh's own."""
    path = in_pieces(tmp_path, 2)
    write_pvtu(path, ["run\\0.vtu", "run\\1.vtu"])
    assert len(read(path, ReadOptions(field="u")).hexes) == 216
    assert files_of(path) == (path, tmp_path / "run" / "0.vtu", tmp_path / "run" / "1.vtu")


@pytest.mark.parametrize("names", [(".",), ("run.pvtu", "run"), ("run.pvtu", "run/0.vtu", "run/1.vtu", "run/2.vtu")])
def test_pieces_are_not_converted_a_second_time(names, tmp_path):
    """Neither where a folder is searched nor where a pattern of the shell names them."""
    in_pieces(tmp_path)
    arguments = [str(tmp_path / name) for name in names]
    result = CliRunner().invoke(convert, [*arguments, "-i", "2.2", "--field", "u", "--dry-run", "-d", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert [line.split(" -> ")[0] for line in result.output.splitlines()] == [str(tmp_path / "run.pvtu")]


@pytest.mark.skipif(not BLOOD.is_dir(), reason="the real data lies beside the repository, not in it")
@pytest.mark.parametrize("isovalue, counts", [(0.45, (324, 555, 89)), (0.5, (259, 446, 70))])
def test_a_real_mesh_in_pieces_has_the_surface_that_vtk_finds(isovalue, counts):
    """Counts are VTK's, of its cleaned grid; the edges left open lie on the hull of the vessel."""
    mesh = read(BLOOD / "T0000000500.pvtu", ReadOptions(field="density"))
    measured = measure(extract(mesh, isovalue, backend="mc"))
    assert (measured.vertices, measured.triangles, measured.boundary_edges) == counts
