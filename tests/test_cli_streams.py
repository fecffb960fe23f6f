"""Streams that are closed or full, signals, and what nobody foresaw: one line and an exit code, no traceback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from small_files import ball, write_nifti

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()"]
FULL = Path("/dev/full")
needs_full_disk = pytest.mark.skipif(not FULL.exists(), reason="this system has no device that is always full")
needs_posix = pytest.mark.skipif(os.name == "nt", reason="closes descriptors as POSIX shells do")


@pytest.fixture
def here(tmp_path: Path) -> Path:
    """A folder with a volume and a report of it."""
    write_nifti(tmp_path / "a.nii", ball())
    assert run(tmp_path, "convert", "a.nii", "-i", 50, "-o", "a.ply", "--report", "r.json").returncode == 0
    return tmp_path


def run(folder: Path, *arguments: object, patch: str = "", **settings: Any) -> subprocess.CompletedProcess[str]:
    command = [*PROGRAM[:-1], f"{patch}\n{PROGRAM[-1]}", *map(str, arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | settings
    return subprocess.run(command, cwd=folder, text=True, timeout=60, check=False, **pipes)


def closing(*numbers: int) -> Any:
    """What closes these descriptors before a program starts, as `>&-` does."""

    def close() -> None:
        for number in numbers:
            os.close(number)

    return close


def heeding() -> None:
    """Has a program end at SIGHUP, also where the tests are run by nohup."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


TO_STDOUT = [
    ("--help",),
    ("--version",),
    ("convert", "--help"),
    ("info", "a.nii"),
    ("info", "a.nii", "--json"),
    ("convert", "a.nii", "-i", "50", "-o", "b.ply", "--json", "-q"),
    ("convert", "a.nii", "-i", "50", "-o", "b.ply", "--dry-run"),
    ("convert", "a.nii", "-i", "50", "-o", "-", "-f", "ply", "-q"),
    ("report", "--compare", "r.json", "r.json"),
]


@needs_full_disk
@pytest.mark.parametrize("arguments", TO_STDOUT)
def test_a_full_disk_behind_stdout_is_one_line(here: Path, arguments: tuple[str, ...]) -> None:
    """Exit code 1, for whoever writes results into a file."""
    with FULL.open("w") as full:
        made = run(here, *arguments, stdout=full)
    assert made.returncode == 1 and made.stderr.count("\n") == 1
    assert "stdout: cannot be written (No space left on device)" in made.stderr


@needs_posix
@pytest.mark.parametrize("arguments", TO_STDOUT)
def test_a_closed_stdout_is_one_line(here: Path, arguments: tuple[str, ...]) -> None:
    """Exit code 1; no file that is written takes its place."""
    made = run(here, *arguments, stdout=None, preexec_fn=closing(1))
    assert made.returncode == 1 and made.stderr.count("\n") == 1 and "stdout: cannot be written" in made.stderr


@needs_posix
def test_who_needs_no_stream_misses_none(here: Path) -> None:
    """A conversion with all three closed, alone and with workers: the same bytes, nothing in them that was said."""
    right = (here / "a.ply").read_bytes()
    (here / "b.nii").write_bytes((here / "a.nii").read_bytes())
    for more in (("a.nii",), ("a.nii", "b.nii", "-j", 2)):
        arguments = ("convert", *more, "-i", 50, "-d", "out", "-v", "--report", "s.json")
        closed = {"stdin": None, "stdout": None, "stderr": None, "preexec_fn": closing(0, 1, 2)}
        assert run(here, *arguments, **closed).returncode == 0
        assert (here / "out" / "a.ply").read_bytes() == right
        assert json.loads((here / "s.json").read_text())["totals"]["failed"] == 0


