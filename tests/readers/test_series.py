"""Each step of a series is a job: found, named, dated, and done whatever becomes of the others."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.info import info
from vtu_files import Mesh, write

from isocore.batches.steps import StepChoice
from isocore.errors import IsocoreError, OptionError
from isocore.readers import ReadOptions, files_of, read, times_of

SERIES = Path(__file__).parents[3] / "shared" / "data" / "simulation" / "series"
POINTS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)


def tetrahedron(value: float, moved: float = 0.0) -> Mesh:
    """One cell whose first corner has this value, the others 0."""
    return Mesh(POINTS + moved, [(10, [0, 1, 2, 3])], {"u": np.array([value, 0, 0, 0])})


def write_pvd(path: Path, entries: list[dict[str, Any]]) -> Path:
    sets = "".join("<DataSet " + " ".join(f'{k}="{v}"' for k, v in entry.items()) + "/>" for entry in entries)
    path.write_text(f'<?xml version="1.0"?><VTKFile type="Collection"><Collection>{sets}</Collection></VTKFile>')
    return path


def run_of(folder: Path, count: int = 5) -> Path:
    """run.pvd and its steps, written out of order; the time of step n is n / 2, its value n + 1."""
    (folder / "steps").mkdir()
    for n in range(count):
        write(folder / "steps" / f"u{n}.vtu", tetrahedron(n + 1))
    order = [*range(1, count), 0]
    return write_pvd(folder / "run.pvd", [{"timestep": n / 2, "file": f"steps/u{n}.vtu"} for n in order])


def converted(*arguments: Any) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def records(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "run.json").read_text())["outputs"]
    return found


def test_every_step_is_a_job_with_its_number_and_time(tmp_path):
    """In the order of their times, whatever the order in the file."""
    path = run_of(tmp_path)
    result = converted(path, "-i", 0.5, "-d", tmp_path / "out", "--report", tmp_path / "run.json", "-q")
    assert result.exit_code == 0, result.output
    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == [f"run_{n}.ply" for n in range(5)]
    rows = records(tmp_path)
    assert [(row["step"], row["time"], row["range"][1]) for row in rows] == [(n, n / 2, n + 1) for n in range(5)]
    assert {row["source"] for row in rows} == {str(path)}


def test_series_of_paraview_are_read_too(tmp_path):
    """JSON that names files and times."""
    run_of(tmp_path, 3)
    files = [{"name": f"steps/u{n}.vtu", "time": 10.0 - n} for n in range(3)]
    path = tmp_path / "run.vtu.series"
    path.write_text(json.dumps({"file-series-version": "1.0", "files": files}))
    assert times_of(path) == (8, 9, 10)
    assert [read(path, ReadOptions(step=n)).values.max() for n in range(3)] == [3, 2, 1]


@pytest.mark.parametrize(
    "options, expected",
    [
        (("--steps", "1:3"), [1, 2, 3]),
        (("--steps", "0:4:2"), [0, 2, 4]),
        (("--steps", "::3"), [0, 3]),
        (("--steps", "3:"), [3, 4]),
        (("--steps", "-1"), [4]),
        (("--steps", "-2:,0"), [0, 3, 4]),
        (("--steps", "2:99"), [2, 3, 4]),
        (("--times", "0.5,2"), [1, 4]),
        (("--times", "1.0000001"), [2]),
        (("--times", "2", "--steps", "0"), [0, 4]),
    ],
)
def test_steps_are_chosen_by_number_and_by_time(options, expected, tmp_path):
    """Both ends of a range belong to it."""
    result = converted(run_of(tmp_path), "-i", 0.5, "--dry-run", *options)
    assert result.exit_code == 0, result.output
    names = [line.split(" -> ")[1].split(":")[0] for line in result.output.splitlines()]
    assert names == [str(tmp_path / f"run_{n}.ply") for n in expected]


@pytest.mark.parametrize(
    "options, message",
    [
        (("--steps", "7"), "has no step that --steps asks for; it holds 0 to 4"),
        (("--times", "0.7"), "has no step at time 0.7; it holds 5 steps from 0 to 2"),
        (("--steps", "a"), "a: needs steps as 3, 0:10, 0:10:2 or -1"),
        (("--steps", "0:4:0"), "0:4:0: needs steps"),
        (("--times", "nan"), "nan: needs times"),
        (("-o", "one.ply"), "-o one.ply: is one file, the input has 5 surfaces; use -d"),
        (("--name", "{stem}"), "tell them apart with --name {stem}_{step}"),
    ],
)
def test_what_makes_no_sense_of_a_series_is_refused_before_any_work(options, message, tmp_path):
    """Exit code 2 of the command line, with what there is."""
    result = converted(run_of(tmp_path), "-i", 0.5, *options)
    text = " ".join(f"{result.output} {result.exception}".split())
    assert message in text and not list(tmp_path.glob("*.ply"))
    assert isinstance(result.exception, (OptionError, SystemExit))


def test_names_may_have_step_and_time(tmp_path):
    """Steps in so many digits."""
    result = converted(run_of(tmp_path), "-i", 0.5, "--dry-run", "--steps", "3", "--name", "{stem}-{step:04}-{time}")
    assert f"{tmp_path / 'run-0003-1.5.ply'}" in result.output


def test_a_step_that_fails_leaves_the_others(tmp_path):
    """One file is missing, one half written: those rows fail, with the file's name."""
    path = run_of(tmp_path)
    (tmp_path / "steps" / "u1.vtu").unlink()
    half = tmp_path / "steps" / "u3.vtu"
    half.write_bytes(half.read_bytes()[:500])
    result = converted(path, "-i", 0.5, "-d", tmp_path / "out", "--report", tmp_path / "run.json", "-q")
    assert result.exit_code == 1
    rows = records(tmp_path)
    assert [row["status"] for row in rows] == ["done", "failed", "done", "failed", "done"]
    assert "u1.vtu" in rows[1]["message"] and "missing" in rows[1]["message"] and "u3.vtu" in rows[3]["message"]
    assert all(row["message"].startswith(f"{path}: ") for row in (rows[1], rows[3]))


