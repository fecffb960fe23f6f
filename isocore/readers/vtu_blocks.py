"""Take the bytes of one array block out of a VTU file: raw or base64, plain or compressed.

A block is a header of unsigned integers, then bytes. Plain: one integer, the byte count. Compressed: the number of
parts, their inflated size, the last one's if it is shorter (else 0), then every part's deflated size. VTK encodes
header and bytes in base64 one after the other, other programs in one go; `Segments` follows both.
"""

from __future__ import annotations

import binascii
import importlib
import lzma
import zlib
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

try:
    from isal import isal_zlib as fast_zlib
except ImportError:  # no wheel for this machine
    fast_zlib = zlib

Inflate = Callable[[memoryview, int], bytes]

#: No stream of these formats grows further than this when it is inflated: a header that promises more lies, and
#: nothing is reserved for it.
LARGEST_RATIO = {"vtkZLibDataCompressor": 1100, "vtkLZMADataCompressor": 1 << 15, "vtkLZ4DataCompressor": 260}


class BadBlock(Exception):
    """A block that is not what its header says; the text continues the sentence `array 'p' ...`."""


class Segments:
    """Takes one segment after the other from the text of a block.

    text: from the block's first byte on, possibly far beyond its end. header: dtype of the header's integers.
    """

    def __init__(self, text: memoryview, header: np.dtype[np.unsignedinteger], *, base64: bool) -> None:
        self.text = text
        self.header = header
        self.base64 = base64
        self.position = 0
        self.carry = b""  # decoded, but of the next segment: it shares a group of four letters with the last one

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
        decoded = binascii.a2b_base64(self._letters(-(-wanted // 3) * 4, size))
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
    parts = int(segments.integers(1)[0])
    if parts == 0:
        return memoryview(b"")
    full, last = segments.integers(2).tolist()
    sizes = segments.integers(parts).tolist()
    sizes_inflated = [full] * (parts - 1) + [last or full]
    total, deflated = sum(sizes_inflated), sum(sizes)
    if total > LARGEST_RATIO[compressor] * (deflated + 64):
        raise BadBlock(f"promises {total:,} bytes, more than its {deflated:,} can inflate to; copy the file again")
    packed = segments.take(deflated)
    inflate = _inflater(compressor)
    result = memoryview(np.empty(total, np.uint8))
    source = target = 0
    for size, wanted in zip(sizes, sizes_inflated, strict=True):
        inflated = inflate(packed[source : source + size], wanted)
        if len(inflated) != wanted:
            raise BadBlock(f"inflates to {len(inflated):,} bytes where {wanted:,} are promised; copy the file again")
        result[target : target + wanted] = inflated
        source, target = source + size, target + wanted
    return result


def missing_compressor(compressor: str) -> str:
    """Why `compressor` cannot be read here, or "": a sentence's end with what to do."""
    if compressor and compressor not in LARGEST_RATIO:
        return f"is compressed with {compressor}, which is unknown; write it with zlib or without compression"
    if compressor == "vtkLZ4DataCompressor":
        try:
            importlib.import_module("lz4.block")
        except ImportError:
            return "is compressed with LZ4; install the Python package lz4, or write the file with zlib"
    return ""


def _inflater(compressor: str) -> Inflate:
    """inflate(part, wanted): the part's bytes; no more than `wanted` + 1 are of interest."""
    if compressor == "vtkZLibDataCompressor":
        run: Inflate = lambda part, wanted: fast_zlib.decompress(part, 15, wanted + 1)  # noqa: E731
    elif compressor == "vtkLZMADataCompressor":
        run = lambda part, wanted: lzma.LZMADecompressor().decompress(part, wanted + 1)  # noqa: E731
    else:
        lz4 = importlib.import_module("lz4.block")
        run = lambda part, wanted: lz4.decompress(part, uncompressed_size=wanted)  # noqa: E731

    def inflate(part: memoryview, wanted: int) -> bytes:
        try:
            return run(part, wanted)
        except MemoryError:
            raise
        except Exception as error:
            raise BadBlock(f"is damaged or ends early ({' '.join(str(error).split())}); copy the file again") from error

    return inflate
