"""Many inputs: crashes, hangs, broken files, resuming, interrupting."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from misbehaving_worker import program
from small_files import ball, write_nifti

from isocore.batches.leftovers import remove_parts
from isocore.batches.one_job import estimate
from isocore.batches.run import Batch, run_jobs
from isocore.batches.stamps import stamp_path
from isocore.job import Job, Target

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()"]
FAST = ("-i", "50", "-b", "mc", "-q")


@pytest.fixture
def scans(tmp_path: Path) -> Path:
    """Twelve good inputs in two folders."""
    for number in range(12):
        folder = tmp_path / "scans" / ("a" if number % 2 else "b")
        write_nifti(folder / f"s{number:02}.nii.gz", ball(radius=3 + number / 10))
    return tmp_path / "scans"


def convert(*arguments: object, rules: tuple[str, ...] = ()) -> subprocess.CompletedProcess[str]:
    command = [*(program(*rules) if rules else PROGRAM), "convert", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def contents(folder: Path) -> dict[str, bytes]:
    """Every file in the folder but the stamps, which hold seconds."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".isocore")
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def outputs(report: Path) -> list[dict[str, Any]]:
    return json.loads(report.read_text())["outputs"]


def test_a_broken_a_crashing_and_a_killed_input_are_three_rows(scans: Path, tmp_path: Path) -> None:
    """All others are converted, and no half-written file is left."""
    (scans / "a" / "s01.nii.gz").write_bytes(b"junk")
    report = tmp_path / "run.json"
    result = convert(scans, "-d", tmp_path / "out", *FAST, "-j", 2, "--report", report, rules=("s02=crash", "s03=oom"))
    assert result.returncode == 1
    failed = {Path(run["source"]).name[:3]: run["message"] for run in outputs(report) if run["status"] == "failed"}
    assert sorted(failed) == ["s01", "s02", "s03"]
    assert "SIGSEGV" in failed["s02"] and "memory" in failed["s03"]
    assert len(contents(tmp_path / "out")) == 9
    assert [run["source"] for run in outputs(report)] == sorted(run["source"] for run in outputs(report))


def test_a_hanging_input_is_given_up(scans: Path, tmp_path: Path) -> None:
    """--timeout ends it; the rest goes on."""
    report = tmp_path / "run.json"
    arguments = (scans, "-d", tmp_path / "out", *FAST, "--timeout", 4, "--report", report)
    assert convert(*arguments, rules=("s05=hang",)).returncode == 1
    (row,) = (run for run in outputs(report) if run["status"] == "failed")
    assert "longer than 4 s" in row["message"] and len(contents(tmp_path / "out")) == 11


def test_workers_write_the_same_bytes_as_one_process(scans: Path, tmp_path: Path) -> None:
    """Whatever the number of jobs."""
    jobs = [
        Job(source=path, targets=(Target("50", tmp_path / "alone" / f"{path.stem}.ply"),), backend="mc")
        for path in sorted(scans.rglob("*.gz"))
    ]
    assert [run.status for _, run in run_jobs(jobs)] == ["done"] * 12
    many = [
        Job(source=job.source, targets=(Target("50", tmp_path / "many" / job.targets[0].output.name),), backend="mc")
        for job in jobs
    ]
    assert sorted(run.status for _, run in run_jobs(many, Batch(workers=2))) == ["done"] * 12
    assert contents(tmp_path / "alone") == contents(tmp_path / "many")


def test_jobs_that_do_not_fit_together_run_one_by_one(scans: Path, tmp_path: Path) -> None:
    """Never more inputs at once than their estimates allow, yet each gets its turn."""
    jobs = [
        Job(source=path, targets=(Target("50", tmp_path / f"{path.stem}.ply"),), backend="mc")
        for path in sorted(scans.rglob("*.gz"))
    ]
    busy: list[int] = []
    batch = Batch(workers=2, memory_bytes=estimate(jobs[0]) + 1)
    assert len(list(run_jobs(jobs, batch, at=lambda now: busy.append(len(now))))) == 12
    assert max(busy) == 1


