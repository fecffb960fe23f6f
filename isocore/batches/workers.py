"""Jobs in worker processes: a crash, a kill or a hang of one is its own failed rows, and nobody else's.

The standard library's process pool does not serve: there one dead process breaks the pool, a job cannot be given up
after a time, and a job yields one result, while here each surface's record comes as soon as it is made.
"""

from __future__ import annotations

import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from time import monotonic
from typing import Any, BinaryIO, cast

from isocore.batches.frames import receive, send
from isocore.job import Job
from isocore.pipeline import failed
from isocore.report.record import RunReport
from isocore.whole_file import remove_parts

#: Starts a worker process.
COMMAND = (sys.executable, "-P", "-m", "isocore.batches.worker")
_END_SECONDS = 5.0


@dataclass(frozen=True, slots=True)
class Limits:
    """count: workers at once; seconds: per job; memory_bytes: for the estimates of all jobs at once."""

    count: int = 1
    seconds: float | None = None
    memory_bytes: int | None = None


class Worker:
    """One process and the job it is at. A thread passes on what it says; everything else is the main thread's."""

    def __init__(self, events: queue.SimpleQueue[tuple[Worker, Any]]) -> None:
        self.job: Job | None = None
        self.runs = 0
        self.deadline: float | None = None
        self.overtime = False
        self.bytes = 0
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  # closed with the worker
        self._process = subprocess.Popen(
            COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
        )
        threading.Thread(target=self._listen, args=(events,), daemon=True).start()

    def start(self, job: Job, *, seconds: float | None, estimate: int) -> None:
        """Give it a job; it must be idle."""
        self.job, self.runs, self.overtime, self.bytes = job, 0, False, estimate
        self.deadline = None if seconds is None else monotonic() + seconds
        try:
            send(cast(BinaryIO, self._process.stdin), job)
        except OSError:
            self._process.kill()

    def rest(self) -> None:
        """It has done its job."""
        self.job, self.deadline, self.bytes = None, None, 0

    def kill(self, *, overtime: bool = False) -> None:
        """End it, whatever it does."""
        self.overtime = overtime
        self._process.kill()

    def close(self) -> None:
        """End it and wait until it has ended."""
        self._process.kill()
        self._process.wait(_END_SECONDS)
        for stream in (self._process.stdin, self._process.stdout, self._errors):
            if stream is not None:
                try:
                    stream.close()
                except OSError:
                    continue

    def why_it_ended(self) -> str:
        """A sentence about a process that ended before its job did."""
        code = self._process.wait(_END_SECONDS)
        if code == -signal.SIGKILL:
            return "its worker was killed, probably for lack of memory; lower --jobs or crop the data"
        if code < 0:
            return f"its worker crashed ({signal.Signals(-code).name}); please report it with the file"
        self._errors.seek(0)
        said = self._errors.read().decode(errors="replace").strip().splitlines()
        return f"its worker ended with code {code} ({said[-1] if said else 'without a word'}); please report it"

    def _listen(self, events: queue.SimpleQueue[tuple[Worker, Any]]) -> None:
        stdout = cast(BinaryIO, self._process.stdout)
        try:
            while True:
                events.put((self, receive(stdout)))
        except Exception as error:
            events.put((self, error))


def run_in_workers(
    jobs: Sequence[Job], limits: Limits, *, estimate: Callable[[Job], int], at: Callable[[list[Job]], None]
) -> Iterator[tuple[Job, RunReport]]:
    """Convert all jobs, some at once; records come as they are done. `at` is told what is being worked on.

    However this ends, no worker and no half-written file is left.
    """
    events: queue.SimpleQueue[tuple[Worker, Any]] = queue.SimpleQueue()
    waiting = deque(jobs)
    workers: list[Worker] = []
    try:
        while waiting or any(worker.job for worker in workers):
            _assign(waiting, workers, events, limits, estimate)
            at([worker.job for worker in workers if worker.job])
            worker, message = _next(events, workers)
            job = worker.job
            if isinstance(message, RunReport) and job is not None:
                worker.runs += 1
                yield job, message
            elif message is None:
                worker.rest()
            elif isinstance(message, Exception):
                workers.remove(worker)
                yield from _lost(worker, limits)
                worker.close()
    finally:
        for worker in workers:
            worker.close()
            if worker.job is not None:
                remove_parts(target.output for target in worker.job.targets)


def _assign(
    waiting: deque[Job],
    workers: list[Worker],
    events: queue.SimpleQueue[tuple[Worker, Any]],
    limits: Limits,
    estimate: Callable[[Job], int],
) -> None:
    """Start jobs while a worker is free and the estimates fit; a job that fits nowhere runs alone."""
    while waiting:
        busy = [worker for worker in workers if worker.job]
        if len(busy) >= limits.count:
            return
        needed = estimate(waiting[0])
        held = sum(worker.bytes for worker in busy)
        if busy and limits.memory_bytes is not None and held + needed > limits.memory_bytes:
            return
        idle = next((worker for worker in workers if not worker.job), None)
        if idle is None:
            idle = Worker(events)
            workers.append(idle)
        idle.start(waiting.popleft(), seconds=limits.seconds, estimate=needed)


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
