"""Time isocore against its peers, in one process on the same samples: `make bench`.

Every figure is the median of several runs after one warm-up. Peers and we take turns, and a ratio is the median of
those of each turn, so that it holds when the machine's speed drifts. Writes bench.json with the commit and the machine.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import isocore
from isocore.backends import Options, prepare
from isocore.volume import Volume

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "sample_volumes"))
from knot import knot_field  # noqa: E402

SHARED = ROOT.parent / "shared" / "data" / "volumes"
Run = Callable[[], Any]


def volumes() -> Iterator[tuple[str, Volume, float]]:
    """The volumes that are at hand: name, volume, isovalue."""
    for name, path, isovalue in (
        ("MNI T1", SHARED / "mni" / "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz", 150.0),
        ("t1_crop", SHARED / "mri" / "t1_crop.nii.gz", 60.0),
        ("bone", SHARED / "microct" / "trabecular_bone_gz.nhdr", 63.0),
    ):
        if path.exists():
            volume = isocore.read(path)
            assert isinstance(volume, Volume)
            yield name, volume, volume.stored_isovalue(isovalue)
    knot = knot_field(256)
    yield "knot uint8", Volume(np.asfortranarray(np.trunc(knot).astype(np.uint8))), 200.0
    yield "knot float32", Volume(np.asfortranarray(knot.astype(np.float32))), 200.0
    yield "smooth noise", Volume(smooth_noise(256)), 0.0


def smooth_noise(n: int) -> np.ndarray:
    """White noise, smoothed over about two samples."""
    noise = np.fft.rfftn(np.random.default_rng(0).standard_normal((n, n, n)))
    x, y = np.fft.fftfreq(n)[:, None, None], np.fft.fftfreq(n)[None, :, None]
    z = np.fft.rfftfreq(n)[None, None, :]
    smooth = np.fft.irfftn(noise * np.exp(-2 * (np.pi * 2) ** 2 * (x**2 + y**2 + z**2)), s=(n, n, n), axes=(0, 1, 2))
    return np.asfortranarray(smooth.astype(np.float32))


def ours(volume: Volume, stored: float, backend: str, threads: int, **options: Any) -> Run:
    """`extract` of a backend, placed in the world, as the report times it."""
    extract = prepare(volume, backend, Options(threads=threads, **options))
    isovalue = volume.scaled(stored)
    return lambda: len(extract(isovalue).surface.triangles)


def flying_edges(volume: Volume, stored: float, threads: int) -> Run:
    """VTK's Flying Edges, triangles only; VTK from PyPI threads only with this back end."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk

    image = vtk.vtkImageData()
    image.SetDimensions(*volume.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(volume.samples.ravel(order="K")))
    filter_ = vtk.vtkFlyingEdges3D()
    filter_.SetInputData(image)
    filter_.SetValue(0, stored)
    for off in (filter_.ComputeNormalsOff, filter_.ComputeGradientsOff, filter_.ComputeScalarsOff):
        off()

    def run() -> int:
        vtk.vtkSMPTools.SetBackend("STDThread" if threads > 1 else "Sequential")
        vtk.vtkSMPTools.Initialize(threads)
        filter_.Modified()
        filter_.Update()
        return int(filter_.GetOutput().GetNumberOfPolys())

    return run


def scikit_image(volume: Volume, stored: float) -> Run:
    """scikit-image's Lewiner marching cubes (one thread)."""
    from skimage.measure import marching_cubes

    return lambda: len(marching_cubes(volume.samples, stored)[1])


@dataclass(frozen=True, slots=True)
class Timed:
    """How long each run took, and what came of it."""

    rounds: list[float]
    triangles: int

    @property
    def seconds(self) -> float:
        """The median."""
        return statistics.median(self.rounds)

    def ratio(self, peer: Timed) -> float:
        """The median of the ratios to a peer's runs of the same rounds."""
        return statistics.median(own / other for own, other in zip(self.rounds, peer.rounds, strict=True))


def take_turns(runs: dict[str, Run], rounds: int) -> dict[str, Timed]:
    """Run each in turn, after one warm-up."""
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    triangles = {name: run() for name, run in runs.items()}
    for _ in range(rounds):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            seconds[name].append(time.perf_counter() - start)
    return {name: Timed(seconds[name], triangles[name]) for name in runs}


def machine() -> dict[str, str]:
    """Where these figures come from."""
    head = ["git", "rev-parse", "--short", "HEAD"]
    commit = subprocess.run(head, cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()
    here = {"machine": platform.platform(), "processor": processor(), "python": platform.python_version()}
    return {"commit": commit, **here}


def processor() -> str:
    """The processor's name, where the system tells it."""
    listing = Path("/proc/cpuinfo")
    lines = listing.read_text().splitlines() if listing.exists() else []
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.processor())


def main() -> None:
    """Print the table and write bench.json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--no-scikit-image", action="store_true", help="leave out the slowest peer")
    arguments = parser.parse_args()
    print(f"{'volume':14}{'threads':>8}  {'method':22}{'triangles':>12}{'ms':>10}{'x Flying Edges':>16}")
    rows = []
    for name, volume, stored in volumes():
        for threads in (1, 2):
            runs = {
                "VTK Flying Edges": flying_edges(volume, stored, threads),
                "isocore mc": ours(volume, stored, "mc", threads),
                "isocore asc, no bound": ours(volume, stored, "asc", threads, max_error="none"),
                "isocore asc, 0.5 voxel": ours(volume, stored, "asc", threads, max_error="0.5"),
            }
            if threads == 1 and not arguments.no_scikit_image:
                runs["scikit-image"] = scikit_image(volume, stored)
            timed = take_turns(runs, arguments.rounds)
            for method, own in timed.items():
                ratio = own.ratio(timed["VTK Flying Edges"])
                print(f"{name:14}{threads:>8}  {method:22}{own.triangles:>12,}{1e3 * own.seconds:>10.1f}{ratio:>16.2f}")
                row = {"volume": name, "threads": threads, "method": method, "triangles": own.triangles}
                rows.append({**row, "seconds": own.seconds, "ratio": ratio})
    (ROOT / "bench.json").write_text(json.dumps({**machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
