"""Fuzz isocore for a number of inputs or of seconds, on several processes: `make fuzz`.

    python tests/fuzz/run.py --runs 100000 --jobs 2 --seed 7 --targets vtu,index
    python tests/fuzz/run.py --again vtu:7:1234     # makes one input again and runs it here

Prints the executions of each target and every finding; the input that failed is saved. Exit code 1 if there is one.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from fuzz.targets import CASES, TARGETS, random_of  # noqa: E402
from fuzz.worker import AT  # noqa: E402

#: A process that is at the same input for so long hangs; its own clock counts processor time only.
_HANGS_AFTER_SECONDS = 120.0
#: Files that live for a millisecond need no disk.
_MEMORY = Path("/dev/shm")
_MOST_FINDINGS = 200
_TELLS_EVERY_SECONDS = 60.0


@dataclass
class Outcome:
    """executions by target; findings as the workers tell them, and those that ended one."""

    executions: Counter[str] = field(default_factory=Counter)
    findings: list[dict[str, Any]] = field(default_factory=list)


class Worker:
    """One process after the other over a share of the inputs: one that ends early is followed by the next."""

    def __init__(self, targets: list[str], seed: int, first: int, step: int, last: int) -> None:
        self._targets, self._seed, self._next, self._step, self._last = targets, seed, first, step, last
        self._first, self._told = first, 0
        self._folder = tempfile.TemporaryDirectory(prefix="isocore-fuzz-", dir=_MEMORY if _MEMORY.is_dir() else None)
        self._at = Path(self._folder.name) / "at"
        self._log = Path(self._folder.name) / "findings"
        self._process: subprocess.Popen[bytes] | None = None
        self._start()

    def _start(self) -> None:
        self._at.write_bytes(AT.pack(self._next, 0))
        self._started = time.monotonic()
        numbers = map(str, (self._seed, self._next, self._step, self._last))
        command = [sys.executable, "-P", str(HERE / "worker.py"), ",".join(self._targets), *numbers, self._folder.name]
        with self._log.open("ab") as log, Path(self._folder.name, "stderr").open("wb") as errors:
            self._process = subprocess.Popen(command, stdout=log, stderr=errors)

    def poll(self, outcome: Outcome) -> bool:
        """Whether there is more to come; a process that crashed or hangs is told of and followed by another."""
        assert self._process is not None
        self._collect(outcome)
        number, begun = AT.unpack(self._at.read_bytes())
        code = self._process.poll()
        if code is None and time.monotonic() - (begun / 1000 or self._started) > _HANGS_AFTER_SECONDS:
            self._process.kill()
            self._process.wait()
            code = -1
            self._lost(outcome, number, "hang", f"longer than {_HANGS_AFTER_SECONDS:.0f} seconds")
        elif code is None:
            return True
        elif code != 0:
            tail = Path(self._folder.name, "stderr").read_text("utf-8", "replace")[-400:]
            if not begun:
                raise RuntimeError(f"a worker ends before its first input: {tail}")
            self._lost(outcome, number, "crash", f"exit code {code}: {tail}")
        if code == 0 or self._next >= self._last:
            return False
        self._start()
        return True

    def _collect(self, outcome: Outcome) -> None:
        """What the process has told since the last time."""
        lines = self._log.read_bytes().splitlines(keepends=True)
        whole = [line for line in lines if line.endswith(b"\n")]
        outcome.findings += [json.loads(line) for line in whole[self._told :]]
        self._told = len(whole)

    def executions(self) -> Counter[str]:
        """How many inputs of each target there were so far."""
        number, _ = AT.unpack(self._at.read_bytes())
        return Counter(
            self._targets[done % len(self._targets)] for done in range(self._first, min(number, self._last), self._step)
        )

    def _lost(self, outcome: Outcome, number: int, kind: str, detail: str) -> None:
        target = self._targets[number % len(self._targets)]
        outcome.findings.append(
            {"target": target, "seed": self._seed, "number": number, "kind": kind, "detail": detail}
        )
        self._next = number + self._step
        self._at.write_bytes(AT.pack(self._next, 0))

    def stop(self, outcome: Outcome) -> None:
        """End the process, count what was done, and collect what it told."""
        assert self._process is not None
        if self._process.poll() is None:
            self._process.terminate()
        self._process.wait()
        self._collect(outcome)
        outcome.executions += self.executions()
        self._folder.cleanup()


def fuzz(
    targets: Iterable[str],
    *,
    seed: int,
    runs: int,
    jobs: int = 1,
    seconds: float = float("inf"),
    tell: Callable[[Outcome, list[Worker]], None] = lambda outcome, workers: None,
) -> Outcome:
    """Run so many inputs in turn over the targets, or until so many seconds are over; `tell` is called meanwhile."""
    outcome, chosen = Outcome(), list(targets)
    workers = [Worker(chosen, seed, job, jobs, runs) for job in range(min(jobs, runs))]
    working, end = list(workers), time.monotonic() + seconds
    try:
        while working and time.monotonic() < end and len(outcome.findings) < _MOST_FINDINGS:
            time.sleep(0.1)
            working = [worker for worker in working if worker.poll(outcome)]
            tell(outcome, workers)
    finally:
        for worker in workers:
            worker.stop(outcome)
    return outcome


def saved(finding: dict[str, Any], folder: Path) -> Path:
    """The folder with the files of the input that failed, made again."""
    target, seed, number = finding["target"], finding["seed"], finding["number"]
    place = folder / f"{target}-{seed}-{number}"
    place.mkdir(parents=True, exist_ok=True)
    for name, content in CASES[target].made(random_of(target, seed, number)).items():
        (place / name).write_bytes(content)
    (place / "finding.json").write_text(json.dumps(finding, indent=2) + "\n")
    return place


class _Teller:
    """Prints findings as they come, and now and then how far it is."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._told, self._next = folder, 0, time.monotonic() + _TELLS_EVERY_SECONDS

    def findings(self, outcome: Outcome) -> None:
        """Those that were not told yet; their inputs are saved."""
        for finding in outcome.findings[self._told :]:
            print(f"{saved(finding, self._folder)}: {finding['kind']}: {finding['detail']}", flush=True)
        self._told = len(outcome.findings)

    def tell(self, outcome: Outcome, workers: list[Worker]) -> None:
        """Called several times a second."""
        self.findings(outcome)
        if time.monotonic() > self._next:
            self._next += _TELLS_EVERY_SECONDS
            done = sum(worker.executions().total() for worker in workers)
            print(f"{done:,} executions so far", file=sys.stderr, flush=True)


