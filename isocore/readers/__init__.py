"""From a file to a field, and what is known of a file before it is read. The formats are rows of formats.py."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from isocore.errors import InputError, IsocoreError, about, reading
from isocore.readers.formats import BY_SUFFIX, SEARCHED, Field, Format
from isocore.readers.options import ReadOptions
from isocore.readers.packed import unpacked_bytes

if TYPE_CHECKING:
    from isocore.readers.vtk_fields import FieldInfo


def suffix_of(path: os.PathLike[str] | str) -> str | None:
    """The longest known suffix that `path` ends in, in either case; None where there is none."""
    name = Path(path).name.lower()
    return max((suffix for suffix in BY_SUFFIX if name.endswith(suffix)), key=len, default=None)


def read(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> Field:
    """The field in `path`. Every refusal is an IsocoreError whose message starts with the path."""
    with _named(path):
        return _format(path).read(Path(path), options or ReadOptions())


def count_volumes(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> int:
    """How many volumes `path` holds, by its header; 1 for a mesh."""
    with _named(path):
        return _format(path).count(Path(path), options or ReadOptions())


def offered_fields(path: os.PathLike[str] | str) -> tuple[FieldInfo, ...]:
    """What a mesh offers to contour, fields of points before those of cells; () for a volume."""
    with _named(path):
        return _format(path).fields(Path(path))


def files_of(path: Path) -> tuple[Path, ...]:
    """`path`, then the files beside it that belong to it: detached samples, a sidecar.

    Never an error: where the file cannot tell, `path` stands alone, and reading it will say why.
    """
    suffix = suffix_of(path)
    try:
        odd = path.exists() and not path.is_file()  # a pipe would be waited for
        return (path,) if odd or suffix is None else (path, *BY_SUFFIX[suffix].files(path))
    except (IsocoreError, OSError, ValueError, OverflowError):
        return (path,)


def content_bytes(path: Path) -> int:
    """A guess at the bytes of an input with all that belongs to it, unpacked, by what costs no reading."""
    return sum(unpacked_bytes(file) for file in files_of(path))


def _format(path: os.PathLike[str] | str) -> Format:
    if Path(path).is_dir():
        raise InputError("is a folder, not a file; name the file inside it")
    suffix = suffix_of(path)
    if suffix is None:
        raise InputError(f"has no suffix known here; known are {', '.join(SEARCHED)}")
    found = Path(path).stat()
    if not stat.S_ISREG(found.st_mode):
        raise InputError("is a pipe or a device, not a file; write what it holds to a file first")
    if not found.st_size:
        raise InputError("is empty; copy it again")
    return BY_SUFFIX[suffix]


@contextmanager
def _named(path: os.PathLike[str] | str) -> Iterator[None]:
    """Errors from below, with the path in front where it is not there yet."""
    name = os.fspath(path)
    with reading(path):
        try:
            yield
        except IsocoreError as error:
            if about(name, error) == str(error):
                raise
            raise type(error)(about(name, error)) from error


__all__ = [
    "SEARCHED",
    "ReadOptions",
    "content_bytes",
    "count_volumes",
    "files_of",
    "offered_fields",
    "read",
    "suffix_of",
]
