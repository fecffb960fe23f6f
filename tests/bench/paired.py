"""The speed of two installs side by side: `python tests/bench/paired.py OLD/bin/python NEW/bin/python`.

Each interpreter is a child process that loads its own isocore and its own copy of the fields, then times one call at
a time when asked through a pipe. The two take turns, A B and then B A, so that a machine that speeds up or slows down
does so for both. A timing is the least processor time of a few calls on one thread, so that other work on the machine
counts little. A figure is the median over the rounds of the ratio B / A of one round; below 1 the second is faster.

An interpreter may also be a script that starts one with settings of its own. The child uses the public names of isocore
and of its backends only, so that it runs with earlier and later installs.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

ROOT = Path(__file__).resolve().parent.parent.parent
VOLUMES: dict[str, tuple[str, float]] = {
    "MNI T1": ("volumes/mni/mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz", 150.0),
    "t1_crop": ("volumes/mri/t1_crop.nii.gz", 60.0),
    "bone": ("volumes/microct/trabecular_bone_gz.nhdr", 63.0),
    "knot 64": ("64", 200.0),
    "knot 256": ("256", 200.0),
}
METHODS: dict[str, dict[str, Any]] = {
    "mc": {},
    "mc trilinear": {"topology": "trilinear"},
    "asc 0.5": {"max_error": "0.5"},
    "asc none": {"max_error": "none"},
}
MESH, BRICKS = "mesh 2 M tets", 70
#: A timing makes as many calls as take so long, but not fewer than LEAST_CALLS.
TIMING_SECONDS = 0.1
LEAST_CALLS = 3


def runs(data: Path) -> dict[str, Callable[[], Any]]:
    """What a child can time, by name; what a call needs is made before its first timing."""
    import isocore
    from isocore.backends import Options, prepare

    options = Options(threads=1)

    @cache
    def volume(name: str) -> Any:
        source = VOLUMES[name][0]
        return knot(int(source)) if source.isdigit() else isocore.read(data / source)

    @cache
    def surface(name: str) -> Any:
        return isocore.extract(volume(name), VOLUMES[name][1], backend="mc", options=options)

    @cache
    def mesh() -> Any:
        from smooth_mesh import smooth_mesh

        return smooth_mesh(BRICKS)

    @cache
    def extractor(backend: str) -> Any:
        return prepare(mesh(), backend, options)

    def drawn(name: str, method: str) -> Any:
        chosen = Options(threads=1, **METHODS[method])
        return isocore.extract(volume(name), VOLUMES[name][1], backend=method.split()[0], options=chosen)

    found: dict[str, Callable[[], Any]] = {}
    for name, (source, _) in VOLUMES.items():
        if source.isdigit() or (data / source).is_file():
            for method in METHODS:
                found[f"{name}: {method}"] = lambda name=name, method=method: drawn(name, method)
            found[f"{name}: measure"] = lambda name=name: isocore.measure(surface(name), 1)
    found[f"{MESH}: thinning prepare"] = lambda: prepare(mesh(), "thinning", options)
    for backend in ("thinning", "mc"):
        found[f"{MESH}: {backend} isovalue"] = lambda backend=backend: extractor(backend)(0.3)
    command = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "--help"]
    found["isocore --help"] = lambda: subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return found


def knot(samples_per_axis: int) -> Any:
    """The knot as uint8, as the sample is made."""
    import numpy as np

    import isocore

    sys.path.insert(0, str(ROOT / "sample_volumes"))
    from knot import knot_field

    return isocore.Volume(np.asfortranarray(np.trunc(knot_field(samples_per_axis)).astype(np.uint8)))


def answer(data: Path) -> None:
    """The child: a line names a run and how often to call it, the answer is the least seconds of a call."""
    found = runs(data)
    print(json.dumps(list(found)), flush=True)
    for line in sys.stdin:
        name, calls = json.loads(line)
        print(json.dumps(min(processor_seconds(found[name]) for _ in range(calls))), flush=True)


def processor_seconds(run: Callable[[], Any]) -> float:
    """What one call takes of the processor, in this process and in the children it waits for."""
    before = getrusage(RUSAGE_CHILDREN)
    start = time.process_time()
    result = run()
    own = time.process_time() - start
    del result
    after = getrusage(RUSAGE_CHILDREN)
    return own + after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


class Install:
    """A child process with one install, and its runs' names."""

    def __init__(self, python: str, data: Path) -> None:
        self.python = python
        self._child = subprocess.Popen(
            [python, __file__, "--child", "--data", str(data)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.names: list[str] = self._line()

    def _line(self) -> Any:
        assert self._child.stdout is not None
        line = self._child.stdout.readline()
        if not line:
            raise SystemExit(f"{self.python}: its process ended, code {self._child.wait()}")
        return json.loads(line)

    def seconds(self, name: str, calls: int) -> float:
        """The least seconds of that many calls, by the child's clock."""
        assert self._child.stdin is not None
        self._child.stdin.write(json.dumps((name, calls)) + "\n")
        self._child.stdin.flush()
        return float(self._line())

    def close(self) -> None:
        """End the child by the end of its input."""
        assert self._child.stdin is not None
        self._child.stdin.close()
        self._child.wait()


@dataclass(frozen=True, slots=True)
class Pair:
    """The seconds of each round, of both installs."""

    first: list[float]
    second: list[float]

    @property
    def ratios(self) -> list[float]:
        """second / first, of each round, from small to large."""
        return sorted(b / a for a, b in zip(self.first, self.second, strict=True))


def take_turns(one: Install, other: Install, name: str, rounds: int) -> Pair:
    """Rounds after a warm-up of both; who goes first alternates."""
    quickest = min(one.seconds(name, 2), other.seconds(name, 2))
    calls = max(LEAST_CALLS, round(TIMING_SECONDS / max(1e-6, quickest)))
    first, second = [], []
    for turn in range(rounds):
        if turn % 2 == 0:
            first.append(one.seconds(name, calls))
            second.append(other.seconds(name, calls))
        else:
            second.append(other.seconds(name, calls))
            first.append(one.seconds(name, calls))
    return Pair(first, second)


def row(name: str, pair: Pair) -> float:
    """Print one line of the table; the median ratio."""
    ratios, first, second = pair.ratios, statistics.median(pair.first), statistics.median(pair.second)
    middle = statistics.median(ratios)
    quarter = len(ratios) // 4
    spread = f"{ratios[quarter]:.3f} to {ratios[-1 - quarter]:.3f}"
    print(f"{name:34}{1e3 * first:10.2f}{1e3 * second:10.2f}{middle:8.3f}   {spread}", flush=True)
    return middle


def main() -> None:
    """Print the table; exit code 1 where a median ratio is above the limit."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pythons", nargs="*", metavar="PYTHON", help="the first and the second install's interpreter")
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="folder of real volumes")
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("--only", default="", help="only rows whose name contains this")
    parser.add_argument("--limit", type=float, help="exit with 1 where a median ratio is above this")
    parser.add_argument("--child", action="store_true", help="be one of the two processes")
    asked = parser.parse_args()
    if asked.child:
        answer(asked.data)
        return
    if len(asked.pythons) != 2:
        parser.error("name two interpreters")
    one, other = (Install(python, asked.data) for python in asked.pythons)
    print(f"{'':34}{'A ms':>10}{'B ms':>10}{'B / A':>8}   middle half of the rounds")
    slower = []
    for name in [name for name in one.names if name in other.names and asked.only in name]:
        if row(name, take_turns(one, other, name, asked.rounds)) > (asked.limit or float("inf")):
            slower.append(name)
    for install in (one, other):
        install.close()
    if slower:
        sys.exit(f"above {asked.limit}: {', '.join(slower)}")


if __name__ == "__main__":
    main()
