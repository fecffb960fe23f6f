"""Stills of surfaces: compared by their size and colours, never by bytes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import shapes_mesh
from click.testing import CliRunner
from isocore.cli.main import isocore as program
from png import read_png
from shapes import SAMPLES
from small_files import ball, write_nifti

import isocore
from isocore import pictures
from isocore.errors import FieldError, OptionError
from isocore.surface import Part, Surface
from isocore.views import directions, parse_views

KNOT = SAMPLES / "knot.nii.gz"


@pytest.fixture
def embree() -> None:
    pytest.importorskip("embreex", reason="pictures are drawn by embreex: pip install 'isocore[picture]'")


def run(*arguments: object) -> Any:
    return CliRunner().invoke(program, ["convert", *(str(argument) for argument in arguments)])


def share(pixels: npt.NDArray[np.uint8]) -> float:
    """How much of a picture is not paper."""
    return float((pixels != 255).any(axis=2).mean())


def arrow() -> Surface:
    """A box that is long along x, with a red half at its +x end and a green one at -x; RAS."""
    cube = shapes_mesh.cube()
    low, high = cube.vertices.min(axis=0), cube.vertices.max(axis=0)
    unit = (cube.vertices - low) / (high - low)
    vertices = np.concatenate([unit * [2, 1, 1], unit * [2, 1, 1] - [2, 0, 0]]).astype(np.float32)
    triangles = np.concatenate([cube.triangles, cube.triangles + len(unit)]).astype(np.int32)
    counts = {"vertices": len(unit), "triangles": len(cube.triangles)}
    parts = (Part(name="r", colour=(255, 0, 0), **counts), Part(name="g", colour=(0, 255, 0), **counts))
    return Surface(vertices, triangles, space="ras", parts=parts)


@pytest.mark.usefixtures("embree")
def test_a_picture_has_the_size_and_the_shape_that_is_asked_for(tmp_path: Path) -> None:
    """A ball fills a circle, in blue, lit from above on the left."""
    source = write_nifti(tmp_path / "ball.nii", ball(24, radius=9))
    asked = ("--picture", tmp_path / "new" / "b.png", "--picture-size", "300x200")
    result = run(source, "-i", 50, "-o", tmp_path / "b.ply", *asked)
    assert result.exit_code == 0, result.output
    pixels = read_png(tmp_path / "new" / "b.png").astype(int)
    assert pixels.shape == (200, 300, 3)
    radius = 200 * (1 - 2 * 0.04) / 2
    assert share(pixels) == pytest.approx(np.pi * radius**2 / pixels[..., 0].size, rel=0.04)
    ball_ = pixels[(pixels != 255).any(axis=2)]
    assert (ball_[:, 2] > ball_[:, 0]).mean() > 0.95
    assert pixels[70, 120].sum() > pixels[130, 180].sum() + 60


@pytest.mark.usefixtures("embree")
def test_views_show_their_side() -> None:
    """From A the right half of a person is on the left; from L only the left end is seen; S has the front up."""
    def middle(view: str) -> npt.NDArray[np.uint8]:
        (one,) = directions(parse_views(view), "ras")
        return pictures.draw(arrow(), [one], (80, 40))[20]

    def reds(row: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
        return (row[:, 0] > row[:, 1]) & (row[:, 1] < 200)

    front, back, left, right = (middle(view) for view in ("A", "P", "L", "R"))
    assert reds(front)[:38].any() and not reds(front)[42:].any()
    assert reds(back)[42:].any() and not reds(back)[:38].any()
    assert not reds(left).any() and reds(right).any()
    for name, space, eye in (("A", "lps", -1), ("P", "lps", 1), ("A", "las", 1), ("+y", "native", 1)):
        assert directions(parse_views(name), space)[0][0] == (0, eye, 0)
    assert directions(parse_views("s"), "lps") == [((0, 0, 1), (0, -1, 0))]
    with pytest.raises(FieldError, match="does not say where its axes point"):
        directions(parse_views("A"), "native")


@pytest.mark.parametrize("view", ["corner", "30:-20", "0:90", "A", "-z", "+x", "I"])
def test_a_view_is_a_right_angle(view: str) -> None:
    """Both directions have length 1, and are square to each other."""
    ((eye, up),) = directions(parse_views(view), "las")
    assert np.linalg.norm(eye) == pytest.approx(1) and np.linalg.norm(up) == pytest.approx(1)
    assert np.dot(eye, up) == pytest.approx(0)


@pytest.mark.parametrize("text", ["", "Q", "A,,L", "10", "10:95", "nan:0", ",".join("A" * 13)])
def test_what_is_no_view_is_refused(text: str) -> None:
    """With those that there are."""
    with pytest.raises(OptionError, match="--view"):
        parse_views(text)


@pytest.mark.usefixtures("embree")
def test_several_views_stand_side_by_side() -> None:
    """At one scale, and each holds all of the surface."""
    views = directions(parse_views("A,L,S"), "ras")
    pixels = pictures.draw(arrow(), views, (300, 100))
    assert pixels.shape == (100, 300, 3)
    seen = [(pixels[:, start : start + 100] != 255).any(axis=2) for start in (0, 100, 200)]
    assert [one.any(axis=0).sum() for one in seen] == pytest.approx([92, 23, 92], abs=2)
    assert [one.any(axis=1).sum() for one in seen] == pytest.approx([23, 23, 23], abs=2)


@pytest.mark.usefixtures("embree")
@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e307])
def test_a_surface_of_any_size_is_drawn(scale: float) -> None:
    """Also where coordinates pass float32; edges are dark lines; nothing is a white picture."""
    sphere = shapes_mesh.sphere()
    surface = Surface(sphere.vertices.astype(np.float64) * scale, sphere.triangles)
    views = directions(parse_views("corner"), "native")
    plain, lined = (pictures.draw(surface, views, (60, 60), edges=edges) for edges in (0, 1.0))
    assert 0.6 < share(plain) < 0.7 and lined.mean() < plain.mean() - 5
    empty = Surface(np.empty((0, 3), np.float32), np.empty((0, 3), np.int32))
    assert (pictures.draw(empty, views, (20, 10)) == 255).all()


@pytest.mark.usefixtures("embree")
def test_vertex_colours_are_drawn() -> None:
    """They go before those of parts."""
    surface = arrow()
    blue = Surface(
        surface.vertices, surface.triangles, parts=surface.parts,
        colours=np.tile(np.array([0, 0, 255], np.uint8), (len(surface.vertices), 1)),
    )
    pixels = pictures.draw(blue, directions(parse_views("corner"), "ras"), (40, 30))
    seen = pixels[(pixels != 255).any(axis=2)].astype(int)
    assert (seen[:, 2] >= seen[:, 0]).all() and (seen[:, 2] >= seen[:, 1]).all()


@pytest.mark.usefixtures("embree")
def test_labels_in_one_file_are_one_picture(tmp_path: Path) -> None:
    """In their own colours."""
    samples = np.zeros((14, 14, 14), np.uint8)
    samples[2:6, 4:10, 4:10], samples[8:12, 4:10, 4:10] = 1, 2
    write_nifti(tmp_path / "labels.nii", samples)
    (tmp_path / "names.csv").write_text("index,name,color\n1,one,#ff0000\n2,two,#00ff00\n")
    result = run(
        tmp_path / "labels.nii", "--labels", "all", "--names", tmp_path / "names.csv", "-o", tmp_path / "a.ply",
        "--picture", tmp_path / "a.png", "--view", "P", "--picture-size", "60x40",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    pixels = read_png(tmp_path / "a.png").astype(int)
    left, right = pixels[20, 15], pixels[20, 45]
    assert left[0] > 2 * left[1] and right[1] > 2 * right[0]


@pytest.mark.usefixtures("embree")
def test_a_picture_counts_for_if_changed_dry_run_and_depfile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is gone, was changed or is asked for otherwise is drawn again; nothing else is."""
    monkeypatch.chdir(tmp_path)
    source = write_nifti(tmp_path / "ball.nii", ball(10))
    plain = (source, "-i", 50, "-o", "b.ply", "--if-changed", "--no-reference")
    order = (*plain, "--picture-size", "40x30", "--picture", "b.png")
    assert "1 done" in run(*order, "--depfile", "b.d").output
    assert (tmp_path / "b.d").read_text().startswith("b.ply b.png: ")
    assert "1 skipped" in run(*order).output
    (tmp_path / "b.png").unlink()
    assert "b.ply and b.png: isovalue 50, run (no picture yet, or changed)" in run(*order, "--dry-run").output
    assert "1 done" in run(*order).output and (tmp_path / "b.png").exists()
    (tmp_path / "b.png").write_bytes(b"another")
    assert "1 done" in run(*order).output
    assert "1 done" in run(*order, "--view", "A").output
    assert "1 skipped" in run(*order, "--view", "A").output
    assert "1 skipped" in run(*plain).output


