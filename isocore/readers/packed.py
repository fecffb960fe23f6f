"""The bytes of a file, plain, gzip, zlib or bzip2, read once and straight to where they belong.

gzip is inflated by isal where there is a wheel of it (about 2.5 times zlib), else by zlib; both know files of
several members and check every checksum they pass. Messages carry no path: `isocore.readers.read` adds it.
"""

from __future__ import annotations

import gzip
import io
import os
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, Protocol, Self, TypeVar, cast

from isocore.errors import InputError, one_line
from isocore.readers.members import Bounded, Packing, content, end_of_members, inflater_error, is_padded, unpacking

Got = TypeVar("Got")

#: One call of the inflater: small enough to stay in the second-level cache.
_CHUNK = 1 << 18
#: No deflate stream inflates to more than this many times its size, no bzip2 block of 900,000 bytes that run-length
#: coding made of 255 times as many is shorter than thirty; a scan usually inflates to four times its size.
_LIMITS = {"gzip": 1032, "zlib": 1032, "bzip2": 1_600_000}
_USUAL_RATIO = 4
#: Surplus content is counted so far: it may be endless, and a warning says that there is too much all the same.
_MOST_SURPLUS = 1 << 26
#: The shortest gzip file: a header of ten bytes, and a checksum and a size of four each.
_SHORTEST_GZIP = 18


def packing_by_suffix(path: Path) -> Packing:
    """How a file of bare samples is packed: its first bytes may be anything."""
    return "gzip" if path.name.lower().endswith(".gz") else "none"


def packing_of(path: Path) -> Packing:
    """How a file with a header is packed, by its first bytes: suffixes lie."""
    with path.open("rb") as file:
        magic = file.read(3)
    if magic[:2] == b"\x1f\x8b":
        return "gzip"
    return "bzip2" if magic == b"BZh" else "none"


def unpacked_bytes(path: Path) -> int:
    """A guess at the bytes of content, without unpacking: of gzip the last four bytes say so, modulo 2^32.

    0 where the file cannot be read; the size of the file where its name does not end in .gz.
    """
    try:
        size = path.stat().st_size
        if packing_by_suffix(path) == "none" or size < _SHORTEST_GZIP:
            return size
        with path.open("rb") as file:
            file.seek(-4, os.SEEK_END)
            stated = int.from_bytes(file.read(4), "little")
    except OSError:
        return 0
    return min(stated, size * _LIMITS["gzip"]) if stated >= size else size * _USUAL_RATIO


class Source(Protocol):
    """Bytes that are read once, forwards. warnings: complete when all has been read."""

    @property
    def warnings(self) -> tuple[str, ...]: ...

    def skip(self, count: int) -> None: ...

    def fill(self, target: memoryview) -> None: ...

    def rest(self, expected: int = 0) -> int: ...


