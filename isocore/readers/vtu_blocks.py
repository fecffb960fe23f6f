"""Take the bytes of one array block out of a VTU file: raw or base64, plain or compressed.

A block is a header of unsigned integers, then bytes. Plain: one integer, the byte count. Compressed: the
number of parts, their inflated size, the last one's if it is shorter (else 0), then every part's deflated
size. VTK encodes header and bytes in base64 one after the other, other programs in one go; `Segments` follows
both.
"""

from __future__ import annotations

import binascii
import importlib
import lzma
import os
import zlib
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from itertools import accumulate
from types import ModuleType
from typing import Protocol

import numpy as np
import numpy.typing as npt

from isocore.errors import one_line

fast_zlib: ModuleType = zlib
with suppress(ImportError):  # no wheel for this machine
    from isal import isal_zlib as fast_zlib

Inflate = Callable[[memoryview, int], bytes]

#: No stream of these formats grows further than this when it is inflated: a header that promises more lies,
#: and nothing is reserved for it.
LARGEST_RATIO = {"vtkZLibDataCompressor": 1100, "vtkLZMADataCompressor": 1 << 15, "vtkLZ4DataCompressor": 260}


_PARTS_AT_ONCE = 256
#: The highest level of LZMA asks for 65 MiB.
_LZMA_MEMORY = 1 << 28


class BadBlock(Exception):
    """A block that is not what its header says; the text continues the sentence `array 'p' ...`."""


class Letters(Protocol):
    """Bytes that can be asked for in part, as a memoryview or as what lies on the disk."""

    def __len__(self) -> int: ...
    def __getitem__(self, part: slice, /) -> memoryview: ...


class Segments:
    """Takes one segment after the other from the text of a block.

    text: from the block's first byte on, possibly far beyond its end.
    header: dtype of the header's integers.
    """

    def __init__(self, text: Letters, header: np.dtype[np.unsignedinteger], *, base64: bool) -> None:
        self.text = text
        self.header = header
        self.base64 = base64
        self.position = 0
        self.carry = (
            b""  # decoded, but of the next segment: it shares a group of four letters with the last one
        )

    def integers(self, count: int) -> npt.NDArray[np.unsignedinteger]:
        return np.frombuffer(self.take(count * self.header.itemsize), self.header)

    def take(self, size: int) -> memoryview:
        """The next `size` bytes."""
        if not self.base64:
            return memoryview(self._letters(size, size))
        carry, wanted = self.carry, size - len(self.carry)
        if wanted <= 0:
            self.carry = carry[size:]
            return memoryview(carry[:size])
        try:
            decoded = binascii.a2b_base64(self._letters(-(-wanted // 3) * 4, size))
        except binascii.Error:
            decoded = b""
        if len(decoded) < wanted:
            raise BadBlock("has damaged base64; copy the file again")
        self.carry = decoded[wanted:]
        return memoryview(carry + decoded)[:size] if carry else memoryview(decoded)[:size]

    def _letters(self, count: int, size: int) -> memoryview:
        left = len(self.text) - self.position
        if count > left:
            raise BadBlock(f"ends early ({left:,} of {count:,} bytes); copy the file again")
        self.position += count
        return self.text[self.position - count : self.position]


def payload(segments: Segments, compressor: str) -> memoryview:
    """The bytes of a block behind its header, inflated where the file is compressed."""
    if not compressor:
        return segments.take(int(segments.integers(1)[0]))
    inflate = _inflater(compressor)
    parts = int(segments.integers(1)[0])
    if parts == 0:
        return memoryview(b"")
    full, last = segments.integers(2).tolist()
    sizes = segments.integers(parts).tolist()
    wanted = [full] * (parts - 1) + [last or full]
    total, deflated = sum(wanted), sum(sizes)
    if total > LARGEST_RATIO[compressor] * (deflated + 64):
        raise BadBlock(
            f"promises {total:,} bytes, more than {deflated:,} can inflate to; copy the file again"
        )
    packed = segments.take(deflated)
    ends = list(accumulate(sizes))
    slices = [packed[end - size : end] for end, size in zip(ends, sizes, strict=True)]
    result = memoryview(np.empty(total, np.uint8).data)
    position = 0
    for inflated in _inflate_all(inflate, slices, wanted, threads=_threads(compressor)):
        result[position : position + len(inflated)] = inflated
        position += len(inflated)
    return result


def _inflate_all(
    inflate: Inflate, parts: list[memoryview], wanted: list[int], *, threads: int
) -> Iterator[bytes]:
    """Every part, inflated to exactly the size wanted, in order."""

    def one(part: memoryview, size: int) -> bytes:
        try:
            inflated = inflate(part, size)
        except MemoryError:
            raise
        except Exception as error:
            raise BadBlock(f"is damaged or ends early ({one_line(error)}); copy the file again") from error
        if len(inflated) != size:
            raise BadBlock(f"inflates to another size than the {size:,} bytes promised; copy the file again")
        return inflated

    if threads == 1:
        yield from map(one, parts, wanted)
        return
    with ThreadPoolExecutor(threads) as pool:
        for first in range(0, len(parts), _PARTS_AT_ONCE):
            batch = slice(first, first + _PARTS_AT_ONCE)
            yield from pool.map(one, parts[batch], wanted[batch])


def _threads(compressor: str) -> int:
    """LZMA takes milliseconds per part and is worth a thread; for the others the hand-over costs as much."""
    return min(4, os.cpu_count() or 1) if compressor == "vtkLZMADataCompressor" else 1


def _inflated_zlib(part: memoryview, wanted: int) -> bytes:
    """No longer than wanted + 1: `decompress` itself takes its size for a hint only."""
    inflater = fast_zlib.decompressobj(zlib.MAX_WBITS)
    inflated: bytes = inflater.decompress(part, wanted + 1)
    if not inflater.eof and len(inflated) <= wanted:
        raise EOFError("its zlib stream is cut")
    return inflated


def _inflated_lzma(part: memoryview, wanted: int) -> bytes:
    inflater = lzma.LZMADecompressor(memlimit=_LZMA_MEMORY)
    inflated = inflater.decompress(part, wanted + 1)
    if not inflater.eof and len(inflated) <= wanted:
        raise EOFError("its LZMA stream is cut")
    return inflated


def _inflater(compressor: str) -> Inflate:
    """inflate(part, wanted): the bytes of a part; of those beyond `wanted` one is enough to tell."""
    if compressor == "vtkZLibDataCompressor":
        return _inflated_zlib
    if compressor == "vtkLZMADataCompressor":
        return _inflated_lzma
    if compressor != "vtkLZ4DataCompressor":
        raise BadBlock(f"is compressed with {compressor}, which is unknown; write the file with zlib")
    try:
        lz4 = importlib.import_module("lz4.block")
    except ImportError:
        raise BadBlock(
            "is compressed with LZ4; install the Python package lz4, or write it with zlib"
        ) from None
    return lambda part, wanted: lz4.decompress(part, uncompressed_size=wanted)
