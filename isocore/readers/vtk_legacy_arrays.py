"""The numbers of a legacy VTK file: as text, or as big-endian bytes, one array after the other."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from mmap import mmap
from typing import Any
from urllib.parse import unquote

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.vtu_blocks import BadBlock
from isocore.readers.vtu_words import floats, integers

#: numpy's types; a C long has eight bytes, as on all systems but Windows.
TYPES = {
    "unsigned_char": "u1", "char": "i1", "signed_char": "i1", "unsigned_short": "u2", "short": "i2",
    "unsigned_int": "u4", "int": "i4", "unsigned_long": "u8", "long": "i8", "unsigned_long_long": "u8",
    "long_long": "i8", "vtkidtype": "i8", "vtktypeint64": "i8", "vtktypeuint64": "u8", "vtktypeint32": "i4",
    "vtktypeuint32": "u4", "float": "f4", "double": "f8",
}  # fmt: skip
#: A vtkIdType is written as an int.
_IN_FILES = {"vtkidtype": "i4"}
_WORD = re.compile(rb"\S+")
_CHUNK = 1 << 18


@dataclass(frozen=True, slots=True)
class Located:
    """An array of the file. kind: in VTK's words, lower case. count: of numbers; start, end: byte offsets."""

    name: str
    kind: str
    count: int
    start: int
    end: int

    @property
    def dtype(self) -> np.dtype[Any]:
        return np.dtype(_IN_FILES.get(self.kind) or TYPES[self.kind])


class Cursor:
    """A place in the file, which moves on as lines and arrays are taken; last: the name of the last array."""

    def __init__(self, path: str, data: mmap | bytes, start: int, *, binary: bool) -> None:
        self.path, self.data, self.place, self.binary = path, data, start, binary
        self.last = ""

    def at(self, keyword: str) -> bool:
        """Does the next line begin with this word?"""
        head = self.data[self.place : self.place + len(keyword) + 64]
        return head.lstrip()[: len(keyword)].upper() == keyword.encode()

    def words(self) -> list[str]:
        """The words of the next line that has any; none at the end of the file."""
        while self.place < len(self.data):
            end = self.data.find(b"\n", self.place)
            end = len(self.data) if end < 0 else end
            line = self.data[self.place : min(end, self.place + 4096)]
            self.place = end + 1
            if words := line.split():
                return [word.decode("utf-8", "replace") for word in words]
        return []

    def skip(self, name: str, kind: str, count: int) -> Located:
        """Where the next array lies, behind which the cursor then stands. kind: in VTK's words."""
        found = Located(name, kind.lower(), count, self.place, self.place)
        self.last = name
        if found.kind not in TYPES and found.kind not in ("bit", "string"):
            raise InputError(f"{self.path}: array {name!r} has type {kind[:40]!r}, none of VTK's; write it again")
        if found.kind == "string":
            self.place = self._behind_strings(count)
        elif not self.binary:
            self.place = self._behind_words(name, count)
        else:
            size = -(-count // 8) if found.kind == "bit" else count * found.dtype.itemsize
            left = max(0, len(self.data) - self.place)
            if size > left:
                raise InputError(f"{self.path}: array {name!r} ends early ({left:,} of {size:,} bytes); copy it again")
            self.place += size
        return replace(found, end=self.place)

    def read(self, found: Located) -> npt.NDArray[Any]:
        """The numbers of an array, flat; the result may look into the mapped file."""
        if found.kind in ("bit", "string"):
            raise InputError(f"{self.path}: array {found.name!r} holds {found.kind}s, not numbers; choose another")
        if self.binary:
            dtype = found.dtype.newbyteorder(">")
            return np.frombuffer(self.data, dtype, found.count, found.start) if found.count else np.empty(0, dtype)
        try:
            if found.dtype.kind == "f":
                with np.errstate(over="ignore"):  # beyond float32 is infinite
                    return floats(self.data, found.start, found.end).astype(found.dtype, copy=False)
            numbers = integers(self.data, found.start, found.end)
        except BadBlock as error:
            raise InputError(f"{self.path}: array {found.name!r} {error}") from error
        limits = np.iinfo(found.dtype)
        if found.dtype.itemsize < 8 and numbers.size and (numbers.min() < limits.min or numbers.max() > limits.max):
            raise InputError(f"{self.path}: array {found.name!r} holds a number that is no {found.kind}; correct it")
        return numbers.astype(found.dtype, copy=False)

    def _behind_words(self, name: str, count: int) -> int:
        """Where the line ends on which the last of so many words stands."""
        place, left = self.place, count
        while left:
            text = self.data[place : place + _CHUNK]
            if not text:
                held = f"{count - left:,} of {count:,} numbers"
                raise InputError(f"{self.path}: array {name!r} ends early ({held}); copy it again")
            if place + len(text) < len(self.data):  # a word may go on beyond the chunk
                cut = max(text.rfind(space) for space in (b" ", b"\n", b"\t", b"\r"))
                if cut < 0:
                    raise InputError(f"{self.path}: array {name!r} holds a word of {_CHUNK:,} letters; copy it again")
                text = text[:cut]
            words = len(text.split())
            if words >= left:
                for match in _WORD.finditer(text):
                    left -= 1
                    if not left:
                        return place + match.end()
            left -= words
            place += max(1, len(text))
        return place

    def _behind_strings(self, count: int) -> int:
        """In text one a line; in bytes each after its length, whose first two bits say how many bytes it has."""
        place = self.place
        for _ in range(count):
            if not self.binary:
                place = self.data.find(b"\n", place) + 1
                if not place:
                    raise InputError(f"{self.path}: ends inside an array of strings; copy it again")
                continue
            if place >= len(self.data):
                raise InputError(f"{self.path}: ends inside an array of strings; copy it again")
            size = 1 << (3 - (self.data[place] >> 6))
            length = int.from_bytes(self.data[place : place + size], "big") & ((1 << (8 * size - 2)) - 1)
            place += size + length
        return place


def plain_name(word: str) -> str:
    """A name as it was before VTK wrote it with % for blanks and the like."""
    return unquote(word)
