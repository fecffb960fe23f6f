"""Turn the arrays of a VTU file into numpy arrays, one at a time and only those that are asked for."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from mmap import mmap
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.vtu_blocks import BadBlock, Segments, payload
from isocore.readers.vtu_file import StoredFile, Stretch
from isocore.readers.vtu_layout import ArrayTag, Layout
from isocore.readers.vtu_words import floats, integers

DTYPES = {
    **{f"Int{bits}": f"i{bits // 8}" for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": f"u{bits // 8}" for bits in (8, 16, 32, 64)},
    **{f"Float{bits}": f"f{bits // 8}" for bits in (32, 64)},
}
#: Arrays may share bytes, as long as no more than this comes of it.
_MOST_SHARED = 1 << 26
_TEXT = re.compile(rb"\S")


@dataclass(slots=True)
class _Used:
    """What arrays have taken so far: letters of the file, and bytes of numbers that came of them."""

    letters: int = 0
    unpacked: int = 0

    def add(self, letters: int, unpacked: int, held: int) -> None:
        """BadBlock where arrays share so much of the file's `held` bytes that a small one fills the memory."""
        self.letters += letters
        self.unpacked += unpacked
        if self.letters > held and self.unpacked > _MOST_SHARED:
            raise BadBlock(
                f"shares its bytes with others: so far {self.letters:,} were taken of a file of {held:,};"
                " write each array once"
            )


@dataclass(frozen=True, slots=True)
class ArrayReader:
    """Reads the arrays of one VTU file. file: where its appended data are; None where they lie in `data`, too."""

    path: str
    data: mmap | bytes
    layout: Layout
    file: StoredFile | None = None
    used: _Used = field(default_factory=lambda: _Used())

    def read(self, tag: ArrayTag, values: int | None = None) -> npt.NDArray[Any]:
        """The array's numbers, flat, in the file's type and byte order; `values`: how many it has to hold.

        The result may look into `data`: copy what is to outlive it.
        """
        try:
            numbers = self._ascii(tag) if tag.format == "ascii" else self._binary(tag)
            if values is not None and len(numbers) != values:
                raise BadBlock(
                    f"holds {len(numbers):,} numbers where its piece promises {values:,}; copy the file again"
                )
        except BadBlock as error:
            raise InputError(f"{self.path}: array {tag.name!r} {error}") from error
        return numbers

    def _dtype(self, tag: ArrayTag) -> np.dtype[Any]:
        if tag.type not in DTYPES:
            raise BadBlock(f"has type {tag.type!r}; one of {', '.join(DTYPES)} is needed")
        return np.dtype(self._order() + DTYPES[tag.type])

    def _order(self) -> str:
        return "<" if self.layout.byte_order == "LittleEndian" else ">"

    def _binary(self, tag: ArrayTag) -> npt.NDArray[Any]:
        dtype = self._dtype(tag)
        if tag.format == "binary":
            text: memoryview | Stretch = self._inline(tag)
            base64 = True
        elif tag.format == "appended":
            text, base64 = self._appended(tag)
        else:
            raise BadBlock(f"has format {tag.format!r}; ascii, binary or appended is needed")
        header = np.dtype(self._order() + DTYPES[self.layout.header_type])
        segments = Segments(text, header, base64=base64)
        block = payload(segments, self.layout.compressor)
        self.used.add(segments.position, len(block), self.file.size if self.file else len(self.data))
        if len(block) % dtype.itemsize:
            raise BadBlock(
                f"has {len(block):,} bytes, which is no multiple of {dtype.itemsize}; copy the file again"
            )
        return np.frombuffer(block, dtype)

    def _inline(self, tag: ArrayTag) -> memoryview:
        """The base64 letters between the tags, without white space."""
        first, end = tag.text
        found = _TEXT.search(self.data, first, end)
        if found is None:
            return memoryview(b"")
        first = found.start()
        tail = self.data[max(first, end - 4096) : end]
        end -= len(tail) - len(tail.rstrip())
        if any(self.data.find(space, first, end) >= 0 for space in (b"\n", b" ", b"\t", b"\r")):
            return memoryview(self.data[first:end].translate(None, b" \t\r\n"))
        return memoryview(self.data)[first:end]

    def _appended(self, tag: ArrayTag) -> tuple[memoryview | Stretch, bool]:
        if self.layout.appended is None or tag.offset is None:
            raise BadBlock("is said to be appended, but the file has no appended data for it; copy it again")
        encoding, start = self.layout.appended
        if encoding not in ("raw", "base64"):
            raise BadBlock(f"is appended as {encoding!r}; raw or base64 is needed")
        first = start + tag.offset
        return Stretch(self.file, first) if self.file else memoryview(self.data)[first:], encoding == "base64"

    def _ascii(self, tag: ArrayTag) -> npt.NDArray[Any]:
        dtype = self._dtype(tag).newbyteorder("=")
        first, end = tag.text
        if dtype.kind == "f":
            with np.errstate(over="ignore"):  # what is no float32 becomes infinite
                return floats(self.data, first, end).astype(dtype, copy=False)
        numbers = integers(self.data, first, end)
        limits = np.iinfo(dtype)
        if dtype.itemsize < 8 and numbers.size and (numbers.min() < limits.min or numbers.max() > limits.max):
            raise BadBlock(f"holds a number that is no {tag.type}; copy the file again")
        return numbers.astype(dtype, copy=False)
