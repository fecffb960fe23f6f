"""Messages and warnings: one line, printable, of bounded length, whatever a file or its name brings into them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_files import ball, write_nifti

from isocore.cell_mesh import CellMesh
from isocore.errors import LONGEST, InputError, OptionError, about, one_line, printable, reading, shortened
from isocore.job import Job, Target
from isocore.pipeline import failed
from isocore.report import BatchReport
from isocore.report.render_github import github_annotations
from isocore.volume import Volume

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()"]
NASTY = "a\nb\r\x1b[31m\x9b2J\x85\u2028\u202e\ud800\udcff\t\x00z"


def isocore(folder: Path, *arguments: object, **environment: str) -> subprocess.CompletedProcess[bytes]:
    command = [*PROGRAM, *map(str, arguments)]
    settings: dict[str, Any] = {"cwd": folder, "env": os.environ | environment, "timeout": 60, "check": False}
    return subprocess.run(command, capture_output=True, **settings)


def test_what_is_not_printable_is_shown_as_its_escape() -> None:
    """Also separators of lines that only some programs know, and bytes that are no text."""
    assert printable(NASTY) == r"a\nb\r\x1b[31m\x9b2J\x85\u2028\u202e\ud800\xff\t\x00z"
    assert printable("Müller 脳 \u3000.nii") == "Müller 脳 \u3000.nii"
    assert printable("\udcff\n", stray=True) == "\udcff\\n"


@pytest.mark.parametrize("kind", [InputError, OptionError])
def test_every_error_has_one_printable_line_of_bounded_length(kind: type[Exception]) -> None:
    """Both ends stay: the path's, and what to do."""
    text = str(kind(f"scans/{NASTY}: holds {'x' * 10**6}; name another"))
    assert text.isprintable() and len(text) <= LONGEST
    assert text.startswith("scans/a\\n") and text.endswith("; name another")


def test_a_long_path_makes_room_for_what_happened() -> None:
    """Its own middle goes first."""
    path = "/".join(["deep" * 10] * 90) + "/last.nii"
    text = shortened(f"{path}: ends early (65,360 of 131,072 bytes); copy it again")
    assert len(text) == LONGEST and text.endswith("/last.nii: ends early (65,360 of 131,072 bytes); copy it again")


@pytest.mark.parametrize("path", ["a.nii", "a\n.nii", "d/" * 60 + "a.nii", "d/" * 1500 + "a\x1b.nii"])
def test_a_message_names_its_path_once(path: str) -> None:
    """However often it passes through the places that put it there, and however the path is spelled or cut."""
    text = about(path, InputError(about(path, f"{path}: is empty; copy it again")))
    assert text == shortened(f"{path}: is empty; copy it again") == about(path, "is empty; copy it again")
    job = Job(source=Path(path), targets=(Target("50", Path("x.ply")),))
    assert failed(job, job.targets[0], InputError(text)).message == text


def test_foreign_errors_are_cut_too() -> None:
    """A library may quote half the file."""
    assert len(one_line(ValueError("x" * 10**6))) <= LONGEST
    with pytest.raises(InputError) as refusal, reading("a.nii"):
        raise ValueError("bad\x1b header " + "x" * 1000)
    assert str(refusal.value).isprintable() and len(str(refusal.value)) <= LONGEST


def test_warnings_and_misses_are_held_to_the_same() -> None:
    """Wherever they come from: a field's name can stand in them."""
    job = Job(source=Path("a.nii"), targets=(Target("50", Path("x.ply")),))
    run = replace(failed(job, job.targets[0], InputError("x")), warnings=(NASTY, "y" * 999), missed=(NASTY,))
    assert all(text.isprintable() and len(text) <= LONGEST for text in (*run.warnings, *run.missed))


def test_files_cannot_speak_through_messages(tmp_path: Path) -> None:
    """Keys and values of a sidecar and names of fields, on stderr and in the report."""
    (tmp_path / "k.raw").write_bytes(b"12345678")
    (tmp_path / "k.raw.json").write_text(json.dumps({"shape": [2, 2, 2], "dtype": "uint8", "a\n::error::x\x1b[31m": 1}))
    (tmp_path / "d.raw").write_bytes(b"12345678")
    (tmp_path / "d.raw.json").write_text(json.dumps({"shape": [2, 2, 2], "dtype": "\u2028" + "z" * 10**6}))
    made = isocore(tmp_path, "convert", "k.raw", "d.raw", "-d", "out", "-q", "--report", "r.json")
    assert made.returncode == 1
    lines = made.stderr.decode().splitlines()
    assert len(lines) == 2 and all(line.isprintable() and len(line) < LONGEST + 20 for line in lines)
    assert r"a\n::error::x\x1b[31m" in lines[0]
    messages = [run["message"] for run in json.loads((tmp_path / "r.json").read_text())["outputs"]]
    assert all(text.isprintable() and len(text) <= LONGEST for text in messages)


def test_no_name_of_a_file_is_a_command_to_github(tmp_path: Path) -> None:
    """Neither by a line break of its own nor at the start of a line, also in the older spelling."""
    names = ["x\n::stop-commands::t\n.nii", "::add-mask::e.nii", "a##[stop-commands]t.nii"]
    for name in names:
        write_nifti(tmp_path / "in" / name, ball())
    more = ("-i", 50, "-v", "-b", "mc", "--require", "nonempty", "--max-triangles", 3)
    made = isocore(tmp_path / "in", "convert", *names, "-d", "../out", *more, GITHUB_ACTIONS="true")
    assert made.returncode == 3
    lines = [line.strip() for line in made.stderr.decode().split("\n")]
    assert {line.partition(" ")[0] for line in lines if line.startswith("::")} == {"::error"}
    assert not any("##[" in line for line in lines if not line.startswith("::error "))
    for command in (("info", *names), ("convert", *names, "-i", 50, "-d", "../out", "--dry-run")):
        shown = isocore(tmp_path / "in", *command, GITHUB_ACTIONS="true").stdout.decode()
        assert shown and "##[" not in shown and not any(line.lstrip().startswith("::") for line in shown.split("\n"))


def test_an_annotation_holds_no_second_command() -> None:
    """Its place and its text are escaped as GitHub wants them."""
    job = Job(source=Path("a,b:c\n::x.nii"), targets=(Target("50", Path("x.ply")),))
    (line,) = github_annotations(BatchReport((failed(job, job.targets[0], InputError("50%\nlost")),)))
    assert line == r"::error file=a%2Cb%3Ac%0A%3A%3Ax.nii,title=isocore::a,b:c\n::x.nii: 50%25\nlost"


def test_a_warning_about_a_field_is_printable_whatever_the_file_calls_it() -> None:
    """A name out of a file moves no cursor in the report of warnings either."""
    warning = "p\x1b[31m\n\x85\u202e is not finite"
    volume = Volume(np.zeros((2, 2, 2), np.float32, order="F"), warnings=(warning,))
    points, tets = np.zeros((4, 3)), np.array([[0, 1, 2, 3]], np.int32)
    mesh = CellMesh(points, tets, np.empty((0, 8), np.int32), np.zeros(4), warnings=(warning,))
    assert volume.warnings == mesh.warnings == ("p\\x1b[31m\\n\\x85\\u202e is not finite",)