@needs_full_disk
def test_a_full_disk_behind_stderr_stops_nothing(here: Path) -> None:
    """There is nobody to tell; what was asked for is done."""
    (here / "bad.nii").write_bytes(b"junk" * 100)
    with FULL.open("w") as full:
        made = run(here, "convert", "bad.nii", "a.nii", "-i", 50, "-d", "out", "-v", "--report", "s.json", stderr=full)
    assert made.returncode == 1 and (here / "out" / "a.ply").exists()
    assert json.loads((here / "s.json").read_text())["totals"]["done"] == 1
    with FULL.open("w") as full:
        assert run(here, "convert", "a.nii", "-i", 50, "-d", "out", "-v", stderr=full).returncode == 0


@needs_posix
def test_a_list_from_a_closed_stdin_is_a_wrong_command(here: Path) -> None:
    """One line about the list."""
    made = run(here, "convert", "--files-from", "-", "-d", "out", stdin=None, preexec_fn=closing(0))
    assert made.returncode == 2 and "--files-from -: cannot be read" in made.stderr and "Traceback" not in made.stderr


LONG = "x" * 300


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("convert", "a.nii", "-d", LONG), 2),
        (("convert", "a.nii", "-o", f"{LONG}/b.ply"), 2),
        (("convert", "a.nii", "-d", "out", "--report", f"{LONG}/r.json"), 2),
        (("convert", f"{LONG}.nii", "-d", "out"), 1),
        (("convert", "a.nii", "-o", f"{LONG}.ply"), 1),
        (("convert", "a.nii", "-d", "out", "--report", f"{LONG}.json"), 1),
        (("convert", "a.nii", "-d", "out", "--depfile", LONG), 1),
        (("convert", "a.nii", "-d", "out", "--name", LONG), 1),
        (("convert", "/".join(["y" * 200] * 30) + "/a.nii", "-d", "out"), 1),
        (("convert", "--files-from", LONG, "-d", "out"), 2),
        (("info", f"{LONG}.nii"), 1),
        (("index", f"{LONG}.vtu"), 1),
        (("report", f"{LONG}.json"), 1),
        (("report", "r.json", "--to", f"{LONG}.csv"), 1),
    ],
)
def test_a_name_that_is_too_long_is_one_line(here: Path, arguments: tuple[str, ...], code: int) -> None:
    """Whatever is called so: a wrong command where it is a folder's, a failed row or file otherwise."""
    made = run(here, *arguments, *(("-i", "50", "-q") if arguments[0] == "convert" else ()))
    assert made.returncode == code and "Traceback" not in made.stderr and "internal error" not in made.stderr
    assert "File name too long" in made.stderr and all(len(line) < 400 for line in made.stderr.splitlines())


@pytest.mark.parametrize("command", ["info", "index", "bench"])
def test_what_nobody_foresaw_costs_one_file(here: Path, command: str) -> None:
    """With its type, for a report of it; the others are done."""
    fault = (
        "import isocore.describe as d, isocore.readers as r\n"
        "def read(path, *a, **k): raise KeyError(f'no {path.name}')\nd.read = r.read = read"
    )
    (here / "b.nii").write_bytes((here / "a.nii").read_bytes())
    made = run(here, command, "a.nii", "b.nii", patch=fault)
    assert made.returncode == 1 and "Traceback" not in made.stderr
    assert made.stderr.splitlines() == [
        f"isocore: {name}: internal error (KeyError: 'no {name}'); please report it" for name in ("a.nii", "b.nii")
    ]


def test_what_nobody_foresaw_in_a_conversion_is_a_failed_row(here: Path) -> None:
    """With the type of the error, and the others are converted."""
    (here / "b.nii").write_bytes((here / "a.nii").read_bytes())
    fault = (
        "import isocore.pipeline as p\ntrue = p.read\n"
        "def read(path, *a, **k):\n"
        "    if path.name == 'b.nii': raise LookupError('lost\\n\\x1b')\n"
        "    return true(path, *a, **k)\n"
        "p.read = read\n"
        "from isocore.batches.run import Batch\nfrom isocore.cli import running\n"
        "running._batch = lambda jobs, options: Batch()"  # in this process, where these changes hold
    )
    for more in ((), ("--if-changed",)):
        arguments = ("convert", "b.nii", "a.nii", "-i", 50, "-d", "out", "--report", "s.json", *more)
        made = run(here, *arguments, patch=fault)
        assert made.returncode == 1, made.stderr
        rows = {row["source"]: row for row in json.loads((here / "s.json").read_text())["outputs"]}
        assert rows["a.nii"]["status"] in ("done", "skipped")
        assert rows["b.nii"]["message"] == r"b.nii: internal error (LookupError: lost \x1b); please report it"


