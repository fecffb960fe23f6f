"""The compiled module as Python sees it: named results, and the handle of a mesh's index."""

from __future__ import annotations

import ast
import gc
import os
import signal
import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import meshes
import numpy as np
import pytest

import isocore
from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.methods.mesh_index import MeshIndex
from isocore.methods.thinning import build_index, ready_index

STUB = ast.parse((Path(isocore.__file__).parent / "_kernels.pyi").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def mesh() -> CellMesh:
    cubes = meshes.mesh_of(np.ones((4, 4, 4), bool), hexes=True)
    tets = meshes.mesh_of(np.ones((4, 4, 4), bool))
    mixed = CellMesh(cubes.points, tets.tets[:200], cubes.hexes, np.zeros(len(cubes.points)))
    return meshes.with_values(mixed, np.sin(2 * mixed.points).sum(axis=1))


def test_the_stub_and_the_module_offer_the_same_names() -> None:
    """A name in one is a name in the other; so are the fields of every named tuple, in order."""
    declared = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    compiled = {name for name in vars(_kernels_module()) if not name.startswith("_")}
    assert compiled == set(declared)
    for name, node in declared.items():
        if isinstance(node, ast.ClassDef) and node.bases:
            fields = tuple(
                line.target.id
                for line in node.body
                if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name)
            )
            assert getattr(_kernels, name)._fields == fields


def _kernels_module() -> object:
    import sys

    return sys.modules[_kernels.Index.__module__]


def _swapped_low(index: MeshIndex) -> MeshIndex:
    return replace(index, hexes=replace(index.hexes, low=index.hexes.low[::-1].copy()))


def _with_record(index: MeshIndex, column: int, number: int) -> MeshIndex:
    records = index.tets.records.copy()
    records[7, column] = number
    return replace(index, tets=replace(index.tets, records=records))


def _naming_a_point_twice(index: MeshIndex) -> MeshIndex:
    highest = int(index.tets.records[7, :4].argmax())
    return _with_record(index, highest, int(index.tets.records[7, (highest + 1) % 4]))


#: What is said -> an index that deserves it. Columns of a tetrahedron's record: 4 points, 4 twins.
DAMAGES = {
    "a point that does not exist": lambda index: _with_record(index, 2, len(index.original)),
    "a point that does not": lambda index: _with_record(index, 2, -1),
    "a cell that does not exist": lambda index: _with_record(index, 5, 4 * len(index.tets.records)),
    "names a point twice": _naming_a_point_twice,
    "is not glued to it": lambda index: _with_record(index, 5, 0),
    "the order of their lowest points": lambda index: replace(
        index, tets=replace(index.tets, records=index.tets.records[::-1].copy())
    ),
    "the skeleton names": lambda index: replace(
        index, tets=replace(index.tets, skeleton=index.tets.skeleton + len(index.tets.records))
    ),
    "not sorted": _swapped_low,
    "as long as the skeleton": lambda index: replace(index, tets=replace(index.tets, high=index.tets.high[1:])),
}


@pytest.mark.parametrize("said", DAMAGES)
def test_an_index_is_checked_once_before_it_is_walked(mesh: CellMesh, said: str) -> None:
    """Whatever it names must be there; the message says what is not."""
    index = build_index(mesh)
    assert len(np.unique(index.hexes.low)) > 1
    with pytest.raises(ValueError, match=said):
        ready_index(mesh, DAMAGES[said](index))


def test_one_value_and_one_id_per_point(mesh: CellMesh) -> None:
    """Arrays of different lengths do not go together."""
    index = build_index(mesh)
    parts = [(part.records, part.skeleton, part.low, part.high) for part in index.parts]
    for points, values, original in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        with pytest.raises(ValueError, match="per point"):
            _kernels.Index(
                mesh.points[index.original][points:],
                mesh.values[index.original][values:],
                *parts,
                index.original[original:],
            )


def test_a_handle_takes_no_other_types(mesh: CellMesh) -> None:
    """Nothing is converted on the way: that would be a copy."""
    index = build_index(mesh)
    with pytest.raises(TypeError):
        ready_index(mesh, replace(index, tets=replace(index.tets, records=index.tets.records.astype(np.int64))))


def test_a_handle_keeps_its_arrays_alive(mesh: CellMesh) -> None:
    """It is the only one that still holds them, and other memory was asked for since."""
    expected = ready_index(mesh, build_index(mesh)).propagate(0.3)
    index = build_index(mesh)
    copies = [replace(part, records=part.records.copy(), skeleton=part.skeleton.copy()) for part in index.parts]
    ready = ready_index(mesh, replace(index, tets=copies[0], hexes=copies[1], original=index.original.copy()))
    del index, copies
    gc.collect()
    filled = [np.full(len(mesh.tets) * 8 // n, -1, np.int32) for n in range(1, 200)]
    assert [a.tobytes() for a in ready.propagate(0.3)[:2]] == [a.tobytes() for a in expected[:2]]
    assert len(filled) == 199


def test_calls_from_several_threads_do_not_disturb_each_other(mesh: CellMesh) -> None:
    """They get the bytes that they would get alone."""
    ready = ready_index(mesh, build_index(mesh))
    grid = _kernels.GridIndex(np.asfortranarray(np.random.default_rng(2).random((24, 24, 24))))
    isovalues = [0.1 + 0.01 * n for n in range(40)]
    for handle in (ready, grid):
        alone = [handle.propagate(isovalue) for isovalue in isovalues]
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(handle.propagate, isovalues))
        for one, other in zip(alone, together, strict=True):
            assert one.vertices.tobytes() == other.vertices.tobytes()
            assert one.triangles.tobytes() == other.triangles.tobytes()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="only where processes can be forked")
def test_a_forked_process_walks_with_threads_of_its_own(mesh: CellMesh) -> None:
    """An index has kept threads, which are not there in a process that is forked."""
    ready = ready_index(mesh, build_index(mesh))
    expected = ready.propagate(0.3, 2).triangles.tobytes()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of a process with threads that is forked
        child = os.fork()
    if child == 0:
        try:
            signal.alarm(60)  # ends it if it waits for ever
            same = ready.propagate(0.3, 2).triangles.tobytes() == expected
            del ready
            os._exit(0 if same else 1)
        finally:
            os._exit(2)
    assert os.waitpid(child, 0)[1] == 0
