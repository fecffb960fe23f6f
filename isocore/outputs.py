"""How a surface gets to its target: what its format makes of it, which is what is measured; then its bytes."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from hashlib import sha256
from typing import Any, BinaryIO, cast

from isocore.errors import writing
from isocore.job import STDOUT, Job, Target
from isocore.report.sections import Written
from isocore.surface import Surface
from isocore.whole_file import whole_file
from isocore.writers import WRITERS

_NO_NORMALS = "STL holds no vertex normals, only one for every triangle, so --normals adds none; write PLY or OBJ"


def format_warnings(job: Job) -> tuple[str, ...]:
    """What was asked for and the format does not hold."""
    return (_NO_NORMALS,) if job.options.normals and not job.normals else ()


def write_target(surface: Surface, target: Target, job: Job) -> Written:
    """Write a rounded surface to its target and hash what is written on its way."""
    to_stdout = target.output == STDOUT
    place: AbstractContextManager[BinaryIO | None] = writing("stdout") if to_stdout else whole_file(target.output)
    with place as opened:
        stream = _Hashed(opened or sys.stdout.buffer)
        WRITERS[f".{job.format}"](cast(BinaryIO, stream), surface, job.options.threads)
        if to_stdout:
            sys.stdout.buffer.flush()
    return stream.written()


class _Hashed:
    """A stream that keeps the hash and the length of what passes."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._hash = sha256()
        self._bytes = 0

    def write(self, data: Any) -> int:
        """Pass the data on."""
        self._hash.update(data)
        self._bytes += memoryview(data).nbytes
        return self._stream.write(data)

    def written(self) -> Written:
        """Hash and length of everything so far."""
        return Written(sha256=self._hash.hexdigest(), bytes=self._bytes)
