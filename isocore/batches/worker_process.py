"""One worker process, as its parent sees it: what it is at, what it says, and why it ended."""

from __future__ import annotations

import errno
import queue
import signal
import subprocess
import tempfile
import threading
from collections.abc import Sequence
from contextlib import suppress
from time import monotonic
from typing import IO, Any, BinaryIO, cast

from isocore.batches.frames import receive, send
from isocore.errors import one_line
from isocore.job import Job

_END_SECONDS = 5.0


class Worker:
    """One process and the job it is at. A thread passes on what it says; everything else is the main thread's."""

    def __init__(self, command: Sequence[str], events: queue.SimpleQueue[tuple[Worker, Any]]) -> None:
        """Raises OSError where the system starts no process any more."""
        self.job: Job | None = None
        self.runs = 0
        self.ready = False
        self.deadline: float | None = None
        self.overtime = False
        self.bytes = 0
        self._errors = _scratch()
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors or subprocess.DEVNULL,
            )
        except BaseException:
            if self._errors is not None:
                self._errors.close()
            raise
        try:
            threading.Thread(target=self._listen, args=(events,), daemon=True).start()
        except RuntimeError as error:  # no thread can be started
            self.close()
            raise OSError(errno.EAGAIN, one_line(error)) from error

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
        with suppress(subprocess.TimeoutExpired):  # it may hang in the system, on a disk that went away
            self._process.wait(_END_SECONDS)
        for stream in (self._process.stdin, self._process.stdout, self._errors):
            if stream is not None:
                try:
                    stream.close()
                except OSError:
                    continue

    def why_it_ended(self) -> str:
        """A sentence about a process that ended before its job did."""
        try:
            code = self._process.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            return "its worker fell silent; please report it with the file"
        if code < 0:
            return _why_of_signal(-code)
        said: list[str] = []
        if self._errors is not None:
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


def _scratch() -> IO[bytes] | None:
    """Where a worker's last words go; None where no folder for temporary files can be written to."""
    try:
        return tempfile.TemporaryFile()
    except OSError:
        return None


def _why_of_signal(number: int) -> str:
    try:
        name = signal.Signals(number).name
    except ValueError:
        name = f"signal {number}"
    if name == "SIGKILL":
        return "its worker was killed, probably for lack of memory; lower --jobs or crop the data"
    if name == "SIGBUS":
        return "its worker crashed (SIGBUS): the file changed while it was read, or the disk fails; copy it again"
    if name in ("SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT", "SIGXCPU"):
        return f"its worker was ended from outside ({name}); convert it again"
    return f"its worker crashed ({name}); please report it with the file"
