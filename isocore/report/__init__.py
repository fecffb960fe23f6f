"""Reports: the record of a run, and one renderer per format.

A renderer is a function in its own file and a row here; the suffix of the report's path chooses it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from isocore.errors import InputError, OptionError, reading
from isocore.late import late
from isocore.report.record import MESH_BYTES, BatchReport, RunReport
from isocore.whole_file import whole_file

Renderer = Callable[..., str]

RENDERERS: dict[str, Renderer] = {
    ".json": late("report.render_json", "render_json"),
    ".jsonl": late("report.render_json", "render_jsonl"),
    ".csv": late("report.render_csv", "render_csv"),
    ".html": late("report.render_html", "render_html"),
    ".md": late("report.render_markdown", "render_markdown"),
    ".xml": late("report.render_junit", "render_junit"),
}

#: Formats that share a suffix with another: chosen by the whole name.
NAMED_RENDERERS: dict[str, Renderer] = {"bench.json": late("report.render_benchmark", "render_benchmark")}


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
    is_page = renderer is RENDERERS[".html"]
    text = renderer(batch, mesh_bytes=mesh_bytes, page=path) if is_page else renderer(batch)
    with whole_file(path) as stream:
        stream.write(text.encode())


def load_report(path: Path) -> BatchReport:
    """A JSON report, as save_report wrote it. Raises InputError for anything else."""
    from isocore.report.keys import SCHEMA, batch_from_dict  # late: a run that writes no report needs no keys
    from isocore.report.schema import parsed

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
    "load_report",
    "merged",
    "renderer_for",
    "save_report",
]
