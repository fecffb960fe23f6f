"""The report as the JSON that benchmark-action reads: a list of named numbers, all of them better when smaller."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from isocore.report.record import BatchReport, RunReport
from isocore.report.summary import own_seconds
from isocore.report.texts import json_text


def render_benchmark(batch: BatchReport) -> str:
    """Seconds, triangles and peak memory of every output that was made."""
    entries = [entry for run in batch.outputs for entry in _entries(run)]
    return json_text(entries, indent=2) + "\n"


def _entries(run: RunReport) -> Iterator[dict[str, Any]]:
    if run.status not in ("done", "empty"):
        return
    name = f"{run.source} at {run.asked.asked} ({run.backend})"
    values = (
        ("total", run.seconds and run.seconds.total, "s"),
        ("prepare and extract", own_seconds(run), "s"),
        ("triangles", run.surface and run.surface.triangles, "triangles"),
        ("peak memory", run.peak_rss_bytes, "bytes"),
    )
    for what, value, unit in values:
        if value is not None:
            yield {"name": f"{name}: {what}", "value": value, "unit": unit}
