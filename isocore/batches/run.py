"""Many jobs: each failure its own rows, and nothing that one job does stops the others."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace

from isocore.batches import stamps
from isocore.batches.leftovers import remove_parts
from isocore.errors import one_line
from isocore.job import STDOUT, Job, Target
from isocore.memory import estimated_bytes
from isocore.pipeline import convert, failed, requirements_checked
from isocore.readers import content_bytes
from isocore.report.record import RunReport


@dataclass(frozen=True, slots=True, kw_only=True)
class Batch:
    """How jobs are run.

    workers: processes at once; 0 runs everything in this one.
    seconds_per_job, memory_bytes: limits of the workers.
    scheduler: address of a dask scheduler that gets the jobs instead.
    """

    workers: int = 0
    seconds_per_job: float | None = None
    memory_bytes: int | None = None
    scheduler: str | None = None
    fail_fast: bool = False


def run_jobs(
    jobs: Sequence[Job], batch: Batch | None = None, *, at: Callable[[list[Job]], None] = lambda jobs: None
) -> Iterator[tuple[Job, RunReport]]:
    """Convert all jobs; records come as they are done. `at` is told what is being worked on."""
    batch = batch or Batch()
    outputs = [target.output for job in jobs for target in job.targets if target.output != STDOUT]
    remove_parts([*outputs, *map(stamps.stamp_path, outputs)])
    runs = _runs(jobs, batch, at)
    with closing(runs):
        for job, run in runs:
            yield job, run
            if batch.fail_fast and run.status == "failed":
                return


def _runs(
    jobs: Sequence[Job], batch: Batch, at: Callable[[list[Job]], None]
) -> Generator[tuple[Job, RunReport], None, None]:
    if batch.scheduler is not None:
        from isocore.batches.cluster import run_on_cluster

        yield from run_on_cluster(jobs, batch.scheduler)
    elif batch.workers:
        from isocore.batches.workers import Limits, run_in_workers

        limits = Limits(batch.workers, batch.seconds_per_job, batch.memory_bytes)
        yield from run_in_workers(jobs, limits, estimate=estimate, at=at)
    else:
        for job in jobs:
            at([job])
            for run in guarded(job):
                yield job, run


def estimate(job: Job) -> int:
    """Bytes that a job may take at its peak."""
    return estimated_bytes(content_bytes(job.source))


def guarded(job: Job) -> Iterator[RunReport]:
    """The records of a job, also where it meets an error nobody foresaw."""
    done = 0
    try:
        for run in _changed(job) if job.if_changed else convert(job):
            yield run
            done += 1
    except Exception as error:
        what = f"internal error ({type(error).__name__}: {one_line(error)}); please report it"
        unforeseen = RuntimeError(f"{job.source}: {what}")
        for target in job.targets[done:]:
            yield failed(job, target, unforeseen)


def _changed(job: Job) -> Iterator[RunReport]:
    """As convert, but outputs that are up to date are skipped, with the record of the run that made them."""
    source_hash = stamps.input_hash(job.source)
    left: list[Target] = []
    skipped: dict[Target, RunReport] = {}
    for target in job.targets:
        _, earlier = stamps.reason_to_run(job, target, source_hash)
        if earlier is None:
            left.append(target)
        else:
            skipped[target] = requirements_checked(replace(earlier, status="skipped", message="up to date"), job)
    made = convert(replace(job, targets=tuple(left))) if left else iter(())
    for target in job.targets:
        if target in skipped:
            yield skipped[target]
            continue
        run = next(made)
        if run.status in ("done", "empty") and target.output != STDOUT:
            stamps.keep_stamp(job, target, source_hash, run)
        yield run


def plan_lines(jobs: Sequence[Job]) -> Iterator[str]:
    """What would be done and why, and how much memory it may take: the dry run."""
    for job in jobs:
        source_hash = stamps.input_hash(job.source) if job.if_changed else ""
        for target in job.targets:
            reason = stamps.reason_to_run(job, target, source_hash)[0] if job.if_changed else "asked for"
            what = f"run ({reason})" if reason else "skip (up to date)"
            memory = f", about {estimate(job) / 2**20:,.0f} MiB" if reason else ""
            yield f"{job.source} -> {target.output}: isovalue {target.choice}, {what}{memory}"
