"""`isocore convert`, as its users call it."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.main import main
from small_files import ball, write_nifti


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def program(*arguments: object, **settings: Any) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, timeout=60, check=False, **settings)


def record(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text())["outputs"][0]


def test_a_volume_becomes_a_surface_and_a_report(tmp_path: Path) -> None:
    """The first command of the README, with everything the report says about it."""
    source = write_nifti(tmp_path / "ball.nii.gz", ball())
    result = run(source, "-i", 50, "-o", tmp_path / "ball.ply", "-b", "mc", "--report", tmp_path / "run.json")
    assert result.exit_code == 0
    assert (tmp_path / "ball.ply").read_bytes().startswith(b"ply\nformat binary_little_endian")
    found = record(tmp_path / "run.json")
    assert (found["status"], found["isovalue"], found["backend"], found["kind"]) == ("done", 50, "mc", "volume")
    assert found["surface"]["watertight"] and found["surface"]["euler"] == 2
    assert found["reference"]["triangles"] == found["surface"]["triangles"] and found["ratio"]["triangles"] == 1
    assert "1 done" in result.stderr and not result.stdout


def test_the_sha256_in_the_report_is_the_outputs(tmp_path: Path) -> None:
    """Anyone can check an output against its report."""
    from hashlib import sha256

    source = write_nifti(tmp_path / "ball.nii", ball())
    run(source, "-i", 50, "-o", tmp_path / "ball.stl", "--report", tmp_path / "run.json")
    content = (tmp_path / "ball.stl").read_bytes()
    assert record(tmp_path / "run.json")["sha256"] == sha256(content).hexdigest()
    assert record(tmp_path / "run.json")["bytes"] == len(content)


def test_without_an_isovalue_the_reason_is_reported(tmp_path: Path) -> None:
    """A mask is cut halfway, anything else by Otsu."""
    mask = write_nifti(tmp_path / "mask.nii", (ball() > 50).astype(np.uint8))
    assert run(mask, "-o", tmp_path / "mask.ply", "--report", tmp_path / "run.json").exit_code == 0
    assert record(tmp_path / "run.json")["isovalue"] == 0.5
    assert "two values" in record(tmp_path / "run.json")["chosen"]


def test_a_folder_is_mirrored(tmp_path: Path) -> None:
    """Subfolders of the input become subfolders of the output."""
    for name in ("a.nii", "deep/b.nii.gz"):
        write_nifti(tmp_path / "in" / name, ball())
    assert run(tmp_path / "in", "-d", tmp_path / "out", "-i", 50, "-i", "60", "-f", "obj").exit_code == 0
    made = sorted(str(path.relative_to(tmp_path / "out")) for path in (tmp_path / "out").rglob("*.obj"))
    assert made == ["a_50.obj", "a_60.obj", "deep/b_50.obj", "deep/b_60.obj"]


def test_one_bad_file_never_stops_the_others(tmp_path: Path) -> None:
    """Exit code 1, one line about the bad one, and the good one done."""
    (tmp_path / "bad.nii").write_bytes(b"junk" * 100)
    write_nifti(tmp_path / "good.nii", ball())
    result = run(tmp_path, "-d", tmp_path / "out", "-i", 50)
    assert result.exit_code == 1
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["good.ply"]
    assert str(tmp_path / "bad.nii") in result.stderr and "Traceback" not in result.stderr


def test_an_isovalue_out_of_range_gives_an_empty_surface(tmp_path: Path) -> None:
    """That is a result, with the range of the samples beside it; only --require makes it a miss."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    result = run(source, "-i", 1000, "-o", tmp_path / "none.ply", "--report", tmp_path / "run.json")
    assert result.exit_code == 0 and record(tmp_path / "run.json")["status"] == "empty"
    assert "the samples lie between 0 and" in result.stderr
    assert run(source, "-i", 1000, "-o", tmp_path / "none.ply", "--require", "nonempty").exit_code == 3


