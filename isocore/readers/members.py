"""The members of a packed file, looked at apart from reading it: how much they hold, and what lies behind the last.

Nothing here keeps more than a piece of the content in memory, however far a few bytes inflate.
"""

from __future__ import annotations

import bz2
import io
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, Literal, cast

Packing = Literal["none", "gzip", "zlib", "bzip2"]

MAGIC = b"\x1f\x8b"
_PACKED, _UNPACKED = 1 << 14, 1 << 18  # bytes at a time
#: The empty member that ends a file packed in blocks (BGZF): its last nine bytes are zeros and no padding.
_LAST_BLOCK = bytes.fromhex("1f8b08040000000000ff0600424302001b0003000000000000000000")
_EMPTY_MEMBER_ZEROS = 9


def content(file: IO[bytes], packing: Packing) -> Iterator[bytes]:
    """All of the content that can be had from where `file` stands, piece by piece, however damaged its end."""
    unpacker = _unpacker(packing)
    for packed in iter(lambda: file.read(_PACKED), b""):
        while packed:
            try:
                yield from _pieces(unpacker, packed, packing)
            except (zlib.error, OSError):
                return
            packed = unpacker.unused_data
            if unpacker.eof and packing == "zlib":
                return
            if unpacker.eof:
                unpacker = _unpacker(packing)


def end_of_members(path: Path, start: int) -> int | None:
    """The byte behind the last gzip member, where anything but a member follows it.

    None where a member is cut or damaged, or where no whole one is there.
    """
    with path.open("rb") as file:
        end = _after_member(file, start)
        position = end
        while position is not None:
            end = position
            following = _behind_zeros(file, end)
            file.seek(following)
            if file.read(2) != MAGIC:
                return end
            position = _after_member(file, following)
        return None


def is_padded(path: Path, content_bytes: int) -> bool:
    """Whether zeros lie behind the last gzip member of a file with so many bytes of content."""
    with path.open("rb") as file:
        file.seek(-min(path.stat().st_size, 1 << 10), io.SEEK_END)
        tail = file.read()
    stated = (content_bytes % 2**32).to_bytes(4, "little")
    if tail.endswith((stated, _LAST_BLOCK)):
        return False
    zeros = len(tail) - len(tail.rstrip(b"\0"))
    return zeros > _EMPTY_MEMBER_ZEROS or any(tail.endswith(stated + bytes(n)) for n in range(1, zeros + 1))


def unpacking(file: IO[bytes], packing: Packing) -> Any:
    """`file` as one to read the unpacked content from."""
    if packing == "gzip":
        try:
            from isal import igzip as inflater
        except ImportError:
            import gzip as inflater  # type: ignore[no-redef]
        return inflater.GzipFile(fileobj=file, mode="rb")  # type: ignore[no-untyped-call]
    if packing == "zlib":
        return Inflated(file)
    return bz2.BZ2File(file) if packing == "bzip2" else file


def inflater_error() -> type[Exception]:
    """What isal raises; it is no zlib.error."""
    try:
        from isal.isal_zlib import error
    except ImportError:
        return zlib.error
    return cast(type[Exception], error)


def _zlib() -> Any:
    try:
        from isal import isal_zlib
    except ImportError:
        return zlib
    return isal_zlib


class Inflated(io.RawIOBase):
    """The content of a zlib stream that begins where `file` stands; what lies behind it is not looked at."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._inflater: Any = _zlib().decompressobj()

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, target: Any) -> int:
        """Fill `target` with what comes next, as far as one call gives it; how much it was."""
        while not self._inflater.eof:
            packed = self._inflater.unconsumed_tail or self._file.read(_PACKED)
            if got := self._inflater.decompress(packed, len(target)):  # also of what it took in before
                target[: len(got)] = got
                return len(got)
            if not packed:
                raise EOFError
        return 0


class Bounded(io.RawIOBase):
    """The bytes of an open file from where it stands to byte `end`."""

    def __init__(self, file: IO[bytes], end: int) -> None:
        self._file, self._left = file, end - file.tell()

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, target: Any) -> int:
        """Fill `target` with what comes next; how much it was."""
        got = self._file.read(min(len(target), self._left))
        target[: len(got)] = got
        self._left -= len(got)
        return len(got)


def _unpacker(packing: Packing) -> Any:
    if packing == "bzip2":
        return bz2.BZ2Decompressor()
    return zlib.decompressobj(wbits=31 if packing == "gzip" else 15)


def _pieces(unpacker: Any, packed: bytes, packing: Packing) -> Iterator[bytes]:
    """What `packed` unpacks to, as far as the member goes."""
    yield unpacker.decompress(packed, _UNPACKED)
    if packing != "bzip2":
        while unpacker.unconsumed_tail and not unpacker.eof:
            yield unpacker.decompress(unpacker.unconsumed_tail, _UNPACKED)
    else:
        while not unpacker.needs_input and not unpacker.eof:
            yield unpacker.decompress(b"", _UNPACKED)


def _after_member(file: IO[bytes], start: int) -> int | None:
    """The byte behind the member that starts at `start`; None where it is cut or damaged."""
    file.seek(start)
    unpacker = _unpacker("gzip")
    while not unpacker.eof:
        packed = file.read(_PACKED)
        if not packed:
            return None
        try:
            for _ in _pieces(unpacker, packed, "gzip"):
                pass
        except zlib.error:
            return None
    return file.tell() - len(unpacker.unused_data)


def _behind_zeros(file: IO[bytes], position: int) -> int:
    file.seek(position)
    while piece := file.read(_PACKED):
        if left := piece.lstrip(b"\0"):
            return file.tell() - len(left)
    return file.tell()