@pytest.mark.usefixtures("embree")
def test_pictures_overwrite_nothing_that_matters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No output, input, report or other picture; several surfaces need a template."""
    monkeypatch.chdir(tmp_path)
    source = write_nifti(tmp_path / "ball.nii", ball(10))
    (tmp_path / "in.png").symlink_to(source)
    for more, said in [
        (("-i", 50, "-i", 60, "-d", "out", "--picture", "b.png"), "'{stem}_{isovalue}.png'"),
        (("-i", 50, "-o", "b.ply", "--picture", "in.png"), "in.png: is also an input"),
        (("-i", 50, "-o", "b.ply", "--picture", "b.png", "--depfile", "b.png"), "and would be overwritten"),
        (("-i", 50, "-o", "b.ply", "--picture", "b.jpg"), "let the name end in .png"),
        (("-i", 50, "-o", "b.ply", "--picture", "{stm}.png"), "--picture {stm}.png: {stm} is no field"),
        (("-i", 50, "-o", "b.ply", "--view", "A"), "--view: says how a picture is drawn; add --picture"),
        (("-i", 50, "-o", "b.ply", "--picture", "b.png", "--picture-size", "1x1"), "as 1024x768"),
    ]:
        result = run(source, *more)
        assert result.exit_code and said in f"{result.output} {result.exception}", said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["ball.nii", "in.png"]
    small = ("--picture", "o/{stem}-{isovalue}.png", "--picture-size", "20x20")
    assert run(source, "-i", 50, "-i", 60, "-d", "o", *small).exit_code == 0
    assert {path.name for path in (tmp_path / "o").glob("*.png")} == {"ball-50.png", "ball-60.png"}


@pytest.mark.usefixtures("embree")
def test_a_view_that_a_mesh_cannot_have_fails_that_input_before_it_is_written(tmp_path: Path) -> None:
    """A mesh does not say which way its axes point."""
    result = run(SAMPLES / "torus.vtu", "-o", tmp_path / "t.ply", "--picture", tmp_path / "t.png", "--view", "A")
    assert result.exit_code == 1 and "use +x -x +y -y +z -z" in result.output
    assert not list(tmp_path.iterdir())


def test_without_embreex_one_line_says_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before any work."""
    monkeypatch.setattr(pictures, "find_spec", lambda name: None)
    result = run(KNOT, "-o", tmp_path / "k.ply", "--picture", tmp_path / "k.png")
    assert result.exit_code != 0 and not list(tmp_path.iterdir())
    lines = [line for line in f"{result.output}{result.exception or ''}".splitlines() if line]
    assert any("--picture: needs embreex; pip install 'isocore[picture]'" in line for line in lines)


@pytest.mark.usefixtures("embree")
def test_pictures_come_of_a_batch_from_python(tmp_path: Path) -> None:
    """With the fields of names."""
    write_nifti(tmp_path / "ball.nii", ball(10))
    place = str(tmp_path / "{stem}_{isovalue}.png")
    isocore.convert_files(tmp_path / "ball.nii", tmp_path, isovalues=[50, 60], picture=place, view="A,L")
    for name in ("ball_50.png", "ball_60.png"):
        assert share(read_png(tmp_path / name)) > 0.3
    with pytest.raises(OptionError, match=r"let the name end in \.png"):
        isocore.convert_files(tmp_path / "ball.nii", tmp_path, picture="a.jpg")
