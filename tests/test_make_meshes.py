"""`make meshes`: pattern rules over a folder of scans, rebuilding only what changed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small_files import ball, write_nifti

RULES = Path(__file__).parent.parent / "examples" / "meshes.mk"
PROGRAM = f"{sys.executable} -P -c 'from isocore.cli.main import main; main()'"


def make(folder: Path, *arguments: str) -> list[str]:
    """The scans that were converted."""
    settings = ["SCANS=scans", "OUT=meshes", "ISO=50", "BACKEND=mc", f"ISOCORE={PROGRAM}", *arguments]
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MAKE")}
    command = ["make", "-j2", "-f", str(RULES), *settings]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120, check=True, env=environment)
    return sorted(
        Path(line.split(" convert ")[1].split()[0]).name for line in run.stdout.splitlines() if " convert " in line
    )


@pytest.mark.skipif(shutil.which("make") is None, reason="no make on this machine")
def test_only_what_changed_is_made_again(tmp_path: Path) -> None:
    """Twice does nothing; a touched scan, a touched data file and other settings do what they must."""
    write_nifti(tmp_path / "scans" / "a.nii.gz", ball())
    write_nifti(tmp_path / "scans" / "deep" / "b.nii", ball())
    header = ["NRRD0004", "type: float", "dimension: 3", "sizes: 12 12 12", "encoding: raw", "endian: little"]
    (tmp_path / "scans" / "c.nhdr").write_text("\n".join([*header, "data file: c.raw", ""]))
    (tmp_path / "scans" / "c.raw").write_bytes(ball().tobytes(order="F"))
    everything = ["a.nii.gz", "b.nii", "c.nhdr"]
    assert make(tmp_path) == everything
    assert sorted(path.name for path in (tmp_path / "meshes").rglob("*.ply")) == ["a.ply", "b.ply", "c.ply"]
    assert make(tmp_path) == []
    now = time.time()
    for path in tmp_path.rglob("*"):
        os.utime(path, (now - 100, now - 100))
    os.utime(tmp_path / "scans" / "deep" / "b.nii", (now - 50, now - 50))
    assert make(tmp_path) == ["b.nii"]
    os.utime(tmp_path / "scans" / "c.raw", (now - 50, now - 50))
    assert make(tmp_path) == ["c.nhdr"]
    assert make(tmp_path, "ISO=60") == everything
