"""docs/report.md and the JSON report name the same keys: those of volumes and meshes, done, empty, skipped, failed."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from shapes import SAMPLES
from small_files import ball, write_nifti

DOCUMENT = Path(__file__).parent.parent.parent / "docs" / "report.md"
#: The sections that describe the report, in its order: a section of the record has the name of its key.
WHOLE, RECORD = "The whole", "A record"
#: Objects whose keys the program does not choose.
OPEN = {"facts"}


def documented() -> dict[str, set[str]]:
    """Keys in the first column of every section's table, by section."""
    text = DOCUMENT.read_text(encoding="utf-8").split("## Other formats", 1)[0]
    sections: dict[str, set[str]] = {}
    for part in re.split(r"^##+ ", text, flags=re.MULTILINE)[1:]:
        title, *lines = part.splitlines()
        rows = [line.split("|")[1] for line in lines if line.startswith("| `")]
        sections[title.strip()] = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    return sections


def collected(reports: list[dict[str, Any]]) -> dict[str, set[str]]:
    """Keys of real reports, by the section that describes them."""
    seen: dict[str, set[str]] = defaultdict(set)
    for report in reports:
        seen[WHOLE] |= report.keys()
        for name in ("tool", "host", "totals"):
            seen[name] |= report[name].keys()
        for record in report["outputs"]:
            seen[RECORD] |= record.keys()
            for name, value in record.items():
                for part in value if isinstance(value, list) else (value,):
                    if isinstance(part, dict) and name not in OPEN:
                        seen[name] |= part.keys()
    return seen


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Every backend on a volume and on a mesh, with every option, and every status."""
    folder = tmp_path_factory.mktemp("reports")
    scan = write_nifti(folder / "ball.nii", ball(8))
    masks = write_nifti(folder / "mask.nii", (ball(8) > 50).astype(np.uint8))
    (folder / "broken.nii").write_bytes(b"junk" * 100)
    mesh = SAMPLES / "torus.vtu"
    commands: list[tuple[object, ...]] = [
        (scan, "-i", 50, "--triangles", 40, "--max-error", 0.5, "--simplify"),
        (scan, "-i", 50, "-b", "asc", "--block-size", 8, "--max-error", "0.3mm", "--cap", "--normals"),
        (scan, "-i", 50, "-b", "mc", "--topology", "trilinear", "--max-triangles", 3),
        (scan, "-i", 50, "-b", "thinning", "--offset", "auto", "--ignore", 0),
        (masks, "--labels", 1, "--smooth", 2, "--background", 0),
        (masks, "--keep-largest", 1, "--min-piece", 2, "--fill-bubbles"),
        (scan, "-i", 50, "--carry", scan, "--colormap", "turbo"),
        (scan, "-i", 50, "-i", 60, "--merge-isovalues", "-f", "vtp", "--compress"),
        (mesh, "-i", 0.1, "-b", "mc"),
        (mesh, "-i", 0.1, "-b", "thinning"),
        (scan, "-i", 1e9, "-b", "mc", "--if-changed"),
        (scan, "-i", 1e9, "-b", "mc", "--if-changed"),
        (folder / "broken.nii", "-i", 50),
    ]
    written = []
    for command in commands:
        arguments = (*command, "-d", folder / "out", "--report", folder / "run.json", "-q")
        CliRunner().invoke(convert, [str(argument) for argument in arguments])
        written.append(json.loads((folder / "run.json").read_text(encoding="utf-8")))
    return written


def test_the_runs_reach_every_status(reports: list[dict[str, Any]]) -> None:
    """Else the other tests would prove less than they say."""
    statuses = [run["status"] for report in reports for run in report["outputs"]]
    assert statuses == ["done"] * 11 + ["empty", "skipped", "failed"]
    assert {run["kind"] for report in reports for run in report["outputs"]} == {"volume", "mesh", None}


def test_every_key_of_a_report_is_documented(reports: list[dict[str, Any]]) -> None:
    """A key that only some runs have is one, too."""
    known = documented()
    missing = {name: keys - known.get(name, set()) for name, keys in collected(reports).items()}
    assert not {name: keys for name, keys in missing.items() if keys}


def test_every_documented_key_is_in_some_report(reports: list[dict[str, Any]]) -> None:
    """A promise that no run keeps is a lie."""
    seen = collected(reports)
    unkept = {name: keys - seen[name] for name, keys in documented().items()}
    assert not {name: keys for name, keys in unkept.items() if keys}


def test_every_record_has_every_key_in_one_order(reports: list[dict[str, Any]]) -> None:
    """Failed ones, too: whoever reads a report need not ask whether a key is there."""
    orders = {tuple(run) for report in reports for run in report["outputs"]}
    assert len(orders) == 1
