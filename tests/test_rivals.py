"""The paper's rivals find the same cells, and the bench prints tables that add up."""

from __future__ import annotations

import meshes
import numpy as np
import pytest
from click.testing import CliRunner

from isocore.benches.rivals import RIVALS, Cells, Rival
from isocore.benches.thinning import cells_of, extrema_graph, mesh_bench
from isocore.methods.thinning import build_index, ready_index

EACH = pytest.mark.parametrize("rival", RIVALS, ids=lambda rival: rival.name)


@EACH
@pytest.mark.parametrize("seed", range(8))
def test_candidates_are_the_cells_that_are_met(rival: Rival, seed: int) -> None:
    """Random ranges of few levels, some without a finite end, at and between their ends."""
    random = np.random.default_rng(seed)
    shape = tuple(random.integers(1, 9, 3).tolist()) if seed % 2 else (1, 1, int(random.integers(1, 5000)))
    low = random.integers(0, 9, int(np.prod(shape))).astype(float)
    high = low + random.integers(0, 5, len(low))
    low[random.random(len(low)) < 0.1 * (seed % 3)] = -np.inf
    high[np.isinf(low) & (seed % 4 == 0)] = -np.inf
    search = rival.build(Cells(low, high, shape))
    for isovalue in (-1, 0, 0.5, 1, 3, 3.5, 8, 9, 12, 13, 20):
        found, looked_at = search.candidates(isovalue)
        assert np.array_equal(found, np.flatnonzero((low < isovalue) & (isovalue <= high)))
        assert looked_at >= len(found)


@pytest.mark.parametrize("hexes", [False, True], ids=["tets", "hexes"])
def test_walks_find_what_the_full_scan_finds(hexes: bool) -> None:
    """Volume thinning visits the same cells; the extrema graph does on a smooth field."""
    mesh = meshes.mesh_of(np.ones((8, 8, 8), bool), hexes=hexes)
    mesh = meshes.with_values(mesh, np.sin(mesh.points).sum(axis=1))
    index = build_index(mesh)
    scan = RIVALS[0].build(cells_of(mesh, index))
    graph = extrema_graph(mesh, index)
    assert index.skeleton_cells < graph.skeleton_cells
    for isovalue in meshes.isovalues(mesh, 20):
        met, _ = scan.candidates(isovalue)
        for some in (index, graph):
            visited = ready_index(mesh, some).walk(isovalue)[1 if hexes else 0]
            assert np.array_equal(np.sort(visited), met)


def test_the_tables_add_up() -> None:
    """Every method intersects the same cells; the skeleton's classes sum to its size."""
    mesh = meshes.mesh_of(np.ones((8, 8, 8), bool))
    mesh = meshes.with_values(mesh, np.sin(mesh.points).sum(axis=1))
    first, registered, skeleton, visited, seconds = mesh_bench(mesh, isovalues=7)
    assert first.rows[0][:2] == (mesh.cells, len(mesh.points))
    assert skeleton.rows[0][0] == sum(int(n) for n in skeleton.rows[0][1:])
    assert ("volume thinning", skeleton.rows[0][0]) in [row[:2] for row in registered.rows]
    assert len({row[2] for row in visited.rows}) == 1
    assert len(seconds.rows) == len(RIVALS) - 1 + 2


def test_bench_and_index_commands_say_what_they_did(tmp_path: object) -> None:
    """On the sample mesh: tables on stdout, and an index that convert then uses."""
    import shutil
    from pathlib import Path

    from isocore.cli.main import isocore

    sample = Path(__file__).parents[1] / "sample_volumes" / "torus.vtu"
    mesh = Path(str(tmp_path)) / "torus.vtu"
    shutil.copy(sample, mesh)
    benched = CliRunner().invoke(isocore, ["bench", str(mesh), "--isovalues", "3"])
    assert benched.exit_code == 0
    assert "Table 5" in benched.output and "volume thinning" in benched.output
    indexed = CliRunner().invoke(isocore, ["index", str(mesh)])
    assert indexed.exit_code == 0
    assert indexed.output.startswith(f"{mesh}.isoindex: ")
    converted = CliRunner().invoke(isocore, ["convert", str(mesh), "-i", "0.5", "-d", str(tmp_path), "--no-reference"])
    assert converted.exit_code == 0
    assert "repay" not in converted.output
