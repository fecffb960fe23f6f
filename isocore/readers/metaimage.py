"""Read MetaImage: .mha with its samples behind the header, .mhd with its samples in files beside it.

Binary, packed with zlib or gzip, or text; in one file, numbered files or a list of them. World is LPS, in mm.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from isocore.arrays import contourable
from isocore.errors import InputError
from isocore.readers import metaimage_header
from isocore.readers.joined import Decoded, Joined
from isocore.readers.layout import Layout, chosen, load
from isocore.readers.members import MAGIC, Packing
from isocore.readers.metaimage_header import Head, layout_of, placement
from isocore.readers.options import ReadOptions
from isocore.readers.packed import Packed, Source
from isocore.readers.pointers import absence_beside
from isocore.volume import Volume

#: A name with one printf place for a number, then first, last and step.
_NUMBERED = re.compile(
    r"(?P<pattern>[^%]*%0?\d?[diu][^%]*?)\s+(?P<first>\d{1,18})\s+(?P<last>\d{1,18})(\s+(?P<step>\d{1,18}))?"
)
#: So many files are looked for before the header is known to be sound.
_MOST_FILES = 1 << 16


def read_metaimage(path: Path, options: ReadOptions) -> Volume:
    """The volume of a MetaImage; `path` is its .mha or its .mhd."""
    head = metaimage_header.parsed(path)
    layout = layout_of(head)
    place = placement(head)
    volume = chosen(layout, options.volume)
    files = _files(path, head)
    if not files or layout.total_bytes % len(files):
        raise InputError(f"header spreads {layout.total_bytes:,} bytes unevenly over {len(files)} files; mend it")
    share = layout.total_bytes // len(files)
    parts = [partial(_opened, file, start, head, layout, share) for file, start in files]
    if len(parts) > 1:
        with parts[0]():  # which is refused before anything is allocated, where the header promises too much
            pass
    with Joined(parts, share) if len(parts) > 1 else parts[0]() as source:
        samples: Any = load(source, layout, volume)
        surplus = source.rest() if layout.ends_with(volume) else 0
        behind = source.warnings
    samples, lost = contourable(samples)
    warnings = place.warnings + lost + behind
    if surplus:
        warnings += (f"has {surplus:,} bytes more than its header describes; check its HeaderSize and ElementType",)
    return Volume(samples, affine=place.affine, space=place.space, unit=place.unit, warnings=warnings)


def count_metaimage(path: Path, options: ReadOptions) -> int:
    """How many volumes the file holds: times, or values at a voxel."""
    return layout_of(metaimage_header.parsed(path)).volumes


def metaimage_files(path: Path) -> tuple[Path, ...]:
    """The files that hold the samples, as far as they are there."""
    found = (path.parent / name for name in islice(_names(metaimage_header.parsed(path)), _MOST_FILES))
    return tuple(file for file in found if file.is_file())


def _files(path: Path, head: Head) -> list[tuple[Path, int]]:
    """The files that hold the samples, in order, and the byte of each at which they may start."""
    if head.need("ElementDataFile").upper() == "LOCAL":
        return [(path, head.size)]
    files = []
    for name in islice(_names(head), _MOST_FILES):  # one at a time: a number may stand for very many
        file = path.parent / name
        if file == path:
            raise InputError("header names itself as the file of its samples; it is damaged")
        if not file.is_file():
            raise InputError(f"its samples are missing: {absence_beside(file)}")
        files.append((file, 0))
    return files


def _names(head: Head) -> Iterator[str]:
    """The names of the data files, in order; none where the samples follow the header."""
    named = head.need("ElementDataFile")
    if head.files or named.upper().startswith("LIST"):
        yield from head.files
    elif match := _NUMBERED.fullmatch(named):
        numbers = range(int(match["first"]), int(match["last"]) + 1, max(int(match["step"] or 1), 1))
        yield from (match["pattern"] % number for number in numbers)
    elif named.upper() != "LOCAL":
        yield named.replace("\\", os.sep)


def _opened(file: Path, start: int, head: Head, layout: Layout, share: int) -> AbstractContextManager[Source]:
    """One data file, ready to hand out its share of the samples' bytes; it is closed by leaving its context."""
    skipped = head.whole("HeaderSize", 1, [0.0])[0]
    if skipped < -1:
        raise InputError(f"header skips {skipped} bytes, which is not possible; mend it")
    if "binarydata" in head.fields and not head.says("BinaryData"):
        return nullcontext(Decoded(_from_text(file, start + max(skipped, 0), layout), share))
    packed = head.says("CompressedData")
    if skipped == -1 and not packed:
        start, skipped = max(start, file.stat().st_size - share), 0
    subject = "" if head.need("ElementDataFile").upper() == "LOCAL" else f"{file.name} "
    start += max(skipped, 0)
    if start > file.stat().st_size:
        raise InputError(f"{subject}ends early, before byte {start:,} where its samples start; copy it again")
    source = Packed(file, packing=_packing(file, start) if packed else "none", start=start, subject=subject)
    return _ready(source, share, layout)


def _packing(file: Path, start: int) -> Packing:
    """MetaIO writes zlib's format and reads gzip's too."""
    with file.open("rb") as opened:
        opened.seek(start)
        return "gzip" if opened.read(2) == MAGIC else "zlib"


def _ready(source: Packed, share: int, layout: Layout) -> Packed:
    try:
        source.promise(share, kept_bytes=layout.volume_bytes)
    except BaseException:
        source.__exit__()
        raise
    return source


def _from_text(file: Path, start: int, layout: Layout) -> bytes:
    """The samples' bytes of a file of numbers as text."""
    with file.open("rb") as text:
        text.seek(min(start, file.stat().st_size))
        written = text.read().split()
    try:
        return np.array(written, dtype=np.bytes_).astype(layout.dtype).tobytes()
    except (ValueError, OverflowError):
        raise InputError(f"text is no list of {layout.dtype.name} samples; check its ElementType") from None
