"""The report as JSON, and as one JSON record per line."""

from __future__ import annotations

import json

from isocore.report.record import BatchReport, batch_as_dict, run_as_dict


def render_json(batch: BatchReport) -> str:
    """The whole report."""
    return json.dumps(batch_as_dict(batch), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def render_jsonl(batch: BatchReport) -> str:
    """One output per line."""
    records = (json.dumps(run_as_dict(run), ensure_ascii=False, allow_nan=False) for run in batch.outputs)
    return "".join(record + "\n" for record in records)
