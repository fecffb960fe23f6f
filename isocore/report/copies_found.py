"""Copies of surfaces for a page that is made later, perhaps elsewhere.

They come out of the file beside the JSON report, else out of the meshes, as long as those hold what the report says.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from hashlib import file_digest
from pathlib import Path

import numpy as np

from isocore.copies import Copy, copied, copy_from_dict, triangles_each
from isocore.report.record import BatchReport, RunReport
from isocore.report.texts import json_text
from isocore.surface import Surface
from isocore.whole_file import whole_file
from isocore.writers.read_back import Mesh, read_mesh

_KIND = "isocore copies"


def copies_path(report: Path) -> Path:
    """Where the copies of a JSON report's surfaces lie: `run.json.copies` beside `run.json`."""
    return report.with_name(f"{report.name}.copies")


def has_copies_beside(report: Path) -> bool:
    """Whether a report is of the format that a page is made from later."""
    return report.suffix.lower() == ".json" and report.name.lower() != "bench.json"


def save_copies(batch: BatchReport, report: Path) -> None:
    """Write the copies beside a JSON report; nothing where there is none. Raises OutputError if the disk refuses."""
    records = [
        {"output": run.output, "asked": run.asked.asked, "sha256": run.written.sha256, "copy": run.copy.as_dict()}
        for run in batch.outputs
        if run.copy is not None and run.written is not None
    ]
    if records:
        with whole_file(copies_path(report)) as stream:
            stream.write(json_text({"kind": _KIND, "copies": records}).encode())


def with_copies(batch: BatchReport, page_bytes: int, report: Path | None = None) -> BatchReport:
    """The batch with a copy of each surface that has none yet and whose copy or file is found.

    report: the JSON file that the batch was loaded from; outputs are looked for from here, from the folder that it
    names, and from its own.
    """
    runs = list(batch.outputs)
    lacking = [n for n, run in enumerate(runs) if run.triangles and run.output != "-" and run.copy is None]
    most = triangles_each(page_bytes, sum(run.triangles > 0 for run in runs))
    if not lacking or not most:
        return batch
    kept = {} if report is None else _kept_copies(report)
    for n in lacking:
        if (found := kept.get(_key(runs[n]))) is not None:
            runs[n] = replace(runs[n], copy=found)
    folders = [Path(), *([Path(batch.folder)] if batch.folder else []), *([report.parent] if report else [])]
    files: dict[str, list[int]] = {}
    for n in lacking:
        files.setdefault(runs[n].output, []).append(n)
    for output, numbers in files.items():
        if any(runs[n].copy is None for n in numbers):
            for n, found in zip(numbers, file_copies(output, [runs[n] for n in numbers], most, folders), strict=True):
                runs[n] = replace(runs[n], copy=runs[n].copy or found)
    return replace(batch, outputs=tuple(runs))


def file_copies(
    output: str, runs: list[RunReport], most: int, folders: Iterable[Path] = (Path(),)
) -> list[Copy | None]:
    """A copy for each of the runs that wrote this file, one behind the other; None where it does not hold them."""
    for folder in folders:
        path = folder / output
        if not _is_as_written(path, runs[0]):
            continue
        mesh = read_mesh(path)
        if mesh is None:
            continue
        if len(runs) == 1 or all(run.triangles == len(mesh[1]) for run in runs):  # or the same surface several times
            return _parts(mesh, runs[:1], most) * len(runs)
        if len(mesh[1]) == sum(run.triangles for run in runs):
            return _parts(mesh, runs, most)
    return [None] * len(runs)


def _parts(mesh: Mesh, runs: list[RunReport], most: int) -> list[Copy | None]:
    vertices, triangles = mesh
    copies: list[Copy | None] = []
    start = 0
    for run in runs:
        part = triangles if len(runs) == 1 else triangles[start : start + run.triangles]
        start += run.triangles
        used, numbers = np.unique(part, return_inverse=True)
        kind = np.float64 if vertices.dtype == np.float64 else np.float32
        surface = Surface(
            vertices[used].astype(kind), numbers.reshape(-1, 3).astype(np.int32), offset=run.offset
        )
        color = run.findings.label and run.findings.label.color
        red_green_blue = None if not color else (int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16))
        copies.append(copied(surface, most, red_green_blue))
    return copies


def _is_as_written(path: Path, run: RunReport) -> bool:
    """Whether the file holds what the run wrote, as far as the run knows."""
    try:
        if not path.is_file():
            return False
        if run.written is None:
            return True
        with path.open("rb") as stream:
            return file_digest(stream, "sha256").hexdigest() == run.written.sha256
    except OSError:
        return False


def _key(run: RunReport) -> tuple[str, str, str]:
    return run.output, run.asked.asked, "" if run.written is None else run.written.sha256


def _kept_copies(report: Path) -> dict[tuple[str, str, str], Copy]:
    """What lies beside a JSON report, by output, isovalue and hash; nothing where that is damaged or another's."""
    try:
        record = json.loads(copies_path(report).read_bytes())
        if record["kind"] != _KIND:
            return {}
        found = {(one["output"], one["asked"], one["sha256"]): copy_from_dict(one["copy"]) for one in record["copies"]}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return {}
    return {key: copy for key, copy in found.items() if copy is not None}
