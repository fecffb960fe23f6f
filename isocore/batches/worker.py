"""A worker process: jobs come in on stdin, records go out on stdout, one pickled frame after the other.

It stays warm from job to job and leaves at once when its parent does, even where that was killed.
"""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
from collections.abc import Callable, Iterator

from isocore.batches.frames import READY, receive, send
from isocore.batches.one_job import guarded
from isocore.job import Job
from isocore.memory import share_one_heap
from isocore.report.record import RunReport


def work_until_stdin_ends(work: Callable[[Job], Iterator[RunReport]] = guarded) -> None:
    """Say that it is ready, then answer every job with its records and a None.

    Everything a job needs was imported above: a module that two threads import at once, this one and the listener that
    unpickles a job, can end both.
    """
    for name in ("SIGINT", "SIGHUP"):  # they reach the parent too, which ends its workers in order
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    share_one_heap()
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(jobs,), daemon=True).start()
    send(replies, READY)
    while True:
        for run in work(jobs.get()):
            send(replies, run)
        send(replies, None)


def _listen(jobs: queue.SimpleQueue[Job]) -> None:
    try:
        while True:
            jobs.put(receive(sys.stdin.buffer))
    except (EOFError, OSError):
        os._exit(0)


if __name__ == "__main__":
    work_until_stdin_ends()
