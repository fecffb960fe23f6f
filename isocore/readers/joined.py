"""Sources of bytes that are no single packed file: several files in a row, and samples decoded from text."""

from __future__ import annotations

from collections.abc import Sequence

from isocore.errors import InputError
from isocore.readers.packed import Source


class Joined:
    """Parts of `part_bytes` each, read as if they were one."""

    def __init__(self, parts: Sequence[Source], part_bytes: int) -> None:
        self._parts, self._part_bytes, self._position = parts, part_bytes, 0

    def skip(self, count: int) -> None:
        """Leave out the next `count` bytes."""
        while count > 0:
            part, step = self._next(count)
            part.skip(step)
            count -= step

    def fill(self, target: memoryview) -> None:
        """Fill all of `target` with what comes next."""
        while target:
            part, step = self._next(len(target))
            part.fill(target[:step])
            target = target[step:]

    def rest(self) -> int:
        """How many bytes the parts have beyond what they should."""
        return sum(part.rest() for part in self._parts)

    def _next(self, count: int) -> tuple[Source, int]:
        index, inside = divmod(self._position, self._part_bytes)
        step = min(count, self._part_bytes - inside)
        self._position += step
        return self._parts[index], step


class Decoded:
    """Bytes that are in memory already; `promised_bytes` of them are expected."""

    def __init__(self, content: bytes, promised_bytes: int) -> None:
        if len(content) < promised_bytes:
            raise InputError(f"ends early ({len(content):,} of {promised_bytes:,} bytes); copy it again")
        self._content, self._position = memoryview(content), 0

    def skip(self, count: int) -> None:
        """Leave out the next `count` bytes."""
        self._position += count

    def fill(self, target: memoryview) -> None:
        """Fill all of `target` with what comes next."""
        target[:] = self._content[self._position : self._position + len(target)]
        self._position += len(target)

    def rest(self) -> int:
        """How many bytes are left."""
        return len(self._content) - self._position