@pytest.mark.parametrize(
    ("arguments", "miss"), [(("--require", "watertight"), "watertight"), (("--max-triangles", 4), "max-triangles")]
)
def test_a_missed_requirement_is_exit_code_3(tmp_path: Path, arguments: tuple[object, ...], miss: str) -> None:
    """A surface that is cut by the border is not watertight; the output is there all the same."""
    source = write_nifti(tmp_path / "ball.nii", ball(6))
    result = run(source, "-i", 50, "-o", tmp_path / "open.ply", *arguments, "--report", tmp_path / "run.json")
    assert result.exit_code == 3
    assert record(tmp_path / "run.json")["missed"][0].startswith(miss)
    assert (tmp_path / "open.ply").exists()


def test_a_negative_slope_turns_the_surface_inside_out(tmp_path: Path) -> None:
    """Slope and intercept move the isovalue: the range and the choice are those of the values."""
    source = write_nifti(tmp_path / "ball.nii", ball(dtype="int16"), slope=-2.0, intercept=10.0)
    run(source, "-i", -90, "-o", tmp_path / "ball.ply", "-b", "mc", "--report", tmp_path / "run.json")
    found = record(tmp_path / "run.json")
    assert found["range"][1] == 10 and found["surface"]["volume"] is not None and found["surface"]["volume"] < 0


@pytest.mark.parametrize(
    "arguments",
    [
        ("-i", "nan"),
        ("-i", "p101"),
        ("-i", "1:2"),
        ("-b", "nothing"),
        ("-o", "x.vtk"),
        ("-o", "-"),
        ("-o", "x.ply", "-d", "y"),
        ("-o", "x.ply", "-i", "1", "-i", "2"),
        ("--name", "{nothing}"),
        ("--report", "run.txt"),
        ("--require", "beauty"),
        ("--max-error", "-1"),
        ("--max-error", "1e-"),
        ("--block-size", "3"),
        ("-b", "mc", "--block-size", "4"),
        ("--shape", "1,2"),
        ("--memory-limit", "much"),
        ("-j", "0"),
    ],
)
def test_a_wrong_command_is_refused_before_any_file_is_opened(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
) -> None:
    """Exit code 2 and one line, although the input does not even exist."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["isocore", "convert", "missing.nii", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    assert "Traceback" not in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_bound_on_the_error_has_one_grammar(tmp_path: Path) -> None:
    """What the method takes the command line takes, and the report says it in the user's words."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    arguments = ("-i", 50, "--max-error", "300um", "-o", tmp_path / "b.ply", "--report", tmp_path / "run.json")
    assert run(source, *arguments).exit_code == 0
    found = record(tmp_path / "run.json")
    assert found["options"]["max_error"] == found["error"]["bound"] == "300um" and found["error"]["max_world"] <= 0.3


def test_two_inputs_for_one_output_are_refused(tmp_path: Path) -> None:
    """Before any work."""
    for name in ("a.nii", "a.nii.gz"):
        write_nifti(tmp_path / name, ball())
    result = program("convert", tmp_path, "-d", tmp_path / "out")
    assert result.returncode == 2 and b"tell them apart with --name" in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_surface_goes_to_stdout(tmp_path: Path) -> None:
    """The very bytes of the file; everything else is on stderr."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    program("convert", source, "-i", 50, "-o", tmp_path / "ball.ply")
    piped = program("convert", source, "-i", 50, "-o", "-", "-f", "ply")
    assert piped.returncode == 0 and piped.stdout == (tmp_path / "ball.ply").read_bytes()


def test_json_on_stdout_is_the_report(tmp_path: Path) -> None:
    """And nothing but the report."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    printed = json.loads(program("convert", source, "-i", 50, "-o", tmp_path / "b.ply", "--json").stdout)
    assert printed["schema"] == 1 and printed["totals"]["done"] == 1


