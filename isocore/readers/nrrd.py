"""Read NRRD: .nrrd with its samples behind the header, .nhdr with its samples in files beside it.

Encodings raw, gzip, bzip2, text and hex. World is what the header says: RAS, LAS, LPS, or its own ("native").
"""

from __future__ import annotations

import binascii
import re
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from isocore.errors import InputError
from isocore.readers import nrrd_header
from isocore.readers.joined import Decoded, Joined
from isocore.readers.layout import Layout, chosen, load
from isocore.readers.members import Packing
from isocore.readers.nrrd_axes import TEXT_ENCODINGS, axes_of, placement
from isocore.readers.nrrd_header import LIST, Head
from isocore.readers.options import ReadOptions
from isocore.readers.packed import Packed, Source
from isocore.readers.pointers import absence_beside
from isocore.readers.sample_types import contourable
from isocore.volume import Volume

_PACKINGS: dict[str, Packing] = {
    "raw": "none",
    "gzip": "gzip",
    "gz": "gzip",
    "bzip2": "bzip2",
    "bz2": "bzip2",
}
#: data file: a name with one printf place for a number, first, last, step, and the axes in each.
_NUMBERED = re.compile(r"[^%\s]*%0?\d?[du][^%\s]*(\s+-?\d{1,400}){3,4}")
#: So many of them are looked for before the header is known to be sound, and so many in a row that are not there: a
#: damaged one may number billions.
_MOST_FILES, _MOST_MISSING = 1 << 16, 1 << 8
#: What stands before the samples of a packed file whose last bytes they are is no longer than this, or than they.
_LONGEST_PREAMBLE = 1 << 26


