"""Does a surface of any volume meet itself? All volumes below a folder, several isovalues, every method.

    python tests/bench/self_intersections.py ../shared/data/volumes

One line per volume: triangles, pairs that meet by method, and the time of extraction and of the count.
"""

from __future__ import annotations

import sys
from pathlib import Path
from time import process_time

import numpy as np

from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.errors import IsocoreError
from isocore.readers import ReadOptions, read
from isocore.volume import Volume

METHODS = {
    "mc": ("mc", Options()),
    "mc --cap": ("mc", Options(cap=True)),
    "mc --topology trilinear": ("mc", Options(topology="trilinear")),
    "asc": ("asc", Options()),
    "asc --no-simplify": ("asc", Options(simplify=False)),
    "asc --max-error none": ("asc", Options(max_error="none")),
}
#: Shares of the samples below an isovalue.
RANKS = (0.2, 0.5, 0.8, 0.95)


def volumes(path: Path) -> list[Volume]:
    """The file's volume, or its first of several; nothing where it is none or too large."""
    for options in (ReadOptions(), ReadOptions(volume=0)):
        try:
            found = read(path, options)
            return [found] if isinstance(found, Volume) and found.samples.size < 40_000_000 else []
        except IsocoreError:
            continue
    return []


def isovalues(volume: Volume) -> list[float]:
    """Values among the samples' own, where vertices are nearest to each other, and between them."""
    some = np.unique(volume.samples[np.isfinite(volume.samples)])
    if len(some) < 2:
        return []
    among = [some[int(rank * (len(some) - 1))] for rank in RANKS]
    between = [(some[n].astype(float) + some[n + 1]) / 2 for n in (0, len(some) // 2 - 1)]
    return [volume.scaled(float(value)) for value in (*among, *between)]


def main() -> None:
    """Look at everything below the folders that are named."""
    total, broken = 0, 0
    for path in sorted(path for folder in sys.argv[1:] for path in Path(folder).rglob("*") if path.is_file()):
        for volume in volumes(path):
            triangles, pairs, seconds = 0, dict.fromkeys(METHODS, 0), [0.0, 0.0]
            for method, (backend, options) in METHODS.items():
                extract = prepare(volume, backend, options)
                for isovalue in isovalues(volume):
                    start = process_time()
                    surface = extract(isovalue).surface
                    middle = process_time()
                    pairs[method] += _kernels.self_intersections(surface.vertices, surface.triangles, 1)
                    seconds[0] += middle - start
                    seconds[1] += process_time() - middle
                    triangles += len(surface.triangles)
                    total += 1
            broken += any(pairs.values())
            found = ", ".join(f"{method}: {n}" for method, n in pairs.items() if n) or "0 pairs"
            print(f"{path}: {triangles:,} triangles, {found}; {seconds[0]:.2f} s + {seconds[1]:.2f} s", flush=True)
    print(f"{total:,} surfaces; {broken} volumes with a surface that meets itself")


if __name__ == "__main__":
    main()
