"""Time climbing and simplification against decimation of marching cubes' mesh to as many triangles.

    python tests/bench/decimation_time.py [--only NAME] [--rounds N]     (needs fast-simplification and meshoptimizer)

What is timed of ours is all that leads from the samples to the surface within half a voxel both ways: climbing,
marching cubes for the reference, simplification with its proofs, placement. Of the others it is their one call, on a
mesh that is there already. All take turns; figures are medians, and ratios medians of those of each turn. With one
thread it is the processor's time that counts, so that other work on the machine matters little; with two it is the time
on the clock, which means something on an idle machine only. Exit code 1 where a ratio is above what must be kept.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import fast_simplification
import meshoptimizer
import numpy as np
from run import volumes

from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.volume import Volume

Run = Callable[[], int]


@dataclass(frozen=True, slots=True)
class Musts:
    """The largest number of triangles, and the largest ratios of our time to a peer's.

    two_rival: to fast-simplification. The least gain of two threads is the same for all.
    """

    triangles: int
    one: float
    two: float
    two_rival: float


MUSTS = {
    "MNI T1": Musts(triangles=47_500, one=2.5, two=1.4, two_rival=1.0),
    "bone": Musts(triangles=128_000, one=3.0, two=1.7, two_rival=1.0),
    "t1_crop": Musts(triangles=215_000, one=3.0, two=1.7, two_rival=1.1),
}
LEAST_GAIN = 1.7


def ours(volume: Volume, stored: float, threads: int) -> Run:
    """All of `asc` within half a voxel, as the report times it."""
    extract = prepare(volume, "asc", Options(threads=threads, max_error="0.5"))
    isovalue = volume.scaled(stored)
    return lambda: len(extract(isovalue).surface.triangles)


def peers(volume: Volume, stored: float, target: int) -> dict[str, Run]:
    """The others, on marching cubes' mesh."""
    vertices, triangles = _kernels.marching_cubes(volume.samples, stored, volume.inside_is_below)[:2]
    indices = triangles.astype(np.uint32).ravel()
    out = np.zeros_like(indices)

    def by_meshoptimizer() -> int:
        return int(meshoptimizer.simplify(out, indices, vertices, target_index_count=3 * target, target_error=1e9) // 3)

    def by_fast_simplification() -> int:
        return len(fast_simplification.simplify(vertices, triangles, target_count=target)[1])

    return {"meshoptimizer": by_meshoptimizer, "fast-simplification": by_fast_simplification}


def timed(run: Run, clock: Callable[[], float]) -> float:
    """Seconds of one call, by this clock."""
    start = clock()
    run()
    return clock() - start


def take_turns(runs: dict[str, tuple[Run, Callable[[], float]]], rounds: int) -> dict[str, list[float]]:
    """Seconds of each round, after a warm-up of each."""
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for run, _ in runs.values():
        run()
    for _ in range(rounds):
        for name, (run, clock) in runs.items():
            seconds[name].append(timed(run, clock))
    return seconds


def ratio(ours: list[float], theirs: list[float]) -> float:
    """The median of each round's."""
    return statistics.median(a / b for a, b in zip(ours, theirs, strict=True))


def compare(name: str, volume: Volume, stored: float, rounds: int) -> list[str]:
    """Print one row; what of it is above its must."""
    musts, one, two = MUSTS[name], ours(volume, stored, 1), ours(volume, stored, 2)
    count = one()
    of_peers = peers(volume, stored, count)
    mesh, rival = of_peers["meshoptimizer"], of_peers["fast-simplification"]
    cpu, wall = time.process_time, time.perf_counter
    runs: dict[str, Any] = {"one": (one, cpu), "two": (two, wall), "mesh": (mesh, cpu), "rival": (rival, cpu)}
    seconds = take_turns(runs, rounds)
    figures = {key: statistics.median(each) for key, each in seconds.items()}
    to_mesh, two_to_mesh = ratio(seconds["one"], seconds["mesh"]), ratio(seconds["two"], seconds["mesh"])
    two_to_rival, gain = ratio(seconds["two"], seconds["rival"]), ratio(seconds["one"], seconds["two"])
    print(
        f"| {name} | {count:,} | {figures['one']:.2f} / {figures['two']:.2f} | {figures['mesh']:.2f} "
        f"| {figures['rival']:.2f} | {to_mesh:.2f} / {two_to_mesh:.2f} | {two_to_rival:.2f} | {gain:.2f} |",
        flush=True,
    )
    checks = (
        ("triangles", count, musts.triangles),
        ("one thread, times meshoptimizer", to_mesh, musts.one),
        ("two threads, times meshoptimizer", two_to_mesh, musts.two),
        ("two threads, times fast-simplification", two_to_rival, musts.two_rival),
        ("two threads, share of one thread's time", 1 / gain, 1 / LEAST_GAIN),
    )
    return [f"{name}: {what}: {found:,.2f}, must be {most:,.2f}" for what, found, most in checks if found > most]


def main() -> None:
    """Print the table and what is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="", help="only volumes whose name contains this")
    asked = parser.parse_args()
    print("| volume | triangles | seconds, 1 / 2 threads | meshoptimizer | fast-simplification ", end="")
    print("| times meshoptimizer, 1 / 2 | times fast-simplification, 2 | gain of two threads |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    missed = []
    for name, volume, stored in volumes():
        if name in MUSTS and asked.only in name:
            missed += compare(name, volume, stored, asked.rounds)
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
