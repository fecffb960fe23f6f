"""Tables on screens of any width, and without one."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from isocore.cli.table import Column, cells_of, columns_of, folded, set_table, shortened
from records import SURFACE
from small_files import ball, write_nifti
from terminal import Screen, on_a_terminal

from isocore.errors import printable
from isocore.report.keys import run_from_dict
from isocore.report.record import BatchReport
from isocore.report.summary import HEADINGS, LEAVING, RIGHT, summary_rows, told_apart

WIDTHS = (80, 100, 160)
COLUMNS = columns_of(HEADINGS, RIGHT, LEAVING, "file")
SAMPLES = Path(__file__).resolve().parent.parent / "sample_volumes"


def record(output: str, triangles: int = 1_924_067, **others: object) -> dict[str, object]:
    return {
        "source": "scans/x.nii.gz",
        "output": output,
        "isovalue": 1200.0,
        "status": "done",
        "surface": SURFACE | {"triangles": triangles},
        "reference": {"name": "mc", "triangles": 12_345_678, "vertices": 9, "seconds": 1.5},
        "ratio": {"triangles": 6.42, "seconds": 2.0},
        "seconds": {"prepare": 1.0, "extract": 12.25, "total": 14.5},
        **others,
    }


def batch(*outputs: str) -> BatchReport:
    return BatchReport(tuple(run_from_dict(record(output)) for output in outputs))


@pytest.mark.parametrize("width", range(40, 161, 4))
def test_a_table_is_never_wider_than_its_screen(width: int) -> None:
    """And every number in it is whole: it stands in the table of a screen without an end."""
    rows = summary_rows(batch(*(f"meshes/sub-{n:03}_ses-01_acq-mprage_run-2_T1w_1200.ply" for n in range(3))))
    lines = set_table(COLUMNS, rows, width)
    whole = {word for line in set_table(COLUMNS, rows) for word in line.split()}
    assert max(map(len, lines)) <= width
    for line in lines:
        assert set(line.split()[1:]) <= whole, line


def test_columns_leave_by_their_place_and_the_last_ones_stay() -> None:
    """The file and its status stay on any screen, and what leaves first is back first."""
    rows = summary_rows(batch("knot.ply"))
    shown = [set_table(COLUMNS, rows, width)[0] for width in range(20, 100)]
    assert all("file" in heading and "status" in heading for heading in shown)
    for heading in shown:
        missing = [name for name in LEAVING if name not in heading]
        assert missing == list(LEAVING[: len(missing)])
    assert shown[-1].split() == " ".join(HEADINGS).split()


def test_a_column_that_says_nothing_leaves_first() -> None:
    """Without a reference there is nothing to compare with, and the seconds keep their place."""
    alone = record("a_name_of_some_length_for_a_surface.ply")
    del alone["reference"], alone["ratio"]
    heading = set_table(COLUMNS, summary_rows(BatchReport((run_from_dict(alone),))), 80)[0]
    assert "seconds" in heading and "watertight" in heading and "ratio" not in heading and "reference" not in heading


def test_the_readmes_table_fits_80_columns() -> None:
    """With everything but the reference's seconds."""
    heading, line = set_table(COLUMNS, summary_rows(batch("head_150.stl")), 80)
    assert heading.startswith("file") and "12,345,678" not in line and "1,924,067" in line


def test_without_a_terminal_nothing_is_left_out() -> None:
    """However long."""
    name = "a" * 200 + ".ply"
    line = set_table(COLUMNS, summary_rows(batch(name)))[1]
    assert name in line and "12,345,678" in line and len(line) > 250


def test_a_long_name_loses_its_head() -> None:
    """What tells scans of one subject apart stands at the end."""
    assert shortened(["sub-CC110033_ses-01_T1w.ply", "short.ply"], 16) == ["...es-01_T1w.ply", "short.ply"]


def test_names_that_end_alike_lose_their_middle() -> None:
    """Different names stay different."""
    names = [f"sub-{n:03}_a_very_long_common_ending_of_names_T1w.ply" for n in range(30)]
    cut = shortened(names, 24)
    assert len(set(cut)) == 30 and all(len(name) <= 24 and "..." in name for name in cut)


def test_paths_are_told_apart_by_their_folders() -> None:
    """By as many as it takes, and only where names are alike."""
    assert told_apart(["out/a/T1.ply", "out/b/T1.ply", "out/b/T2.ply"]) == ["a/T1.ply", "b/T1.ply", "T2.ply"]
    assert told_apart(["x/a/s/T1.ply", "x/b/s/T1.ply"]) == ["a/s/T1.ply", "b/s/T1.ply"]
    assert told_apart(["T1.ply", "a/T1.ply", "/a/T1.ply"]) == ["T1.ply", "a/T1.ply", "/a/T1.ply"]
    assert told_apart(["a/T1.ply", "a/T1.ply", ""]) == ["T1.ply", "T1.ply", "."]


def test_an_empty_surface_is_neither_closed_nor_open() -> None:
    """It has a dash."""
    runs = [run_from_dict(record("a.ply", triangles)) for triangles in (0, 4)]
    rows = summary_rows(BatchReport(tuple(runs)))
    assert [row[HEADINGS.index("watertight")] for row in rows] == ["-", "yes"]


def test_wide_characters_take_two_columns_and_combining_ones_none() -> None:
    """Columns stay in line below a Chinese name."""
    assert cells_of("头骨.ply") == 8 and cells_of("e\u0301.ply") == 5
    columns = [Column("file", shrinks=True), Column("n", right=True)]
    lines = set_table(columns, [("头骨_头骨_头骨.ply", "1"), ("ab.ply", "22")], 15)
    assert {cells_of(line) for line in lines[1:]} == {15}


