"""Sources of bytes that are no single packed file: several files in a row, and samples decoded from text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Self

from isocore.errors import InputError
from isocore.readers.packed import Source

#: Opens a source, which is closed by leaving its context.
Opener = Callable[[], AbstractContextManager[Source]]


class Joined:
    """Parts of `part_bytes` each, read as if they were one; one at a time is open, as systems allow no thousands."""

    def __init__(self, parts: Sequence[Opener], part_bytes: int) -> None:
        self._parts, self._part_bytes, self._position = parts, part_bytes, 0
        self._number, self._surplus = -1, 0
        self._context: AbstractContextManager[Source] | None = None
        self.warnings: tuple[str, ...] = ()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        if self._context is not None:
            self._context.__exit__(None, None, None)
            self._context = None

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

    def rest(self, expected: int = 0) -> int:
        """How many bytes the parts have beyond what they should; all have been read."""
        self._leave()
        return self._surplus

    def _next(self, count: int) -> tuple[Source, int]:
        number, inside = divmod(self._position, self._part_bytes)
        if number != self._number:
            self._leave()
            self._context = self._parts[number]()
            self._part, self._number = self._context.__enter__(), number
        step = min(count, self._part_bytes - inside)
        self._position += step
        return self._part, step

    def _leave(self) -> None:
        """Close the part that is open, and keep what it has to say."""
        if self._context is not None:
            self._surplus += self._part.rest()
            self.warnings += self._part.warnings
            self.__exit__()


class Decoded:
    """Bytes that are in memory already; `promised_bytes` of them are expected."""

    warnings: tuple[str, ...] = ()

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

    def rest(self, expected: int = 0) -> int:
        """How many bytes are left."""
        return len(self._content) - self._position
