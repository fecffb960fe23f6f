"""Jobs in worker processes: a crash, a kill or a hang of one is its own failed rows, and nobody else's.

The standard library's process pool does not serve: there one dead process breaks the pool, a job cannot be given up
after a time, and a job yields one result, while here each surface's record comes as soon as it is made.
"""

from __future__ import annotations

import queue
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from isocore.batches.frames import READY
from isocore.batches.leftovers import remove_parts
from isocore.batches.worker_process import Worker
from isocore.errors import one_line
from isocore.job import Job
from isocore.pipeline import failed
from isocore.report.record import RunReport

#: Starts a worker process.
COMMAND = (sys.executable, "-P", "-m", "isocore.batches.worker")
#: Files that this process opens besides: its libraries, reports, lists.
_SPARE_FILES = 40


@dataclass(frozen=True, slots=True)
class Limits:
    """count: workers at once; seconds: per job; memory_bytes: for the estimates of all jobs at once."""

    count: int = 1
    seconds: float | None = None
    memory_bytes: int | None = None


class _Team:
    """The workers there are, and how many there may be: as many as are asked for and as the system lets start."""

    def __init__(self, limits: Limits) -> None:
        self.events: queue.SimpleQueue[tuple[Worker, Any]] = queue.SimpleQueue()
        self.workers: list[Worker] = []
        self.limits = limits
        self.most = _startable(limits.count)
        self.why = ""

    def busy(self) -> list[Worker]:
        """Those that have a job."""
        return [worker for worker in self.workers if worker.job]

    def assign(self, waiting: deque[Job], estimate: Callable[[Job], int]) -> None:
        """Start jobs while a worker is free and the estimates fit; a job that fits nowhere runs alone."""
        while waiting:
            busy = self.busy()
            needed = estimate(waiting[0])
            held = sum(worker.bytes for worker in busy)
            if busy and self.limits.memory_bytes is not None and held + needed > self.limits.memory_bytes:
                return
            idle = self._idle()
            if idle is None:
                return
            idle.start(waiting.popleft(), seconds=self.limits.seconds, estimate=needed)

    def _idle(self) -> Worker | None:
        """A worker without a job, a new one if need be; None where there is none to be had."""
        idle = next((worker for worker in self.workers if not worker.job), None)
        if idle is None and len(self.workers) < self.most:
            try:
                idle = Worker(COMMAND, self.events)
            except (OSError, MemoryError) as error:
                self.most, self.why = len(self.workers), one_line(error)
            else:
                self.workers.append(idle)
        return idle


def _startable(count: int) -> int:
    """At most `count`, and so many that files can still be opened: each worker keeps three."""
    try:
        import resource
    except ImportError:  # Windows
        return count
    files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return count if files == resource.RLIM_INFINITY else max(1, min(count, (files - _SPARE_FILES) // 3))


def run_in_workers(
    jobs: Sequence[Job],
    limits: Limits,
    *,
    estimate: Callable[[Job], int],
    here: Callable[[Job], Iterator[RunReport]],
    at: Callable[[list[Job]], None],
) -> Iterator[tuple[Job, RunReport]]:
    """Convert all jobs, some at once; records come as they are done. `at` is told what is being worked on.

    here: converts a job in this process, for where no worker can be started.
    However this ends, no worker and no half-written file is left.
    """
    team = _Team(limits)
    waiting = deque(jobs)
    try:
        while waiting or team.busy():
            team.assign(waiting, estimate)
            at([worker.job for worker in team.busy() if worker.job] or [waiting[0]])
            if not team.busy():
                yield from _without_worker(waiting.popleft(), team, here)
                continue
            worker, message = _next(team.events, team.workers)
            job = worker.job
            if isinstance(message, RunReport) and job is not None:
                worker.runs += 1
                yield job, message
            elif message is None:
                worker.rest()
            elif message == READY:
                worker.ready = True
            elif isinstance(message, Exception):
                team.workers.remove(worker)
                if job is not None and not worker.ready and not worker.overtime:
                    team.most, team.why = len(team.workers), worker.why_it_ended()
                    waiting.appendleft(job)
                else:
                    yield from _lost(worker, limits)
                worker.close()
    finally:
        for worker in team.workers:
            worker.close()
            if worker.job is not None:
                remove_parts(target.output for target in worker.job.targets)


def _without_worker(
    job: Job, team: _Team, here: Callable[[Job], Iterator[RunReport]]
) -> Iterator[tuple[Job, RunReport]]:
    """Convert a job in this process; before the next one a worker is tried again."""
    missing = "without --timeout and " if team.limits.seconds else ""
    why = f"no worker could be started ({team.why}); converted {missing}without its protection from crashes"
    for run in here(job):
        yield job, replace(run, warnings=(*run.warnings, why))
    team.most = _startable(team.limits.count)


def _next(events: queue.SimpleQueue[tuple[Worker, Any]], workers: list[Worker]) -> tuple[Worker, Any]:
    """The next event; workers past their deadline are ended, which is an event too."""
    while True:
        deadlines = [worker.deadline for worker in workers if worker.deadline is not None]
        try:
            return events.get(timeout=max(0.0, min(deadlines) - monotonic()) if deadlines else None)
        except queue.Empty:
            for worker in workers:
                if worker.deadline is not None and worker.deadline <= monotonic():
                    worker.deadline = None
                    worker.kill(overtime=True)


def _lost(worker: Worker, limits: Limits) -> Iterator[tuple[Job, RunReport]]:
    job = worker.job
    if job is None:
        return
    why = worker.why_it_ended()
    if worker.overtime:
        why = f"took longer than {limits.seconds:g} s; allow more with --timeout"
    remove_parts(target.output for target in job.targets)
    for target in job.targets[worker.runs :]:
        yield job, failed(job, target, RuntimeError(why))
