"""The report as JSON, and as one JSON record per line. A record takes one line in both, so that they can be compared.

A record's line is kept: a report is written again after every input, and would otherwise cost the square of them.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

from isocore.report.keys import batch_as_dict, run_as_dict
from isocore.report.record import BatchReport, RunReport
from isocore.report.texts import json_text

_LINES: WeakKeyDictionary[RunReport, str] = WeakKeyDictionary()


def render_json(batch: BatchReport) -> str:
    """The whole report."""
    keys = []
    for key, value in batch_as_dict(batch, outputs=False).items():
        text = json_text(value)
        if key == "outputs":
            lines = ",\n    ".join(_line(run) for run in batch.outputs)
            text = f"[\n    {lines}\n  ]" if lines else "[]"
        keys.append(f'  "{key}": {text}')
    return "{\n" + ",\n".join(keys) + "\n}\n"


def render_jsonl(batch: BatchReport) -> str:
    """One output per line."""
    return "".join(_line(run) + "\n" for run in batch.outputs)


def _line(run: RunReport) -> str:
    line = _LINES.get(run)
    if line is None:
        line = _LINES[run] = json_text(run_as_dict(run))
    return line