def test_what_nobody_foresaw_elsewhere_is_one_line(here: Path) -> None:
    """With its type and place; `python -X dev` shows the rest."""
    fault = "import isocore.batches.plan as p\ndef plan(*a, **k): raise ZeroDivisionError('odd')\np.plan = plan"
    made = run(here, "convert", "a.nii", "-d", "out", patch=fault)
    assert made.returncode == 1 and made.stderr.count("\n") == 1
    assert made.stderr.startswith("isocore: internal error (ZeroDivisionError: odd; <string> line 2, `python -X dev`")


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="this system has no SIGHUP")
def test_a_program_that_is_to_outlive_its_terminal_does(here: Path) -> None:
    """As nohup starts it: with SIGHUP ignored."""
    patch = (
        "import os, signal\nfrom isocore.batches import run\ntrue = run.guarded\n"
        "def guarded(job):\n    os.kill(os.getpid(), signal.SIGHUP)\n    yield from true(job)\nrun.guarded = guarded"
    )
    arguments = ("convert", "a.nii", "-i", 50, "-d", "out", "-q")
    ignoring = run(here, *arguments, patch=patch, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    assert ignoring.returncode == 0 and (here / "out" / "a.ply").exists()
    (here / "out" / "a.ply").unlink()
    made = run(here, *arguments, patch=patch, preexec_fn=heeding)
    assert made.returncode == 129 and made.stderr == "isocore: hung up\n" and not (here / "out" / "a.ply").exists()


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="this system has no SIGHUP")
def test_signals_that_come_twice_do_not_disturb_the_cleaning_up(here: Path) -> None:
    """A connection that ends and a service that is stopped send several."""
    patch = (
        "import os, signal\nfrom isocore.writers import WRITERS\n"
        "def write(stream, *a, **k):\n"
        "    stream.write(b'half')\n"
        "    try: os.kill(os.getpid(), signal.SIGHUP); signal.pause()\n"
        "    finally: os.kill(os.getpid(), signal.SIGTERM); os.kill(os.getpid(), signal.SIGHUP)\n"
        "WRITERS['.ply'] = write"
    )
    arguments = ("convert", "a.nii", "-i", 50, "-d", "out", "-q", "--report", "s.json")
    made = run(here, *arguments, patch=patch, preexec_fn=heeding)
    assert made.returncode == 129 and made.stderr == "isocore: hung up\n"
    assert list((here / "out").iterdir()) == [] and json.loads((here / "s.json").read_text())["outputs"] == []


@pytest.mark.parametrize(
    "arguments",
    [
        ("convert", "", "-d", "out"),
        ("convert", "a.nii", "-d", ""),
        ("convert", "a.nii", "-d", "out", "--depfile", ""),
        ("convert", "--files-from", "", "-d", "out"),
        ("info", ""),
        ("report", "r.json", "--to", ""),
    ],
)
def test_an_empty_path_is_a_wrong_command(here: Path, arguments: tuple[str, ...]) -> None:
    """A variable of a script that has no value does not mean the working folder."""
    before = sorted(here.rglob("*"))
    made = run(here, *arguments)
    assert made.returncode == 2 and "is empty; name a file or a folder" in made.stderr
    assert sorted(here.rglob("*")) == before


def test_an_output_with_a_slash_at_its_end_is_no_file(here: Path) -> None:
    """Where there is no such folder, a file of its name would be made in its place."""
    before = sorted(here.rglob("*"))
    made = run(here, "convert", "a.nii", "-i", 50, "-f", "ply", "-o", "meshes/")
    assert made.returncode == 2 and "meshes/ is a folder; name a file in it, or give the folder with -d" in made.stderr
    assert sorted(here.rglob("*")) == before


