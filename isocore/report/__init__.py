"""Reports: the record of a run, and one renderer per format.

A renderer is a function in its own file and a row here; the suffix of the report's path chooses it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from isocore.errors import OptionError
from isocore.report.record import (
    BatchReport,
    RunReport,
    batch_as_dict,
    batch_from_dict,
    run_as_dict,
    run_from_dict,
)
from isocore.report.render_csv import render_csv
from isocore.report.render_json import render_json, render_jsonl
from isocore.report.render_markdown import render_markdown
from isocore.whole_file import whole_file

Renderer = Callable[[BatchReport], str]

RENDERERS: dict[str, Renderer] = {
    ".json": render_json,
    ".jsonl": render_jsonl,
    ".csv": render_csv,
    ".md": render_markdown,
}


def renderer_for(path: Path) -> Renderer:
    """The renderer of this path's suffix. Raises OptionError for any other."""
    renderer = RENDERERS.get(path.suffix.lower())
    if renderer is None:
        raise OptionError(f"{path}: no such report format; choose one of {' '.join(RENDERERS)}")
    return renderer


def save_report(batch: BatchReport, path: Path) -> None:
    """Write the report whole or not at all."""
    text = renderer_for(path)(batch)
    with whole_file(path) as stream:
        stream.write(text.encode())


__all__ = [
    "RENDERERS",
    "BatchReport",
    "RunReport",
    "batch_as_dict",
    "batch_from_dict",
    "render_json",
    "renderer_for",
    "run_as_dict",
    "run_from_dict",
    "save_report",
]
