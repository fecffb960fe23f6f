"""The copies of surfaces in a page: whatever lies in the output files, the page is made."""

from __future__ import annotations

import base64
import json
import os
import random
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapes_mesh
from small_files import ball, write_nifti

from isocore.copies import copied
from isocore.job import Job, Target
from isocore.pipeline import convert
from isocore.report import BatchReport, RunReport, save_report
from isocore.report.keys import run_from_dict
from isocore.surface import Surface
from isocore.writers import FORMATS, write
from isocore.writers.read_back import read_mesh


def run_of(output: Path) -> RunReport:
    record = {"source": "a.nii", "output": str(output), "status": "done", "surface": {"triangles": 100}}
    return run_from_dict(record)


def page(folder: Path, *outputs: Path) -> list[dict[str, Any]]:
    """The records inside the page of these outputs."""
    save_report(BatchReport(tuple(run_of(output) for output in outputs)), folder / "run.html")
    text = (folder / "run.html").read_text(encoding="utf-8")
    match = re.search(r'<script type="application/json" id="report">(.*?)</script>', text, re.DOTALL)
    assert match
    outputs_: list[dict[str, Any]] = json.loads(match[1])["outputs"]
    return outputs_


def unpacked(mesh: dict[str, Any]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The vertices as the page draws them, in the world."""
    steps = np.frombuffer(base64.b64decode(mesh["vertices"]), "<u2").reshape(-1, 3) / 65535
    low, high = np.array(mesh["low"]), np.array(mesh["high"])
    return low + steps * (high - low)


@pytest.mark.parametrize("scale", [1e-200, 1e30, 1e45, 1e150, 1e307])
@pytest.mark.parametrize("most", [200, 60_000])
def test_a_surface_of_any_size_is_drawn_at_its_place(tmp_path: Path, scale: float, most: int) -> None:
    """Also where coordinates pass float32 and their squares pass float64."""
    sphere = shapes_mesh.sphere()
    vertices = sphere.vertices.astype(np.float64) * scale
    write(Surface(vertices, sphere.triangles), tmp_path / "mesh.ply")
    mesh = read_mesh(tmp_path / "mesh.ply")
    assert mesh is not None and mesh[0].dtype == np.float64
    copy = copied(Surface(*mesh), most)
    assert copy is not None and 20 < copy.count <= most
    drawn = unpacked(copy.as_dict()) / scale
    assert np.allclose(drawn.min(axis=0), sphere.vertices.min(axis=0), atol=0.5)
    radii, expected = np.linalg.norm(drawn, axis=1), np.linalg.norm(sphere.vertices, axis=1)
    assert expected.min() * 0.8 < radii.min() and radii.max() < expected.max() * 1.01
    json.dumps(copy.as_dict(), allow_nan=False)


def test_a_surface_longer_than_a_double_can_say_has_no_copy() -> None:
    """Rather than one with an infinite side."""
    vertices = np.array([[-1.5e308, 0, 0], [1.5e308, 0, 0], [0, 1, 0]])
    assert copied(Surface(vertices, np.array([[0, 1, 2]], np.int32)), 1000) is None


@pytest.mark.parametrize("format", ["ply", "obj"])
def test_an_input_with_coordinates_beyond_float32_gets_its_page(tmp_path: Path, format: str) -> None:
    """Its neighbours in the batch are drawn, and so is it."""
    good, huge = write_nifti(tmp_path / "good.nii", ball(8)), tmp_path / "huge.nii"
    header = bytearray(good.read_bytes())
    struct.pack_into("<f", header, 280, 2e38)  # srow_x[0]
    huge.write_bytes(header)
    outputs = [tmp_path / f"{source.stem}.{format}" for source in (good, huge)]
    for source, output in zip((good, huge), outputs, strict=True):
        (run,) = convert(Job(source=source, targets=(Target("50", output),), format=format, backend="mc"))  # type: ignore[arg-type]
        assert run.status == "done", run.message
    small, large = page(tmp_path, *outputs)
    assert max(small["mesh"]["high"]) < 1e3 and max(large["mesh"]["high"]) > 1e39


@pytest.mark.parametrize("format", FORMATS)
def test_a_damaged_output_costs_the_page_one_copy(tmp_path: Path, format: str) -> None:
    """Bytes changed, cut, doubled: no error, and what is read has finite vertices and no index beyond them."""
    write(shapes_mesh.sphere(), tmp_path / f"mesh.{format}")
    whole = (tmp_path / f"mesh.{format}").read_bytes()
    dice = random.Random(4)
    refused = 0
    for _ in range(600):
        data = bytearray(whole)
        for _ in range(dice.randint(1, 4)):
            at = dice.randrange(min(len(data), 400)) if dice.random() < 0.5 else dice.randrange(len(data))
            words = [b"\xff" * 4, b"\x00\x00\xc0\x7f", b"-1 ", b"nan ", b"99999999999 ", dice.randbytes(2), b""]
            data[at : at + dice.randint(0, 8)] = dice.choice(words)
        (tmp_path / f"bad.{format}").write_bytes(data)
        mesh = read_mesh(tmp_path / f"bad.{format}")
        refused += mesh is None
        if mesh is not None:
            assert np.isfinite(mesh[0]).all() and set(mesh[1].ravel().tolist()) <= set(range(len(mesh[0])))
            small = copied(Surface(mesh[0].astype(np.float64), mesh[1]), 200)
            assert small is None or json.dumps(small.as_dict(), allow_nan=False)
    assert refused > 100


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "a vertex that is not finite"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1e999 0\nf 1 2 3\n", "a vertex beyond a double"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a vertex that does not exist"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "a vertex before the first"),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n", "an index beyond 32 bits"),
    ],
    ids=lambda part: part if isinstance(part, str) else "",
)
def test_what_is_no_surface_is_left_out_of_the_page(tmp_path: Path, text: bytes, why: str) -> None:
    """The others stay in it."""
    (tmp_path / "bad.obj").write_bytes(text)
    write(shapes_mesh.sphere(), tmp_path / "good.obj")
    bad, good = page(tmp_path, tmp_path / "bad.obj", tmp_path / "good.obj")
    assert "mesh" not in bad and "mesh" in good


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no FIFOs")
def test_an_output_that_became_a_fifo_is_not_waited_for(tmp_path: Path) -> None:
    """Nobody may ever write to it."""
    os.mkfifo(tmp_path / "mesh.ply")
    assert read_mesh(tmp_path / "mesh.ply") is None
