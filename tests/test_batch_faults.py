"""Faults of folders, files and disks around a batch: each costs its own row, with a message, and nothing else."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest
from small_files import ball, write_nifti

from isocore.batches.leftovers import remove_parts
from isocore.batches.stamps import UNHASHED, options_hash
from isocore.job import Job, Target

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


# Two runs in one folder


@contextmanager
def writing(target: Path, *, prefix: str = "") -> Iterator[subprocess.Popen[bytes]]:
    """Another process that is writing this file, and goes on until it is told to finish."""
    code = (
        f"{prefix}\nimport sys\nfrom isocore.whole_file import whole_file\n"
        f"with whole_file({str(target)!r}) as s:\n"
        "    s.write(b'whole'); s.flush(); print('writing', flush=True); sys.stdin.read()"
    )
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-P", "-c", code], **pipes) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == b"writing\n"
            yield process
        finally:
            process.kill()


def parts_in(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if path.name.endswith(".part")]


@pytest.mark.parametrize("name", ["a.ply", "\u8111" * 80 + ".ply", "x" * 250 + ".ply"])
def test_nobody_removes_what_another_run_is_writing(tmp_path: Path, name: str) -> None:
    """Also where that run is stopped for a while; what it leaves when it is killed goes at once."""
    target = tmp_path / name
    with writing(target) as process:
        process.send_signal(signal.SIGSTOP)
        (part,) = parts_in(tmp_path)
        os.utime(part, (time.time() - 3600,) * 2)  # its lock counts, however long it has not grown
        remove_parts([target])
        assert len(parts_in(tmp_path)) == 1
        process.send_signal(signal.SIGCONT)
        process.communicate(b"", timeout=30)
        assert process.returncode == 0 and target.read_bytes() == b"whole" and not parts_in(tmp_path)
    with writing(target) as process:
        process.kill()
        process.wait(10)
        assert len(parts_in(tmp_path)) == 1
        remove_parts([target])
        assert not parts_in(tmp_path)


def test_a_leftover_is_found_behind_a_link(tmp_path: Path) -> None:
    """It lies where the link leads to."""
    (tmp_path / "far").mkdir()
    (tmp_path / "a.ply").symlink_to("far/b.ply")
    with writing(tmp_path / "a.ply") as process:
        process.kill()
        process.wait(10)
        assert len(parts_in(tmp_path / "far")) == 1
        remove_parts([tmp_path / "a.ply"])
        assert not parts_in(tmp_path / "far")


@pytest.mark.parametrize(
    "prefix",
    [
        "import platform; platform.node = lambda: 'another machine'",
        "import fcntl\ndef flock(*_): raise OSError(95, 'not supported')\nfcntl.flock = flock",
    ],
)
def test_where_locks_do_not_tell_age_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prefix: str) -> None:
    """A part from another machine, or on a disk without locks, is left alone until it has not grown for a while."""
    if "flock" in prefix:
        monkeypatch.setattr("isocore.batches.leftovers.lock", lambda stream, wait: None)
    with writing(tmp_path / "a.ply", prefix=prefix) as process:
        process.kill()
        process.wait(10)
    remove_parts([tmp_path / "a.ply"])
    (part,) = parts_in(tmp_path)
    os.utime(part, (time.time() - 3600,) * 2)
    remove_parts([tmp_path / "a.ply"])
    assert not parts_in(tmp_path)


def test_two_runs_at_once_leave_whole_files_and_no_failure(tmp_path: Path) -> None:
    """As overlapping cron jobs do."""
    for number in range(8):
        write_nifti(tmp_path / "in" / f"s{number}.nii", ball(24, radius=6 + number / 10))
    command = [*PROGRAM, "convert", "in", "-d", "out", *FAST, "--if-changed"]
    runs = [subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE) for _ in range(3)]
    said = [run.communicate(timeout=60)[1] for run in runs]
    assert [run.returncode for run in runs] == [0, 0, 0] and said == [b"", b"", b""]
    assert len(list((tmp_path / "out").glob("*.ply"))) == 8 and not parts_in(tmp_path / "out")


# Workers that cannot be started


def without_workers(folder: Path, patch: str, *arguments: object) -> list[dict[str, Any]]:
    """Convert four inputs by a program with this patch; the rows of its report."""
    for number in range(4):
        write_nifti(folder / "in" / f"s{number}.nii", ball())
    code = f"{patch}\nfrom isocore.cli.main import main; main()"
    command = [sys.executable, "-P", "-c", code, "convert", "in", "-d", "out", *FAST, "--report", "r.json"]
    made = subprocess.run([*command, *map(str, arguments)], cwd=folder, capture_output=True, timeout=60, check=False)
    assert made.returncode == 0, made.stderr
    return outputs(folder / "r.json")


@pytest.mark.parametrize(
    ("patch", "told"),
    [
        ("from isocore.batches import workers; workers.COMMAND = ('/no/such/program',)", "No such file or directory"),
        ("import os\nfrom isocore.batches import workers; workers.COMMAND = (os.devnull,)", "Permission denied"),
        (
            "import sys\nfrom isocore.batches import workers\n"
            "workers.COMMAND = (sys.executable, '-c', 'import nowhere')",
            "No module named 'nowhere'",
        ),
        (
            "import threading\nfrom isocore.batches import worker_process as p\n"
            "class T(threading.Thread):\n    def start(self): raise RuntimeError('no thread left')\n"
            "p.threading = type('threading', (), {'Thread': T})",
            "no thread left",
        ),
    ],
)
@pytest.mark.parametrize("more", [("-j", 2), ("-j", 3, "--timeout", 60)])
def test_without_workers_the_program_converts_itself(
    tmp_path: Path, patch: str, told: str, more: tuple[object, ...]
) -> None:
    """And says what that takes away."""
    rows = without_workers(tmp_path, patch, *more)
    assert [row["status"] for row in rows] == ["done"] * 4
    for row in rows:
        (warning,) = (text for text in row["warnings"] if "no worker could be started" in text)
        assert told in warning and ("--timeout" in warning) == ("--timeout" in more)


def test_with_fewer_workers_than_asked_for_the_batch_goes_on(tmp_path: Path) -> None:
    """The second cannot be started; no row suffers, none is converted twice."""
    patch = (
        "import subprocess\nfrom isocore.batches import worker_process as p\nstarted = []\n"
        "class Popen(subprocess.Popen):\n"
        "    def __init__(self, *a, **k):\n"
        "        if started: raise BlockingIOError(11, 'Resource temporarily unavailable')\n"
        "        started.append(1); super().__init__(*a, **k)\n"
        "p.subprocess.Popen = Popen"
    )
    rows = without_workers(tmp_path, patch, "-j", 3)
    assert [(row["status"], row["warnings"]) for row in rows] == [("done", [])] * 4


def test_a_batch_needs_few_open_files_and_no_temporary_folder(tmp_path: Path) -> None:
    """Twenty workers where 64 files may be open, and nowhere to put what they say last."""
    patch = (
        "import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))\n"
        "import tempfile\ndef none(*a, **k): raise FileNotFoundError(2, 'No usable temporary directory found')\n"
        "tempfile.TemporaryFile = none"
    )
    rows = without_workers(tmp_path, patch, "-j", 20)
    assert [(row["status"], row["warnings"]) for row in rows] == [("done", [])] * 4


# What is up to date


def test_what_else_was_asked_for_has_to_be_there_too(tmp_path: Path) -> None:
    """The ambiguous places, of this very surface, and the reference; a report and a depfile are written every time."""
    import numpy as np

    corners = np.zeros((6, 6, 6), np.float32)
    corners[2, 2, 2] = corners[3, 3, 2] = 100
    write_nifti(tmp_path / "a.nii", corners)

    def status(*more: object, isovalue: int = 50, output: str = "a.ply") -> str:
        arguments = ("a.nii", "-i", isovalue, "-b", "mc", "-q", "-o", output, "--if-changed", "--report", "r.json")
        assert isocore(tmp_path, "convert", *arguments, *more).returncode == 0
        return outputs(tmp_path / "r.json")[0]["status"]

    places, depfile = tmp_path / "f.ply", tmp_path / "deps"
    assert status("--no-reference") == "done" and status("--no-reference") == "skipped"
    assert status() == "done" and status() == "skipped" and status("--no-reference") == "skipped"
    assert outputs(tmp_path / "r.json")[0]["reference"]["triangles"] > 0
    assert status("--ambiguities", places) == "done" and places.is_file()
    right = places.read_bytes()
    assert status("--ambiguities", places) == "skipped" and status() == "skipped"
    assert status("--ambiguities", places, isovalue=20, output="b.ply") == "done" and places.read_bytes() != right
    assert status("--ambiguities", places) == "done" and places.read_bytes() == right
    places.unlink()
    assert status("--ambiguities", places) == "done" and places.read_bytes() == right
    assert status("--ambiguities", tmp_path / "g.ply") == "done" and (tmp_path / "g.ply").read_bytes() == right
    assert status("--depfile", depfile) == "skipped" and depfile.is_file()


def test_whatever_changes_the_output_counts() -> None:
    """Every field of a job and of its options, but for those that are listed with a reason."""
    job = Job(source=Path("a.nii"), targets=())
    target = Target("50", Path("x.ply"))
    base = options_hash(job, target)
    other: dict[str, Any] = {"format": "stl", "backend": "mc", "space": "lps", "offset": "1,2,3"}
    packed = replace(job, format="vtp")
    assert options_hash(replace(packed, compress=True), target) != options_hash(packed, target)
    for item in fields(Job):
        if item.name in UNHASHED or item.name in ("options", "read_options", "compress"):
            continue
        value = other.get(item.name, "other")
        assert options_hash(replace(job, **{item.name: value}), target) != base, item.name
    for name in ("options", "read_options"):
        part = getattr(job, name)
        for item in fields(part):
            value = not getattr(part, item.name) if isinstance(getattr(part, item.name), bool) else 7
            value = {"normals": False, "max_error": "0.25", "carry": ("p",)}.get(item.name, value)
            changed = options_hash(replace(job, **{name: replace(part, **{item.name: value})}), target)
            assert (changed != base) == (item.name != "threads"), item.name
    assert options_hash(job, Target("51", Path("x.ply"))) != base


@pytest.mark.parametrize("name", ["x" * 246, "\u8111" * 82])
def test_a_name_that_leaves_no_room_for_a_stamps_own_has_one_all_the_same(tmp_path: Path, name: str) -> None:
    """So that what it names is skipped, too."""
    write_nifti(tmp_path / f"{name}.nii", ball())
    for status in ("done", "skipped"):
        made = isocore(tmp_path, "convert", f"{name}.nii", "-d", "out", *FAST, "--if-changed", "--report", "r.json")
        assert made.returncode == 0 and not made.stderr
        assert outputs(tmp_path / "r.json")[0]["status"] == status
