"""Which method is taken where none is named, and that the program does not advise against its own choice."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from isocore.cli.index import index
from shapes import SAMPLES
from small_files import ball, write_nifti

from isocore.backends import default_backend, repays_thinning
from isocore.cell_mesh import CellMesh
from isocore.extraction import Outlook


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    return Path(shutil.copyfile(SAMPLES / "torus.vtu", tmp_path / "torus.vtu"))


def _records(source: Path, *arguments: str) -> list[dict[str, Any]]:
    """The report's records of a run that has to succeed."""
    report = source.with_suffix(".json")
    run = CliRunner().invoke(
        convert, [str(source), *arguments, "-d", str(source.parent / "out"), "--no-reference", "--report", str(report)]
    )
    assert run.exit_code == 0, run.output
    found: list[dict[str, Any]] = json.loads(report.read_text())["outputs"]
    return found


@pytest.mark.parametrize("named", [(), ("-b", "auto")])
def test_few_isovalues_of_a_mesh_are_scanned_in_full(mesh: Path, named: tuple[str, ...]) -> None:
    """Thinning first would take longer; the report says so, and no warning does."""
    for record in _records(mesh, "-i", "0.1", "-i", "0.2", *named):
        assert record["backend"] == "mc" and record["warnings"] == []
        assert record["backend_chosen"] == (
            "a full scan, since 2 isovalues would not repay thinning and no index lies beside the mesh"
        )


def test_an_index_beside_the_mesh_is_used(mesh: Path) -> None:
    """Also for one isovalue; a damaged one is replaced, with a warning about the index alone."""
    assert CliRunner().invoke(index, [str(mesh)]).exit_code == 0
    (record,) = _records(mesh, "-i", "0.1")
    assert (record["backend"], record["backend_chosen"]) == ("thinning", "the index beside the mesh is used")
    assert record["warnings"] == []
    beside = mesh.with_name("torus.vtu.isoindex")
    beside.write_bytes(beside.read_bytes()[:-1])
    (record,) = _records(mesh, "-i", "0.1")
    (warning,) = record["warnings"]
    assert record["backend"] == "thinning" and "is damaged" in warning and warning.endswith("thinned anew")


@pytest.mark.parametrize("cells", [1_000_000, 2_058_000, 6_000_000, 80_000_000])
def test_many_isovalues_of_a_large_mesh_repay_thinning(cells: int) -> None:
    """One less does not; and the larger the mesh, the sooner."""
    enough = math.ceil(repays_thinning(cells))
    assert 50 < enough < 100
    assert repays_thinning(2 * cells) < repays_thinning(cells)
    assert default_backend(CellMesh, Outlook(isovalues=enough, cells=cells)) == (
        "thinning",
        f"{enough} isovalues repay thinning",
    )
    assert default_backend(CellMesh, Outlook(isovalues=enough - 1, cells=cells))[0] == "mc"


def test_no_number_of_isovalues_repays_thinning_a_small_mesh(mesh: Path) -> None:
    """Looking at all of its cells takes no time to speak of."""
    assert repays_thinning(20_000) == repays_thinning(0) == math.inf
    many = _records(mesh, "-i", "-0.2:0.2:250")
    assert {record["backend"] for record in many} == {"mc"}


def test_a_named_method_is_taken_and_advised_on(mesh: Path) -> None:
    """Thinning for one isovalue gets its warning only where somebody asked for it."""
    (record,) = _records(mesh, "-i", "0.1", "-b", "thinning")
    assert (record["backend"], record["backend_chosen"]) == ("thinning", "given")
    assert "does not repay thinning" in record["warnings"][0]


def test_volumes_are_climbed(tmp_path: Path) -> None:
    """However many isovalues there are."""
    (record,) = _records(write_nifti(tmp_path / "ball.nii", ball()), "-i", "50")
    assert (record["backend"], record["backend_chosen"]) == ("asc", "the default for volumes")
