"""The pages for readers: their lines, links, pictures and numbers, and that their commands print what they show."""

from __future__ import annotations

import re
from pathlib import Path

import by_hand_loops
import draw_all
import numpy as np
import pytest
import scan
import the_volume
from click.testing import CliRunner
from isocore.cli.main import isocore as program
from png import read_png

from isocore import _kernels

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = {path.name for room in ("isocore", "tests") for path in (ROOT / room / "kernels").rglob("*.[ch]pp")}
WIDEST = 100


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_can_be_read_in_a_terminal(page: Path) -> None:
    """No line is wider than 100 columns; a row of a table may be, but not in the README."""
    lines = page.read_text(encoding="utf-8").splitlines()
    wide = [
        n for n, line in enumerate(lines, 1) if len(line) > WIDEST and (page.name == "README.md" or line[:1] != "|")
    ]
    assert not wide, f"{page}: lines {wide}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    """Relative links and pictures name files, and a header or source file that is named exists."""
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
        assert "://" in target or (page.parent / target).exists(), f"{page}: {target}"
    missing = {name.split("/")[-1] for name in re.findall(r"`([\w/]+\.[ch]pp)`", text)} - SOURCES
    assert not missing, f"{page} names {missing}"


def test_drawings_and_worked_numbers_are_what_the_scripts_make(tmp_path: Path) -> None:
    """Every SVG and the whole page, byte for byte; and no drawing without a script."""
    draw_all.main(tmp_path)
    for made in sorted(tmp_path.iterdir()):
        kept = draw_all.PAGE if made.suffix == ".md" else draw_all.HERE / made.name
        assert made.read_bytes() == kept.read_bytes(), f"{kept}: run docs/pictures/draw_all.py"
    assert {path.name for path in draw_all.HERE.glob("*.svg")} == {path.name for path in tmp_path.glob("*.svg")}
    shown = set(re.findall(r"\(pictures/(\w+\.svg)\)", draw_all.PAGE.read_text(encoding="utf-8")))
    assert shown == {path.name for path in tmp_path.glob("*.svg")}


def test_pictures_of_surfaces_are_what_their_script_makes(tmp_path: Path) -> None:
    """The same pixels, but for a few that lie on an edge between two shades; small; and with the README's numbers."""
    pytest.importorskip("embreex", reason="pictures are drawn by embreex: pip install 'isocore[picture]'")
    scan.main(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == scan.PICTURES.keys()
    for kept in (scan.HERE / name for name in scan.PICTURES):
        ours, theirs = (read_png(path).astype(int) for path in (tmp_path / kept.name, kept))
        assert ours.shape == theirs.shape and np.count_nonzero(np.abs(ours - theirs) > 8) < ours.size / 500
        assert kept.stat().st_size < 250_000
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    for surface in scan.surfaces():
        assert f" {len(surface.triangles):,} triangles" in text


def test_the_volume_climbed_by_hand_is_what_the_kernels_make_of_it() -> None:
    """The same boxes, the same vertices to the last bit, the same triangles, the same farthest crossing."""
    block = the_volume.climbed()
    vertices, triangles, facts = _kernels.climb(the_volume.samples(), the_volume.ISOVALUE, False, False, 1, 4)
    assert facts.highrices == len(block.boxes)
    places = [block.place(edge) for edge, is_kept in zip(block.crossings, block.kept, strict=True) if is_kept]
    assert np.array_equal(np.array(places, dtype=vertices.dtype), vertices)
    assert turned(by_hand_loops.triangles(block)) == turned(triangles.tolist())
    farthest = max(far for box in block.boxes for _, far in by_hand_loops.deviation(block, box))
    assert facts.error_voxels[0] == pytest.approx(farthest, abs=1e-6)
    march, cells = the_volume.marched()
    assert len(_kernels.marching_cubes(the_volume.samples(), the_volume.ISOVALUE)[1]) == len(cells) and all(march.kept)


def turned(triangles: list[by_hand_loops.Triangle]) -> list[list[int]]:
    """In one order, each from its lowest corner on."""
    return sorted([*triangle[n:], *triangle[:n]] for triangle in triangles for n in [triangle.index(min(triangle))])


def test_the_table_of_bounds_is_what_the_kernels_measure() -> None:
    """The last table of docs/how-climbing-works.md."""
    text = draw_all.PAGE.read_text(encoding="utf-8").split("| bound, voxels |")[1]
    rows = re.findall(r"^\| (none|[\d.]+) \| (\d+) \| (\d+) \| ([\d.]+) \|$", text, re.MULTILINE)
    assert len(rows) >= 5
    for bound, boxes, triangles, measured in rows:
        most = float("inf") if bound == "none" else float(bound)
        _, drawn, facts = _kernels.climb(the_volume.samples(), the_volume.ISOVALUE, False, False, 1, 4, most)
        assert (facts.highrices, len(drawn), facts.split_again) == (int(boxes), int(triangles), 0)
        assert f"{facts.error_voxels.max:.3f}" == measured


def examples() -> list[tuple[str, list[str]]]:
    """The README's commands and what it says they print."""
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    starts = [n for n, line in enumerate(lines) if line.startswith("    $ isocore ")]
    ends = [next(m for m in range(n, len(lines)) if not lines[m]) for n in starts]
    return [(lines[n].removeprefix("    $ isocore "), lines[n + 1 : m]) for n, m in zip(starts, ends, strict=True)]


@pytest.mark.parametrize(
    ("command", "shown"), examples(), ids=lambda part: part.split()[0] if type(part) is str else ""
)
def test_a_command_of_the_readme_prints_what_it_shows(
    command: str, shown: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Word by word, but for numbers with a point, as those are times and what depends on them."""
    (tmp_path / "sample_volumes").symlink_to(ROOT / "sample_volumes")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(program, command.split())
    assert result.exit_code == 0
    assert words(result.output.splitlines()) == words(shown)


def words(lines: list[str]) -> list[str]:
    return [word for line in lines for word in line.split() if not re.fullmatch(r"\d+\.\d+", word)]


def test_there_are_three_commands_to_try() -> None:
    """Each with something to compare."""
    assert len(examples()) == 3 and all(shown for _, shown in examples())
