"""Peak memory of converting a label map, beyond the volume, as a multiple of the surface that all labels share.

    python tests/bench/label_memory.py [--must RATIO] [MAP ...]

The whole command is measured: `isocore convert MAP --labels all --smooth 20 --max-error 0.5`, and the same without the
bound, from reading to the last file written, in a process of its own that has converted a small map before. So neither
the interpreter nor what it imports counts. The surface is the mesh before it is simplified: 12 bytes a vertex, 12 a
triangle; with its labels 8 more a triangle. Exit code 1 where the simplified one's ratio is above what it must be.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import multiprocessing
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import nibabel
import numpy as np
from isocore.cli.main import isocore as command
from memory import resident_bytes
from run import ROOT

from isocore import _kernels, memory, read
from isocore.methods.label_map import label_ranks, take_census
from isocore.volume import Volume

MUST = 3.0
MAPS = (ROOT.parent / "shared" / "data" / "labels" / "julich_lh_207.nii.gz",)
WAYS = {"as it is": (), "smoothed": ("--smooth", "20"), "simplified": ("--smooth", "20", "--max-error", "0.5")}


class Peak(NamedTuple):
    """Bytes: the samples, the shared mesh without and with its labels, and what the process held beyond the samples."""

    volume: int
    surface: int
    labelled: int
    beyond: int


def convert(path: Path, folder: Path, options: tuple[str, ...]) -> None:
    """Run the command in this process, silently."""
    words = ["convert", str(path), "--labels", "all", "-d", str(folder), "--threads", "2", *options]
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        command.main(words, standalone_mode=False)


def peak_of(path: Path, options: tuple[str, ...]) -> Peak:
    """What one conversion takes; in this process."""
    with tempfile.TemporaryDirectory() as folder:
        small = Path(folder) / "small.nii.gz"
        nibabel.save(nibabel.Nifti1Image(np.arange(64, dtype=np.uint8).reshape(4, 4, 4) // 20, np.eye(4)), small)
        convert(small, Path(folder) / "small", options)
        memory.forget_peak()
        before = resident_bytes()
        convert(path, Path(folder) / "meshes", options)
        peak = memory.peak_bytes()
    assert peak is not None
    volume = read(path)
    assert isinstance(volume, Volume)
    census = take_census(volume)
    mesh = _kernels.label_surfaces(volume.samples, census.stored, label_ranks(census.values, 0), 1)
    surface = 12 * (mesh.vertices + mesh.triangles)
    return Peak(volume.samples.nbytes, surface, surface + 8 * mesh.triangles, peak - before - volume.samples.nbytes)


def main() -> None:
    """Print the table and what is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="*", type=Path, default=MAPS)
    parser.add_argument("--must", type=float, default=MUST)
    asked = parser.parse_args()
    print("| map | labels' surfaces | volume MB | surface MB | peak beyond the volume MB | ratio | with its labels |")
    print("|---|---|---:|---:|---:|---:|---:|")
    missed = []
    for path in asked.maps:
        for way, options in WAYS.items():
            with multiprocessing.get_context("spawn").Pool(1) as pool:
                peak = pool.apply(peak_of, (path, options))
            ratio = peak.beyond / peak.surface
            sizes = " | ".join(f"{size / 1e6:.1f}" for size in (peak.volume, peak.surface, peak.beyond))
            print(f"| {path.name} | {way} | {sizes} | {ratio:.2f} | {peak.beyond / peak.labelled:.2f} |", flush=True)
            if ratio > asked.must:
                missed.append(f"{path.name}, {way}: {ratio:.2f} times the surface, must be {asked.must:.2f}")
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
