"""A surface without triangles: a result, but nothing that could be watertight."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti

ROOT = Path(__file__).parent.parent


def converted(folder: Path, *arguments: object) -> Result:
    """One good surface and one that no sample reaches."""
    source = write_nifti(folder / "ball.nii", ball())
    words = (source, "-i", 50, "-i", 1000, "-b", "mc", "-d", folder / "out", *arguments)
    return CliRunner().invoke(convert, [str(word) for word in words])


def test_every_report_says_that_nothing_was_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`-` in tables, null in the report, skipped in JUnit, a warning on GitHub; exit code 0."""
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    reports = [word for ending in ("json", "md", "xml") for word in ("--report", tmp_path / f"r.{ending}")]
    result = converted(tmp_path, *reports)
    assert result.exit_code == 0
    good, empty = json.loads((tmp_path / "r.json").read_text())["outputs"]
    assert (good["status"], good["surface"]["watertight"], good["surface"]["manifold"]) == ("done", True, True)
    assert (empty["status"], empty["surface"]["watertight"]) == ("empty", None)
    assert (empty["surface"]["manifold"], empty["surface"]["volume"]) == (None, None)
    lines = [*result.stderr.splitlines(), *(tmp_path / "r.md").read_text().splitlines()]
    rows = [line.replace("|", " ").split() for line in lines if re.match(r"(\| )?ball.*ply\b", line)]
    assert [row[-2:] for row in rows] == [["yes", "done"], ["-", "empty"]] * 2
    suite = ElementTree.parse(tmp_path / "r.xml").find("testsuite")
    assert suite is not None and (suite.get("skipped"), suite.get("failures")) == ("1", "0")
    (skipped,) = suite.iter("skipped")
    assert "no surface at isovalue 1000" in str(skipped.get("message"))
    (line,) = (line for line in result.stderr.splitlines() if line.startswith("::"))
    assert line.startswith("::warning file=") and ",title=isocore empty::" in line and "ball_1000.ply: no surf" in line


@pytest.mark.parametrize(
    ("requirement", "misses"),
    [
        ("watertight", ["watertight: the surface is empty"]),
        ("manifold", ["manifold: the surface is empty"]),
        ("nonempty", ["nonempty: no triangles"]),
        ("watertight,manifold nonempty", ["watertight: the surface is empty", "manifold: the surface is empty"]),
    ],
)
@pytest.mark.parametrize("again", [False, True])
def test_an_empty_surface_meets_no_requirement(
    tmp_path: Path, requirement: str, misses: list[str], again: bool
) -> None:
    """Exit code 3; also where an earlier run made it and it is up to date."""
    if again:
        converted(tmp_path, "--if-changed")
    result = converted(tmp_path, "--require", requirement, "--if-changed", "--report", tmp_path / "r.json")
    good, empty = json.loads((tmp_path / "r.json").read_text())["outputs"]
    assert result.exit_code == 3 and good["missed"] == [] and empty["missed"][: len(misses)] == misses
    assert empty["status"] == ("skipped" if again else "empty")
    assert ("isocore: " in result.stderr) and f"misses {misses[0]}" in result.stderr


def test_no_triangles_are_at_most_any_number(tmp_path: Path) -> None:
    """--max-triangles alone is met."""
    result = converted(tmp_path, "--max-triangles", 0, "--report", tmp_path / "r.json")
    good, empty = json.loads((tmp_path / "r.json").read_text())["outputs"]
    assert result.exit_code == 3 and good["missed"] and not empty["missed"]


@pytest.mark.parametrize("text", ["", " ", ",", " , "])
def test_a_gate_that_requires_nothing_is_refused(tmp_path: Path, text: str) -> None:
    """A variable of a script that was never set is no gate that passes."""
    result = converted(tmp_path, "--require", text)
    assert result.exit_code == 2 and "names nothing to require" in result.stderr and not (tmp_path / "out").exists()


def test_the_shipped_workflow_and_gate_ask_for_a_surface() -> None:
    """Whoever copies them is told of empty meshes."""
    for name in ("github-workflow.yml", "one-liners.md"):
        text = (ROOT / "examples" / name).read_text(encoding="utf-8")
        gates = re.findall(r'--require "([^"]*)"', text)
        assert gates and all("nonempty" in gate.split() for gate in gates)
