"""Peak memory of climbing with a bound, beyond the volume and marching cubes' surface, per vertex of climbing's mesh.

    python tests/bench/simplification_memory.py [--must BYTES] [--only NAME]

What is measured is all that leads from the samples to the surface within half a voxel both ways: climbing, marching
cubes for the reference, simplification with its proofs, placement. Each figure comes from a process of its own, which
has extracted a small surface before. Marching cubes' surface is taken off with 12 bytes a vertex and 12 a triangle.
Exit code 1 where a vertex of a scan takes more than it must. Of the smooth volumes that the bench makes itself,
climbing keeps so few vertices that what counts is the index of marching cubes' surface.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import tempfile
from pathlib import Path

import numpy as np
from memory import resident_bytes
from run import volumes

from isocore import memory
from isocore.backends import Options, prepare
from isocore.volume import Volume

MUST = 200.0
SCANS = ("MNI T1", "t1_crop", "bone")
BOUND = "0.5"


def sizes_of(samples: Path, isovalue: float) -> tuple[int, int]:
    """How many vertices climbing's mesh has, and the bytes of marching cubes' surface."""
    volume = Volume(np.load(samples))
    climbed = prepare(volume, "asc", Options(max_error=BOUND, simplify=False))(isovalue).surface
    marched = prepare(volume, "mc", Options())(isovalue).surface
    return len(climbed.vertices), 12 * (len(marched.vertices) + len(marched.triangles))


def peak_of(samples: Path, isovalue: float, threads: int) -> int:
    """Bytes at the peak that are not the volume; in this process."""
    volume = Volume(np.load(samples))
    small = Volume(np.asfortranarray(volume.samples[:4, :4, :4]))
    prepare(small, "asc", Options(threads=1, max_error=BOUND))(float(small.samples.mean()) + 0.5)
    extract = prepare(volume, "asc", Options(threads=threads, max_error=BOUND))
    memory.forget_peak()
    before = resident_bytes()
    extract(isovalue)
    peak = memory.peak_bytes()
    assert peak is not None
    return peak - before


def main() -> None:
    """Print the table and what is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--must", type=float, default=MUST)
    parser.add_argument("--only", metavar="NAME")
    asked = parser.parse_args()
    print("| volume | threads | climbing's vertices | reference MB | peak beyond the volume MB | bytes a vertex |")
    print("|---|---:|---:|---:|---:|---:|")
    missed = []
    spawn = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as folder:
        samples = Path(folder) / "samples.npy"
        for name, volume, isovalue in volumes():
            if asked.only not in (None, name):
                continue
            np.save(samples, volume.samples)
            with spawn.Pool(1) as pool:
                vertices, surface = pool.apply(sizes_of, (samples, isovalue))
            for threads in (1, 2):
                with spawn.Pool(1) as pool:
                    peak = pool.apply(peak_of, (samples, isovalue, threads))
                each = (peak - surface) / vertices
                row = f"| {name} | {threads} | {vertices:,} | {surface / 1e6:.1f} | {peak / 1e6:.1f} | {each:.0f} |"
                print(row, flush=True)
                if name in SCANS and each > asked.must:
                    missed.append(f"{name}, {threads} threads: {each:.0f} bytes a vertex, must be {asked.must:.0f}")
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