def read_nrrd(path: Path, options: ReadOptions) -> Volume:
    """The volume of a NRRD file; `path` is its .nrrd or its .nhdr."""
    head = nrrd_header.parsed(path)
    axes = axes_of(head)
    place = placement(head, axes)
    volume = chosen(axes.layout, options.volume)
    files = _files(path, head, axes.layout)
    parts = [partial(_opened, file, start, head, axes.layout, parts=len(files)) for file, start in files]
    whole = Joined(parts, axes.layout.total_bytes // len(parts)) if len(parts) > 1 else parts[0]()
    with whole as source:
        samples: Any = load(source, axes.layout, volume)
        surplus = source.rest() if axes.layout.ends_with(volume) else 0
        behind = source.warnings
    samples, warnings = contourable(samples)
    warnings += behind
    if surplus:
        warnings += (f"has {surplus:,} bytes more than its header describes; check its byte skip",)
    return Volume(samples, affine=place.affine, space=place.space, unit=place.unit, warnings=warnings)


def count_nrrd(path: Path, options: ReadOptions) -> int:
    """How many volumes the file holds."""
    return axes_of(nrrd_header.parsed(path)).layout.volumes


def nrrd_files(path: Path) -> tuple[Path, ...]:
    """The files that hold the samples of a .nhdr, as far as they are there; also where its header is damaged."""
    if not path.name.lower().endswith(".nhdr"):
        return ()
    found: list[Path] = []
    missing = 0
    for name in islice(_names(nrrd_header.data_files_of(path)), _MOST_FILES):
        if (file := path.parent / name).is_file():
            found.append(file)
            missing = 0
        elif (missing := missing + 1) > _MOST_MISSING:
            break
    return tuple(found)


def _files(path: Path, head: Head, layout: Layout) -> list[tuple[Path, int]]:
    """The files that hold the samples, in order, and the byte of each at which they may start."""
    if "data file" not in head.fields:
        return [(path, head.size)]
    files = []
    for name in _names(head, most=layout.total_bytes):
        files.append(path.parent / name)
        if not files[-1].is_file():  # before the next name is made: a damaged header may number billions
            raise InputError(f"its samples are missing: {absence_beside(files[-1])}")
    if not files:
        raise InputError("its samples are missing: no data file beside it; put it there")
    if layout.total_bytes % len(files):
        raise InputError(f"header spreads {layout.total_bytes:,} bytes unevenly over {len(files)} files; mend it")
    return [(file, 0) for file in files]


def _names(head: Head, *, most: int | None = None) -> Iterator[str]:
    """The names of the data files, in order. most: of numbered ones."""
    named = head.fields.get("data file", "")
    if LIST.fullmatch(named):
        yield from head.files
    elif _NUMBERED.fullmatch(named):
        pattern, *numbers = named.split()
        yield from (pattern % number for number in _numbers(*map(int, numbers[:3]), most=most))
    else:
        yield named


def _numbers(first: int, last: int, step: int, *, most: int | None) -> range:
    numbers = range(first, last + (1 if step > 0 else -1), step or 1)
    count = max(0, (numbers.stop - numbers.start + numbers.step - (1 if numbers.step > 0 else -1)) // numbers.step)
    if not count or (most is not None and count > most):
        raise InputError(f"header numbers {count} data files from {first} to {last}; mend it")
    return numbers


def _opened(file: Path, start: int, head: Head, layout: Layout, *, parts: int) -> AbstractContextManager[Source]:
    """One data file, ready to hand out its share of the samples' bytes; it is closed by leaving its context."""
    share_bytes = layout.total_bytes // parts
    lines, skipped = _skips(head)
    start = _after_lines(file, start, lines)
    encoding = head.need("encoding").lower()
    if encoding in (*TEXT_ENCODINGS, "hex"):
        return nullcontext(Decoded(_from_text(file, start + skipped, encoding, layout), share_bytes))
    if encoding not in _PACKINGS:
        raise InputError(f"header names the encoding {encoding[:20]!a}, which cannot be read; use raw or gzip")
    subject = f"{file.name} " if "data file" in head.fields else ""
    source = Packed(file, packing=_PACKINGS[encoding], start=start, subject=subject)
    try:
        if skipped < 0:
            skipped = _bytes_before(source, share_bytes)
        source.promise(max(skipped, 0) + share_bytes, kept_bytes=layout.volume_bytes)
        source.skip(skipped)
    except BaseException:
        source.__exit__()
        raise
    return source


def _bytes_before(source: Packed, share_bytes: int) -> int:
    """Of a packed file, how many bytes of content come before its last `share_bytes`."""
    most = 2 * share_bytes + _LONGEST_PREAMBLE
    held = source.content_bytes(most=most)
    if held > most and source.is_packed:
        raise InputError(
            f"inflates to more than {most:,} bytes, of which its last {share_bytes:,} are samples; check its byte skip"
        )
    return max(held - share_bytes, 0)  # of a file that ends early it is told where it does


def _skips(head: Head) -> tuple[int, int]:
    """Lines to skip before unpacking, and bytes to skip after it; -1: the samples are the last bytes."""
    lines, skipped = (int(head.fields.get(name, 0)) for name in ("line skip", "byte skip"))
    if lines < 0 or skipped < -1:
        raise InputError(f"header skips {lines} lines and {skipped} bytes, which is not possible; mend it")
    return lines, skipped


def _after_lines(file: Path, start: int, lines: int) -> int:
    with file.open("rb") as text:
        text.seek(start)
        for _ in range(lines):
            if not text.readline():
                raise InputError(f"header skips {lines} lines of {file.name}, which has fewer; mend it")
        return text.tell()


def _from_text(file: Path, start: int, encoding: str, layout: Layout) -> bytes:
    """The samples' bytes of a text or hex encoding."""
    with file.open("rb") as text:
        text.seek(min(max(start, 0), file.stat().st_size))
        written = text.read().split()
    try:
        if encoding == "hex":
            return binascii.unhexlify(b"".join(written))
        return np.array(written, dtype=np.bytes_).astype(layout.dtype).tobytes()
    except (ValueError, OverflowError):
        raise InputError(f"text is no list of {layout.dtype.name} samples; check its encoding and type") from None
