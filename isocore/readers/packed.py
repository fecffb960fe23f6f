"""The bytes of a file, plain, gzip or bzip2, read once and straight to where they belong.

gzip is inflated by isal where there is a wheel of it (about 2.5 times zlib), else by zlib; both know files of
several members and check every checksum they pass. Messages carry no path: `isocore.readers.read` adds it.
"""

from __future__ import annotations

import bz2
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, Literal, Protocol, Self, cast

from isocore.errors import InputError, one_line

Packing = Literal["none", "gzip", "bzip2"]

#: One call of the inflater: small enough to stay in the second-level cache.
_CHUNK = 1 << 18
#: No deflate stream inflates to more than this many times its size, and a scan usually to this many.
_DEFLATE_LIMIT = 1032
_USUAL_RATIO = 4
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
    return min(stated, size * _DEFLATE_LIMIT) if stated >= size else size * _USUAL_RATIO


class Source(Protocol):
    """Bytes that are read once, forwards."""

    def skip(self, count: int) -> None: ...

    def fill(self, target: memoryview) -> None: ...

    def rest(self) -> int: ...


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
        self._file = path.open("rb", buffering=0)
        self._file.seek(start)
        self._content: Any = _unpacking(self._file, packing)

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
        if self._packing == "gzip" and content_bytes > file_bytes * _DEFLATE_LIMIT:
            most = f"{file_bytes:,} of gzip hold at most {file_bytes * _DEFLATE_LIMIT:,}"
            raise InputError(f"{self._subject}should hold {content_bytes:,} bytes; {most}; {self._advice}")
        memory_bytes = _memory_bytes()
        if kept_bytes > memory_bytes:
            raise InputError(f"needs {kept_bytes:,} bytes of memory of {memory_bytes:,}; crop the data")

    def read(self, count: int) -> bytes:
        """The next `count` bytes; fewer where the content ends."""
        with self._intact():
            content = bytes(self._content.read(count))
        self._unpacked += len(content)
        return content

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
                got = self._content.readinto(target[filled : filled + _CHUNK])
                if not got:
                    raise self._ends_early(self._plain_bytes() if self._packing == "none" else self._unpacked)
                filled += got
                self._unpacked += got

    def finish(self) -> None:
        """Look one byte ahead: at the end of the content this checks the last checksum."""
        if self._packing != "none":
            self.read(1)

    def rest(self) -> int:
        """How many bytes are left; they are read."""
        if self._packing == "none":
            return self._start + self._plain_bytes() - self._file.tell()
        return sum(len(chunk) for chunk in iter(lambda: self.read(_CHUNK), b""))

    def content_bytes(self) -> int:
        """How many bytes the whole content has: where it is packed, a pass of its own through all of it."""
        return self._plain_bytes() if self._packing == "none" else sum(map(len, self._whole()))

    def _plain_bytes(self) -> int:
        return self._path.stat().st_size - self._start

    @contextmanager
    def _intact(self) -> Iterator[None]:
        """One message for what inflaters call by many names: content that is cut, and content that is damaged."""
        try:
            yield
        except EOFError:  # the inflater keeps to itself what it had unpacked before the cut
            raise self._ends_early(self.content_bytes()) from None
        except (zlib.error, ValueError, OSError, _isal_error()) as error:
            if self._packing == "none":
                raise
            why = f"compressed data is damaged ({one_line(error)})"
            raise InputError(f"{self._subject}{why}; copy it again") from error

    def _ends_early(self, held_bytes: int) -> InputError:
        where = f"({held_bytes:,} of {self._promised:,} bytes)" if held_bytes < self._promised else "amid packed data"
        return InputError(f"{self._subject}ends early {where}; {self._advice}")

    def _whole(self) -> Iterator[bytes]:
        """All of the content that can be had, from its first byte, however damaged its end."""
        with self._path.open("rb") as file:
            file.seek(self._start)
            unpacker = _unpacker(self._packing)
            for packed in iter(lambda: file.read(1 << 14), b""):
                while packed:
                    try:
                        yield unpacker.decompress(packed)
                    except (zlib.error, OSError):
                        return
                    packed = unpacker.unused_data
                    if unpacker.eof:
                        unpacker = _unpacker(self._packing)


def _unpacker(packing: Packing) -> Any:
    return zlib.decompressobj(wbits=31) if packing == "gzip" else bz2.BZ2Decompressor()


def _unpacking(file: IO[bytes], packing: Packing) -> Any:
    """`file` as one to read the unpacked content from."""
    if packing == "gzip":
        try:
            from isal import igzip as inflater
        except ImportError:
            import gzip as inflater  # type: ignore[no-redef]
        return inflater.GzipFile(fileobj=file, mode="rb")  # type: ignore[no-untyped-call]
    return bz2.BZ2File(file) if packing == "bzip2" else file


def _isal_error() -> type[Exception]:
    """What isal raises; it is no zlib.error."""
    try:
        from isal.isal_zlib import error
    except ImportError:
        return zlib.error
    return cast(type[Exception], error)


def _memory_bytes() -> float:
    """The machine's memory; without bound where it does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return float("inf")
