"""Warnings of many files: one line for each kind, quiet or not, and none of those that were said before."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.warned import Warned
from records import SURFACE
from small_files import ball, write_nifti

from isocore.report.keys import run_from_dict
from isocore.report.record import BatchReport, RunReport
from isocore.report.render_github import github_annotations


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def warnings(result: Result) -> list[str]:
    return [line for line in result.stderr.splitlines() if line.startswith("isocore: warning: ")]


def scans(folder: Path) -> Path:
    """Eight that are cut by the border, each in its own number of edges, and three that are not."""
    for n in range(11):
        write_nifti(folder / f"s{n}.nii", ball(6 + n % 2) if n < 8 else ball(12))
    return folder


@pytest.mark.parametrize("flags", [(), ("-q",), ("-j", "2")])
def test_many_open_surfaces_are_one_line(tmp_path: Path, flags: tuple[str, ...]) -> None:
    """It says how many of how many; the report says which."""
    report = tmp_path / "run.json"
    result = run(scans(tmp_path / "in"), "-i", 50, "-d", tmp_path / "out", "--report", report, *flags)
    assert warnings(result) == ["isocore: warning: 8 of 11 surfaces are open at the border; --cap closes them"]
    assert f"isocore: {report} lists which" in result.stderr
    told = [record["warnings"] for record in json.loads(report.read_text())["outputs"]]
    assert sum("--cap" in " ".join(texts) for texts in told) == 8


def test_one_open_surface_is_named(tmp_path: Path) -> None:
    """With its number of edges, and no hint at a report."""
    source = write_nifti(tmp_path / "ball.nii", ball(6))
    result = run(source, "-i", 50, "-d", tmp_path / "out")
    (line,) = warnings(result)
    assert line.startswith(f"isocore: warning: {source}: the surface is open") and "edges" in line
    assert "lists which" not in result.stderr


def test_verbose_says_each_warning_at_once(tmp_path: Path) -> None:
    """Below the line of its output, and once only."""
    result = run(scans(tmp_path / "in"), "-i", 50, "-d", tmp_path / "out", "-v")
    assert len(warnings(result)) == 8 and len(set(warnings(result))) == 8
    before = result.stderr.splitlines()[0]
    assert before.startswith(f"{tmp_path}/in/s0.nii -> ") and result.stderr.splitlines()[1] == warnings(result)[0]


def test_surfaces_without_triangles_are_one_line(tmp_path: Path) -> None:
    """And another kind than open ones."""
    result = run(scans(tmp_path / "in"), "-i", 50, "-i", 5000, "-d", tmp_path / "out")
    assert warnings(result)[0].endswith("8 of 22 surfaces are open at the border; --cap closes them")
    assert "11 of 22 surfaces are empty; `isocore info FILE`" in warnings(result)[1] and len(warnings(result)) == 2


def test_what_is_up_to_date_is_not_warned_about_again(tmp_path: Path) -> None:
    """Its record keeps the warnings, so the report still has them."""
    report = tmp_path / "run.json"
    arguments = (scans(tmp_path / "in"), "-i", 50, "-d", tmp_path / "out", "--if-changed", "--report", report)
    assert len(warnings(run(*arguments))) == 1
    again = run(*arguments)
    assert again.exit_code == 0 and not warnings(again) and "11 skipped" in again.stderr
    assert sum(len(record["warnings"]) for record in json.loads(report.read_text())["outputs"]) == 8
    write_nifti(tmp_path / "in" / "s0.nii", ball(6, radius=3.5))
    (line,) = warnings(run(*arguments))
    assert "s0.nii: the surface is open" in line


def test_github_is_not_told_old_warnings() -> None:
    """Of what was skipped."""
    made, skipped = (a_run("a.nii", "no orientation", status=status) for status in ("done", "skipped"))
    assert len(github_annotations(BatchReport((made, skipped)))) == 1


def a_run(source: str, *texts: str, output: str = "", **others: object) -> RunReport:
    record = {"source": source, "output": output or f"{source}.ply", "status": "done", "warnings": list(texts)}
    return run_from_dict(record | others)


def lines(*runs: RunReport) -> list[str]:
    warned = Warned()
    for one in runs:
        warned.add(one)
    return [line.removeprefix("isocore: warning: ") for line in warned.lines()]


def test_a_kind_is_a_text_without_its_numbers_and_paths() -> None:
    """The first of a kind is shown, with how many more there are; others that say the same word by word say so."""
    texts = ("{} samples are not finite", "{}.nii.ply: odd", "no orientation")
    runs = [a_run(f"{n}.nii", *(text.format(n) for text in texts)) for n in range(4)]
    assert lines(*runs, a_run("good.nii")) == [
        "0.nii: 0 samples are not finite (the like for 3 more of 5 inputs)",
        "0.nii: 0.nii.ply: odd (the like for 3 more of 5 inputs)",
        "0.nii: no orientation (the same for 3 more of 5 inputs)",
    ]


def test_a_warning_about_an_input_is_said_once_for_all_its_surfaces() -> None:
    """And one that differs from surface to surface counts them."""
    runs = [a_run("a.nii", "no orientation", f"{n} moved", output=f"{n}.ply", surface=SURFACE) for n in range(3)]
    assert lines(*runs) == ["a.nii: no orientation", "a.nii: 0 moved (the like for 2 more of 3 surfaces)"]


def test_warnings_of_different_kinds_stay_apart() -> None:
    """Also where their numbers are alike, and a control character in one breaks no line."""
    assert lines(a_run("a.nii", "12 samples", "12 voxels\n")) == ["a.nii: 12 samples", "a.nii: 12 voxels\\n"]
