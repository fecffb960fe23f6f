"""`isocore bench VOLUME` and `convert --ambiguities`, as their users call them."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ET
from pathlib import Path

from click.testing import CliRunner
from isocore.cli.bench import bench
from isocore.cli.convert import convert
from shapes import SAMPLES
from small_files import ball, write_nifti

KNOT = SAMPLES / "knot.nii.gz"


def test_bench_says_what_was_set_aside(tmp_path: Path) -> None:
    """A fill value decides neither the isovalue nor the range of those that thinning walks; --ignore leaves it out."""
    samples = ball()
    samples[:3] = 1e20
    source = str(write_nifti(tmp_path / "ball.nii", samples))
    told = CliRunner().invoke(bench, [source])
    assert told.exit_code == 0 and "432 samples are 1e+20" in told.stderr
    quiet = CliRunner().invoke(bench, [source, "--ignore", "1e20"])
    assert quiet.exit_code == 0 and not quiet.stderr
    table = json.loads(CliRunner().invoke(bench, [source, "-b", "thinning", "--json"]).stdout)[0]["tables"][0]
    assert all(row["intersected"] > 20 * 100 for row in table["rows"])


def test_a_volume_gives_the_papers_table_and_plot(tmp_path: Path) -> None:
    """Block sizes 1 to 32, several bounds, as text, CSV, Markdown and SVG."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    files = {option: tmp_path / f"table.{option}" for option in ("csv", "markdown", "plot")}
    arguments = [x for option, path in files.items() for x in (f"--{option}", str(path))]
    result = CliRunner().invoke(bench, [str(source), "-i", "50", *arguments])
    assert result.exit_code == 0, result.output
    assert "block size" in result.stdout and "Isovalue 50" in result.stdout
    rows = list(csv.DictReader(files["csv"].read_text().splitlines()))
    assert [int(row["block size"]) for row in rows][:6] == [1, 2, 4, 8, 16, 32]
    assert float(rows[0]["mc / asc"]) == 1
    for row in rows:
        assert row["max error"] == "none" or float(row["error max"]) <= float(row["max error"])
        assert row["max error"] == "none" or float(row["simplified back"]) <= float(row["max error"])
        assert row["max error"] == "none" or int(row["simplified"]) < int(row["triangles"])
        assert (row["max error"] == "none") == (row["mc simplified"] == "-")
    assert files["markdown"].read_text().count("\n|") == len(rows) + 2
    drawn = ET.fromstring(files["plot"].read_text())
    assert drawn.tag.endswith("svg") and len(drawn.findall("{*}polyline")) == 2


def test_thinning_meets_its_rivals_on_a_volume(tmp_path: Path) -> None:
    """All of them find the same cells, the octree among them; only the full scan looks at every one."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    result = CliRunner().invoke(bench, [str(source), "-b", "thinning", "--isovalues", "5", "--json"])
    assert result.exit_code == 0, result.output
    rows = {row["method"]: row for row in json.loads(result.stdout)[0]["tables"][0]["rows"]}
    assert {"full scan", "octree", "volume thinning, drawn"} <= set(rows)
    assert len({row["intersected"] for row in rows.values()}) == 1
    assert rows["octree"]["visited"] < rows["full scan"]["visited"]
    assert rows["volume thinning, drawn"]["registered"] < rows["octree"]["registered"]


def test_thinning_on_a_volume_takes_no_isovalue(tmp_path: Path) -> None:
    """An option of the other table is refused, exit code 2."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    result = CliRunner().invoke(bench, [str(source), "-b", "thinning", "-i", "50"])
    assert result.exit_code == 2
    assert "--isovalues" in result.stderr


def test_bench_refuses_an_isovalue_that_draws_nothing(tmp_path: Path) -> None:
    """One line, exit code 1."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    result = CliRunner().invoke(bench, [str(source), "-i", "1e6"])
    assert result.exit_code == 1
    assert "draws no surface" in result.stderr


def test_ambiguous_places_are_written_beside_the_surface(tmp_path: Path) -> None:
    """One input, one isovalue, one file of points."""
    places = tmp_path / "places.ply"
    arguments = [str(KNOT), "-i", "200", "-o", str(tmp_path / "knot.ply"), "--ambiguities", str(places)]
    assert CliRunner().invoke(convert, arguments).exit_code == 0
    assert places.read_bytes().startswith(b"ply\n") and b"saddle_distance" in places.read_bytes()


def test_one_file_of_places_does_not_go_with_two_isovalues(tmp_path: Path) -> None:
    """Refused before anything is read, exit code 2."""
    arguments = [str(KNOT), "-i", "200", "-i", "100", "-d", str(tmp_path), "--ambiguities", "places.ply"]
    result = CliRunner().invoke(convert, arguments)
    assert result.exit_code == 2
    assert "--ambiguities" in result.stderr
