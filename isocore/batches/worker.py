"""A worker process: jobs come in on stdin, records go out on stdout, one pickled frame after the other.

It stays warm from job to job and leaves at once when its parent does, even where that was killed.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import struct
import sys
import threading
import time
from typing import Any, BinaryIO

LENGTH = struct.Struct("<Q")
#: For tests only: NAME=what, where the job whose source contains NAME does `what` (crash, hang, oom).
TEST_HOOK = "ISOCORE_TEST_WORKER"


def send(stream: BinaryIO, message: Any) -> None:
    """Write one frame."""
    data = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(LENGTH.pack(len(data)) + data)
    stream.flush()


def receive(stream: BinaryIO) -> Any:
    """The next frame's message. Raises EOFError where the other side has gone."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)


def main() -> None:
    """Work until stdin ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    jobs: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(jobs,), daemon=True).start()

    from isocore.batches.run import guarded

    while True:
        job = jobs.get()
        _obey_test_hook(str(job.source))
        for run in guarded(job):
            send(replies, run)
        send(replies, None)


def _listen(jobs: queue.SimpleQueue[Any]) -> None:
    try:
        while True:
            jobs.put(receive(sys.stdin.buffer))
    except (EOFError, OSError):
        os._exit(0)


def _obey_test_hook(source: str) -> None:
    for rule in os.environ.get(TEST_HOOK, "").split(","):
        name, _, what = rule.partition("=")
        if not what or name not in source:
            continue
        if what == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        elif what == "oom":
            os.kill(os.getpid(), signal.SIGKILL)
        elif what == "hang":
            time.sleep(3600)


if __name__ == "__main__":
    main()
