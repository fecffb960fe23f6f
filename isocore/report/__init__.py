"""Reports: the record of a run, and one renderer per format.

A renderer is a function in its own file and a row here; the suffix of the report's path chooses it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from isocore.errors import InputError, OptionError, reading
from isocore.report.copies_found import copies_path, save_copies, with_copies
from isocore.report.keys import SCHEMA, batch_as_dict, batch_from_dict, run_as_dict, run_from_dict
from isocore.report.record import BatchReport, RunReport
from isocore.report.render_benchmark import render_benchmark
from isocore.report.render_csv import render_csv
from isocore.report.render_github import github_annotations
from isocore.report.render_html import MESH_BYTES, render_html
from isocore.report.render_json import render_json, render_jsonl
from isocore.report.render_junit import render_junit
from isocore.report.render_markdown import render_markdown
from isocore.report.schema import parsed
from isocore.whole_file import whole_file

Renderer = Callable[[BatchReport], str]

RENDERERS: dict[str, Renderer] = {
    ".json": render_json,
    ".jsonl": render_jsonl,
    ".csv": render_csv,
    ".html": render_html,
    ".md": render_markdown,
    ".xml": render_junit,
}

#: Formats that share a suffix with another: chosen by the whole name.
NAMED_RENDERERS: dict[str, Renderer] = {"bench.json": render_benchmark}


def renderer_for(path: Path) -> Renderer:
    """The renderer of this path's suffix. Raises OptionError for any other."""
    renderer = NAMED_RENDERERS.get(path.name.lower()) or RENDERERS.get(path.suffix.lower())
    if renderer is None:
        raise OptionError(f"{path}: no such report format; choose one of {' '.join(RENDERERS)}")
    return renderer


def save_report(batch: BatchReport, path: Path, *, mesh_bytes: int = MESH_BYTES) -> None:
    """Write the report whole or not at all.

    mesh_bytes bounds the copies of the surfaces in a page, which are made from the meshes where a run has none.
    """
    renderer = renderer_for(path)
    text = render_html(batch, mesh_bytes=mesh_bytes, page=path) if renderer is render_html else renderer(batch)
    with whole_file(path) as stream:
        stream.write(text.encode())


def load_report(path: Path) -> BatchReport:
    """A JSON report, as save_report wrote it. Raises InputError for anything else."""
    with reading(path):
        data = path.read_bytes()
        try:
            record = parsed(data)
            if not isinstance(record, dict) or record.get("schema") is True or record.get("schema") != SCHEMA:
                raise InputError(f"is not a report of schema {SCHEMA}")
            return batch_from_dict(record)
        except InputError as error:
            raise InputError(f"{path}: {error}; name a .json report as isocore wrote it") from error


def merged(batches: list[BatchReport]) -> BatchReport:
    """Several reports as one; of two runs with the same output the later one stays."""
    if len(batches) == 1:
        return batches[0]
    runs = {(run.output, run.source, run.asked.asked): run for batch in batches for run in batch.outputs}
    first = batches[0]
    folder = first.folder if all(batch.folder == first.folder for batch in batches) else ""
    seconds = sum(batch.seconds for batch in batches)
    return BatchReport(tuple(runs.values()), first.arguments, seconds, first.tool, first.host, folder)


__all__ = [
    "MESH_BYTES",
    "RENDERERS",
    "BatchReport",
    "RunReport",
    "batch_as_dict",
    "batch_from_dict",
    "copies_path",
    "github_annotations",
    "load_report",
    "merged",
    "render_json",
    "renderer_for",
    "run_as_dict",
    "run_from_dict",
    "save_copies",
    "save_report",
    "with_copies",
]
