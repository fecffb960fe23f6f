"""Names of files in reports: those that are not UTF-8, and those that a spreadsheet takes for a formula."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from small_files import ball, write_nifti

from isocore.errors import printable
from isocore.report import BatchReport, load_report, renderer_for, save_report
from isocore.report.keys import run_from_dict

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()"]
ENDINGS = ("json", "jsonl", "csv", "md", "html", "xml")
#: As a share of Windows of the last century names it: Latin-1.
LATIN = b"M\xfcller"


def isocore(folder: Path, *arguments: str | bytes, text: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    environment = os.environ | {"LC_ALL": "C.UTF-8", "PYTHONUTF8": "0"}
    command = [*PROGRAM, *arguments]
    return subprocess.run(
        command, cwd=folder, input=text, capture_output=True, timeout=120, check=False, env=environment
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder `in` with a name that is not UTF-8 and one that is."""
    good = write_nifti(tmp_path / "in" / "z.nii", ball(8))
    try:
        Path(os.fsdecode(bytes(good.parent) + b"/" + LATIN + b".nii")).write_bytes(good.read_bytes())
    except OSError:
        pytest.skip("this file system takes UTF-8 names only")
    return tmp_path


def test_a_name_that_is_not_utf8_is_converted_and_reported_in_every_format(folder: Path) -> None:
    """The reports are UTF-8, show the byte as \\xfc, and JSON gives the very name back."""
    reports = [word for ending in ENDINGS for word in ("--report", f"r.{ending}")]
    made = isocore(folder, "convert", "in", "-i", "50", "-d", "out", *reports, "--report", "bench.json")
    assert made.returncode == 0 and rb"M\xfcller.ply" in made.stderr
    assert sorted(os.fsencode(path.name) for path in (folder / "out").iterdir()) == [LATIN + b".ply", b"z.ply"]
    for name in (*(f"r.{ending}" for ending in ENDINGS), "bench.json"):
        text = (folder / name).read_bytes().decode("utf-8")
        assert "ller" in text and ("\\udcfc" if "json" in name else "\\xfc") in text, name
    loaded = load_report(folder / "r.json").outputs
    assert [os.fsencode(run.output) for run in loaded] == [b"out/" + LATIN + b".ply", b"out/z.ply"]
    assert (folder / "r.html").read_text(encoding="utf-8").count('"mesh": {') == 2


def test_isocore_report_renders_such_names_again(folder: Path) -> None:
    """Every format out of the JSON report, and the surface is found for the page."""
    isocore(folder, "convert", "in", "-i", "50", "-d", "out", "--report", "r.json", "-q")
    targets = [word for ending in ENDINGS for word in ("--to", f"again.{ending}")]
    assert isocore(folder, "report", "r.json", *targets).returncode == 0
    assert (folder / "again.html").read_text(encoding="utf-8").count('"mesh": {') == 2
    assert (folder / "again.jsonl").read_text(encoding="utf-8").count("\\udcfc") >= 2
    assert isocore(folder, "report", "--compare", "r.json", "r.json").stdout.count(rb"M\xfcller.ply") == 1


def test_stdout_and_the_depfile_hold_the_names_own_bytes(folder: Path) -> None:
    """make, and whoever reads a dry run or the depfile, finds the file; JSON on stdout stays UTF-8."""
    made = isocore(folder, "convert", "in", "-i", "50", "-d", b"o\xe9", "--depfile", "deps", "--json", "-q")
    assert made.returncode == 0 and len(json.loads(made.stdout.decode("utf-8"))["outputs"]) == 2
    assert b"o\xe9/" + LATIN + b".ply: in/" + LATIN + b".nii\n" in (folder / "deps").read_bytes()
    assert b"in/" + LATIN + b".nii -> " in isocore(folder, "convert", "in", "-i", "50", "--dry-run").stdout
    assert b"in/" + LATIN + b".nii" in isocore(folder, "info", b"in/" + LATIN + b".nii").stdout
    told = isocore(folder, "info", "--json", b"in/" + LATIN + b".nii").stdout.decode("utf-8")
    assert os.fsencode(json.loads(told)[0]["source"]) == b"in/" + LATIN + b".nii"


def test_a_list_of_files_may_hold_any_name(folder: Path) -> None:
    """`find | isocore convert --files-from -`."""
    made = isocore(
        folder, "convert", "--files-from", "-", "-i", "50", "-d", "out", "-q", text=b"in/" + LATIN + b".nii\n"
    )
    assert made.returncode == 0 and [path.name[0] for path in (folder / "out").iterdir()] == ["M"]
    assert isocore(folder, "convert", "--files-from", "-", text=b"a\0b").returncode == 2


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@x", "\tx", "\rx", "\nx", "\uff1d1"])
def test_no_cell_of_a_csv_begins_a_formula(name: str) -> None:
    """An apostrophe goes before it; numbers below zero stay numbers."""
    record = {"source": f"{name}.nii", "output": "out/a.ply", "status": "failed", "message": f"{name}.nii: is broken"}
    rest = {"warnings": [f"{name} w", "b"], "chosen": f"{name} c", "isovalue": -5.0, "surface": {"euler": -2}}
    text = renderer_for(Path("x.csv"))(BatchReport((run_from_dict(record | rest),)))
    (row,) = csv.DictReader(io.StringIO(text, newline=""))
    assert row["source"] == f"'{name}.nii" and row["output"] == "out/a.ply"
    said = f"'{name}" if name.isprintable() else printable(name)
    assert row["message"] == f"{said}.nii: is broken" and row["warnings"] == f"{said} w; b"
    assert row["chosen"] == f"'{name} c" and row["isovalue"] == "-5" and row["surface.euler"] == "-2"


def test_a_lone_surrogate_that_is_no_byte_breaks_no_format(tmp_path: Path) -> None:
    """Such as only a foreign report holds."""
    (tmp_path / "x.json").write_text(
        '{"schema": 1, "outputs": [{"source": "a\\ud800", "output": "\\ud800", "status": "done"}]}'
    )
    batch = load_report(tmp_path / "x.json")
    for ending in ENDINGS:
        save_report(batch, tmp_path / f"y.{ending}")
    assert "\\ud800" in (tmp_path / "y.md").read_text(encoding="utf-8").replace("\\\\", "\\")
    (case,) = ElementTree.parse(tmp_path / "y.xml").iter("testcase")
    assert case.get("classname") == "a\\ud800"
