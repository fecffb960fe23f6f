"""From a file to a field: which function reads which suffix.

A format is a file in this folder and a row in READERS. The longest suffix wins.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeAlias

from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, IsocoreError, reading
from isocore.readers.nifti import count_nifti, read_nifti
from isocore.readers.nrrd import count_nrrd, read_nrrd
from isocore.readers.options import ReadOptions
from isocore.readers.raw import count_raw, read_raw
from isocore.volume import Volume

Reader: TypeAlias = Callable[[Path, ReadOptions], Volume | CellMesh]
Counter: TypeAlias = Callable[[Path, ReadOptions], int]


def _read_vtu(path: Path, options: ReadOptions) -> CellMesh:
    from isocore.readers.vtu import read_vtu

    return read_vtu(path, options)


READERS: dict[str, Reader] = {
    ".nii": read_nifti,
    ".nii.gz": read_nifti,
    ".hdr": read_nifti,
    ".hdr.gz": read_nifti,
    ".img": read_nifti,
    ".img.gz": read_nifti,
    ".nrrd": read_nrrd,
    ".nhdr": read_nrrd,
    ".raw": read_raw,
    ".raw.gz": read_raw,
    ".vtu": _read_vtu,
}

#: Formats that may hold several volumes, and who counts them.
_COUNTERS: dict[Reader, Counter] = {read_nifti: count_nifti, read_nrrd: count_nrrd, read_raw: count_raw}

#: What a folder is searched for: an .img is found through its .hdr.
SEARCHED = tuple(suffix for suffix in READERS if not suffix.startswith(".img"))


def suffix_of(path: os.PathLike[str] | str) -> str | None:
    """The longest suffix of READERS that `path` ends in, in either case; None where there is none."""
    name = Path(path).name.lower()
    return max((suffix for suffix in READERS if name.endswith(suffix)), key=len, default=None)


def read(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> Volume | CellMesh:
    """The field in `path`. Every refusal is an IsocoreError whose message starts with the path."""
    with _named(path):
        return _reader(path)(Path(path), options or ReadOptions())


def count_volumes(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> int:
    """How many volumes `path` holds, by its header; 1 for a mesh."""
    with _named(path):
        counter = _COUNTERS.get(_reader(path))
        return counter(Path(path), options or ReadOptions()) if counter else 1


def _reader(path: os.PathLike[str] | str) -> Reader:
    if Path(path).is_dir():
        raise InputError("is a folder, not a file; name the file inside it")
    suffix = suffix_of(path)
    if suffix is None:
        raise InputError(f"has no suffix known here; known are {', '.join(SEARCHED)}")
    if not Path(path).exists():
        raise InputError("no such file; check the path")
    if not Path(path).stat().st_size:
        raise InputError("is empty; copy it again")
    return READERS[suffix]


@contextmanager
def _named(path: os.PathLike[str] | str) -> Iterator[None]:
    """Errors from below, with the path in front where it is not there yet."""
    name = os.fspath(path)
    with reading(path):
        try:
            yield
        except IsocoreError as error:
            if str(error).startswith(f"{name}:"):
                raise
            raise type(error)(f"{name}: {error}") from error


__all__ = ["READERS", "SEARCHED", "ReadOptions", "count_volumes", "read", "suffix_of"]
