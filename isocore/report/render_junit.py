"""The report as JUnit XML: a test case per output, missed requirements as failures, everything else as errors."""

from __future__ import annotations

import re
from html import escape

from isocore.report.record import BatchReport, RunReport

#: Characters that XML 1.0 cannot hold, not even escaped.
_UNSPEAKABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def render_junit(batch: BatchReport) -> str:
    """One suite; seconds are those of each output."""
    runs = batch.outputs
    counts = {
        "tests": len(runs),
        "failures": sum(bool(run.missed) and run.status != "failed" for run in runs),
        "errors": sum(run.status == "failed" for run in runs),
        "skipped": sum(run.status == "skipped" and not run.missed for run in runs),
        "time": f"{batch.seconds:.3f}",
    }
    attributes = "".join(f" {key}={_quoted(str(value))}" for key, value in counts.items())
    totals = "".join(f" {key}={_quoted(str(value))}" for key, value in counts.items() if key != "skipped")
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f'<testsuites name="isocore"{totals}>']
    lines += [f'  <testsuite name="isocore convert"{attributes}>', *map(_case, runs), "  </testsuite>", "</testsuites>"]
    return "\n".join(lines) + "\n"


def _case(run: RunReport) -> str:
    seconds = run.seconds.get("total", 0.0) if run.status != "skipped" else 0.0
    name = f"name={_quoted(run.output)} classname={_quoted(run.source)} time={_quoted(f'{seconds:.3f}')}"
    inside = []
    if run.status == "failed":
        inside.append(f'<error type="failed" message={_quoted(run.message)}/>')
    elif run.missed:
        inside.append(f'<failure type="missed" message={_quoted("; ".join(run.missed))}/>')
    elif run.status == "skipped":
        inside.append(f"<skipped message={_quoted(run.message)}/>")
    if run.warnings:
        inside.append(f"<system-err>{escape(_clean(chr(10).join(run.warnings)), quote=False)}</system-err>")
    if not inside:
        return f"    <testcase {name}/>"
    return f"    <testcase {name}>" + "".join(inside) + "</testcase>"


def _quoted(text: str) -> str:
    return '"' + escape(_clean(text)).replace("\n", "&#10;") + '"'


def _clean(text: str) -> str:
    return _UNSPEAKABLE.sub("\ufffd", text)
