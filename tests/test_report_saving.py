"""Reports that cannot be written: the batch goes on, and so do the other reports."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from isocore.cli import running
from isocore.cli.convert import convert
from isocore.cli.report import report
from small_files import ball, write_nifti

from isocore.errors import OutputError
from isocore.report import BatchReport, save_report

FULL = Path("/dev/full")
needs_full_disk = pytest.mark.skipif(not FULL.exists(), reason="this system has no /dev/full to stand for a full disk")


@pytest.fixture
def scans(tmp_path: Path) -> Path:
    """Four good inputs."""
    for number in range(4):
        write_nifti(tmp_path / "in" / f"s{number}.nii", ball(8))
    return tmp_path / "in"


def converted(scans: Path, *arguments: object) -> Result:
    words = (scans, "-i", 50, "-b", "mc", "-d", scans.parent / "out", "--no-progress", *arguments)
    return CliRunner().invoke(convert, [str(word) for word in words])


def sources(path: Path) -> list[str]:
    return [Path(run["source"]).name for run in json.loads(path.read_text())["outputs"]]


@needs_full_disk
def test_a_report_on_a_full_disk_stops_neither_the_batch_nor_other_reports(scans: Path, tmp_path: Path) -> None:
    """One warning, one line at the end, exit code 1; the table is shown."""
    full, good, depfile = tmp_path / "full.json", tmp_path / "good.json", tmp_path / "deps"
    full.symlink_to(FULL)
    result = converted(scans, "--report", full, "--report", good, "--depfile", depfile)
    assert result.exit_code == 1 and len(list((tmp_path / "out").glob("*.ply"))) == 4
    assert sources(good) == ["s0.nii", "s1.nii", "s2.nii", "s3.nii"] and depfile.read_text().count(".ply: ") == 4
    lines = [line for line in result.stderr.splitlines() if str(full) in line]
    assert len(lines) == 2 and all("No space left on device" in line for line in lines)
    assert lines[0].startswith("isocore: warning: ") and "4 done" in result.stderr
    assert result.stderr.splitlines()[-1] == lines[1] and "warning" not in lines[1]


def test_a_report_that_can_be_written_again_is_whole_in_the_end(
    scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that was full for a while costs a warning, and no exit code."""
    tries: list[int] = []

    def hiccup(batch: BatchReport, path: Path, **settings: Any) -> None:
        tries.append(len(batch.outputs))
        if 2 <= len(tries) <= 4:
            raise OutputError(f"{path}: cannot be written (Stale file handle); check the folder and the free space")
        save_report(batch, path, **settings)

    monkeypatch.setattr(running, "save_report", hiccup)
    result = converted(scans, "--report", tmp_path / "r.json")
    assert result.exit_code == 0 and tries == [1, 2, 3, 4, 4]
    assert sources(tmp_path / "r.json") == ["s0.nii", "s1.nii", "s2.nii", "s3.nii"]
    assert result.stderr.count("Stale file handle") == 1


def test_a_fault_of_a_renderer_costs_its_report_only(
    scans: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever it is; the line names its kind."""

    def broken(batch: BatchReport, path: Path, **settings: Any) -> None:
        if path.suffix == ".md":
            raise ZeroDivisionError("of\nall things")
        save_report(batch, path, **settings)

    monkeypatch.setattr(running, "save_report", broken)
    result = converted(scans, "--report", tmp_path / "r.md", "--report", tmp_path / "r.json")
    assert result.exit_code == 1 and len(sources(tmp_path / "r.json")) == 4
    assert f"{tmp_path / 'r.md'}: cannot be made (ZeroDivisionError: of all things)" in result.stderr.splitlines()[-1]


@needs_full_disk
def test_a_depfile_that_cannot_be_written_is_said_after_everything_else(scans: Path, tmp_path: Path) -> None:
    """Exit code 1, since make would not know what to make again."""
    (tmp_path / "deps").symlink_to(FULL)
    result = converted(scans, "--depfile", tmp_path / "deps")
    assert result.exit_code == 1 and "4 done" in result.stderr
    assert result.stderr.splitlines()[-1].startswith(f"isocore: {tmp_path / 'deps'}: cannot be written (No space")


def test_all_reports_of_a_run_say_the_same_seconds(scans: Path, tmp_path: Path) -> None:
    """The clock stops when the last record has come, not when a report is made."""
    result = converted(scans, "--report", tmp_path / "a.json", "--report", tmp_path / "b.json", "--json")
    said = [json.loads(text)["totals"]["seconds"] for text in (result.stdout, (tmp_path / "a.json").read_text())]
    assert said == [json.loads((tmp_path / "b.json").read_text())["totals"]["seconds"]] * 2
    assert f"{said[0]:.2f} s" in result.stderr.splitlines()[-1]


@needs_full_disk
def test_isocore_report_writes_what_it_can(scans: Path, tmp_path: Path) -> None:
    """The targets after the one that cannot be written, too."""
    converted(scans, "--report", tmp_path / "r.json")
    (tmp_path / "full.csv").symlink_to(FULL)
    targets = ["--to", str(tmp_path / "full.csv"), "--to", str(tmp_path / "good.csv")]
    result = CliRunner().invoke(report, [str(tmp_path / "r.json"), *targets])
    assert result.exit_code == 1 and (tmp_path / "good.csv").read_text().count("done") == 4
    assert result.stderr.startswith(f"isocore: {tmp_path / 'full.csv'}: cannot be written (No space left on device)")
