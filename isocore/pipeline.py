"""One job, from its source to its outputs: the only place that calls both a reader and a writer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from isocore.asked import asked_of
from isocore.backends import BACKENDS, REFERENCE, Extract, Field, Outlook, backend_for, prepare
from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError, InputError, IsocoreError, about
from isocore.extraction import Findings
from isocore.field_facts import FieldFacts
from isocore.histogram import histogram
from isocore.isovalue import choose
from isocore.job import Job, Options, Target
from isocore.labels import Label
from isocore.measurements import measure
from isocore.memory import forget_peak, peak_bytes
from isocore.offset import moved_field, moved_surface, offset_of
from isocore.outputs import (
    Sink,
    carried_facts,
    check_colours,
    check_pictures,
    format_warnings,
    page_copy,
    write_ambiguities,
)
from isocore.pieces import check_unit, keep_pieces
from isocore.readers import files_of, read
from isocore.remarks import border, emptiness
from isocore.report.record import RunReport
from isocore.report.sections import Ratio, Reference, Seconds
from isocore.requirements import missed
from isocore.rounded_error import remeasured
from isocore.segmentation import isovalue_warnings, label_count
from isocore.timer import Timer
from isocore.volume import Volume
from isocore.writers.rounding import as_read, rounded


def convert(job: Job) -> Iterator[RunReport]:
    """Read and prepare once, then extract, measure and write each target; one report per target, failed ones too."""
    sink = Sink(job)
    runs = _converted(job, sink)
    if not job.together:
        yield from runs
        return
    waiting = list(runs)
    timer = Timer()
    try:
        with timer("write"):
            written, colors = sink.finish()
    except (IsocoreError, MemoryError, ValueError) as error:
        for target in job.targets:
            yield failed(job, target, error)
    else:
        for run in waiting:
            yield run if run.status == "failed" else replace(run, written=written, colors=colors)


def _converted(job: Job, sink: Sink) -> Iterator[RunReport]:
    """The reports of all targets; sink: takes their surfaces."""
    forget_peak()
    timer, threads = Timer(), job.options.threads
    done = 0
    try:
        with timer("read"):
            source = _read(job, timer)
            spread = histogram(source, threads=threads)
            offset = offset_of(source, job.offset)
            source = moved_field(source if job.holds_fields else replace(source, carried=()), offset)
            check_colours(source, job)
        check_unit(job.options, source.unit)
        known = FieldFacts.of(source, spread)
        check_pictures(job, known.space)
        labels = label_count(source, spread)
        outlook = _outlook(job, source)
        backend, why = backend_for(job, type(source), outlook)
        with timer("prepare"):
            extract = prepare(source, backend, replace(job.options, normals=job.normals, angles=True), outlook)
        reference = _ReferenceRuns(source, backend, job)
        for target in job.targets:
            try:
                with timer("prepare"):
                    chosen = choose(target.choice, spread)
                with timer("extract"):
                    found = extract(chosen.isovalue)
                timer.move(found.seconds_normals, "extract", "normals")
                timer.move(found.seconds_degrees, "extract", "measure")
                with timer("measure"):
                    kept = keep_pieces(moved_surface(found.surface, source, offset), job.options)
                    surface, losses = rounded(kept.surface, job.format, threads)
                    form = as_read(surface, job.format, threads)
                    measured = measure(form, threads, self_intersections=job.counts_intersections)
                    findings = replace(found.findings, pieces=kept.facts)
                    if surface is not kept.surface:
                        whole = surface if kept.is_whole else rounded(kept.whole, job.format, threads)[0]
                        findings = remeasured(findings, source, chosen.isovalue, whole, job.options)
                        del whole
                with timer("write"):
                    written, colors = sink.write(surface, target, chosen.isovalue)
                    write_ambiguities(source, chosen.isovalue, job, offset)
            except (IsocoreError, MemoryError) as error:
                yield failed(job, target, error, seconds=timer.taken())
            else:
                run = RunReport(
                    asked=asked_of(job, target),
                    status="done" if measured.triangles else "empty",
                    message="" if measured.triangles else kept.message or emptiness(chosen, spread, findings.label),
                    warnings=source.warnings
                    + known.warnings
                    + chosen.warnings
                    + isovalue_warnings(chosen, spread, labels)
                    + found.warnings
                    + format_warnings(job)
                    + kept.warnings
                    + border(measured, known)
                    + losses,
                    written=written,
                    field=known,
                    isovalue=None if isinstance(target.choice, Label) else chosen.isovalue,
                    chosen=chosen.why,
                    offset=offset,
                    backend=backend,
                    backend_chosen=why,
                    surface=measured,
                    carried=carried_facts(surface, source),
                    colors=colors,
                    findings=_named(findings, target),
                    seconds=timer.taken(),
                    peak_rss_bytes=peak_bytes(),
                    copy=page_copy(surface, target, job),
                )
                del found, kept, surface, form
                yield requirements_checked(reference.compared(run), job)
            done += 1
    except (IsocoreError, MemoryError) as error:
        for target in job.targets[done:]:
            yield failed(job, target, error, seconds=timer.taken())


def failed(job: Job, target: Target, error: BaseException, *, seconds: Seconds | None = None) -> RunReport:
    """The record of a target that came to nothing; its message starts with a path."""
    text = "does not fit into memory; free some or crop the data" if isinstance(error, MemoryError) else str(error)
    return RunReport(
        asked=asked_of(job, target),
        status="failed",
        message=about(job.source, text, target.output),
        backend=job.backend,
        seconds=seconds,
        peak_rss_bytes=peak_bytes(),
    )


def requirements_checked(run: RunReport, job: Job) -> RunReport:
    """The run with what the job requires and its surface misses."""
    return run if run.surface is None else replace(run, missed=missed(run.surface, job.require, job.max_triangles))


def _read(job: Job, timer: Timer) -> Field:
    if job.refusal:
        raise InputError(job.refusal)
    known = None if job.read_ahead is None else job.read_ahead.take()
    if job.read_ahead is not None and known is not None:
        timer.add(job.read_ahead.seconds, "read")
    source = read(job.source, job.read_options) if known is None else known
    if isinstance(source, Volume):
        return job.place(source)
    if job.space != "native":
        raise FieldError(f"a mesh does not say which space it is in, so not {job.space} either; use --space native")
    return source


def _named(findings: Findings, target: Target) -> Findings:
    """What is said of a label, with the name and the colour that the label was chosen with."""
    choice = target.choice
    if findings.label is None or not isinstance(choice, Label):
        return findings
    color = None if choice.colour is None else "#" + bytes(choice.colour).hex()
    return replace(findings, label=replace(findings.label, name=choice.name, color=color))


def _outlook(job: Job, source: Field) -> Outlook:
    asked = Outlook(isovalues=len(job.targets), named=job.backend is not None)
    if not isinstance(source, CellMesh):
        return asked
    from isocore.methods.index_file import index_path  # late: only a mesh has an index

    step = files_of(job.source, job.read_options.step)[1:] if job.read_options.step is not None else ()
    index = index_path(step[0] if len(step) == 1 else job.source)
    try:
        found = index if index.is_file() else None
    except OSError:  # the source's name leaves no room for a longer one
        found = None
    return replace(asked, index=found, cells=source.cells)


class _ReferenceRuns:
    """Marching cubes on the same field, prepared at the first target that needs it."""

    def __init__(self, source: Field, backend: str, job: Job) -> None:
        self._source, self._backend = source, backend
        self._options = Options(threads=job.options.threads, cap=job.options.cap)
        self._wanted = job.reference and isinstance(source, BACKENDS[REFERENCE].accepts)
        self._extract: Extract | None = None

    def compared(self, run: RunReport) -> RunReport:
        """The run beside the reference; where it is the reference itself nothing is extracted again."""
        if not self._wanted or run.isovalue is None or run.surface is None or run.seconds is None:
            return run
        own_seconds = run.seconds.prepare + run.seconds.extract
        own_triangles, own_vertices = run.surface.triangles, run.surface.vertices
        if (pieces := run.findings.pieces) is not None:  # the reference has all pieces
            own_triangles += pieces.triangles_dropped
            own_vertices += pieces.vertices_dropped
        if self._backend == REFERENCE and run.findings.simplification is None:
            triangles, vertices, seconds = own_triangles, own_vertices, own_seconds
        else:
            triangles, vertices, seconds = self._extracted(run.isovalue)
        return replace(
            run,
            reference=Reference(name=REFERENCE, triangles=triangles, vertices=vertices, seconds=seconds),
            ratio=Ratio(
                triangles=triangles / own_triangles if own_triangles else None,
                seconds=own_seconds / seconds if seconds else None,
            ),
        )

    def _extracted(self, isovalue: float) -> tuple[int, int, float]:
        """Triangles, vertices, and the seconds they took; those of the first call include the preparation."""
        timer = Timer()
        if self._extract is None:
            with timer("prepare"):
                self._extract = prepare(self._source, REFERENCE, self._options)
        with timer("extract"):
            surface = self._extract(isovalue).surface
        return len(surface.triangles), len(surface.vertices), timer.taken().total
