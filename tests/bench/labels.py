"""Time the extraction of all labels with smoothing against VTK's surface nets with theirs.

    python tests/bench/labels.py [--only NAME] [--rounds N] [DATA]     (needs vtk)

Ours is all that leads from the samples to the mesh that all labels share, smoothed 20 rounds: the census of labels,
extraction, smoothing. VTK's is one run of vtkSurfaceNets3D with 20 iterations of its own smoothing, told the labels.
Both take turns; figures are medians, and ratios medians of those of each turn. With one thread it is the processor's
time that counts, so that other work on the machine matters little; with two it is the time on the clock, which means
something on an idle machine only. Exit code 1 where a ratio is above 1.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import vtk
from run import ROOT
from vtk.util.numpy_support import numpy_to_vtk

import isocore
from isocore import _kernels
from isocore.methods.label_map import label_ranks, take_census
from isocore.volume import Volume

MUST, ROUNDS_OF_SMOOTHING = 1.0, 20
MAPS = ROOT.parent / "shared" / "data" / "labels"


def maps(folder: Path) -> Iterator[tuple[str, Volume]]:
    """The label maps that are at hand."""
    for path in sorted(folder.iterdir()):
        volume = isocore.read(path)
        if isinstance(volume, Volume):
            yield path.name.split(".")[0], volume


def ours(volume: Volume, threads: int) -> int:
    """Triangles of all labels, smoothed."""
    census = take_census(volume)
    surfaces = _kernels.label_surfaces(volume.samples, census.stored, label_ranks(census.values, 0), threads)
    surfaces.smooth(ROUNDS_OF_SMOOTHING, threads)
    return surfaces.triangles


def image_of(volume: Volume) -> vtk.vtkImageData:
    """The same samples, without a copy."""
    image = vtk.vtkImageData()
    image.SetDimensions(volume.samples.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(volume.samples.reshape(-1, order="F")))
    return image


def theirs(image: vtk.vtkImageData, labels: list[float], threads: int) -> int:
    """Triangles of VTK's surface nets, smoothed."""
    vtk.vtkSMPTools.SetBackend("Sequential" if threads == 1 else "STDThread")
    vtk.vtkSMPTools.Initialize(threads)
    nets = vtk.vtkSurfaceNets3D()
    nets.SetInputData(image)
    for n, label in enumerate(labels):
        nets.SetValue(n, label)
    nets.SmoothingOn()
    nets.SetNumberOfIterations(ROUNDS_OF_SMOOTHING)
    nets.Update()
    return int(nets.GetOutput().GetNumberOfCells())


def timed(run: Callable[[], int], clock: Callable[[], float]) -> float:
    """Seconds of one call, by this clock."""
    start = clock()
    run()
    return clock() - start


def compare(name: str, volume: Volume, rounds: int) -> list[str]:
    """Print a row for each number of threads; what of it is above its must."""
    image, census = image_of(volume), take_census(volume)
    labels = [float(label) for label in census.stored[census.values != 0]]
    missed = []
    for threads, clock in ((1, time.process_time), (2, time.perf_counter)):

        def our_run(threads: int = threads) -> int:
            return ours(volume, threads)

        def their_run(threads: int = threads) -> int:
            return theirs(image, labels, threads)

        counts = our_run(), their_run()  # a warm-up of both
        turns = [(timed(our_run, clock), timed(their_run, clock)) for _ in range(rounds)]
        own, other = (1e3 * statistics.median(each) for each in zip(*turns, strict=True))
        ratio = statistics.median(a / b for a, b in turns)
        print(
            f"| {name} | {len(labels)} | {threads} | {counts[0]:,} | {counts[1]:,} "
            f"| {own:.0f} | {other:.0f} | {ratio:.2f} |",
            flush=True,
        )
        if ratio > MUST:
            missed.append(f"{name}, {threads} threads: {ratio:.2f} of VTK's time, must be {MUST:.2f}")
    return missed


def main() -> None:
    """Print the table and what is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", nargs="?", type=Path, default=MAPS, help="a folder of label maps")
    parser.add_argument("--rounds", type=int, default=11)
    parser.add_argument("--only", default="", help="only maps whose name contains this")
    asked = parser.parse_args()
    print("| map | labels | threads | triangles | VTK's | ms | VTK ms | ratio |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    missed = []
    for name, volume in maps(asked.data):
        if asked.only in name:
            missed += compare(name, volume, asked.rounds)
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
