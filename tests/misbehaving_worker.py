"""A worker process that crashes, hangs or is killed at the jobs that its arguments name, as NAME=crash, hang or oom.

Tests start it in place of the real one: `program(rules)` is the command line with such workers.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from isocore.batches.one_job import guarded
from isocore.batches.worker import work_until_stdin_ends
from isocore.job import Job
from isocore.report import RunReport


def program(*rules: str) -> list[str]:
    """A command that is isocore's own but for its workers."""
    worker = [sys.executable, "-P", str(Path(__file__).resolve()), *rules]
    code = f"from isocore.batches import workers; workers.COMMAND = {worker!r}; "
    return [sys.executable, "-P", "-c", code + "from isocore.cli.main import main; main()"]


def misbehaving(job: Job) -> Iterator[RunReport]:
    """The job's records, unless a rule names its source."""
    for name, _, what in (rule.partition("=") for rule in sys.argv[1:]):
        if name not in str(job.source):
            continue
        if what == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        elif what == "oom":
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == "hang":
            time.sleep(3600)
    yield from guarded(job)


if __name__ == "__main__":
    work_until_stdin_ends(misbehaving)