def test_parts_of_one_time_are_one_mesh(tmp_path):
    """Joined where they meet; a file that a restart names again counts once."""
    for name, moved in (("a", 0.0), ("b", 1.0)):
        write(tmp_path / f"{name}.vtu", tetrahedron(1, moved))
    entries = [{"timestep": 0, "part": part, "file": f"{name}.vtu"} for part, name in enumerate(("a", "b", "a"))]
    mesh = read(write_pvd(tmp_path / "run.pvd", entries))
    assert len(mesh.tets) == 2 and len(mesh.points) == 8


def test_steps_may_be_meshes_in_pieces(tmp_path):
    """A .pvd of .pvtu: all files are known as the series' own."""
    write(tmp_path / "a.vtu", tetrahedron(1))
    write(tmp_path / "b.vtu", tetrahedron(1, 1.0))
    pieces = '<Piece Source="a.vtu"/><Piece Source="b.vtu"/>'
    (tmp_path / "s.pvtu").write_text(f'<VTKFile type="PUnstructuredGrid">{pieces}</VTKFile>')
    path = write_pvd(tmp_path / "run.pvd", [{"timestep": 3, "file": "s.pvtu"}])
    assert len(read(path).tets) == 2
    assert [file.name for file in files_of(path)] == ["run.pvd", "s.pvtu", "a.vtu", "b.vtu"]
    result = converted(tmp_path, "-i", 0.5, "--dry-run", "-d", tmp_path / "out")
    assert result.output.startswith(f"{path} -> ") and len(result.output.splitlines()) == 1


def test_a_series_that_grows_leaves_its_earlier_steps_up_to_date(tmp_path):
    """--if-changed looks at a step's own files."""
    path = run_of(tmp_path, 2)
    arguments = (path, "-i", 0.5, "-d", tmp_path / "out", "--if-changed", "--report", tmp_path / "run.json", "-q")
    converted(*arguments)
    write(tmp_path / "steps" / "u2.vtu", tetrahedron(3))
    write_pvd(path, [{"timestep": n / 2, "file": f"steps/u{n}.vtu"} for n in range(3)])
    converted(*arguments)
    assert [row["status"] for row in records(tmp_path)] == ["skipped", "skipped", "done"]
    write(tmp_path / "steps" / "u1.vtu", tetrahedron(7))
    converted(*arguments)
    assert [row["status"] for row in records(tmp_path)] == ["skipped", "done", "skipped"]


