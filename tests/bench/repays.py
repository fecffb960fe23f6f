"""From how many isovalues on does thinning a mesh repay itself? `python tests/bench/repays.py [BRICKS...]`.

Smooth tetrahedra; a walk and a full scan take turns at twenty isovalues, by this process's processor time, on one
thread and on two. isocore/backends.py chooses by a fit to these figures.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from smooth_mesh import smooth_mesh

from isocore.backends import Options, Outlook, prepare, repays_thinning


def seconds(run: Callable[[], Any]) -> tuple[float, Any]:
    """Of the processor, for one call; and its result."""
    start = time.process_time()
    result = run()
    return time.process_time() - start, result


def figures(bricks: int, threads: int, rounds: int) -> str:
    """A line of the table."""
    mesh, options = smooth_mesh(bricks), Options(threads=threads)
    isovalues = np.linspace(mesh.values.min(), mesh.values.max(), 22)[1:-1].tolist()
    prepared = [seconds(lambda: prepare(mesh, "thinning", options, Outlook(isovalues=20))) for _ in range(rounds)]
    walk, scan = prepared[-1][1], prepare(mesh, "mc", options, Outlook(isovalues=20))
    spent: dict[str, list[float]] = {"walk": [], "scan": []}
    for isovalue in isovalues[:1] + rounds * isovalues:
        spent["walk"].append(seconds(lambda isovalue=isovalue: walk(isovalue))[0])
        spent["scan"].append(seconds(lambda isovalue=isovalue: scan(isovalue))[0])
    first = statistics.median(found[0] for found in prepared)
    walked, scanned = (statistics.fmean(each[1:]) for each in spent.values())
    even = f"{first / (scanned - walked):8.0f}" if walked < scanned else "   never"
    return (
        f"{mesh.cells:>12,}{threads:8}{1e3 * first:10.1f}{1e3 * walked:9.2f}{1e3 * scanned:9.2f}{even}"
        f"{repays_thinning(mesh.cells):9.0f}{(first + 80 * walked) / (80 * scanned):12.2f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bricks", nargs="*", type=int, default=[10, 24, 40, 70, 100])
    parser.add_argument("--rounds", type=int, default=3)
    asked = parser.parse_args()
    print("  tetrahedra threads  thin ms  walk ms  scan ms    even   chosen  of 80 scans")
    for bricks in asked.bricks:
        for threads in (1, 2):
            print(figures(bricks, threads, asked.rounds), flush=True)


if __name__ == "__main__":
    main()
