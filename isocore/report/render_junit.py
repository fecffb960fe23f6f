"""The report as JUnit XML: a test case per output, missed requirements as failures, everything else as errors.

An output that is up to date and one that is empty are skipped: nothing about them was tested.
"""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from isocore.report.record import BatchReport, RunReport
from isocore.report.texts import shown

#: Characters that XML 1.0 cannot hold, not even escaped.
_UNSPEAKABLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
#: Inside of a tag: what ElementTree writes, and what this report has held since its first version.
_SPELLINGS = (
    ("<system-err />", "<system-err></system-err>"),
    (" />", "/>"),
    ("'", "&#x27;"),
    ("&#09;", "\t"),
    ("&#13;", "\r"),
)


def render_junit(batch: BatchReport) -> str:
    """One suite; seconds are those of each output."""
    runs = batch.outputs
    totals = {
        "tests": str(len(runs)),
        "failures": str(sum(bool(run.missed) and run.status != "failed" for run in runs)),
        "errors": str(sum(run.status == "failed" for run in runs)),
    }
    skipped = {"skipped": str(sum(_is_skipped(run) for run in runs))}
    time = {"time": f"{batch.seconds:.3f}"}
    suites = Element("testsuites", {"name": "isocore"} | totals | time)
    suite = SubElement(suites, "testsuite", {"name": "isocore convert"} | totals | skipped | time)
    suite.text = "\n  "
    cases = [SubElement(suite, "testcase", _names(run)) for run in runs]
    indent(suites)
    for case, run in zip(cases, runs, strict=True):
        _tell(case, run)
    text = re.sub("<[^>]*>", _respelled, tostring(suites, encoding="unicode"))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _names(run: RunReport) -> dict[str, str]:
    seconds = run.seconds.total if run.seconds is not None and run.status != "skipped" else 0.0
    return {"name": _clean(run.output), "classname": _clean(run.source), "time": f"{seconds:.3f}"}


def _is_skipped(run: RunReport) -> bool:
    return not run.missed and (run.status in ("empty", "skipped"))


def _tell(case: Element, run: RunReport) -> None:
    """What came of the run, on the line of its case."""
    if run.status == "failed":
        SubElement(case, "error", type="failed", message=_clean(run.message))
    elif run.missed:
        SubElement(case, "failure", type="missed", message=_clean("; ".join(run.missed)))
    elif _is_skipped(run):
        SubElement(case, "skipped", message=_clean(run.message))
    if run.warnings:
        SubElement(case, "system-err").text = _clean("\n".join(run.warnings))


def _respelled(tag: re.Match[str]) -> str:
    text = tag[0]
    for theirs, ours in _SPELLINGS:
        text = text.replace(theirs, ours)
    return text


def _clean(text: str) -> str:
    return _UNSPEAKABLE.sub("\ufffd", shown(text))
