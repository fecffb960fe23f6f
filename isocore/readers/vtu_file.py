"""The bytes of a VTU file: its tags and what stands between them at once, appended arrays as they are asked for.

They are read, not mapped: a mapped file that gets shorter meanwhile, as one that a solver is writing again, ends the
process (SIGBUS).
"""

from __future__ import annotations

import mmap as memory
import os
import sys
from contextlib import suppress
from mmap import mmap
from pathlib import Path
from threading import Lock

from isocore.readers.vtu_blocks import BadBlock

#: Where appended data are announced within so many bytes, they are left on the disk; else the file is read whole. It is
#: looked for in a few bytes first.
_HEAD, _FEW = 1 << 24, 1 << 15
#: From so many bytes on it pays to ask for large pages.
_LARGE = 1 << 22
#: Behind the start of that tag: the rest of it, and the underscore before the data.
_TAG = 1 << 12
_APPENDED = b"<AppendedData"


class StoredFile:
    """An open file, and how long it was when it was opened."""

    def __init__(self, path: str) -> None:
        self._file = Path(path).open("rb", buffering=0)  # noqa: SIM115  # closed with the source
        self._lock = Lock()
        self.size = os.fstat(self._file.fileno()).st_size

    def __del__(self) -> None:
        if hasattr(self, "_file"):
            self._file.close()

    def tags(self) -> mmap | bytes:
        """From the first byte to the start of the appended data or beyond; all of a file that has none."""
        for size in (_FEW, _HEAD):
            if size < self.size and 0 <= (head := self.read(0, size)).find(_APPENDED) < size - _TAG:
                return head
        return self.all()

    def all(self) -> mmap | bytes:
        """Every byte; fewer than `size` where the file got shorter."""
        return self.read(0, self.size)

    def read(self, first: int, end: int) -> mmap | bytes:
        """The bytes from `first` to before `end`, as far as they are there."""
        size, filled = end - first, 0
        with self._lock:
            self._file.seek(first)
            if size < _LARGE:
                parts = []
                while got := self._file.read(size - filled):
                    parts.append(got)
                    filled += len(got)
                return b"".join(parts)
            room = _room(size)
            with memoryview(room) as target:
                while count := self._file.readinto(target[filled:]):  # one call takes two gigabytes at most
                    filled += count
        return room if filled == size else room[:filled]

    def close(self) -> None:
        """Nothing is read any more; what was read stays."""
        self._file.close()


def _room(size: int) -> mmap:
    """Memory to read into, in large pages where the system has them: they are half the time of reading."""
    if sys.platform == "win32":
        return mmap(-1, size)
    room = mmap(-1, size, flags=memory.MAP_PRIVATE | memory.MAP_ANONYMOUS)
    if hasattr(memory, "MADV_HUGEPAGE"):
        with suppress(OSError):  # a system without them
            room.madvise(memory.MADV_HUGEPAGE)
    return room


class Stretch:
    """The bytes of a file from one on, each read when it is asked for."""

    def __init__(self, file: StoredFile, first: int) -> None:
        self._file = file
        self._first = first

    def __len__(self) -> int:
        return max(0, self._file.size - self._first)

    def __getitem__(self, wanted: slice) -> memoryview:
        first, end, _ = wanted.indices(len(self))
        data = self._file.read(self._first + first, self._first + end)
        if len(data) < end - first:
            raise BadBlock("ended while it was read: the file got shorter; wait until it is written, or copy it again")
        return memoryview(data).toreadonly()
