"""Random trials of the theorem: isosurfaces of random fields on all test bodies, and on every real mesh there is.

    python tests/bench/thinning_trials.py [--trials 100000] [--seed 0] [--real]

A trial is one isosurface. Propagation may only visit cells that the isosurface meets, so equal counts of visited and
intersected cells mean equal sets of cells, and each cell draws the same triangles; components are counted on both
surfaces all the same, and every hundredth trial compares the triangles themselves.
"""

from __future__ import annotations

import argparse
import io
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import meshio
import numpy as np
import numpy.typing as npt

sys.path.insert(0, str(Path(__file__).parents[1]))

import meshes
from mesh_oracles import triangle_set

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.methods.thinning import build_index, ready_index
from isocore.readers.cell_splitting import split_cells

#: Cells per block: as ever, and so few that small meshes have many blocks.
BLOCKS = (0, 8, 24, 100)
REAL = Path(__file__).parents[3] / "shared" / "data" / "meshes"


def components(vertices: np.ndarray, triangles: np.ndarray) -> int:
    return _kernels.measure(vertices, triangles).components


def compare(mesh: CellMesh, limit: int, count: Tally) -> None:
    ready = ready_index(mesh, build_index(mesh, cells_per_block=BLOCKS[count.trials % len(BLOCKS)]))
    for isovalue in meshes.isovalues(mesh, limit):
        vertices, triangles, _, visited, _ = ready.propagate(isovalue)
        all_vertices, all_triangles, intersected, _ = _kernels.marching_cells(
            mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue
        )
        there = components(all_vertices, all_triangles)
        found = components(vertices, triangles)
        wrong = visited != intersected or found != there or len(triangles) != len(all_triangles)
        if not wrong and count.trials % 100 == 0:
            wrong = triangle_set(vertices, triangles) != triangle_set(all_vertices, all_triangles)
        count.add(there, wrong)
        if wrong:
            print(f"  missed {there - found} of {there} components at {isovalue!r}")


class Tally:
    def __init__(self) -> None:
        self.trials = self.components = self.wrong = 0

    def add(self, there: int, wrong: bool) -> None:
        self.trials += 1
        self.components += there
        self.wrong += wrong

    def __str__(self) -> str:
        return f"{self.trials:,} isosurfaces, {self.components:,} components, {self.wrong} not equal to the full scan"


def random_meshes(random: np.random.Generator) -> Iterator[CellMesh]:
    bodies, fields = list(meshes.BODIES.values()), list(meshes.FIELDS.values())
    while True:
        for boxes, *_ in bodies:
            mesh = meshes.mesh_of(boxes, hexes=bool(random.integers(2)))
            mesh = meshes.with_values(mesh, fields[random.integers(len(fields))](mesh, random))
            yield meshes.shuffled(mesh, random)


def real_meshes() -> Iterator[tuple[str, CellMesh]]:
    """Every file that meshio reads and that holds solid cells, with every component of its point fields and a wave."""
    for path in sorted(REAL.rglob("*.*")):
        try:
            with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = meshio.read(path)
        except (Exception, SystemExit):
            continue
        solid = {name: _corners(found, name, count) for name, count in SOLID.items()}
        if not sum(map(len, solid.values())):
            continue
        split = split_cells(*solid.values())
        points = np.zeros((len(found.points), 3))
        points[:, : found.points.shape[1]] = found.points
        for name, values in _fields(found, points):
            yield f"{path.relative_to(REAL)} {name}", CellMesh(points.copy(), split.tets, split.hexes, values)


SOLID = {"tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}


def _corners(found: meshio.Mesh, name: str, count: int) -> npt.NDArray[np.int32]:
    blocks = [block.data[:, :count] for block in found.cells if block.type.rstrip("0123456789") == name]
    return np.ascontiguousarray(np.concatenate([np.zeros((0, count), np.int32), *blocks]), np.int32)


def _fields(found: meshio.Mesh, points: npt.NDArray[np.float64]) -> Iterator[tuple[str, npt.NDArray[np.float64]]]:
    scale = np.ptp(points, axis=0).max() or 1.0
    yield "wave", np.sin(points @ np.array([[9, 2, 1], [-1, 8, 3], [2, -3, 7]]) / scale).sum(axis=1)
    for name, data in found.point_data.items():
        columns = np.asarray(data, np.float64).reshape(len(points), -1)
        for number, column in enumerate(columns.T):
            if np.isfinite(column).any() and np.ptp(column[np.isfinite(column)]) > 0:
                yield f"{name}[{number}]", column.copy()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--real", action="store_true", help="the real meshes instead of the random ones")
    asked = parser.parse_args()
    start, tally = time.perf_counter(), Tally()
    if asked.real:
        for name, mesh in real_meshes():
            before = tally.wrong
            compare(mesh, 200, tally)
            print(f"{name}: {mesh.cells:,} cells, {'equal' if tally.wrong == before else 'WRONG'}")
    else:
        for mesh in random_meshes(np.random.default_rng(asked.seed)):
            compare(mesh, 24, tally)
            if tally.trials >= asked.trials:
                break
    print(f"{tally}, in {time.perf_counter() - start:.0f} s")
    return 1 if tally.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
