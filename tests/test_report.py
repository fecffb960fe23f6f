"""The record, and every format it is rendered in."""

from __future__ import annotations

import csv
import io
import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from isocore.errors import InputError
from isocore.report import BatchReport, RunReport, load_report, merged, renderer_for, save_report
from isocore.report.keys import run_as_dict, run_from_dict
from isocore.report.render_github import github_annotations
from isocore.report.render_junit import render_junit

NASTY = 'a "quoted", <b>&amp;</b> | name\x07\n;=cmd'
BROKEN = {"source": f"in/{NASTY}.nii", "output": "out/c.ply", "status": "failed", "message": f"in/{NASTY}: is broken"}
FIELD = {"kind": "volume", "shape": [4, 5, 6], "range": [-1.0, 1.0], "histogram": {"counts": [3, 4]}}


def run_of(**changes: Any) -> RunReport:
    """A run by the keys of its record; what is not named is null."""
    known: dict[str, Any] = {
        "source": "in/a.nii",
        "output": "out/a.ply",
        "status": "done",
        "asked": "50",
        "isovalue": 50.0,
        "surface": {"triangles": 100, "vertices": 52, "watertight": True},
        "seconds": {"prepare": 0.1, "extract": 0.9, "total": 1.5},
    }
    return run_from_dict(known | changes)


@pytest.fixture
def batch() -> BatchReport:
    return BatchReport(
        (
            run_of(),
            run_of(output="out/b.ply", missed=("watertight: 3 open edges",), warnings=("half of it is missing",)),
            run_from_dict(BROKEN),
            run_of(output="out/d.ply", status="skipped", message="up to date"),
            run_of(output="out/e.ply", status="empty", message="no surface", surface={"triangles": 0}, **FIELD),
        ),
        arguments=("convert", "in"),
        seconds=2.5,
    )


def test_a_report_survives_the_round_trip(tmp_path: Path, batch: BatchReport) -> None:
    """JSON that any parser takes, and every record comes back."""
    last = batch.outputs[-1]
    assert last.field is not None
    odd = replace(last, field=replace(last.field, range=(float("nan"), 1.0)))
    batch = replace(batch, outputs=(*batch.outputs[:-1], odd))
    save_report(batch, tmp_path / "run.json")
    assert "NaN" not in (tmp_path / "run.json").read_text()
    again = load_report(tmp_path / "run.json")
    assert [run_as_dict(run) for run in again.outputs] == [run_as_dict(run) for run in batch.outputs]
    assert again.totals == batch.totals


def test_a_report_of_another_version_is_read(tmp_path: Path) -> None:
    """Keys that it lacks are null, keys that only it has are left out: on every level."""
    older = run_of(surface={"triangles": 7})
    newer = run_from_dict(run_as_dict(older) | {"surface": {"triangles": 7, "colour": "red"}, "mood": "good"})
    assert run_as_dict(newer) == run_as_dict(older) and newer.triangles == 7
    assert run_as_dict(older)["surface"]["euler"] is None


def test_csv_has_a_row_per_output_whatever_the_names(batch: BatchReport) -> None:
    """Quotes, commas and line ends within a field."""
    rows = list(csv.DictReader(io.StringIO(renderer_for(Path("x.csv"))(batch), newline="")))
    assert len(rows) == 5 and rows[2]["source"] == f"in/{NASTY}.nii"
    assert rows[0]["surface.triangles"] == "100" and rows[0]["surface.watertight"] == "true"


def test_jsonl_has_a_record_per_line(batch: BatchReport) -> None:
    """And nothing else."""
    lines = renderer_for(Path("x.jsonl"))(batch).splitlines()
    assert [json.loads(line)["output"] for line in lines] == [run.output for run in batch.outputs]


def test_junit_counts_errors_and_failures(batch: BatchReport) -> None:
    """A missed requirement is a failure, a failed run an error, an up-to-date output and an empty one skipped."""
    root = ElementTree.fromstring(renderer_for(Path("x.xml"))(batch))
    (suite,) = root
    counts = {key: suite.get(key) for key in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "5", "failures": "1", "errors": "1", "skipped": "2"}
    cases = suite.findall("testcase")
    assert [child.tag for case in cases for child in case] == ["failure", "system-err", "error", "skipped", "skipped"]
    assert len([case for case in cases if case.get("name") and case.get("classname") and case.get("time")]) == 5


