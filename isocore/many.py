"""What Python programs call for a batch of files: as `isocore convert`, with the options as arguments."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal, SupportsFloat, TypeAlias

from isocore.api import Isovalue, Topology, arguments_named, at_least_one, choices_of, options_of
from isocore.backends import check_options
from isocore.batches.naming import check_picture_template
from isocore.batches.plan import Naming, check_template, find_inputs, plan
from isocore.batches.run import Batch, run_jobs
from isocore.choices import Auto, Format, distinct
from isocore.colormaps import parse_colormap
from isocore.copies import triangles_each
from isocore.errors import OptionError
from isocore.job import Job, Options
from isocore.labels import parse_labels
from isocore.memory import free_bytes, processors
from isocore.pictures import check_installed
from isocore.readers.options import ReadOptions
from isocore.report import MESH_BYTES, BatchReport, RunReport, renderer_for, save_report
from isocore.report.record import working_folder
from isocore.views import Still, parse_views
from isocore.volume import Space

if TYPE_CHECKING:
    from isocore.batches.label_targets import LabelRequest

Name: TypeAlias = os.PathLike[str] | str


def convert_files(
    inputs: Name | Iterable[Name],
    output_dir: Name | None = None,
    *,
    isovalues: Isovalue | Iterable[Isovalue] = "auto",
    labels: str | None = None,
    background: int = 0,
    format: Format = "ply",
    name: str | None = None,
    picture: str | None = None,
    view: str = "corner",
    backend: str | None = None,
    space: Space = "native",
    volume: int | Literal["all"] | None = None,
    max_error: float | str | None = None,
    simplify: bool | None = None,
    triangles: int | None = None,
    block_size: int | None = None,
    topology: Topology | None = None,
    smooth: int | None = None,
    keep_largest: int | None = None,
    min_piece: int | str | None = None,
    fill_bubbles: bool = False,
    cap: bool = False,
    normals: bool | None = None,
    threads: int | None = None,
    options: Options | None = None,
    read_options: ReadOptions | None = None,
    reference: bool = True,
    require: Sequence[str] = (),
    if_changed: bool = False,
    jobs: int = 1,
    timeout: float | None = None,
    reports: Name | Iterable[Name] = (),
    done: Callable[[RunReport], object] | None = None,
    carry: Name | Iterable[Name] = (),
    colormap: str | None = None,
    color_by: str | None = None,
    color_range: tuple[float, float] | None = None,
    merge_isovalues: bool = False,
    compress: bool = False,
) -> BatchReport:
    """Convert files, and all that folders hold, as `isocore convert` does: what happens to one stops no others.

    What is not said here means what the command line's option of this name means.

    inputs: a file, a folder, or several. output_dir: where surfaces go; None is beside each input.
    isovalues: one or several, as in `extract`; "100:400:4" are four. labels: "all" or a list as "1,5-9", for one
        surface per label of label maps, in which background is none.
    max_error to threads, options: as in `extract`; normals: None is yes where the format has them; threads: None
        shares the processors among the inputs at once.
    read_options: what files do not tell themselves; volume: which of a 4-D input, or "all".
    jobs: inputs at once, each in a process of its own; timeout: seconds for each.
    picture: a template as name, with its suffix .png, for a still of each surface, seen from view.
    reports: files to write the report to, each in the format of its suffix.
    carry: other fields by name, "all" of them, or files of volumes on the same grid, for the vertices of each surface;
        colormap, color_by, color_range: how these colour GLB and PLY.
    merge_isovalues: one file of all isovalues of an input. compress: pack the arrays of VTP.
    done: called with the report of each output as soon as it is known.

    Returns the report of each output in the order of the inputs: what failed has the status "failed" and a message.
    Raises OptionError before any work for what makes no sense, OutputError where a report cannot be written.
    """
    start = perf_counter()
    saved = [Path(path) for path in _several(reports)]
    with arguments_named():
        at_once = at_least_one("jobs", jobs)
        share = max(1, processors() // at_once) if threads is None else threads
        pattern = Job(
            source=Path(),
            targets=(),
            format=format,
            backend=backend,
            options=options
            or options_of(
                share, cap, normals, block_size, max_error, simplify, triangles, topology, smooth, keep_largest,
                min_piece, fill_bubbles,
            ),
            read_options=_reading(read_options, volume, carry),
            colormap=None if colormap is None else parse_colormap(colormap),
            color_by=color_by,
            color_range=color_range,
            compress=compress,
            space=space,
            reference=reference,
            require=tuple(require),
            if_changed=if_changed,
            still=Still(views=parse_views(view)),
        )
        naming = Naming(output_dir=None if output_dir is None else Path(output_dir), template=name, picture=picture)
        if picture is not None:
            check_picture_template(picture)
            check_installed()
        wanted = None
        if labels is not None:
            from isocore.batches.label_targets import LabelRequest  # late: few batches are about labels

            wanted = LabelRequest(labels=parse_labels(labels), background=background)
        paths = [Path(one) for one in _several(inputs)]
        planned = _planned(paths, isovalues, pattern, naming, volume, wanted, merge_isovalues, saved)
        for path in saved:
            renderer_for(path)
    if any(path.suffix.lower() == ".html" for path in saved):
        most = triangles_each(MESH_BYTES, sum(len(job.targets) for job in planned))
        planned = [replace(job, page_triangles=most) for job in planned]
    workers = 0 if len(planned) == 1 and timeout is None else min(at_once, len(planned))
    batch = Batch(workers=workers, seconds_per_job=timeout, memory_bytes=free_bytes())
    result = BatchReport(_run(planned, batch, done), seconds=perf_counter() - start, folder=working_folder())
    for path in saved:
        save_report(result, path)
    return result


def _planned(
    inputs: list[Path],
    isovalues: Isovalue | Iterable[Isovalue],
    pattern: Job,
    naming: Naming,
    volume: int | str | None,
    labels: LabelRequest | None,
    merge: bool,
    reports: list[Path],
) -> list[Job]:
    """Everything that can be refused without opening a file, then the jobs."""
    if not inputs:
        raise OptionError("inputs: names no file; pass a path, or several")
    if pattern.backend is not None:
        check_options(pattern.backend, pattern.options)
    check_template(naming.template or "")
    choices = distinct(choice for one in _several(isovalues) for choice in choices_of(one))
    if labels is not None:
        if choices != (Auto(),) or pattern.backend is not None or pattern.options.cap or merge:
            raise OptionError(
                f"labels {labels.labels}: do not go with isovalues, merge_isovalues, backend or cap; leave those out"
            )
        pattern = replace(pattern, options=replace(pattern.options, background=labels.background))
    written = [("reports", path) for path in reports]
    found = find_inputs(inputs)
    return plan(
        found, choices, pattern, naming, volumes=volume, labels=labels, merge=merge, written=written
    )


def _run(jobs: list[Job], batch: Batch, done: Callable[[RunReport], object] | None) -> tuple[RunReport, ...]:
    """The reports, in the order of the jobs and their targets whatever is ready first."""
    targets = [(job, target) for job in jobs for target in job.targets]
    places = {
        (id(job), str(target.output), str(target.choice)): place for place, (job, target) in enumerate(targets)
    }
    runs: dict[int, RunReport] = {}
    for job, run in run_jobs(jobs, batch):
        runs[places[id(job), run.output, run.asked.asked]] = run
        if done is not None:
            done(run)
    return tuple(run for _, run in sorted(runs.items()))


def _several(given: Any) -> list[Any]:
    """One or several, as a list."""
    one = isinstance(given, (str, os.PathLike, SupportsFloat))
    return [given] if one else list(given)


def _reading(options: ReadOptions | None, volume: int | str | None, carry: Name | Iterable[Name]) -> ReadOptions:
    reading = options or ReadOptions()
    if carried := tuple(os.fspath(one) for one in _several(carry)):
        reading = replace(reading, carry=carried)
    return replace(reading, volume=volume) if isinstance(volume, int) else reading