def test_a_name_cannot_move_the_cursor() -> None:
    """Control characters and halves of characters are spelt out."""
    assert printable("a\x1b[2Jb\n\udce9.ply") == "a\\x1b[2Jb\\n\\xe9.ply"
    (_, line) = set_table([Column("file", shrinks=True)], [("a\nb",)])
    assert line == "a\\nb"


def test_a_text_is_folded_between_words_only() -> None:
    """Under its own beginning, or a little to the right where that would leave no room."""
    assert folded("  bounds  ", "(-1.5, 2.25) to (3.5, 4.75)", 38) == ["  bounds  (-1.5, 2.25) to (3.5, 4.75)"]
    lines = folded("  bounds  ", "(-1.5, 2.25) to (3.5, 4.75) and further", 36)
    assert lines == ["  bounds  (-1.5, 2.25) to (3.5,", "          4.75) and further"]
    assert folded("  bounds  ", "1 234567890123456789", 14) == ["  bounds  1", "    234567890123456789"]


def numbers(text: str, timed: bool) -> set[str]:
    """The whole numbers in text. Of a run that is timed anew, those in groups of three digits: a ratio may be 12."""
    return {word for word in text.split() if re.fullmatch(r"[\d,]*,[\d,]*" if timed else r"[\d,]+", word)}


def plain(*arguments: object) -> str:
    command = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    return done.stdout + done.stderr


@pytest.mark.parametrize("command", ["convert", "report", "compare", "bench", "info", "mesh bench"])
def test_every_command_fits_the_terminal_it_runs_on(tmp_path: Path, command: str) -> None:
    """No line is broken by the terminal, and every number is one that stands in the output without a terminal."""
    knot, torus = SAMPLES / "knot.nii.gz", SAMPLES / "torus.vtu"
    made = ("convert", knot, SAMPLES / "head.raw", "-i", 200, "-d", tmp_path / "out", "--no-progress")
    made = (*made, "--name", "a_name_of_more_than_40_characters_for_{stem}", "--report", tmp_path / "run.json")
    if command in ("report", "compare"):
        plain(*made)
    arguments = {
        "convert": made,
        "report": ("report", tmp_path / "run.json"),
        "compare": ("report", "--compare", tmp_path / "run.json", tmp_path / "run.json"),
        "bench": ("bench", knot, "-i", 200),
        "info": ("info", torus, knot),
        "mesh bench": ("bench", torus, "--isovalues", 2),
    }[command]
    timed = command in ("convert", "bench", "mesh bench")
    whole = numbers(plain(*arguments), timed)
    assert len(whole) > 1
    for width in WIDTHS:
        screen, written = on_a_terminal(width, *arguments)
        assert "Traceback" not in written and len(screen.lines) > 2
        assert not screen.broken, [line for line in screen.lines if len(line) > width]
        assert numbers("\n".join(screen.lines), timed) <= whole
        if command in ("convert", "report"):
            assert any("_for_head.ply" in line for line in screen.lines)


SLOW = """
import time
from isocore.cli import console, running
console._PATIENCE_SECONDS = 0
jobs_run = running.run_jobs

def slowly(jobs, batch, *, at):
    # Not before the bar is there, and with time to be drawn between two inputs.
    for _ in range(3000):
        if at.__self__._bar is not None:
            break
        time.sleep(0.01)
    for result in jobs_run(jobs, batch, at=at):
        time.sleep(0.15)
        yield result

running.run_jobs = slowly
"""


@pytest.mark.parametrize("flags", [(), ("-v",)])
def test_warnings_and_the_bar_do_not_collide(tmp_path: Path, flags: tuple[str, ...]) -> None:
    """Failures stand above the bar, each on a line of its own, and nothing of the bar is left at the end."""
    for n in range(4):
        write_nifti(tmp_path / "in" / f"a{n}.nii", ball(6))
        (tmp_path / "in" / f"b{n}.nii").write_bytes(b"junk" * 100)
    screen, written = on_a_terminal(80, "convert", tmp_path / "in", "-i", 50, "-d", tmp_path / "out", *flags, code=SLOW)
    assert "━" in written and "/8" in written, "the bar was never there"
    text = "\n".join(screen.lines)
    assert "━" not in text and "/8" not in text
    for n in range(4):
        (failure,) = [line for line in screen.lines if f"b{n}.nii: " in line and line.startswith("isocore: ")]
        assert failure.startswith(f"isocore: {tmp_path}/in/b{n}.nii: ") and len(failure) > len(str(tmp_path)) + 40
    # A long line is broken by the screen wherever it ends.
    assert "".join(screen.lines).count("--cap") == (4 if flags else 1)
    assert [line for line in screen.lines if line.startswith("4 done, 4 failed")]


def test_a_bar_names_files_as_they_are(tmp_path: Path) -> None:
    """Brackets in a name are no markup for it, and a line feed breaks no line."""
    for name in ("[red]a.nii", "b\n.nii"):
        write_nifti(tmp_path / "in" / name, ball())
    screen, written = on_a_terminal(80, "convert", tmp_path / "in", "-i", 50, "-d", tmp_path / "out", code=SLOW)
    assert "[red]a.nii" in written and "Traceback" not in written
    assert "2 done" in "\n".join(screen.lines) and "b\\n.ply" in "\n".join(screen.lines)


def test_the_screen_of_these_tests_reads_as_a_terminal_does() -> None:
    """Carriage returns go over what stands there, lines break at the width, whole lines can be erased."""
    screen = Screen(4)
    screen.show("abcdef\r\nxy\rz\r\nbar\r\x1b[2K\x1b[1A\x1b[31mZ\x1b[0m")
    assert screen.lines[:3] == ["abcdef", "Zy", ""]