def test_a_dry_run_touches_nothing(tmp_path: Path) -> None:
    """It says what would be done and how much memory that may take."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    result = run(source, "-i", 50, "-d", tmp_path / "out", "--dry-run")
    assert result.exit_code == 0 and "MiB" in result.stdout and not (tmp_path / "out").exists()


def test_every_volume_of_a_series_has_its_own_output(tmp_path: Path) -> None:
    """--volume all; without --volume the message says how many there are."""
    series = write_nifti(tmp_path / "series.nii", np.stack([ball(), ball(radius=3)], axis=3))
    assert "--volume" in run(series, "-i", 50, "-d", tmp_path / "out").stderr
    assert run(series, "-i", 50, "-d", tmp_path / "out", "--volume", "all").exit_code == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["series_v0.ply", "series_v1.ply"]


@pytest.mark.parametrize(("space", "signs"), [("ras", (1, 1, 1)), ("lps", (-1, -1, 1)), ("las", (-1, 1, 1))])
def test_a_space_is_a_change_of_signs(tmp_path: Path, space: str, signs: tuple[int, int, int]) -> None:
    """The bounds in another space are the mirrored ones, and the volume stays positive."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    arguments = (source, "-i", 50, "-o", tmp_path / "b.ply", "--report", tmp_path / "run.json")
    run(*arguments)
    native = np.array(record(tmp_path / "run.json")["surface"]["bounds"])
    run(*arguments, "--space", space)
    found = record(tmp_path / "run.json")
    assert np.allclose(found["surface"]["bounds"], np.sort(native * signs, axis=0), atol=1e-5)
    assert found["space"] == space and found["surface"]["volume"] > 0


def test_help_is_quick_because_it_imports_little() -> None:
    """No numpy, no reader and no rich behind --help."""
    code = (
        "import sys; from click.testing import CliRunner; from isocore.cli.main import isocore;"
        "assert CliRunner().invoke(isocore, ['--help']).exit_code == 0;"
        "assert not {'numpy', 'rich', 'nibabel', 'isocore.readers'} & set(sys.modules)"
    )
    assert subprocess.run([sys.executable, "-P", "-c", code], timeout=60, check=False).returncode == 0


def test_an_open_surface_is_warned_about_and_capped_on_request(tmp_path: Path) -> None:
    """The warning names the option."""
    source = write_nifti(tmp_path / "ball.nii", ball(6))
    assert "--cap" in run(source, "-i", 50, "-o", tmp_path / "open.ply").stderr
    result = run(source, "-i", 50, "-o", tmp_path / "closed.ply", "--cap", "--require", "watertight manifold")
    assert result.exit_code == 0 and "--cap" not in result.stderr


def test_the_data_of_a_header_is_no_input_of_its_own(tmp_path: Path) -> None:
    """However the header spells its path."""
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "tooth.raw").write_bytes(ball().tobytes(order="F"))
    header = ["NRRD0004", "type: float", "dimension: 3", "sizes: 12 12 12", "encoding: raw", "endian: little"]
    (tmp_path / "in" / "tooth.nhdr").write_text("\n".join([*header, "data file: ./tooth.raw", ""]))
    result = run(tmp_path / "in", "-d", tmp_path / "out", "-i", 50, "--report", tmp_path / "run.json")
    assert result.exit_code == 0
    assert len(json.loads((tmp_path / "run.json").read_text())["outputs"]) == 1


def test_a_bar_appears_on_a_terminal_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And there only after a second, in colours only where they are wanted."""
    import io

    from isocore.cli import console

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for stream, shown in ((io.StringIO(), False), (Terminal(), True)):
        monkeypatch.setattr(sys, "stderr", stream)
        monkeypatch.setattr(console, "_PATIENCE_SECONDS", 0.01)
        monkeypatch.setenv("TERM", "xterm")
        with console.Progress(2, wanted=True) as progress:
            for _ in range(50):
                time.sleep(0.01)
                progress.at([])
                if progress._bar is not None:
                    break
            progress.step()
            assert (progress._bar is not None) is shown and bool(stream.getvalue()) is shown