def test_a_second_run_skips_what_is_up_to_date(scans: Path, tmp_path: Path) -> None:
    """Until the input, an option or the output changes; the record of the first run stays."""
    report = tmp_path / "run.json"
    arguments = (scans, "-d", tmp_path / "out", *FAST, "--if-changed", "--report", report)

    def statuses(*more: object) -> list[str]:
        assert convert(*arguments, *more).returncode == 0
        return [run["status"] for run in outputs(report)]

    assert statuses() == ["done"] * 12
    before = contents(tmp_path / "out")
    assert statuses() == ["skipped"] * 12
    assert all(run["surface"]["triangles"] for run in outputs(report))
    os.utime(scans / "a" / "s01.nii.gz")
    assert statuses() == ["skipped"] * 12
    write_nifti(scans / "a" / "s01.nii.gz", ball(radius=2))
    (tmp_path / "out" / "b" / "s00.ply").write_bytes(b"changed by hand")
    (tmp_path / "out" / "b" / "s02.ply").unlink()
    dry = convert(*arguments, "--dry-run").stdout
    assert [reason in dry for reason in ("input changed", "output changed", "no output yet")] == [True] * 3
    assert sorted(statuses()) == ["done"] * 3 + ["skipped"] * 9
    assert statuses("--no-normals") == ["done"] * 12
    assert statuses("--force") == ["done"] * 12
    assert contents(tmp_path / "out").keys() == before.keys()


def test_requirements_hold_for_skipped_outputs_too(scans: Path, tmp_path: Path) -> None:
    """A gate does not open because a surface is old."""
    arguments = (scans, "-d", tmp_path / "out", *FAST, "--if-changed")
    assert convert(*arguments).returncode == 0
    assert convert(*arguments, "--max-triangles", 5).returncode == 3


def test_a_killed_run_is_finished_by_the_next(scans: Path, tmp_path: Path) -> None:
    """kill -9 at random moments: the same bytes as undisturbed, and nothing else in the folder."""
    assert convert(scans, "-d", tmp_path / "calm", *FAST, "--if-changed").returncode == 0
    tries = int(os.environ.get("ISOCORE_TEST_KILLS", "3"))
    chance = random.Random(5)
    for number in range(tries):
        out = tmp_path / f"killed{number}"
        arguments = [*PROGRAM, "convert", str(scans), "-d", str(out), *FAST, "--if-changed", "-j", "2"]
        process = subprocess.Popen(arguments, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.3, 2.5))
        process.kill()
        process.wait(10)
        assert convert(scans, "-d", out, *FAST, "--if-changed", "-j", 2).returncode == 0
        assert contents(out) == contents(tmp_path / "calm")
        assert not list(out.rglob("*.part"))


@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGINT", 130), ("SIGHUP", 129)])
def test_an_interrupted_run_leaves_a_report_and_no_partial_file(
    scans: Path, tmp_path: Path, name: str, code: int
) -> None:
    """The report holds what was done until then."""
    report = tmp_path / "run.json"
    arguments = [str(scans), "-d", str(tmp_path / "out"), *FAST, "-j", "2", "-v", "--report", str(report)]
    with _interruptible():
        process = subprocess.Popen([*program("s11=hang"), "convert", *arguments], stderr=subprocess.PIPE, text=True)
    watch = threading.Timer(60, process.kill)
    watch.start()
    try:
        assert process.stderr is not None
        said = (line for line in process.stderr if ": done, " in line)
        assert len(list(islice(said, 11))) == 11  # a line comes after its record is kept
        process.send_signal(getattr(signal, name))
        assert process.wait(30) == code
    finally:
        watch.cancel()
        process.kill()
        process.communicate(timeout=10)
    assert len(outputs(report)) == 11 and len(contents(tmp_path / "out")) == 11


@contextmanager
def _interruptible() -> Iterator[None]:
    """Children started here can be interrupted, also where the tests run in the background of a script.

    Such a shell has its jobs ignore SIGINT, nohup SIGHUP, and whoever is started ignoring a signal goes on ignoring it.
    """
    usual = {"SIGINT": signal.default_int_handler, "SIGHUP": signal.SIG_DFL}
    before = {name: signal.signal(getattr(signal, name), to) for name, to in usual.items() if hasattr(signal, name)}
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(getattr(signal, name), handler)


