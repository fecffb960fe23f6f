"""Many jobs, here, in workers or on a cluster: nothing that one job does stops the others."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing
from typing import NamedTuple

from isocore.batches import stamps
from isocore.batches.collection import Collections
from isocore.batches.leftovers import remove_parts
from isocore.batches.one_job import estimate, guarded
from isocore.job import STDOUT, Job
from isocore.report.record import RunReport


class Batch(NamedTuple):
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
    pictures = [target.picture for job in jobs for target in job.targets if target.picture is not None]
    remove_parts([*outputs, *pictures, *map(stamps.stamp_path, outputs)])
    runs, lists = _runs(jobs, batch, at), Collections(jobs)
    try:
        with closing(runs):
            for job, run in runs:
                yield job, lists.add(job, run)
                if batch.fail_fast and run.status == "failed":
                    return
    finally:
        lists.finish()


def _runs(
    jobs: Sequence[Job], batch: Batch, at: Callable[[list[Job]], None]
) -> Generator[tuple[Job, RunReport], None, None]:
    if batch.scheduler is not None:
        from isocore.batches.cluster import run_on_cluster  # late, as workers: one job needs neither

        yield from run_on_cluster(jobs, batch.scheduler)
    elif batch.workers:
        from isocore.batches.workers import Limits, run_in_workers

        limits = Limits(batch.workers, batch.seconds_per_job, batch.memory_bytes)
        yield from run_in_workers(jobs, limits, estimate=estimate, here=guarded, at=at)
    else:
        for job in jobs:
            at([job])
            for run in guarded(job):
                yield job, run
