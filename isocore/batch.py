"""Many jobs: each failure one row, and nothing that one job raises stops the others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from isocore.pipeline import Job, convert, failed
from isocore.report.record import RunReport


def run_jobs(jobs: Iterable[Job], *, fail_fast: bool = False) -> Iterator[tuple[Job, RunReport]]:
    """Convert all jobs, one after the other; with fail_fast, none after the first that failed."""
    for job in jobs:
        ended_well = True
        for run in guarded(job):
            ended_well &= run.status != "failed"
            yield job, run
        if fail_fast and not ended_well:
            return


def guarded(job: Job) -> Iterator[RunReport]:
    """The reports of a job, also where it meets an error nobody foresaw."""
    done = 0
    try:
        for run in convert(job):
            yield run
            done += 1
    except Exception as error:
        foreseen = RuntimeError(f"{job.source}: internal error ({type(error).__name__}: {error}); please report it")
        for target in job.targets[done:]:
            yield failed(job, target, foreseen, seconds={})