class Packed:
    """The content of `path` from byte `start` on, unpacked while it is read, forwards only."""

    def __init__(
        self,
        path: Path,
        *,
        packing: Packing,
        start: int = 0,
        subject: str = "",
        advice: str = "copy it again",
    ) -> None:
        """subject, advice: how a message about missing bytes begins and ends."""
        self._subject, self._advice = subject, advice
        self._path, self._packing, self._start = path, packing, start
        self._promised = self._unpacked = 0
        self._bounded = False
        self.warnings: tuple[str, ...] = ()
        self._file = path.open("rb", buffering=0)
        self._file.seek(start)
        self._content: Any = unpacking(self._file, packing)

    @property
    def is_packed(self) -> bool:
        """Whether the content is more than the file's bytes."""
        return self._packing != "none"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self._content.close()
        self._file.close()

    def promise(self, content_bytes: int, *, kept_bytes: int) -> None:
        """Refuse before anything is allocated: content that cannot be there, or that cannot be kept."""
        self._promised = content_bytes
        file_bytes = self._plain_bytes()
        if self._packing == "none" and file_bytes < content_bytes:
            raise self._ends_early(file_bytes)
        limit = _LIMITS.get(self._packing)
        if limit is not None and content_bytes > file_bytes * limit:
            most = f"{file_bytes:,} of {self._packing} hold at most {file_bytes * limit:,}"
            raise InputError(f"{self._subject}should hold {content_bytes:,} bytes; {most}; {self._advice}")
        memory_bytes = _memory_bytes()
        if kept_bytes > memory_bytes:
            raise InputError(f"needs {kept_bytes:,} bytes of memory of {memory_bytes:,}; crop the data")

    def read(self, count: int) -> bytes:
        """The next `count` bytes; fewer where the content ends."""
        with self._intact():
            found = bytes(self._taken(lambda: self._content.read(count)))
        self._unpacked += len(found)
        return found

    def skip(self, count: int) -> None:
        """Leave out the next `count` bytes."""
        if self._packing == "none":
            self._file.seek(count, os.SEEK_CUR)
            return
        scratch = memoryview(bytearray(min(count, _CHUNK)))
        while count > 0:
            self.fill(scratch[: min(count, _CHUNK)])
            count -= min(count, _CHUNK)

    def fill(self, target: memoryview) -> None:
        """Fill all of `target` (bytes) with what comes next."""
        filled = 0
        with self._intact():
            while filled < len(target):
                part = target[filled : filled + _CHUNK]
                got = self._taken(lambda part=part: self._content.readinto(part))  # type: ignore[misc]
                if not got:
                    raise self._ends_early(self._plain_bytes() if self._packing == "none" else self._unpacked)
                filled += got
                self._unpacked += got

    def finish(self) -> None:
        """Look one byte ahead: at the end of the content this checks the last checksum."""
        if self._packing != "none" and not self.read(1):
            self._note_padding()

    def rest(self, expected: int = 0) -> int:
        """How many bytes are left; they are read. Of packed ones no more are counted than tell that it is too many."""
        if self._packing == "none":
            return self._start + self._plain_bytes() - self._file.tell()
        left, most = 0, expected + _MOST_SURPLUS
        while left < most and (chunk := self.read(_CHUNK)):
            left += len(chunk)
        if left < most:
            self._note_padding()
        return left

    def content_bytes(self, *, most: float = float("inf")) -> int:
        """How many bytes the whole content has, or a number above `most`: a pass of its own where it is packed."""
        if self._packing == "none":
            return self._plain_bytes()
        held = 0
        with self._path.open("rb") as file:
            file.seek(self._start)
            for piece in content(file, self._packing):
                held += len(piece)
                if held > most:
                    break
        return held

    def _plain_bytes(self) -> int:
        return self._path.stat().st_size - self._start

    @contextmanager
    def _intact(self) -> Iterator[None]:
        """One message for what inflaters call by many names: content that is cut, and content that is damaged."""
        try:
            yield
        except EOFError:  # the inflater keeps to itself what it had unpacked before the cut
            raise self._ends_early(self.content_bytes(most=self._promised)) from None
        except (zlib.error, ValueError, OSError, inflater_error()) as error:
            if self._packing == "none":
                raise
            why = f"compressed data is damaged ({one_line(error)})"
            raise InputError(f"{self._subject}{why}; copy it again") from error

    def _ends_early(self, held_bytes: int) -> InputError:
        where = f"({held_bytes:,} of {self._promised:,} bytes)" if held_bytes < self._promised else "amid packed data"
        return InputError(f"{self._subject}ends early {where}; {self._advice}")

    def _taken(self, take: Callable[[], Got]) -> Got:
        """What `take` reads; where no gzip member follows the last whole one, without what stands there instead."""
        try:
            return take()
        except (EOFError, gzip.BadGzipFile):
            end = None if self._bounded or self._packing != "gzip" else end_of_members(self._path, self._start)
            if end is None:
                raise
        self._bounded = True
        self._file.seek(self._start)
        self._content.close()
        self._content = unpacking(cast(IO[bytes], io.BufferedReader(Bounded(self._file, end))), self._packing)
        surplus = self._path.stat().st_size - end
        self.warnings += (
            f"{self._subject}has {surplus:,} bytes behind its gzip data that are none; they were left out, but"
            " check that the copy is whole",
        )
        scratch, again = memoryview(bytearray(_CHUNK)), self._unpacked
        while again and (got := self._content.readinto(scratch[: min(again, _CHUNK)])):
            again -= got
        return take()

    def _note_padding(self) -> None:
        """A warning where zeros follow the last gzip member: inflaters pass over them without a word."""
        if self._packing == "gzip" and not self._bounded and is_padded(self._path, self._unpacked):
            self.warnings += (f"{self._subject}is padded with zeros behind its gzip data; they were left out",)


def _memory_bytes() -> float:
    """The machine's memory; without bound where it does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return float("inf")
