"""A VTU file that gets shorter while it is read, and one whose tags are read apart from its data."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from vtu_files import Encoding, Mesh, write

from isocore.errors import InputError
from isocore.readers import ReadOptions, read, vtu_file
from isocore.readers.vtu import read_vtu

POINTS = np.array([[i, j, k] for i in range(8) for j in range(8) for k in range(8)], np.float64)
CUBES = [
    (12, [base + step for step in (0, 64, 72, 8, 1, 65, 73, 9)])
    for i in range(7)
    for j in range(7)
    for k in range(7)
    for base in [64 * i + 8 * j + k]
]
MESH = Mesh(POINTS, CUBES, {"p": ((POINTS - 3.5) ** 2).sum(axis=1), "q": POINTS[:, 0].copy()})
ENCODINGS = [Encoding(), Encoding("binary"), Encoding("appended"), Encoding("appended", "base64", "zlib")]
OPTIONS = ReadOptions(field="p")


@pytest.mark.parametrize("encoding", ENCODINGS, ids=str)
@pytest.mark.parametrize("head", [1 << 24, 2000])
def test_what_is_read_does_not_depend_on_how_much_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: Encoding, head: int
) -> None:
    """All of a file that is small, or the tags first and each array when it is needed."""
    right = read(write(tmp_path / "a.vtu", MESH), OPTIONS)
    path = write(tmp_path / "b.vtu", MESH, encoding)
    monkeypatch.setattr(vtu_file, "_HEAD", head)
    monkeypatch.setattr(vtu_file, "_TAG", 64)
    monkeypatch.setattr(vtu_file, "_LARGE", 1000)
    mesh = read(path, OPTIONS)
    assert np.array_equal(mesh.points, right.points) and np.array_equal(mesh.values, right.values)
    assert np.array_equal(mesh.hexes, right.hexes)


@pytest.mark.parametrize("encoding", ENCODINGS, ids=str)
@pytest.mark.parametrize("text", ["<!-- no <AppendedData encoding='raw'>_ here -->", "<!-- <AppendedData"])
def test_a_comment_is_no_appended_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: Encoding, text: str
) -> None:
    """Though it speaks of them where the tags are looked for."""
    path = write(tmp_path / "a.vtu", MESH, encoding)
    right = read(path, OPTIONS)
    text += "" if text.endswith("-->") else " " * 5000 + "-->"
    path.write_bytes(path.read_bytes().replace(b"<UnstructuredGrid>", b"<UnstructuredGrid>" + text.encode(), 1))
    monkeypatch.setattr(vtu_file, "_HEAD", 2000)
    monkeypatch.setattr(vtu_file, "_TAG", 64)
    assert np.array_equal(read(path, OPTIONS).values, right.values)


@pytest.mark.parametrize("encoding", ENCODINGS, ids=str)
@pytest.mark.parametrize("left", [0, 300, 2500, -1])
@pytest.mark.parametrize("step", ["opened", "tags"])
def test_a_file_that_gets_shorter_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: Encoding, left: int, step: str
) -> None:
    """As one that a program is writing again; before its tags are read, and before its arrays are."""
    path = write(tmp_path / "a.vtu", MESH, encoding)
    size = path.stat().st_size
    monkeypatch.setattr(vtu_file, "_HEAD", 2000)
    monkeypatch.setattr(vtu_file, "_TAG", 64)
    stored = vtu_file.StoredFile

    class Shrinking(stored):
        def __init__(self, name: str) -> None:
            super().__init__(name)
            if step == "opened":
                os.truncate(path, left % size)

        def tags(self) -> bytes:
            found = bytes(super().tags())
            if step == "tags":
                os.truncate(path, left % size)
            return found

    monkeypatch.setattr("isocore.readers.vtu_opening.StoredFile", Shrinking)
    if step == "tags" and encoding.format != "appended":  # all of it was read by then
        assert len(read_vtu(path, OPTIONS).values) == len(POINTS)
        return
    try:
        mesh = read_vtu(path, OPTIONS)
    except InputError as refusal:
        assert str(refusal).startswith(f"{path}: ") and str(refusal).isprintable()
        assert step == "opened" or "the file got shorter" in str(refusal)
    else:  # only what stands behind the arrays is missing
        assert left == -1 and len(mesh.values) == len(POINTS)


def test_a_truncated_file_ends_no_process(tmp_path: Path) -> None:
    """Truncated again and again while a process reads it: that one ends by itself, with the mesh or a refusal."""
    path = write(tmp_path / "a.vtu", MESH, Encoding("appended"))
    whole = path.read_bytes()
    code = (
        "import sys\nfrom isocore.errors import InputError\nfrom isocore.readers import ReadOptions, read\n"
        "print('started', flush=True)\n"
        "for _ in range(300):\n    try: read(sys.argv[1], ReadOptions(field='p'))\n    except InputError: pass\n"
    )
    command = [sys.executable, "-P", "-c", code, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline() == b"started\n"
        while process.poll() is None:
            for content in (whole, whole[:4096], whole[:100]):
                path.write_bytes(content)
        assert process.returncode == 0, process.stderr.read() if process.stderr else ""