def test_a_depfile_names_the_files_of_each_step(tmp_path):
    """A step is made again when its own file changes."""
    path = run_of(tmp_path, 2)
    converted(path, "-i", 0.5, "-d", tmp_path / "out", "--depfile", tmp_path / "deps", "-q")
    rules = [line for line in (tmp_path / "deps").read_text().splitlines() if line.startswith(f"{tmp_path}/out/run_1")]
    assert len(rules) == 1 and "u1.vtu" in rules[0] and "u0.vtu" not in rules[0]


def test_info_describes_the_first_step_and_lists_the_times(tmp_path):
    """And reading without a choice says how to make one."""
    path = run_of(tmp_path)
    facts = json.loads(CliRunner().invoke(info, [str(path), "--json"]).output)[0]
    assert facts["steps"] == 5 and facts["times"] == [0, 0.5, 1, 1.5, 2] and facts["range"] == [0, 1]
    assert "times        0 to 2" in CliRunner().invoke(info, [str(path)]).output
    with pytest.raises(OptionError, match="holds 5 steps"):
        read(path)
    with pytest.raises(OptionError, match="has no step 5; it holds 0 to 4"):
        read(path, ReadOptions(step=5))


@pytest.mark.parametrize(
    "name, text, message",
    [
        ("a.pvd", '<VTKFile type="Collection"/>', "names no steps"),
        ("a.pvd", '<VTKFile type="Table"/>', "holds a VTK Table; a .pvd lists the steps of a series"),
        ("a.pvd", '<VTKFile type="Collection"><DataSet timestep="x" file="a"/></VTKFile>', "gives 'x' as a time"),
        ("a.pvd", '<VTKFile type="Collection"><DataSet timestep="1"/></VTKFile>', "names the file ''"),
        ("a.pvd", '<VTKFile type="Collection"><DataSet file="a.pvd"/></VTKFile>', "a.pvd, which is not read"),
        ("a.pvd", '<VTKFile type="Collection"><DataSet file="a.stl"/></VTKFile>', "one of its 1 files of the step is"),
        ("a.vtu.series", "{", "is not JSON"),
        ("a.vtu.series", "[]", 'lacks "files", a list'),
        ("a.vtu.series", '{"files": [{"name": 3}]}', 'entry 0 of its "files" has no "name"'),
        ("a.vtu.series", '{"files": [{"name": "a", "time": true}]}', "gives 'True' as a time"),
        ("a.vtu.series", '{"files": [{"name": "a", "time": 1e999}]}', "gives 'inf' as a time"),
        ("a.vtu.series", "[" * 100_000, "nested too deeply"),
    ],
)
def test_what_is_no_series_is_one_row_that_says_why(name, text, message, tmp_path):
    """Planned as one job, so that the batch goes on."""
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(IsocoreError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ") and message in str(caught.value)
    result = converted(path, "-i", 0.5, "-d", tmp_path / "out", "--report", tmp_path / "run.json", "-q")
    assert result.exit_code == 1 and [row["status"] for row in records(tmp_path)] == ["failed"]


def test_the_choice_of_nothing_is_all_steps():
    """And negative numbers count from the end."""
    times = (0.0, 1.0, 2.0)
    assert StepChoice().of(Path("a"), times) == [0, 1, 2]
    assert StepChoice(ranges=((-2, None, 1),)).of(Path("a"), times) == [1, 2]


@pytest.mark.skipif(not SERIES.is_dir(), reason="the real data lies beside the repository, not in it")
def test_a_real_series_of_surfaces_says_for_each_step_why_it_has_no_isosurface(tmp_path):
    """ParaView's own example: fifteen steps of quads."""
    path = SERIES / "mesh.vtu.series"
    assert times_of(path) == tuple(map(float, range(15)))
    with pytest.raises(IsocoreError, match=r"mesh_3\.vtu: holds only surface cells \(6,241 quads\)"):
        read(path, ReadOptions(step=3))
