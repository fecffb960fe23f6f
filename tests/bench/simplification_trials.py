"""Simplification against brute force in bulk: the small random volumes of tests/algorithms/test_simplification.py.

    python tests/bench/simplification_trials.py --trials 10000

Prints each broken promise with the seed that shows it, and a count at the end; exit code 1 if there is any. A volume in
which a triangle stays unproved breaks none, because the program then begins again with marching cubes' surface; but it
must be rare.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS), str(TESTS / "algorithms")]

from simplification_oracle import broken_promises  # noqa: E402
from test_simplification import Case  # noqa: E402  # the lines above find the tests' own modules

_RARE = 1000


def main() -> None:
    """Try every seed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    asked = parser.parse_args()
    broken = collapses = again = 0
    for seed in range(asked.first, asked.first + asked.trials):
        case = Case.random(seed)
        found = case.simplified()
        faults = broken_promises(found[:2], case.marched()[:2], case.bound)
        again += found.unproved > 0
        if faults:
            print(f"seed {seed}: {'; '.join(faults)}", flush=True)
        broken += bool(faults)
        collapses += found.collapses
    print(f"{asked.trials:,} volumes, {collapses:,} collapses: {broken:,} broken, {again:,} with unproved triangles")
    sys.exit(1 if broken or again > max(1, asked.trials // _RARE) else 0)


if __name__ == "__main__":
    main()