def test_only_our_own_leftovers_are_removed(tmp_path: Path) -> None:
    """Another output's half-written file may be being written right now."""
    for name in ("a.ply.0123abcd.part", "b.ply.0123abcd.part", "a.ply.part", "a.ply"):
        (tmp_path / name).touch()
    remove_parts([tmp_path / "a.ply", tmp_path / "missing" / "c.ply"])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.ply", "a.ply.part", "b.ply.0123abcd.part"]


def test_a_stamp_lies_beside_its_output() -> None:
    """Hidden, and named after it."""
    assert stamp_path(Path("out/bone.ply")) == Path("out/.bone.ply.isocore")


def test_a_depfile_names_every_file_of_an_input(tmp_path: Path) -> None:
    """A detached header and its data, with spaces quoted as make wants them."""
    (tmp_path / "two words.raw").write_bytes(ball().tobytes(order="F"))
    header = ["NRRD0004", "type: float", "dimension: 3", "sizes: 12 12 12", "encoding: raw", "endian: little"]
    (tmp_path / "head.nhdr").write_text("\n".join([*header, "data file: two words.raw", ""]))
    depfile = tmp_path / "out.d"
    result = convert(tmp_path / "head.nhdr", "-o", tmp_path / "x.ply", *FAST, "--depfile", depfile)
    assert result.returncode == 0
    rule = depfile.read_text().splitlines()[0]
    assert rule == f"{tmp_path}/x.ply: {tmp_path}/head.nhdr {tmp_path}/two\\ words.raw"


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
@pytest.mark.parametrize(
    "stem",
    ["a b", "a#b", "a$b", "a$(b)", "a:b", "a*b", "a?b", "a[b]", "~root", "a\\b", "a\\ b", "a&b", "'a'", 'a"b', "a,{b}"],
)
def test_make_finds_a_file_by_its_rule(tmp_path: Path, stem: str) -> None:
    """It makes the output again when the input is newer, and only then; a file like it does not count."""
    write_nifti(tmp_path / f"{stem}.nii", ball())
    command = [*PROGRAM, "convert", f"{stem}.nii", "-d", "out", *FAST, "--depfile", "deps"]
    made = subprocess.run(command, cwd=tmp_path, capture_output=True, timeout=60, check=False)
    assert (made.returncode, made.stderr) == (0, b"")
    rule = (tmp_path / "deps").read_text().splitlines()[0]
    (tmp_path / "Makefile").write_text(f"{rule}\n\t@echo again\n")
    (tmp_path / "ab.nii").touch()
    for age, said in ((100, b"again\n"), (-100, b"")):
        source, output = tmp_path / f"{stem}.nii", tmp_path / "out" / f"{stem}.ply"
        os.utime(source, (output.stat().st_mtime + age,) * 2)
        words = ["make", "-rRs", "-f", "Makefile"]
        ran = subprocess.run(words, cwd=tmp_path, capture_output=True, timeout=60, check=False)
        assert (ran.returncode, ran.stdout if b"again" in ran.stdout else b"") == (0, said), ran.stderr


@pytest.mark.parametrize("stem", ["a;touch gone", "a\nall:\n\ttouch gone\n", "a=b", "a|b", "a%b", "a\tb"])
def test_no_name_becomes_a_command_of_make(tmp_path: Path, stem: str) -> None:
    """What make cannot write is left out, with a warning; the rest is there."""
    for name in (stem, "good"):
        write_nifti(tmp_path / f"{name}.nii", ball())
    command = [*PROGRAM, "convert", f"{stem}.nii", "good.nii", "-d", "out", *FAST, "--depfile", "deps"]
    made = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
    assert made.returncode == 0 and made.stderr.count("\n") == 1
    assert "since make cannot write such a name" in made.stderr
    assert (tmp_path / "deps").read_text() == "out/good.ply: good.nii\ngood.nii:\n"
