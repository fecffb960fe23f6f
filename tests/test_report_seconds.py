"""One number of seconds: the same on the screen, in JSON, in the page and in Markdown; and where outputs lie."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.report import report
from small_files import ball, write_nifti

from isocore.report.keys import run_as_dict, run_from_dict
from isocore.report.limits import value_of
from isocore.report.sections import Seconds
from isocore.report.summary import HEADINGS

PLACE = HEADINGS.index("seconds")


def called(*words: object) -> Result:
    result = CliRunner().invoke(convert, [str(word) for word in words])
    assert result.exit_code == 0, result.output
    return result


def cells(text: str) -> list[list[str]]:
    """The rows of outputs in a table of text or of Markdown."""
    lines = (line.replace("\\_", "_").replace("|", " ").split() for line in text.splitlines())
    return [line for line in lines if len(line) == len(HEADINGS) and line[0].endswith(".ply")]


def test_seconds_are_one_number_everywhere(tmp_path: Path) -> None:
    """seconds.total of the record, to the third place; also what -v says and --fail-if compares."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    reports = [word for ending in ("json", "md", "html") for word in ("--report", tmp_path / f"r.{ending}")]
    result = called(source, "-i", 50, "-i", 40, "-d", tmp_path / "out", "-v", *reports)
    whole = json.loads((tmp_path / "r.json").read_text())
    totals = [f"{run['seconds']['total']:.3f}" for run in whole["outputs"]]
    own = [f"{run['seconds']['own']:.3f}" for run in whole["outputs"]]
    for text in (result.stderr, (tmp_path / "r.md").read_text()):
        assert [row[PLACE] for row in cells(text)] == totals
        assert [row[PLACE + 1] for row in cells(text)] == own
        assert f"{whole['totals']['seconds']:.2f} s" in text
    told = [line for line in result.stderr.splitlines() if " -> " in line]
    assert [line.rpartition(", ")[2] for line in told] == [f"{total} s" for total in totals]
    shown = re.search(r'id="report">(.*?)</script>', (tmp_path / "r.html").read_text(encoding="utf-8"), re.DOTALL)
    assert shown
    page = json.loads(shown[1])
    assert page["totals"] == whole["totals"]
    assert [run["seconds"] for run in page["outputs"]] == [run["seconds"] for run in whole["outputs"]]
    again = CliRunner().invoke(report, [str(tmp_path / "r.json")])
    assert [row[PLACE] for row in cells(again.stdout)] == totals
    compared = CliRunner().invoke(report, ["--compare", str(tmp_path / "r.json"), str(tmp_path / "r.json")])
    for total in totals:
        assert compared.stdout.count(f" {total} ") >= 2 or float(total) == 0


def test_the_page_shows_those_seconds() -> None:
    """Its script reads the total, and sets the own seconds beside the reference's."""
    text = (Path(__file__).parent.parent / "isocore" / "report" / "page" / "page.js").read_text(encoding="utf-8")
    assert '{ title: "seconds", value: (run) => run.seconds.total,' in text
    assert "const ownSeconds = (run) => (run.surface ? run.seconds.own : null);" in text


def test_own_seconds_are_prepare_and_extract() -> None:
    """Also of a report that was written before it had the key; the ratio to the reference is of these."""
    assert Seconds(read=5, prepare=1, extract=2, normals=4, total=12).own == 3
    record: dict[str, Any] = {"source": "a", "output": "b", "status": "done", "seconds": {"prepare": 0.5, "extract": 1}}
    run = run_from_dict(record)
    assert run_as_dict(run)["seconds"]["own"] == 1.5 == value_of(run, "seconds.own")


def test_what_the_reference_is_set_beside_are_the_own_seconds(tmp_path: Path) -> None:
    """ratio.seconds = seconds.own / reference.seconds."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    called(source, "-i", 50, "-d", tmp_path / "out", "--report", tmp_path / "r.json")
    (run,) = json.loads((tmp_path / "r.json").read_text())["outputs"]
    assert run["ratio"]["seconds"] == pytest.approx(run["seconds"]["own"] / run["reference"]["seconds"])
    stages = (value for key, value in run["seconds"].items() if key not in ("total", "own"))
    assert run["seconds"]["total"] == pytest.approx(sum(stages))


def test_without_a_folder_the_table_says_where_outputs_lie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside each input, by the path that was named; with -d the name is enough."""
    write_nifti(tmp_path / "scans" / "a" / "T1.nii", ball())
    write_nifti(tmp_path / "scans" / "b.nii", ball())
    monkeypatch.chdir(tmp_path)
    beside = called("scans", "-i", 50)
    assert sorted(row[0] for row in cells(beside.stderr)) == ["scans/a/T1.ply", "scans/b.ply"]
    assert beside.stderr.splitlines()[-1].endswith(" s, beside the input")
    elsewhere = called("scans", "-i", 50, "-d", "out")
    assert sorted(row[0] for row in cells(elsewhere.stderr)) == ["T1.ply", "b.ply"]
    assert "beside" not in elsewhere.stderr
    assert "beside" not in called("scans/b.nii", "-i", 50, "-o", "out.ply").stderr
    assert "[default: beside the input]" in " ".join(CliRunner().invoke(convert, ["--help"]).output.split())
