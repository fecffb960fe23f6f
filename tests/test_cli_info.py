"""`isocore info`, and the facts behind it."""

from __future__ import annotations

import json
import shlex
from itertools import permutations, product
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.info import drawn, info
from shapes import SAMPLES
from small_files import ball, write_nifti

from isocore.cell_mesh import CellMesh
from isocore.describe import orientation
from isocore.extrema import count_extrema
from isocore.histogram import Bars
from isocore.volume import Space, Volume


def run(*arguments: object) -> Result:
    return CliRunner().invoke(info, [str(argument) for argument in arguments])


def test_a_volume_is_described(tmp_path: Path) -> None:
    """Shape, type, spacing, orientation, range, and an isovalue with its option."""
    result = run(write_nifti(tmp_path / "ball.nii", ball(dtype="int16"), slope=2.0, intercept=1.0))
    assert result.exit_code == 0
    for text in ("12 x 12 x 12", "int16", "1 x 1 x 1", "RAS", "1 to ", "slope", "-i auto", "log scale"):
        assert text in result.stdout


def test_json_holds_the_same(tmp_path: Path) -> None:
    """One object per file, also where another cannot be read."""
    good = write_nifti(tmp_path / "ball.nii", ball())
    result = run(good, tmp_path / "missing.nii", "--json")
    (found,) = json.loads(result.stdout)
    assert result.exit_code == 1 and "missing.nii" in result.stderr
    assert found["orientation"] == "RAS" and found["nonfinite"] == 0 and sum(found["histogram"]["counts"]) == 12**3


def test_several_volumes_are_counted(tmp_path: Path) -> None:
    """The first is described where none is chosen."""
    series = write_nifti(tmp_path / "series.nii", np.stack([ball(), ball() * 0], axis=3))
    assert json.loads(run(series, "--json").stdout)[0]["volumes"] == 2
    empty = run(series, "--volume", 1).stdout
    assert "do not differ" in empty


def test_samples_that_are_not_finite_are_counted(tmp_path: Path) -> None:
    """And left out of the range."""
    samples = ball()
    samples[0, 0, :3] = [np.nan, np.inf, -np.inf]
    found = json.loads(run(write_nifti(tmp_path / "ball.nii", samples), "--json").stdout)[0]
    assert found["nonfinite"] == 3 and found["range"][0] == 0


def test_a_mesh_is_described() -> None:
    """Cells by type, fields, extrema."""
    found = json.loads(run(*sorted(SAMPLES.glob("*.vtu")), "--json").stdout)
    assert len(found) == 2
    for mesh in found:
        assert mesh["cells"] and mesh["point fields"] and mesh["minima"] > 0 and mesh["maxima"] > 0


def test_extrema_follow_the_order_of_value_and_number() -> None:
    """A constant field has one of each; a vertex above all others is the only maximum."""
    points = np.array([(i, j, k) for k in range(2) for j in range(2) for i in range(3)], np.float64)
    hexes = np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]], np.int32)

    def extrema(values: list[float]) -> tuple[int, int]:
        array = np.array(values, np.float32)
        return count_extrema(CellMesh(points.copy(), np.zeros((0, 4), np.int32), hexes.copy(), array))

    assert extrema([1.0] * 12) == (1, 1)
    assert extrema([float(value) for value in points @ [1, 10, 100]]) == (1, 1)
    assert extrema([5.0 if value % 2 else 1.0 for value in points.sum(axis=1)]) == (6, 6)


@pytest.mark.parametrize("space", ["ras", "lps", "las"])
def test_orientation_names_all_48_ways(space: Space) -> None:
    """As letters of where each index axis grows to."""
    sides = (("L", "R"), ("P", "A"), ("I", "S"))
    seen = set()
    for order, signs in product(permutations(range(3)), product((-1, 1), repeat=3)):
        affine = np.eye(4)
        affine[:3, :3] = 0
        for column, (row, sign) in enumerate(zip(order, signs, strict=True)):
            affine[row, column] = sign * (column + 1)
        volume = Volume(np.zeros((2, 2, 2), np.uint8, order="F"), affine=affine, space="ras").in_space(space)
        letters, oblique = orientation(volume)
        assert letters == "".join(sides[row][sign > 0] for row, sign in zip(order, signs, strict=True))
        assert not oblique
        seen.add(letters)
    assert len(seen) == 48