@needs_posix
def test_where_the_working_folder_is_gone_whole_paths_still_serve(here: Path) -> None:
    """Others are a wrong command, in one line."""
    patch = f"import os\nos.mkdir('gone')\nos.chdir('gone')\nos.rmdir({str(here / 'gone')!r})"
    whole = ("convert", here / "a.nii", "-i", 50, "-q", "-d")
    assert run(here, *whole, here / "out", patch=patch).returncode == 0 and (here / "out" / "a.ply").exists()
    made = run(here, *whole, "out", patch=patch)
    told = "isocore: the working folder is gone; change into one that is there\n"
    assert (made.returncode, made.stderr) == (2, told)


@pytest.mark.skipif(os.name == "nt", reason="this system has no limit of a file's size")
def test_a_limit_of_a_files_size_is_a_failed_row(here: Path) -> None:
    """The signal that comes with it ends no process."""
    patch = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))"
    (here / "b.nii").write_bytes((here / "a.nii").read_bytes())
    made = run(here, "convert", "a.nii", "b.nii", "-i", 50, "-d", "out", "-q", "-j", 2, patch=patch)
    assert made.returncode == 1 and made.stderr.count("(File too large)") == 2 == made.stderr.count("\n")
    assert list((here / "out").iterdir()) == []


@pytest.fixture
def unread() -> Any:
    """A pipe that nobody reads from any more."""
    reader, writer = os.pipe()
    os.close(reader)
    yield writer
    os.close(writer)


@needs_posix
@pytest.mark.parametrize("arguments", [*TO_STDOUT, ("report", "r.json"), ("completion", "bash"), ("bench", "a.nii")])
def test_whoever_leaves_is_told_nothing(here: Path, unread: int, arguments: tuple[str, ...]) -> None:
    """As `head` does; the exit code is that of a program that SIGPIPE ended."""
    made = run(here, *arguments, stdout=unread)
    assert made.returncode == 141
    assert "roken" not in made.stderr and "fail" not in made.stderr and "Traceback" not in made.stderr


@needs_posix
def test_a_surface_that_nobody_reads_is_in_the_reports(here: Path, unread: int) -> None:
    """They and the depfile are whole; nothing lies beside them, and nothing is said."""
    before = set(here.iterdir())
    more = ("--report", "s.json", "--report", "s.html", "--depfile", "deps")
    made = run(here, "convert", "a.nii", "-i", 50, "-o", "-", "-f", "obj", *more, stdout=unread)
    assert made.returncode == 141 and made.stderr == ""
    row = json.loads((here / "s.json").read_text())["outputs"][0]
    assert row["status"] == "failed" and row["message"] == "a.nii: stdout: whoever read it has left"
    assert {path.name for path in set(here.iterdir()) - before} <= {"s.json", "s.html", "s.json.copies", "deps"}


@needs_posix
def test_what_was_asked_for_besides_is_done_when_nobody_reads(here: Path, unread: int) -> None:
    """Surfaces and reports of a batch whose JSON goes to `head`."""
    (here / "b.nii").write_bytes((here / "a.nii").read_bytes())
    arguments = ("convert", "a.nii", "b.nii", "-i", 50, "-d", "out", "--json", "-q", "--report", "s.json", "-j", 2)
    assert run(here, *arguments, stdout=unread).returncode == 141
    assert json.loads((here / "s.json").read_text())["totals"]["done"] == 2
    assert len(list((here / "out").iterdir())) == 2


@needs_posix
def test_a_table_of_a_report_is_a_result(here: Path) -> None:
    """On stdout, for less and grep; stderr is for what went wrong."""
    made = run(here, "report", "r.json")
    assert made.returncode == 0 and made.stderr == "" and "a.ply" in made.stdout and "1 done" in made.stdout
