"""Time the reading of VTU files against VTK's reader, and the join of coincident points: `tests/bench/reading.py`.

One mesh is written by VTK in every encoding; ours and VTK's reader take turns, by this process's processor time, and
the figures are medians. Then many small files go through one command, and through a loop of VTK's reader, contour and
writer in a process of its own. Exit code 1 where an encoding takes more than twice VTK's time, joining more than a
third of ours, or the files more than 0.8 of the loop's.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

import numpy as np
from smooth_mesh import smooth_mesh, vtk_grid

from isocore import CellMesh
from isocore.readers import read
from isocore.readers.options import MeshOptions, ReadOptions

MODES = {
    "ascii": lambda writer: writer.SetDataModeToAscii(),
    "base64": lambda writer: writer.SetDataModeToBinary(),
    "appended base64": lambda writer: (writer.SetDataModeToAppended(), writer.EncodeAppendedDataOn()),
    "appended raw": lambda writer: (writer.SetDataModeToAppended(), writer.EncodeAppendedDataOff()),
}
COMPRESSORS = {"plain": None, "zlib": "ZLib", "lz4": "LZ4", "lzma": "LZMA"}
LOOP = """
import sys, vtk
for source in sys.argv[2:]:
    reader = vtk.vtkXMLUnstructuredGridReader(); reader.SetFileName(source)
    contour = vtk.vtkContourGrid(); contour.SetInputConnection(reader.GetOutputPort()); contour.SetValue(0, 0.3)
    contour.SetInputArrayToProcess(0, 0, 0, 0, "values"); contour.ComputeScalarsOff()
    writer = vtk.vtkPLYWriter(); writer.SetInputConnection(contour.GetOutputPort()); writer.SetFileTypeToBinary()
    writer.SetFileName(sys.argv[1] + "/" + source.rsplit("/", 1)[-1] + ".ply"); writer.Write()
"""


MOST = {"encoding": 2.0, "joining": 1 / 3, "files": 0.8}


def write(grid: Any, path: Path, mode: str, compressor: str | None, bits: int) -> None:
    """One file in one encoding."""
    import vtk

    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    MODES[mode](writer)
    getattr(writer, f"SetHeaderTypeToUInt{bits}")()
    writer.SetCompressorTypeToNone()
    if compressor:
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
    writer.Write()


def vtk_read(path: Path) -> None:
    """VTK's reader, which reads all fields there are: one."""
    import vtk

    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()


def medians(runs: list[Callable[[], Any]], rounds: int) -> list[float]:
    """Processor seconds of each run, which take turns."""
    found: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, seconds in zip(runs, found, strict=True):
            start = time.process_time()
            run()
            seconds.append(time.process_time() - start)
    return [statistics.median(seconds) for seconds in found]


def missed(what: str, figure: float, most: float) -> list[str]:
    """A line where it is more."""
    return [f"{what}: {figure:.2f}, must be {most:.2f}"] if figure > most else []


def encodings(folder: Path, mesh: CellMesh, rounds: int) -> list[str]:
    """The table of encodings; what of it is missed."""
    grid, found = vtk_grid(mesh), []
    print(f"{len(mesh.tets):,} tetrahedra{'':26}{'ours ms':>9}{'VTK ms':>9}{'ratio':>7}{'joining':>9}")
    for mode in MODES:
        for label, compressor in COMPRESSORS.items():
            for bits in (32, 64):
                if mode == "ascii" and (compressor or bits == 64):
                    continue
                if compressor == "LZ4" and find_spec("lz4") is None:  # an extra of ours
                    continue
                path = folder / "mesh.vtu"
                write(grid, path, mode, compressor, bits)
                name = f"{mode}, {label}, {bits} bits"
                found += missed(name, row(name, path, rounds)[0], MOST["encoding"])
    write(vtk_grid(apart(mesh)), path, "appended raw", None, 32)
    name = "the same, each cell with points of its own"
    return found + missed(f"{name}, joining", row(name, path, rounds)[1], MOST["joining"])


def apart(mesh: CellMesh) -> CellMesh:
    """The mesh as discontinuous solvers write it: no two cells name the same point."""
    own = np.arange(mesh.tets.size, dtype=np.int32).reshape(-1, 4)
    return CellMesh(mesh.points[mesh.tets.ravel()], own, mesh.hexes, mesh.values[mesh.tets.ravel()])


def row(name: str, path: Path, rounds: int) -> tuple[float, float]:
    """Ours, VTK's, and ours without joining points; our share of VTK's time, and that of joining in ours."""
    alone = ReadOptions(mesh=MeshOptions(keep_duplicates=True))
    ours, theirs, unjoined = medians([lambda: read(path), lambda: vtk_read(path), lambda: read(path, alone)], rounds)
    joining = (ours - unjoined) / ours
    print(f"{name:44}{1e3 * ours:9.1f}{1e3 * theirs:9.1f}{ours / theirs:7.2f}{100 * joining:8.0f}%", flush=True)
    return ours / theirs, joining


def many_files(folder: Path, files: int, rounds: int) -> list[str]:
    """One command against VTK's loop, both on one thread each, by the processor time of the child.

    The first round, which compiles the Python modules as an installation does, does not count.
    """
    mesh, sources = smooth_mesh(24), []
    for number in range(files):
        moved = CellMesh(mesh.points, mesh.tets, mesh.hexes, mesh.values + 0.001 * number, field_name="values")
        sources.append(folder / f"step_{number:03}.vtu")
        write(vtk_grid(moved), sources[-1], "appended raw", None, 32)
    paths = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    paths |= {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONPYCACHEPREFIX": str(folder / "compiled")}
    names = [str(source) for source in sources]
    ours = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "convert", *names, "-i", "0.3"]
    commands = {
        "isocore convert": [*ours, "-d", str(folder / "ours"), "-q"],
        "VTK loop": [sys.executable, "-P", "-c", LOOP, str(folder), *names],
    }
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
    for _ in range(rounds + 1):
        for name, command in commands.items():
            before, start = getrusage(RUSAGE_CHILDREN), time.perf_counter()
            subprocess.run(command, check=True, env=paths, stdout=subprocess.DEVNULL)
            after = getrusage(RUSAGE_CHILDREN)
            spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            seconds[name].append((time.perf_counter() - start, spent))
    print(f"{files} files of {len(mesh.tets):,} tetrahedra, one isovalue, PLY")
    processor = []
    for name, each in seconds.items():
        wall, spent = (statistics.median(column) for column in zip(*each[1:], strict=True))
        processor.append(spent)
        print(f"{name:18} {wall:7.2f} s, {spent:7.2f} s of the processor")
    return missed("many files", processor[0] / processor[1], MOST["files"])


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bricks", type=int, default=40)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--files", type=int, default=60)
    asked = parser.parse_args()
    found: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        if asked.bricks:
            found += encodings(Path(folder), smooth_mesh(asked.bricks), asked.rounds)
        if asked.files:
            found += many_files(Path(folder), asked.files, asked.rounds)
    if found:
        sys.exit("\n".join(found))


if __name__ == "__main__":
    main()
