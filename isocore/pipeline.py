"""One job, from its source to its outputs: the only place that calls both a reader and a writer."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import Any, BinaryIO, ParamSpec, TypeVar, cast

from isocore import compose
from isocore.ambiguities import find_ambiguities
from isocore.backends import BACKENDS, Extract, Field, Outlook, default_backend, prepare
from isocore.errors import FieldError, IsocoreError, OptionError, writing
from isocore.histogram import histogram
from isocore.isovalue import choose
from isocore.job import STDOUT, Job, Options, Target
from isocore.measurements import measure
from isocore.memory import forget_peak, peak_bytes
from isocore.methods.index_file import index_path
from isocore.readers import read
from isocore.report.record import RunReport
from isocore.surface import Surface
from isocore.volume import Volume
from isocore.whole_file import whole_file
from isocore.writers import writer_for
from isocore.writers.ply import write_ply_points

P = ParamSpec("P")
T = TypeVar("T")

REFERENCE = "mc"
STAGES = ("read", "prepare", "extract", "measure", "write")


class Timer:
    """Seconds per stage. What a job pays once stands in its first record only."""

    def __init__(self) -> None:
        self._seconds = dict.fromkeys(STAGES, 0.0)

    def timed(self, stage: str, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Do the work and add its seconds to the stage."""
        start = perf_counter()
        try:
            return work(*args, **kwargs)
        finally:
            self._seconds[stage] += perf_counter() - start

    def taken(self) -> dict[str, float]:
        """The seconds since the last call, by stage, and their total."""
        seconds, self._seconds = self._seconds, dict.fromkeys(STAGES, 0.0)
        return {**seconds, "total": sum(seconds.values())}


def convert(job: Job) -> Iterator[RunReport]:
    """Read and prepare once, then extract, measure and write each target; one report per target, failed ones too."""
    forget_peak()
    timer = Timer()
    done = 0
    try:
        source = timer.timed("read", _read, job)
        spread = timer.timed("read", histogram, source, threads=job.options.threads)
        backend = job.backend or default_backend(type(source))
        extract = timer.timed("prepare", prepare, source, backend, job.options, _outlook(job))
        reference = _Reference(source, backend, job)
        known = compose.field_parts(source, spread) | {"backend": backend}
        for target in job.targets:
            try:
                chosen = timer.timed("prepare", choose, target.choice, spread)
                found = timer.timed("extract", extract, chosen.isovalue)
                measured = timer.timed("measure", measure, found.surface, threads=job.options.threads)
                written = timer.timed("write", _write, found.surface, target.output, job)
                timer.timed("write", _write_ambiguities, source, chosen.isovalue, job)
            except (IsocoreError, MemoryError) as error:
                yield failed(job, target, error, seconds=timer.taken())
            else:
                parts = known | compose.surface_parts(found, measured, chosen, known)
                parts["warnings"] = known["warnings"] + parts["warnings"] + written.warnings
                run = RunReport(
                    **(_asked(job, target) | parts),
                    sha256=written.hexdigest(),
                    bytes=written.bytes,
                    seconds=timer.taken(),
                    peak_rss_bytes=peak_bytes(),
                )
                del found
                run = reference.compared(run)
                yield replace(run, missed=compose.missed(run, job.require, job.max_triangles))
            done += 1
    except (IsocoreError, MemoryError) as error:
        for target in job.targets[done:]:
            yield failed(job, target, error, seconds=timer.taken())


def _outlook(job: Job) -> Outlook:
    index = index_path(job.source)
    return Outlook(isovalues=len(job.targets), index=index if index.is_file() else None)


def failed(job: Job, target: Target, error: BaseException, *, seconds: dict[str, float]) -> RunReport:
    """The record of a target that came to nothing; its message starts with a path."""
    text = "does not fit into memory; free some or crop the data" if isinstance(error, MemoryError) else str(error)
    paths = (str(job.source), str(target.output))
    message = text if text.startswith(paths) else f"{job.source}: {text}"
    asked = _asked(job, target) | {"backend": job.backend}
    return RunReport(**asked, status="failed", message=message, seconds=seconds, peak_rss_bytes=peak_bytes())


def _asked(job: Job, target: Target) -> dict[str, Any]:
    return {
        "source": str(job.source),
        "output": str(target.output),
        "asked": str(target.choice),
        "volume": job.read_options.volume,
        "options": compose.options_part(job.options, format=job.format, space=job.space),
    }


def _read(job: Job) -> Field:
    source = read(job.source, job.read_options)
    if isinstance(source, Volume):
        return source.in_space(job.space)
    if job.space != "native":
        raise FieldError(f"a mesh does not say which space it is in, so not {job.space} either; use --space native")
    return source


class _Written:
    """A stream that keeps the hash and the length of what passes."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._hash = sha256()
        self.bytes = 0
        self.warnings: tuple[str, ...] = ()

    def write(self, data: Any) -> int:
        """Pass the data on."""
        self._hash.update(data)
        self.bytes += memoryview(data).nbytes
        return self._stream.write(data)

    def hexdigest(self) -> str:
        """The sha256 of everything so far."""
        return self._hash.hexdigest()


def _write(surface: Surface, target: Path, job: Job) -> _Written:
    """Write to the target and hash what is written on its way."""
    writer = writer_for(target, job.format)
    place: AbstractContextManager[BinaryIO | None] = writing("stdout") if target == STDOUT else whole_file(target)
    with place as opened:
        written = _Written(opened or sys.stdout.buffer)
        written.warnings = writer(cast(BinaryIO, written), surface, job.options.threads)
        if target == STDOUT:
            sys.stdout.buffer.flush()
    return written


def _write_ambiguities(source: Field, isovalue: float, job: Job) -> None:
    if job.ambiguities is None:
        return
    if not isinstance(source, Volume):
        raise OptionError(f"--ambiguities {job.ambiguities}: is for volumes only; leave it out")
    found = find_ambiguities(source, isovalue, threads=job.options.threads)
    with whole_file(job.ambiguities) as stream:
        write_ply_points(
            stream, found.points, "saddle_distance", found.distances, space=found.space, unit=found.unit
        )


class _Reference:
    """Marching cubes on the same field, prepared at the first target that needs it."""

    def __init__(self, source: Field, backend: str, job: Job) -> None:
        self._source, self._backend = source, backend
        self._options = Options(threads=job.options.threads, cap=job.options.cap)
        self._wanted = job.reference and isinstance(source, BACKENDS[REFERENCE].accepts)
        self._timer = Timer()
        self._extract: Extract | None = None

    def compared(self, run: RunReport) -> RunReport:
        """The run beside the reference; where it is the reference itself nothing is extracted again."""
        if not self._wanted or run.isovalue is None or run.surface is None:
            return run
        if self._backend == REFERENCE:
            seconds = run.seconds["prepare"] + run.seconds["extract"]
            return compose.with_reference(run, REFERENCE, run.surface["triangles"], run.surface["vertices"], seconds)
        if self._extract is None:
            self._extract = self._timer.timed("prepare", prepare, self._source, REFERENCE, self._options)
        surface = self._timer.timed("extract", self._extract, run.isovalue).surface
        seconds = self._timer.taken()["total"]
        return compose.with_reference(run, REFERENCE, len(surface.triangles), len(surface.vertices), seconds)
