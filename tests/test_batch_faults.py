"""Faults of folders, files and disks around a batch: each costs its own row, with a message, and nothing else."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from small_files import ball, write_nifti

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()"]
FAST = ("-i", "50", "-b", "mc", "-q")
#: A command's start that takes root's leave to read everything, where the tests run as root.
HUMBLE = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]


def isocore(
    folder: Path, *arguments: object, before: list[str] | None = None, seconds: float = 60
) -> subprocess.CompletedProcess[str]:
    command = [*(before or []), *PROGRAM, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=seconds, check=False)


def humble() -> list[str]:
    """What to put before a command so that permissions hold; skips where that cannot be had."""
    if os.geteuid() != 0:
        return []
    if shutil.which("setpriv") is None:
        pytest.skip("runs as root and has no setpriv to drop root's right to read everything")
    return HUMBLE


def outputs(report: Path) -> list[dict[str, Any]]:
    return json.loads(report.read_text())["outputs"]


def test_outputs_are_up_to_date_wherever_their_folder_is(tmp_path: Path) -> None:
    """Moved, or spelled otherwise: skipped rows under the names of now, also in the report."""
    for name in ("a.nii", "b.nii"):
        write_nifti(tmp_path / name, ball())
    arguments = ("a.nii", "b.nii", *FAST, "--if-changed", "--report", "r.json", "-d")
    assert isocore(tmp_path, "convert", *arguments, "out").returncode == 0
    (tmp_path / "out").rename(tmp_path / "moved")
    for spelled in ("moved", str(tmp_path / "moved"), "./b/../moved"):
        (tmp_path / "b").mkdir(exist_ok=True)
        assert isocore(tmp_path, "convert", *arguments, spelled).returncode == 0
        rows = outputs(tmp_path / "r.json")
        assert [(row["status"], row["source"], row["output"]) for row in rows] == [
            ("skipped", name, str(Path(spelled) / f"{name[0]}.ply")) for name in ("a.nii", "b.nii")
        ]
        assert all(row["surface"]["triangles"] for row in rows)


def test_an_unreadable_input_is_a_row_of_its_own(tmp_path: Path) -> None:
    """The others are converted; the command is not refused."""
    for name in ("a.nii", "bad.nii", "c.nii"):
        write_nifti(tmp_path / name, ball())
    (tmp_path / "bad.nii").chmod(0)
    arguments = ("a.nii", "bad.nii", "c.nii", *FAST, "-d", "out")
    made = isocore(tmp_path, "convert", *arguments, before=humble())
    assert made.returncode == 1
    assert made.stderr == "isocore: bad.nii: may not be read; check its permissions\n"
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a.ply", "c.ply"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("more", [(), ("--if-changed",), ("--dry-run", "--if-changed")])
def test_nobody_waits_for_a_pipe_or_a_device(tmp_path: Path, more: tuple[str, ...]) -> None:
    """As input, in a searched folder, as a sidecar and as a header's data."""
    write_nifti(tmp_path / "in" / "ball.nii", ball())
    for name in ("1.nhdr", "2.nii", "3.raw", "3.raw.json", "4.vtu", "5.hdr", "data.bin"):
        os.mkfifo(tmp_path / "in" / name)
    (tmp_path / "in" / "zero.raw").symlink_to("/dev/zero")
    header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: little\ndata file: data.bin\n"
    (tmp_path / "in" / "head.nhdr").write_text(header)
    made = isocore(tmp_path, "convert", "in", "-d", "out", *FAST, *more, "--report", "r.json", seconds=30)
    if "--dry-run" in more:
        assert made.returncode == 0 and len(made.stdout.splitlines()) == 8
        return
    assert made.returncode == 1
    rows = {Path(row["source"]).name: row for row in outputs(tmp_path / "r.json")}
    assert rows.pop("ball.nii")["status"] == "done"
    assert rows.pop("head.nhdr")["message"].endswith("no data.bin beside it; put it there")
    assert sorted(rows) == ["1.nhdr", "2.nii", "3.raw", "4.vtu", "5.hdr", "zero.raw"]
    assert all("is a pipe or a device, not a file" in row["message"] for row in rows.values())
