"""The HTML page, opened in a real browser without network."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_files import ball, write_nifti

from isocore.job import Job, Target
from isocore.pipeline import convert
from isocore.report import BatchReport, RunReport, save_report
from isocore.report.reduce import packed, reduced
from isocore.writers.read_back import read_mesh

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)
ROWS = 200

#: Runs inside the page, after it: what a user would do, and what came of it.
PROBE = """
<script>
addEventListener("load", () => setTimeout(() => {
  const files = () => [...document.querySelectorAll("tbody tr td:first-child")].map((cell) => cell.textContent);
  const found = { errors: window.errors, rows: files().length };
  found.attention = !document.querySelector("#attention").hidden;
  const canvas = document.querySelector("canvas");
  const gl = canvas.getContext("webgl2");
  const pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  found.drawn = pixels.filter((value, place) => place % 4 === 3 && value > 0).length / (pixels.length / 4);
  const begin = performance.now();
  const heads = [...document.querySelectorAll("th button")];
  const triangles = heads.find((head) => head.textContent === "triangles");
  triangles.click();
  found.ascending = files();
  triangles.click();
  found.descending = files();
  const rows = [...document.querySelectorAll("tbody tr")];
  rows[1].click();
  found.milliseconds = performance.now() - begin;
  found.selected = document.querySelector("#name").textContent;
  found.bars = document.querySelectorAll("#bars .bar").length;
  found.histogram = document.querySelectorAll("#histogram rect").length;
  found.line = document.querySelectorAll("#histogram line").length;
  const result = document.createElement("pre");
  result.id = "result";
  result.textContent = JSON.stringify(found);
  document.body.append(result);
}, 300));
</script>
"""


def surfaces(folder: Path) -> list[Any]:
    source = write_nifti(folder / "ball.nii.gz", ball(24, radius=8))
    targets = tuple(Target(choice, folder / f"ball_{choice}.ply") for choice in ("30", "50", "80", "1000"))
    return list(convert(Job(source=source, targets=targets, backend="mc")))


def looked_at(page: Path) -> dict[str, Any]:
    assert BROWSER is not None
    text = page.read_text(encoding="utf-8")
    watch = "<script>window.errors = []; addEventListener('error', (event) => errors.push(event.message));</script>"
    probed = page.with_name("probed.html")
    probed.write_text(
        text.replace("<title>", watch + "<title>").replace("</body>", PROBE + "</body>"), encoding="utf-8"
    )
    command = [BROWSER, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    command += ["--disable-dev-shm-usage", f"--user-data-dir={page.parent / 'profile'}", "--virtual-time-budget=20000"]
    command += ["--host-resolver-rules=MAP * ~NOTFOUND", "--dump-dom", probed.as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=180, check=True).stdout
    match = re.search(r'<pre id="result">(.*?)</pre>', dom, re.DOTALL)
    assert match, "the page's own script did not come to its end"
    found: dict[str, Any] = json.loads(match[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    return found


@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine (Debian: apt-get install chromium)")
def test_the_page_opens_sorts_and_draws(tmp_path: Path) -> None:
    """Offline, with two hundred rows, without an error."""
    runs = surfaces(tmp_path)
    many = [renamed(runs[n % 3], f"{tmp_path}/ball_{('30', '50', '80')[n % 3]}.ply") for n in range(ROWS - 2)]
    failed = replace(renamed(runs[0], "x.ply"), status="failed", message="</script><b>broken", surface=None)
    save_report(BatchReport((*many, runs[3], failed)), tmp_path / "run.html", mesh_bytes=4 << 20)
    found = looked_at(tmp_path / "run.html")
    assert found["errors"] == [] and found["rows"] == ROWS and found["attention"]
    assert 0.02 < found["drawn"] < 0.9
    assert found["ascending"][0] == "ball_1000.ply" and found["ascending"][-1] == "x.ply"
    assert found["descending"][0] == "ball_30.ply" and found["descending"][-1] == "x.ply"
    assert found["selected"].endswith("ball_30.ply")
    assert (found["bars"], found["line"]) == (4, 1) and found["histogram"] > 8
    assert found["milliseconds"] < 5000


def test_the_page_needs_nothing_from_outside(tmp_path: Path) -> None:
    """Of our own parts none names a host, and the policy forbids loading."""
    save_report(BatchReport(tuple(surfaces(tmp_path))), tmp_path / "run.html")
    text = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert "default-src 'none'" in text and not re.search(r"<(script|link|img)[^>]+(src|href)=", text)


def renamed(run: RunReport, output: str) -> RunReport:
    return replace(run, asked=replace(run.asked, output=output))


@pytest.mark.parametrize("limit", [0, 3000, 100_000])
def test_copies_of_surfaces_stay_within_their_bound(tmp_path: Path, limit: int) -> None:
    """All together; with 0 there are none."""
    runs = tuple(surfaces(tmp_path))
    save_report(BatchReport(runs), tmp_path / "run.html", mesh_bytes=limit)
    save_report(BatchReport(runs), tmp_path / "none.html", mesh_bytes=0)
    added = (tmp_path / "run.html").stat().st_size - (tmp_path / "none.html").stat().st_size
    assert added <= limit + 300 * len(runs)
    assert (added > 0) == (limit > 0)


def test_a_reduced_copy_keeps_the_shape(tmp_path: Path) -> None:
    """Fewer triangles in the same box, every index in range."""
    surfaces(tmp_path)
    mesh = read_mesh(tmp_path / "ball_50.ply")
    assert mesh is not None
    vertices, triangles = reduced(mesh, 300)
    assert 50 < len(triangles) <= 300 and triangles.max() < len(vertices)
    assert np.allclose(vertices.min(axis=0), mesh[0].min(axis=0), atol=2)
    assert packed((vertices[:0], triangles[:0])) is None
