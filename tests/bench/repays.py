"""From how many isovalues on does thinning a mesh repay itself? `python tests/bench/repays.py [BRICKS...]`.

Smooth tetrahedra; a walk and a full scan take turns at twenty isovalues, by this process's processor time, on one
thread and on two; on two by the time on the clock as well, which means something on an idle machine only.
isocore/backends.py chooses by a fit to the figures of one thread. Exit code 1 where, on two threads, by the clock,
thinning 2 or 6 million tetrahedra and 80 walks take longer than 80 full scans.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from smooth_mesh import smooth_mesh

from isocore import CellMesh
from isocore.backends import Options, Outlook, prepare, repays_thinning

#: Bricks of the meshes for which thinning must repay itself, and by how many isovalues.
MUST_REPAY, ISOVALUES = (70, 100), 80


@dataclass(frozen=True, slots=True)
class Seconds:
    """Of one call: of the processor, and on the clock."""

    processor: float
    clock: float


def timed(run: Callable[[], Any]) -> tuple[Seconds, Any]:
    """How long one call took; and its result."""
    start, started = time.process_time(), time.perf_counter()
    result = run()
    return Seconds(time.process_time() - start, time.perf_counter() - started), result


@dataclass(frozen=True, slots=True)
class Costs:
    """Seconds, by one clock: to thin, for a walk, for a scan; means over the isovalues, medians of the rounds."""

    thin: float
    walk: float
    scan: float

    @property
    def share(self) -> float:
        """Thinning and the walks beside the scans."""
        return (self.thin + ISOVALUES * self.walk) / (ISOVALUES * self.scan)

    def __str__(self) -> str:
        even = f"{self.thin / (self.scan - self.walk):8.0f}" if self.walk < self.scan else "   never"
        return f"{1e3 * self.thin:10.1f}{1e3 * self.walk:9.2f}{1e3 * self.scan:9.2f}{even}{self.share:13.2f}"


def measured(mesh: CellMesh, threads: int, rounds: int) -> dict[str, Costs]:
    """The costs by the processor's time and by the clock."""
    options = Options(threads=threads)
    isovalues = np.linspace(mesh.values.min(), mesh.values.max(), 22)[1:-1].tolist()
    thinned, scan = [], prepare(mesh, "mc", options, Outlook(isovalues=20))
    for _ in range(rounds):
        seconds, walk = timed(lambda: prepare(mesh, "thinning", options, Outlook(isovalues=20)))
        thinned.append(seconds)
    turns: dict[str, list[list[Seconds]]] = {"walk": [], "scan": []}
    for isovalue in isovalues:
        runs = {"walk": partial(walk, isovalue), "scan": partial(scan, isovalue)}
        taken: dict[str, list[Seconds]] = {name: [] for name in runs}
        for _ in range(rounds):
            for name, run in runs.items():
                taken[name].append(timed(run)[0])
        for name in runs:
            turns[name].append(taken[name])

    def by(clock: str) -> Costs:
        median = statistics.median(getattr(each, clock) for each in thinned)
        means = {
            name: statistics.fmean(statistics.median(getattr(each, clock) for each in turn) for turn in of_all)
            for name, of_all in turns.items()
        }
        return Costs(median, means["walk"], means["scan"])

    return {"processor": by("processor"), "clock": by("clock")}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bricks", nargs="*", type=int, default=[10, 24, 40, 70, 100])
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    print("  tetrahedra threads by         thin ms  walk ms  scan ms    even  of 80 scans  chosen from")
    missed = []
    for bricks in asked.bricks:
        mesh = smooth_mesh(bricks)
        for threads in (1, 2):
            costs = measured(mesh, threads, asked.rounds)
            for clock, each in list(costs.items())[:threads]:
                chosen = f"{repays_thinning(mesh.cells):13.0f}"
                print(f"{mesh.cells:>12,}{threads:8} {clock:9}{each}{chosen}", flush=True)
        if bricks in MUST_REPAY and costs["clock"].share > 1:
            missed.append(f"{mesh.cells:,} tetrahedra: {costs['clock'].share:.2f} of {ISOVALUES} scans, must be 1")
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