def test_junit_follows_the_common_schema(batch: BatchReport) -> None:
    """The attributes and children that the de-facto schema allows, in its order."""
    allowed = {
        "testsuites": {"name", "tests", "failures", "errors", "time"},
        "testsuite": {"name", "tests", "failures", "errors", "skipped", "time"},
        "testcase": {"name", "classname", "time"},
        "failure": {"type", "message"},
        "error": {"type", "message"},
        "skipped": {"message"},
        "system-err": set(),
    }
    for element in ElementTree.fromstring(renderer_for(Path("x.xml"))(batch)).iter():
        assert set(element.attrib) <= allowed[element.tag]


def test_junit_spells_odd_characters_as_ever() -> None:
    """Quotes, ends of lines, what looks like a tag, and what XML cannot hold; the layout is held too."""
    odd = "a'b\"<&> />\n\t\r&#9;\x00"
    held = "a&#x27;b&quot;&lt;&amp;&gt; /&gt;&#10;\t\r&amp;#9;\ufffd"
    said = "a&#x27;b&quot;&lt;&amp;&gt; /&gt;\\n\\t\\r&amp;#9;\\x00"  # messages are one printable line
    failed = run_of(source="s", output=odd, status="failed", message=odd, warnings=[odd], seconds={"total": 0.5})
    done = run_from_dict({"source": "s", "output": "o", "status": "done", "warnings": [""]})
    assert render_junit(BatchReport((failed, done), seconds=1.0)) == (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<testsuites name="isocore" tests="2" failures="0" errors="1" time="1.000">\n'
        '  <testsuite name="isocore convert" tests="2" failures="0" errors="1" skipped="0" time="1.000">\n'
        f'    <testcase name="{held}" classname="s" time="0.500"><error type="failed" message="{said}"/>'
        "<system-err>a'b\"&lt;&amp;&gt; /&gt;\\n\\t\\r&amp;#9;\\x00</system-err></testcase>\n"
        '    <testcase name="o" classname="s" time="0.000"><system-err></system-err></testcase>\n'
        "  </testsuite>\n"
        "</testsuites>\n"
    )
    assert ">\n  </testsuite>\n</testsuites>\n" in render_junit(BatchReport(()))


def test_markdown_puts_failures_first_and_escapes_names(batch: BatchReport) -> None:
    """A pipe in a file name adds no column."""
    text = renderer_for(Path("x.md"))(replace(batch, outputs=(*batch.outputs, run_of(output="o/\x1b[31m\u202e.ply"))))
    assert "\x1b" not in text and "\u202e" not in text and r"\\x1b\[31m" in text
    table = [line for line in text.splitlines() if line.startswith("|")]
    assert len({len(re.findall(r"(?<!\\)\|", line)) for line in table}) == 1 and len(table) == 8
    assert text.index("**failed**") < text.index("| file")


def test_bench_json_is_a_list_of_named_numbers(batch: BatchReport) -> None:
    """Only of outputs that were made in this run."""
    entries = json.loads(renderer_for(Path("bench.json"))(batch))
    assert {frozenset(entry) for entry in entries} == {frozenset({"name", "value", "unit"})}
    assert not any("failed" in entry["name"] for entry in entries)


def test_github_sees_failures_and_warnings(batch: BatchReport) -> None:
    """One line each, with line ends and colons escaped."""
    lines = github_annotations(batch)
    assert [line.split(" ")[0] for line in lines] == ["::error", "::warning", "::error", "::warning"]
    assert lines[-1] == "::warning file=in/a.nii,title=isocore empty::out/e.ply: no surface"
    assert all("\n" not in line for line in lines)


def test_a_foreign_file_is_no_report(tmp_path: Path) -> None:
    """One line that says so."""
    for text in ("", "[]", '{"schema": 99}', '{"schema": 1}', '{"schema": 1, "outputs": [{}]}'):
        (tmp_path / "x.json").write_text(text)
        with pytest.raises(InputError, match=r"x\.json: "):
            load_report(tmp_path / "x.json")


def test_of_two_runs_of_one_output_the_later_stays(batch: BatchReport) -> None:
    """Merging a resumed run into the first."""
    both = merged([batch, BatchReport((run_of(output="out/b.ply"),), seconds=1.0)])
    assert len(both.outputs) == 5 and not both.outputs[1].missed and both.seconds == 3.5
