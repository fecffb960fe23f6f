"""Peak memory of an extraction beyond the volume and its surface, as a share of the volume.

Each figure comes from a process of its own, which has extracted a small surface before, so that neither what an earlier
run left behind nor the interpreter counts. Only where /proc tells the peak.
"""

from __future__ import annotations

import argparse
import itertools
import multiprocessing
import tempfile
from pathlib import Path

import numpy as np
from run import volumes

from isocore import memory
from isocore.backends import Options, prepare
from isocore.volume import Volume

METHODS = {
    "mc": ("mc", {}),
    "asc, no bound": ("asc", {"max_error": "none"}),
    "asc, 0.5 voxel": ("asc", {"max_error": "0.5"}),
}


def resident_bytes() -> int:
    """What the process holds now."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmRSS:"))


def beyond(samples: Path, isovalue: float, method: str, threads: int) -> int:
    """Bytes at the peak that are neither samples nor surface; in this process."""
    volume = Volume(np.load(samples))
    backend, options = METHODS[method]
    small = Volume(np.asfortranarray(volume.samples[:4, :4, :4]))
    prepare(small, backend, Options(threads=1, **options))(float(small.samples.mean()) + 0.5)
    extract = prepare(volume, backend, Options(threads=threads, **options))
    memory.forget_peak()
    before = resident_bytes()
    surface = extract(isovalue).surface
    peak = memory.peak_bytes()
    assert peak is not None
    return peak - before - surface.vertices.nbytes - surface.triangles.nbytes


def main() -> None:
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    print(f"{'volume':14}{'threads':>8}  {'method':16}{'volume MB':>10}{'beyond MB':>10}{'share':>8}")
    with tempfile.TemporaryDirectory() as folder:
        samples = Path(folder) / "samples.npy"
        for name, volume, isovalue in volumes():
            np.save(samples, volume.samples)
            size = volume.samples.nbytes
            for threads, method in itertools.product((1, 2), METHODS):
                with multiprocessing.get_context("spawn").Pool(1) as pool:
                    extra = pool.apply(beyond, (samples, isovalue, method, threads))
                print(f"{name:14}{threads:>8}  {method:16}{size / 1e6:>10.1f}{extra / 1e6:>10.2f}{extra / size:>8.2f}")


if __name__ == "__main__":
    main()
