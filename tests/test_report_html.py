"""The HTML page, opened in a real browser without network."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from isocore.cli.main import isocore as program
from small_files import ball, write_nifti

from isocore.copies import copy_from_dict
from isocore.job import Job, Target
from isocore.pipeline import convert
from isocore.report import BatchReport, RunReport, save_report
from isocore.report.copies_found import with_copies

BROWSER = next(
    (found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))), None
)
ROWS = 200

#: Runs inside the page, after it: what a user would do, and what came of it.
PROBE = """
<script>
addEventListener("load", () => setTimeout(() => {
  const files = () => [...document.querySelectorAll("tbody tr td.file")].map((cell) => cell.textContent);
  const found = { errors: window.errors, rows: files().length };
  found.isovalues = [...document.querySelectorAll("tbody tr")].map((row) => row.children[3].textContent);
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
  rows[Math.min(1, rows.length - 1)].click();
  found.milliseconds = performance.now() - begin;
  found.selected = document.querySelector("#name").textContent;
  found.bars = document.querySelectorAll("#bars .bar").length;
  found.histogram = document.querySelectorAll("#histogram rect").length;
  found.line = document.querySelectorAll("#histogram line").length;
  found.ticked = document.querySelectorAll("td.tick input:checked").length;
  document.querySelector("th.tick input").click();
  found.together = document.querySelectorAll("td.tick input:checked").length;
  found.sides = [...document.querySelectorAll("#sides button")].map((button) => button.textContent).join("");
  const coverage = () => {
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels.reduce((sum, value, place) => sum + (place % 4 === 3 ? value : 0), 0);
  };
  const shade = () => pixels.reduce((sum, value, place) => sum + (place % 4 === 1 ? value : 0), 0);
  const solid = coverage(), bright = shade();
  document.querySelector("#wires").click();
  coverage();
  found.darker = shade() / bright;
  document.querySelector("#wires").click();
  const slider = document.querySelector("#opacity");
  slider.value = 20;
  slider.dispatchEvent(new Event("input"));
  found.fainter = coverage() / solid;
  found.facts = document.querySelector("#facts").textContent;
  found.link = document.querySelector("#facts a").getAttribute("href");
  const box = (name) => document.querySelector(name).getBoundingClientRect();
  const [stage, table] = [box("#stage"), box("#outputs")];
  found.stage = stage.top < table.top ? "above" : stage.left > table.left ? "beside" : "";
  found.wide = document.documentElement.scrollWidth > innerWidth;
  found.width = innerWidth;
  found.single = getComputedStyle(document.querySelector("#outputs")).display === "none";
  found.share = box("#view").width / innerWidth;
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


def looked_at(page: Path, width: int = 1120) -> dict[str, Any]:
    assert BROWSER is not None
    text = page.read_text(encoding="utf-8")
    watch = "<script>window.errors = []; addEventListener('error', (event) => errors.push(event.message));</script>"
    probed = page.with_name("probed.html")
    probed.write_text(
        text.replace("<title>", watch + "<title>").replace("</body>", PROBE + "</body>"), encoding="utf-8"
    )
    command = [BROWSER, "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    command += [f"--window-size={width},900", "--disable-background-networking", "--no-first-run"]
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


@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine (Debian: apt-get install chromium)")
@pytest.mark.parametrize(("width", "place"), [(520, "above"), (800, "above"), (1120, "beside"), (1600, "beside")])
def test_the_viewer_stands_above_or_beside_the_table_at_every_width(tmp_path: Path, width: int, place: str) -> None:
    """With its controls: several surfaces at once, opacity, wires, sides, facts in words and a link to the mesh."""
    save_report(BatchReport(tuple(surfaces(tmp_path))), tmp_path / "run.html")
    found = looked_at(tmp_path / "run.html", width)
    assert found["errors"] == [] and found["width"] == width and not found["wide"]
    assert (found["stage"], found["single"]) == (place, False)
    assert (found["ticked"], found["together"], found["sides"]) == (1, 3, "APLRSI")
    assert found["darker"] < 0.98 and found["fainter"] < 0.6
    assert re.search(r"volume [\d,.]+ mm³", found["facts"]) and "closed; 1 piece; manifold" in found["facts"]
    assert found["link"].startswith("ball_") and (tmp_path / found["link"]).is_file()


@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine (Debian: apt-get install chromium)")
@pytest.mark.parametrize(
    ("isovalues", "shown"),
    [((30, 40.0552763819095), ["30", "40.0553"]), ((30.00000012, 30.00000034), ["30.0000001", "30.0000003"])],
)
def test_isovalues_have_the_digits_that_tell_them_apart(
    tmp_path: Path, isovalues: tuple[float, ...], shown: list[str]
) -> None:
    """Six, or more where two of them are closer."""
    source = write_nifti(tmp_path / "ball.nii.gz", ball(24, radius=8))
    targets = tuple(Target(str(value), tmp_path / f"{n}.ply") for n, value in enumerate(isovalues))
    save_report(BatchReport(tuple(convert(Job(source=source, targets=targets)))), tmp_path / "run.html")
    found = looked_at(tmp_path / "run.html")
    assert found["errors"] == [] and found["isovalues"] == shown


@pytest.mark.skipif(BROWSER is None, reason="no Chromium on this machine (Debian: apt-get install chromium)")
def test_one_surface_fills_the_page(tmp_path: Path) -> None:
    """There is nothing to choose, so no table."""
    save_report(BatchReport(tuple(surfaces(tmp_path)[:1])), tmp_path / "run.html")
    found = looked_at(tmp_path / "run.html")
    assert found["errors"] == [] and found["single"] and found["share"] > 0.9


def test_copies_are_made_where_the_surfaces_are(tmp_path: Path) -> None:
    """By the job, with the colour that it gives; the page then needs no mesh file."""
    source = write_nifti(tmp_path / "ball.nii.gz", ball(24, radius=8))
    job = Job(source=source, targets=(Target("50", tmp_path / "a.ply"),), colour=(255, 0, 16), page_triangles=500)
    (run,) = convert(job)
    (tmp_path / "a.ply").unlink()
    assert run.copy is not None and run.copy.normals is not None and 100 < run.copy.count <= 500
    save_report(BatchReport((run,)), tmp_path / "run.html")
    (record,) = records(tmp_path / "run.html")
    assert record["mesh"] == run.copy.as_dict() and record["mesh"]["colour"] == "#ff0010"
    again = copy_from_dict(record["mesh"])
    assert again is not None and again.as_dict() == run.copy.as_dict()


@pytest.mark.parametrize("key", ["vertices", "triangles", "normals", "low", "count"])
def test_a_damaged_copy_is_none(tmp_path: Path, key: str) -> None:
    """Whatever its file holds, the page draws nothing that is not there."""
    (run,) = surfaces(tmp_path)[:1]
    copy = with_copies(BatchReport((run,)), 1 << 20).outputs[0].copy
    assert copy is not None
    whole = copy.as_dict() | {"normals": base64.b64encode(bytes(len(copy.vertices) // 2)).decode()}
    assert copy_from_dict(whole) is not None
    for wrong in (None, "%", "AAAA", [1], 7):
        assert copy_from_dict(whole | {key: wrong}) is None or (key, wrong) == ("normals", None)


def records(page: Path) -> list[dict[str, Any]]:
    """The outputs inside a page."""
    match = re.search(r'id="report">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
    assert match
    outputs: list[dict[str, Any]] = json.loads(match[1])["outputs"]
    return outputs


def command(*arguments: object) -> Any:
    return CliRunner().invoke(program, [str(argument) for argument in arguments])


def test_a_page_made_later_and_elsewhere_keeps_its_surfaces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From any folder by the meshes; where those are gone by the file beside the report; else a word about it."""
    write_nifti(tmp_path / "ball.nii.gz", ball(24, radius=8))
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path)
    assert command("convert", "ball.nii.gz", "-i", 50, "-i", 80, "-d", "out", "--report", "run.json").exit_code == 0
    assert not (tmp_path / "run.json.copies").exists()
    monkeypatch.chdir(tmp_path / "other")
    assert "warning" not in command("report", "../run.json", "--to", "a.html").output
    assert all("mesh" in run for run in records(Path("a.html")))
    assert records(Path("a.html"))[0]["link"] == "../out/ball_50.ply"
    monkeypatch.chdir(tmp_path)
    reports = ("--report", "run.json", "--report", "run.html")
    assert command("convert", "ball.nii.gz", "-i", 50, "-i", 80, "-d", "out", *reports).exit_code == 0
    for path in (tmp_path / "out").glob("*.ply"):
        path.unlink()
    for name in ("run.json", "run.json.copies"):
        shutil.move(name, tmp_path / "other" / name)
    assert "warning" not in command("report", "other/run.json", "--to", "b.html").output
    assert [run["mesh"] for run in records(Path("b.html"))] == [run["mesh"] for run in records(Path("run.html"))]
    (tmp_path / "other" / "run.json.copies").unlink()
    said = command("report", "other/run.json", "--to", "c.html").output
    assert "c.html: has no copy of 2 of 2 surfaces: out/ball_50.ply is not where" in said


def test_what_is_up_to_date_is_in_the_page_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Labels in one file have a part of it each."""
    samples = np.zeros((12, 12, 12), np.uint8)
    samples[2:5, 2:9, 2:9], samples[6:10, 2:9, 2:9] = 1, 2
    write_nifti(tmp_path / "labels.nii", samples)
    monkeypatch.chdir(tmp_path)
    order = ("convert", "labels.nii", "--labels", "all", "-o", "all.ply", "--if-changed", "--report", "run.html")
    assert command(*order).exit_code == 0
    first = records(Path("run.html"))
    assert command(*order).exit_code == 0
    again = records(Path("run.html"))
    assert [run["status"] for run in again] == ["skipped", "skipped"]
    for key in ("low", "high", "count"):
        assert [run["mesh"][key] for run in first] == [run["mesh"][key] for run in again]


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