def test_a_histogram_is_drawn_in_the_width_it_has() -> None:
    """Every bin a column, rare values still visible."""
    lines = drawn(Bars(0.0, 4.0, (1_000_000, 0, 1, 5)))
    assert len(lines) == 7 and all(len(line) <= 6 for line in lines[:-1])
    assert lines[0].strip() == "█" and lines[-2][4] != " " and lines[-2][3] == " "


def test_what_info_offers_draws_the_same_surface(tmp_path: Path) -> None:
    """Its numbers are exact: `-i` with one of them gives the bytes that `-i otsu` and the others give."""
    scale = np.random.default_rng(0).normal(1, 1e-7, (12, 12, 12))
    path = write_nifti(tmp_path / "pressure.nii", 101325 * scale.astype(np.float64))
    offered = [line.split() for line in run(path).stdout.splitlines() if line.lstrip().startswith("isovalue")]
    assert len(offered) == 4
    for _, number, _, choice, *_ in offered:
        made = []
        for asked in (number, choice):
            out = tmp_path / "out.ply"
            assert CliRunner().invoke(convert, [str(path), "-i", asked, "-o", str(out)]).exit_code == 0
            made.append(out.read_bytes())
        assert made[0] == made[1]


def test_the_range_is_shown_in_the_digits_of_its_type(tmp_path: Path) -> None:
    """A fill value can be pasted behind --ignore."""
    samples = ball()
    samples[0, 0, 0] = np.finfo(np.float32).min
    path = write_nifti(tmp_path / "ball.nii", samples)
    (line,) = [line for line in run(path).stdout.splitlines() if line.lstrip().startswith("range")]
    assert "-3.4028235e+38 to" in line
    assert "-3.4" not in run(path, "--ignore", line.split()[1]).stdout.split("warning")[0]


def pasted(tmp_path: Path, *arguments: object) -> tuple[str, int]:
    """The command that info offers, and how many files it makes in a folder of its own."""
    (command,) = json.loads(run(*arguments, "--json").stdout)[0]["commands"]
    assert f"  command      {command}\n" in run(*arguments).stdout
    program, name, *words = shlex.split(command)
    assert (program, name) == ("isocore", "convert")
    result = CliRunner().invoke(convert, [*words, "-d", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    return command, len(list((tmp_path / "out").iterdir()))


def test_a_mask_is_offered_smoothing(tmp_path: Path) -> None:
    """As a command that runs as it stands, whatever the file's name."""
    path = write_nifti(tmp_path / "my mask's.nii", (ball() > 50).astype(np.uint8))
    command, files = pasted(tmp_path, path)
    assert command.endswith(" --smooth 20") and files == 1
    assert "two values, 0 and 1: it is a mask" in run(path).stdout


def test_a_label_map_is_offered_its_labels(tmp_path: Path) -> None:
    """Of a 4-D file those of the volume that is described; of a raw one with all that its reader was told."""
    samples = np.zeros((12, 12, 12, 2), np.uint8)
    for label, place in enumerate((1, 5, 9), 1):
        samples[place : place + 3, 1:11, 1:11] = label
    command, files = pasted(tmp_path, write_nifti(tmp_path / "seg.nii", samples), "--volume", 1)
    assert command.endswith(" --volume 1 --labels all --smooth 20") and files == 3
    raw = tmp_path / "seg.raw"
    raw.write_bytes(samples[..., 0].tobytes(order="F"))
    told = ("--shape", "12,12,12", "--dtype", "uint8", "--spacing", "0.5,0.5,1", "--ignore", 9)
    command, _ = pasted(tmp_path, raw, *told)
    assert "--shape 12,12,12 --dtype uint8 --spacing 0.5,0.5,1 --ignore 9 --labels all" in command


def test_other_fields_are_offered_no_command(tmp_path: Path) -> None:
    """Their isovalues are what info has to say."""
    path = write_nifti(tmp_path / "ball.nii", ball())
    assert json.loads(run(path, "--json").stdout)[0]["commands"] == []
    assert "command" not in run(path).stdout
