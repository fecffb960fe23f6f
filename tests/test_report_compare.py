"""Two reports side by side: which outputs belong together, and gates that do not pass by mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from isocore.errors import OptionError
from isocore.report import BatchReport, RunReport, save_report
from isocore.report.compare import HEADINGS, compared, comparison_rows, faults
from isocore.report.keys import run_from_dict
from isocore.report.limits import check_limits, parse_limit, value_of

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "report"]


def run_of(name: str = "a", **changes: Any) -> RunReport:
    """A run by the keys of its record; what is not named is null."""
    known: dict[str, Any] = {
        "source": f"in/{name}.nii",
        "output": f"out/{name}.ply",
        "status": "done",
        "asked": "50",
        "isovalue": 50.0,
        "backend": "asc",
        "surface": {"triangles": 100, "vertices": 52, "watertight": True, "volume": 8.0, "euler": -10},
        "seconds": {"prepare": 0.1, "extract": 0.9, "total": 1.5},
        "facts": {"odd": 0},
    }
    return run_from_dict(known | changes)


def failed(name: str = "a") -> RunReport:
    return run_from_dict(
        {"source": f"in/{name}.nii", "output": f"out/{name}.ply", "asked": "50", "status": "failed"}
        | {"message": f"in/{name}.nii: broke"}
    )


def empty(name: str = "a") -> RunReport:
    return run_of(name, status="empty", surface={"triangles": 0, "vertices": 0, "watertight": None})


def batch(*runs: RunReport) -> BatchReport:
    return BatchReport(runs)


def broken(old: BatchReport, new: BatchReport, *limits: str) -> list[str]:
    parsed = [parse_limit(limit) for limit in limits]
    check_limits(parsed, old, new)
    return faults(compared(old, new), parsed)


def called(folder: Path, old: BatchReport, new: BatchReport, *arguments: str) -> subprocess.CompletedProcess[str]:
    """`isocore report --compare` of these two, as a process."""
    save_report(old, folder / "old.json")
    save_report(new, folder / "new.json")
    command = [*PROGRAM, "--compare", "old.json", "new.json", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize(
    ("limit", "wrong"),
    [
        ("triangles>+2%", True),
        ("triangles > 2 %", True),
        ("triangles>+20%", False),
        ("triangles<-2%", False),
        ("triangles<+20%", True),
        ("seconds>+20%", False),
        ("seconds>1.4", True),
        ("seconds.prepare>.2", False),
        ("triangles>105", True),
        ("triangles>1.05E2", True),
        ("surface.vertices<52", False),
        ("surface.watertight<1", False),
        ("surface.euler>+2%", False),
        ("surface.euler<-2%", False),
        ("facts.odd>+2%", False),
        ("facts.odd>-2%", False),
    ],
)
def test_a_limit_breaks_where_it_should(limit: str, wrong: bool) -> None:
    """Ten per cent more triangles in the same time; of what is below zero or zero a share counts from there."""
    new = run_of(surface={"triangles": 110, "vertices": 57, "watertight": True, "euler": -10})
    assert bool(broken(batch(run_of()), batch(new), limit)) is wrong


@pytest.mark.parametrize(
    "text",
    [
        *("", "triangles", "triangles>", "triangles=3", "triangles>=3", "triangles>+2 percent", "triangles>1,000"),
        *("triangles>nan", "triangles>+inf%", ">3", "triangles>3%%", "triangles>\u0663", "a b>3", "triangles>0x10"),
    ],
)
def test_nonsense_is_no_limit(text: str) -> None:
    """Rather than never breaking."""
    with pytest.raises(OptionError, match="is no limit; write one as"):
        parse_limit(text)


def test_a_limit_beyond_all_numbers_is_refused() -> None:
    """It could never be broken."""
    with pytest.raises(OptionError, match="could never be broken"):
        parse_limit("triangles>1e400")


@pytest.mark.parametrize(
    ("limit", "nearest"),
    [
        ("triangels>+2%", "triangles"),
        ("Triangles>+2%", "triangles"),
        ("surface.triangle>5", "surface.triangles"),
        ("surface.water-tight<1", "surface.watertight"),
        ("volume<-2%", "surface.volume"),
        ("second.total>3", "seconds.total"),
        ("status>3", "seconds"),
        ("source>3", "seconds"),
        ("surface>3", "surface.euler"),
    ],
)
def test_a_key_that_no_record_has_is_refused_with_the_nearest(tmp_path: Path, limit: str, nearest: str) -> None:
    """Exit code 2 and no table: texts and whole sections are no numbers either."""
    result = called(tmp_path, batch(run_of()), batch(run_of()), "--fail-if", limit)
    assert result.returncode == 2 and result.stdout == "" and len(result.stderr.splitlines()) == 1
    assert f"--fail-if {limit}: no record has a number {limit.split('>')[0].split('<')[0]}; " in result.stderr
    assert nearest in result.stderr


def test_a_key_that_one_record_has_will_do(tmp_path: Path) -> None:
    """A batch of volumes and meshes has keys that only some records fill."""
    old = batch(run_of(), run_of("m", error={"max": 0.4}))
    assert called(tmp_path, old, old, "--fail-if", "error.max>0.5").returncode == 0
    assert called(tmp_path, old, old, "--fail-if", "error.max>0.3").returncode == 3


def test_outputs_that_are_gone_are_listed_and_miss_a_gate(tmp_path: Path) -> None:
    """Without a gate they are listed only; one that had failed has lost nothing."""
    old, new = batch(run_of("a"), run_of("b"), failed("c")), batch(run_of("a"), run_of("d"))
    told = called(tmp_path, old, new)
    assert told.returncode == 0 and told.stderr == ""
    rows = {line.split()[0]: line.split()[-1] for line in told.stdout.splitlines()[1:]}
    assert rows == {"a.ply": "done", "d.ply": "new", "b.ply": "gone", "c.ply": "gone"}
    gated = called(tmp_path, old, new, "--fail-if", "triangles>+2%")
    assert gated.returncode == 3 and gated.stderr == "isocore: b.ply at 50: is gone, was done\n"


@pytest.mark.parametrize("limit", ["triangles>+2%", "triangles>1000000"])
@pytest.mark.parametrize("old", [batch(run_of("b")), batch()], ids=["other", "empty"])
@pytest.mark.parametrize("new", [batch(run_of("a")), batch()], ids=["some", "none"])
def test_reports_that_share_nothing_pass_no_gate(
    tmp_path: Path, limit: str, old: BatchReport, new: BatchReport
) -> None:
    """Nothing was compared; without a gate that is a warning."""
    told = called(tmp_path, old, new)
    assert told.returncode == 0 and told.stderr.startswith("isocore: warning: the reports share no output")
    gated = called(tmp_path, old, new, "--fail-if", limit)
    assert gated.returncode == 3 and "isocore: the reports share no output, so nothing was compared\n" in gated.stderr


def test_what_fails_now_and_did_not_then_needs_no_gate(tmp_path: Path) -> None:
    """Also an input that is new; what failed before is no news, with a gate or without."""
    assert called(tmp_path, batch(run_of()), batch(failed())).returncode == 3
    assert called(tmp_path, batch(run_of()), batch(run_of(), failed("b"))).returncode == 3
    old, new = batch(run_of("b"), failed()), batch(run_of("b"), failed())
    assert called(tmp_path, old, new).returncode == 0
    assert called(tmp_path, old, new, "--fail-if", "triangles>+2%").returncode == 0
    assert called(tmp_path, old, batch(run_of("b"), run_of()), "--fail-if", "triangles>+2%").returncode == 0


def test_a_surface_that_became_empty_misses_a_gate() -> None:
    """Though it has no more triangles than before."""
    assert broken(batch(run_of()), batch(empty()), "triangles>+2%") == ["a.ply at 50: is empty, had 100 triangles"]
    assert broken(batch(empty()), batch(empty()), "triangles>+2%") == []
    assert broken(batch(empty()), batch(run_of()), "triangles>+2%") == [
        "a.ply at 50: triangles is 100, was 0 (triangles>+2%)"
    ]


def test_a_number_that_is_not_known_any_more_breaks_its_limit() -> None:
    """A volume that leaks has none, so `<-1%` could not see it; NaN is null in a report."""
    leaking = run_of(surface={"triangles": 100, "watertight": False, "volume": None})
    assert broken(batch(run_of()), batch(leaking), "surface.volume<-1%") == [
        "a.ply at 50: surface.volume is not known, was 8 (surface.volume<-1%)"
    ]
    assert broken(batch(leaking), batch(run_of()), "triangles>+1%") == []


def test_a_limit_that_nothing_could_be_held_against_is_broken() -> None:
    """The key is known in one report, but in no output of both."""
    old, new = batch(run_of()), batch(run_of(), run_of("b", error={"max": 0.2}))
    assert broken(old, new, "error.max>+5%") == [
        "error.max>+5%: no output has error.max in both reports, so nothing was held against it"
    ]
    assert broken(old, new, "error.max>0.3") == []


def pairs(old: BatchReport, new: BatchReport) -> list[tuple[str, str]]:
    found = compared(old, new)
    return [("" if before is None else f"{before.source} {before.output}", run.source) for before, run in found.pairs]


def test_inputs_of_one_name_are_told_apart_by_their_folders() -> None:
    """Also where the whole tree has moved, and in another order."""
    old = batch(*(run_of(source=f"/old/{s}/T1.nii.gz", output=f"o/{s}.ply") for s in ("s1", "s2", "s3")))
    new = batch(*(run_of(source=f"/new/{s}/T1.nii.gz", output=f"n/{s}.ply") for s in ("s3", "s1", "s4")))
    assert pairs(old, new) == [
        ("/old/s3/T1.nii.gz o/s3.ply", "/new/s3/T1.nii.gz"),
        ("/old/s1/T1.nii.gz o/s1.ply", "/new/s1/T1.nii.gz"),
        ("", "/new/s4/T1.nii.gz"),
    ]
    assert [run.source for run in compared(old, new).gone] == ["/old/s2/T1.nii.gz"]
    assert pairs(batch(run_of(source="x/T1.nii")), batch(run_of(source="y/T1.nii")))[0][0] == "x/T1.nii out/a.ply"
    two = [run_of(source=f"{s}/T1.nii", output=f"{s}/T1.ply") for s in "abcd"]
    assert [before for before, _ in pairs(batch(*two[:2]), batch(*two[2:]))] == ["", ""]


def test_two_outputs_of_one_input_are_not_mixed_up() -> None:
    """One isovalue in two formats, by two backends, or twice the very same."""
    stl = {"format": "stl", "threads": 1, "cap": False, "normals": False, "space": "native"}
    old = batch(run_of(options=stl | {"format": "ply"}), run_of(output="out/a.stl", options=stl))
    new = batch(run_of(output="new/a.stl", options=stl), run_of(output="new/b.ply", options=stl | {"format": "ply"}))
    assert [before for before, _ in pairs(old, new)] == ["in/a.nii out/a.stl", "in/a.nii out/a.ply"]
    both = batch(run_of(output="x.ply"), run_of(output="y.ply", backend="mc"))
    turned = batch(run_of(output="u.ply", backend="mc"), run_of(output="v.ply"))
    assert [before for before, _ in pairs(both, turned)] == ["in/a.nii y.ply", "in/a.nii x.ply"]
    twice, once = batch(run_of(seconds={"total": 9}), run_of()), batch(run_of())
    for one, other in ((twice, twice), (twice, once), (once, twice)):
        found = compared(one, other)
        assert found.gone == () and len(found.pairs) == 1 and broken(one, other, "seconds>+1%") == []


def test_a_comparison_names_every_output_once() -> None:
    """Rows in the order of the later report, what is gone at the end; nothing is divided by zero."""
    rows = comparison_rows(compared(batch(run_of("a"), empty("b"), run_of("c")), batch(run_of("b"), run_of("a"))))
    assert [row[0] for row in rows] == ["b.ply", "a.ply", "c.ply"] and {len(row) for row in rows} == {len(HEADINGS)}
    assert rows[0][2:5] == ("100", "0", "") and rows[1][4] == "+0.0%" and rows[2][2:5] == ("", "100", "")


def test_seconds_of_a_limit_are_those_of_the_table() -> None:
    """seconds.total, for the whole output."""
    assert value_of(run_of(), "seconds") == 1.5 == value_of(run_of(), "seconds.total")


@pytest.mark.parametrize("arguments", [["--to", "x.html"], ["--to", "x.json", "--fail-if", "triangles>1"]])
def test_a_comparison_writes_no_file(tmp_path: Path, arguments: list[str]) -> None:
    """Rather than leaving --to out without a word."""
    result = called(tmp_path, batch(run_of()), batch(run_of()), *arguments)
    assert result.returncode == 2 and "--to" in result.stderr and not list(tmp_path.glob("x.*"))


def test_a_report_compared_with_itself_passes(tmp_path: Path) -> None:
    """And one report alone is not enough."""
    same = batch(run_of(), empty("b"), failed("c"))
    assert called(tmp_path, same, same, "--fail-if", "seconds>+1%", "--fail-if", "triangles>+0%").returncode == 0
    command = [*PROGRAM, "--compare", "old.json"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 2
    assert json.loads((tmp_path / "old.json").read_text())["totals"]["outputs"] == 3
