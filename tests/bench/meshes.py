"""Time thinning against our own full scan and VTK's scalar tree, in one process: `python tests/bench/meshes.py`.

Two million tetrahedra by default, a smooth field, twenty isovalues, merged points. All three take turns at every
isovalue; the figures are medians over the isovalues.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from smooth_mesh import smooth_mesh, vtk_grid

from isocore.backends import Options, Outlook, prepare
from isocore.cell_mesh import CellMesh


def scalar_tree(mesh: CellMesh, threads: int) -> Callable[[float], int]:
    """VTK's vtkContour3DLinearGrid (which merges points) with vtkSpanSpace, built before the first figure."""
    import vtk

    vtk.vtkSMPTools.SetBackend("STDThread" if threads > 1 else "Sequential")
    vtk.vtkSMPTools.Initialize(threads)
    contour, tree = vtk.vtkContour3DLinearGrid(), vtk.vtkSpanSpace()
    contour.SetInputData(vtk_grid(mesh))
    contour.SetInterpolateAttributes(False)
    contour.SetUseScalarTree(True)
    contour.SetScalarTree(tree)

    def run(isovalue: float) -> int:
        contour.SetValue(0, isovalue)
        contour.Update()
        return int(contour.GetOutput().GetNumberOfPolys())

    return run


def ours(mesh: CellMesh, backend: str, threads: int) -> tuple[Callable[[float], int], float]:
    """A backend's extraction, and the seconds its preparation took."""
    start = time.perf_counter()
    extract = prepare(mesh, backend, Options(threads=threads), Outlook(isovalues=20))
    return lambda isovalue: len(extract(isovalue).surface.triangles), time.perf_counter() - start


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bricks", type=int, default=70)
    mesh = smooth_mesh(parser.parse_args().bricks)
    isovalues = np.linspace(mesh.values.min(), mesh.values.max(), 22)[1:-1].tolist()
    print(f"{len(mesh.tets):,} tetrahedra, {len(isovalues)} isovalues")
    for threads in (1, 2):
        runs: dict[str, Any] = {"VTK span space": scalar_tree(mesh, threads)}
        for backend in ("mc", "thinning"):
            runs[backend], prepared = ours(mesh, backend, threads)
            print(f"{threads} threads  prepare {backend:10} {prepared:8.2f} s")
        seconds: dict[str, list[float]] = {name: [] for name in runs}
        totals = {name: run(isovalues[0]) - run(isovalues[0]) for name, run in runs.items()}
        for isovalue in isovalues:
            for name, run in runs.items():
                start = time.perf_counter()
                totals[name] += run(isovalue)
                seconds[name].append(time.perf_counter() - start)
        for name, each in seconds.items():
            print(f"{threads} threads  {name:18} {totals[name]:>10,} triangles {1e3 * statistics.median(each):8.2f} ms")


if __name__ == "__main__":
    main()
