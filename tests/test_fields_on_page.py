"""The report's page colours surfaces by what they carry, with the map and the range that the report names."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from base64 import b64decode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from isocore.cli.main import isocore as program
from small_files import ball, write_nifti

from isocore.copies import copied, copy_from_dict
from isocore.surface import Surface
from isocore.writers.colormaps import colormap

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)


def converted(folder: Path, *more: object) -> list[dict[str, Any]]:
    """A ball that carries the first coordinate of its samples; the outputs in its page."""
    write_nifti(folder / "heat.nii", np.arange(12.0)[:, None, None] * np.ones((12, 12, 12)))
    scan = write_nifti(folder / "scan.nii", ball())
    words = ("convert", scan, "-i", 40, "-i", 50, "-d", folder / "out", "--carry", folder / "heat.nii", "-b", "mc")
    words += more
    words += ("--report", folder / "run.html", "--report", folder / "run.json", "--no-progress", "-q")
    found = CliRunner().invoke(program, [str(word) for word in words])
    assert found.exit_code == 0, found.output
    return page(folder / "run.html")["outputs"]


def page(path: Path) -> dict[str, Any]:
    match = re.search(r'<script type="application/json" id="report">(.*?)</script>', path.read_text(), re.DOTALL)
    assert match
    found: dict[str, Any] = json.loads(match[1])
    return found


def values_of(mesh: dict[str, Any]) -> Any:
    low, high = mesh["value_range"]
    return low + np.frombuffer(b64decode(mesh["values"]), "<u2") / 65534 * (high - low)


def places_of(mesh: dict[str, Any]) -> Any:
    low, high = np.array(mesh["low"]), np.array(mesh["high"])
    return low + np.frombuffer(b64decode(mesh["vertices"]), "<u2").reshape(-1, 3) / 65535 * (high - low)


@pytest.mark.parametrize("format_", ["ply", "vtp", "glb"])
def test_copies_have_the_value_of_each_vertex(tmp_path, format_):
    """Also where a copy has fewer triangles; the page has the map's colours."""
    for size in ("16M", "12K"):
        made = converted(tmp_path, "-f", format_, "--colormap", "magma", "--color-range", "2:8", "--page-size", size)
        for run in made:
            np.testing.assert_allclose(values_of(run["mesh"]), places_of(run["mesh"])[:, 0], atol=1e-3)
            assert run["colors"] == {"by": "heat", "colormap": "magma", "range": [2, 8]}
    assert made[0]["mesh"]["count"] < made[0]["surface"]["triangles"]
    assert b64decode(page(tmp_path / "run.html")["colormaps"]["magma"]) == colormap("magma").tobytes()


def test_a_page_made_later_has_them_too(tmp_path):
    """Out of the copies beside the JSON report."""
    before = converted(tmp_path)
    words = ["report", str(tmp_path / "run.json"), "--to", str(tmp_path / "later.html")]
    assert CliRunner().invoke(program, words).exit_code == 0
    after = page(tmp_path / "later.html")["outputs"]
    assert [run["mesh"]["values"] for run in after] == [run["mesh"]["values"] for run in before]


def test_a_surface_of_one_colour_has_none(tmp_path):
    """A colour that was asked for goes before what is carried."""
    made = converted(tmp_path, "--color", "#ff0000")
    assert all("values" not in run["mesh"] and run["colors"] is None for run in made)


def test_values_that_are_no_numbers_are_marked():
    """And damaged ones are no copy."""
    corners = np.eye(3, dtype=np.float32)
    surface = Surface(corners, np.array([[0, 1, 2]], np.int32))
    copy = copied(surface, 9, values=np.array([1.0, np.nan, 3.0]))
    assert copy is not None and copy.value_range == (1.0, 3.0)
    assert np.frombuffer(copy.values, "<u2").tolist() == [0, 65535, 65534]
    again = copy_from_dict(copy.as_dict())
    assert again is not None and (again.values, again.value_range) == (copy.values, copy.value_range)
    assert copy_from_dict(copy.as_dict() | {"value_range": [1, float("inf")]}) is None
    assert copy_from_dict(copy.as_dict() | {"values": "AAAA"}) is None
    nothing = copied(surface, 9, values=np.full(3, np.inf))
    assert nothing is not None and nothing.values is None
    same = copied(surface, 9, values=np.full(3, 5.0))
    assert same is not None and same.value_range == (5.0, 5.0)


@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine (Debian: apt-get install chromium)")
def test_the_page_says_what_its_colours_stand_for(tmp_path):
    """A scale below the surface, drawn without an error."""
    converted(tmp_path, "--color-range", "2.5:7.5")
    text = (tmp_path / "run.html").read_text()
    tell = "(event) => document.documentElement.append('PAGE BROKE: ' + event.message)"
    watch = f"<script>addEventListener('error', {tell})</script>"
    (tmp_path / "run.html").write_text(text.replace("<title>", watch + "<title>"))
    command = [str(BROWSER), "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    command += ["--disable-dev-shm-usage", f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=5000"]
    command += ["--host-resolver-rules=MAP * ~NOTFOUND", "--dump-dom", (tmp_path / "run.html").as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=180, check=True).stdout
    assert "PAGE BROKE" not in dom.replace(watch, "")
    scale = re.search(r'<li class="scale">(.*?)</li>', dom)
    assert scale is not None
    assert re.sub(r"<.*?>", "|", scale[1]) == "heat 2.5||7.5" and "rgb(68, 1, 84)" in scale[1]
    assert re.search(r"<dt[^>]*>carried</dt><dd[^>]*>heat from", dom)
