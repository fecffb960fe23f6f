"""The same batch on a real dask scheduler with two workers, one of which is killed half-way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from small_files import ball, write_nifti

pytest.importorskip("distributed", reason="dask.distributed is not installed (isocore[cluster])")

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "convert"]
SECONDS = 60.0


def until(ready: Callable[[], bool]) -> None:
    end = time.monotonic() + SECONDS
    while not ready():
        assert time.monotonic() < end, "nothing happened in time"
        time.sleep(0.05)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler's address and its two worker processes, on loopback."""
    address_file = tmp_path / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    command += ["--no-dashboard", "--scheduler-file", str(address_file)]
    processes = [subprocess.Popen(command, cwd=tmp_path, **quiet)]
    try:
        until(address_file.exists)
        for _ in range(2):
            command = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(address_file)]
            command += ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
            processes.append(subprocess.Popen(command, cwd=tmp_path, **quiet))
        import json

        yield json.loads(address_file.read_text())["address"], processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait(10)


def test_a_cluster_gives_the_same_files_although_a_worker_dies(
    tmp_path: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    """Same bytes, same failures, same resume."""
    address, workers = cluster
    scans = tmp_path / "scans"
    for number in range(40):
        write_nifti(scans / f"s{number:02}.nii.gz", ball(24, radius=6 + number / 10))
    (scans / "s40.nii.gz").write_bytes(b"junk")
    settings = ("-i", "50", "-b", "mc", "-q", "--if-changed")
    subprocess.run([*PROGRAM, str(scans), "-d", str(tmp_path / "alone"), *settings], check=False, timeout=120)
    out = tmp_path / "out"
    command = [*PROGRAM, str(scans), "-d", str(out), *settings, "--scheduler", address]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    until(lambda: len(list(out.glob("*.ply"))) > 3)
    os.kill(workers[0].pid, signal.SIGKILL)
    said = running.communicate(timeout=SECONDS)[1]
    assert running.returncode == 1 and said.count("s40.nii.gz") == 1, said
    made = {path.name: path.read_bytes() for path in out.glob("*.ply")}
    assert made == {path.name: path.read_bytes() for path in (tmp_path / "alone").glob("*.ply")} and len(made) == 40
    again = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert again.returncode == 1 and not list(out.glob("*.part"))


def test_a_scheduler_that_does_not_answer_is_a_wrong_command(tmp_path: Path) -> None:
    """One line with the address."""
    write_nifti(tmp_path / "a.nii", ball())
    command = [*PROGRAM, str(tmp_path / "a.nii"), "-d", str(tmp_path), "--scheduler", "tcp://127.0.0.1:9"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert run.returncode == 2 and "127.0.0.1:9" in run.stderr and "Traceback" not in run.stderr