def _again(text: str) -> None:
    target, seed, number = text.split(":")
    random = random_of(target, int(seed), int(number))
    files = CASES[target].made(random)
    with tempfile.TemporaryDirectory(prefix="isocore-fuzz-") as folder:
        for name, content in files.items():
            Path(folder, name).write_bytes(content)
        CASES[target].asked(Path(folder) / next(iter(files)), random)


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=10**9, help="how many inputs; without end by default")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="for how long")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--seed", type=int, default=1, help="another one makes other inputs")
    parser.add_argument("--targets", default=",".join(TARGETS), help="of %(default)s")
    parser.add_argument("--save", type=Path, default=Path("build/fuzz"), help="where inputs that failed go")
    parser.add_argument("--again", metavar="TARGET:SEED:NUMBER", help="run one input in this process")
    asked = parser.parse_args()
    if asked.again:
        _again(asked.again)
        return
    teller = _Teller(asked.save)
    outcome = fuzz(
        asked.targets.split(","),
        seed=asked.seed,
        runs=asked.runs,
        jobs=asked.jobs,
        seconds=asked.seconds,
        tell=teller.tell,
    )
    teller.findings(outcome)
    for target, count in outcome.executions.items():
        print(f"{target:10} {count:12,} executions")
    print(f"{'all':10} {outcome.executions.total():12,} executions, {len(outcome.findings)} findings")
    sys.exit(1 if outcome.findings else 0)


if __name__ == "__main__":
    main()
