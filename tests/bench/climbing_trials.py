"""Climbing against marching cubes in bulk: random volumes, white noise, published grids, and every real volume.

    python tests/bench/climbing_trials.py --trials 10000

Prints each broken promise with the seed that shows it, and a count at the end; exit code 1 if there is any.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from climbing_promises import compare  # noqa: E402

import isocore  # noqa: E402  # the line above finds the tests' own modules
from isocore.errors import IsocoreError  # noqa: E402
from isocore.readers.options import ReadOptions  # noqa: E402
from isocore.volume import Volume  # noqa: E402

SHARED = ROOT.parent / "shared" / "data"
SIZES = (1, 2, 4, 8, 16, 32)
ERRORS = (math.inf, math.inf, 0.5, 0.2)


def random_volumes(trials: int) -> int:
    """Volumes of 2..9 samples per axis with three to five distinct values, of several types; a seed each."""
    broken = 0
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        values = int(rng.integers(3, 6))
        samples = rng.integers(0, values, rng.integers(2, 10, 3))
        dtype = rng.choice(["uint8", "int16", "uint16", "int32", "float32", "float64"])
        isovalue = float(rng.integers(1, values)) - (0.5 if rng.random() < 0.4 else 0.0)
        volume = Volume(np.asfortranarray(samples.astype(dtype)), slope=-1.0 if rng.random() < 0.25 else 1.0)
        broken += report(
            f"seed {seed}",
            volume,
            volume.scaled(isovalue),
            block_size=int(rng.choice(SIZES)),
            capped=bool(rng.random() < 0.4),
            max_error=float(rng.choice(ERRORS)),
        )
    return broken


def noises() -> int:
    """White noise: floats, and integers with the isovalue in the data."""
    rng = np.random.default_rng(0)
    floats = Volume(np.asfortranarray(rng.standard_normal((70, 64, 61)).astype(np.float32)))
    integers = Volume(np.asfortranarray(rng.integers(0, 8, (66, 60, 65)).astype(np.uint8)))
    return sum(
        report(name, volume, isovalue, block_size=size, max_error=error, capped=size == 8)
        for name, volume, isovalue in (("float noise", floats, 0.1), ("integer noise", integers, 4.0))
        for size in (8, 16, 32)
        for error in (math.inf, 0.5)
    )


def grids() -> int:
    """The published 5^3 grids."""
    path = SHARED / "topology" / "random_5x5x5_shared_2000.npz"
    if not path.exists():
        return 0
    archive = np.load(path)
    samples = next(archive[name] for name in archive.files if archive[name].ndim == 4)
    volumes = (Volume(np.asfortranarray(grid.astype(np.float64))) for grid in samples)
    return sum(report(f"grid {n}", volume, 0.0, block_size=4) for n, volume in enumerate(volumes))


def real_volumes() -> Iterator[tuple[str, Volume]]:
    """Every file of the real data that our readers read as a volume of moderate size."""
    for path in sorted((SHARED / "volumes").rglob("*")):
        if not path.is_file():
            continue
        for options in (ReadOptions(), ReadOptions(volume=0)):
            try:
                field = isocore.read(path, options)
            except (IsocoreError, ValueError):
                continue
            if isinstance(field, Volume) and field.samples.size <= 6e7:
                yield str(path.relative_to(SHARED)), field
            break


def real() -> int:
    """Two isovalues of each real volume, unbounded and with the default bound."""
    broken = 0
    for name, volume in real_volumes():
        samples = np.asarray(volume.samples)
        some = samples[np.isfinite(samples)] if samples.dtype.kind == "f" else samples.ravel()
        if not some.size or some.min() == some.max():
            continue
        for stored in {float(np.quantile(some, 0.9)), (float(some.min()) + float(some.max())) / 2}:
            for error in (math.inf, 0.5):
                broken += report(name, volume, volume.scaled(stored), max_error=error)
    return broken


def report(name: str, volume: Volume, isovalue: float, **options: Any) -> int:
    """1 and a line on the screen if a promise is broken, else 0."""
    found = compare(volume, isovalue, **options)
    if found:
        print(f"{name}, isovalue {isovalue:g}, {options}: {'; '.join(found)}")
    return int(bool(found))


def main() -> None:
    """Run what is asked for, all by default."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=10_000)
    parser.add_argument("--only", choices=("random", "noise", "grids", "real"))
    asked = parser.parse_args()
    parts = {"random": lambda: random_volumes(asked.trials), "noise": noises, "grids": grids, "real": real}
    broken = 0
    for part, run in parts.items():
        if asked.only in (None, part):
            found = run()
            print(f"{part}: {found} broken")
            broken += found
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
