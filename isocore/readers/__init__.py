"""From a file to a field, and what is known of a file before it is read. The formats are rows of formats.py."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from isocore.errors import InputError, IsocoreError, about, reading
from isocore.late import late
from isocore.readers.carried_volumes import carried_files, with_carried
from isocore.readers.formats import BY_SUFFIX, SEARCHED, Field, Format
from isocore.readers.ignored import without_ignored
from isocore.readers.options import ReadOptions
from isocore.readers.packed import unpacked_bytes
from isocore.readers.pointers import absence, pointer
from isocore.volume import Volume

if TYPE_CHECKING:
    from isocore.readers.vtk_fields import FieldInfo


T = TypeVar("T")
_Named = tuple[Format, str]
#: What a file is whose suffix does not tell; most suffixes do.
_readable_as: Callable[..., _Named | None] = late("readers.strangers", "readable_as")
_what_it_is: Callable[..., str | None] = late("readers.strangers", "what_it_is")
#: Of files without a header the content cannot tell what they are.
_BARE = (".raw", ".raw.gz")


def suffix_of(path: os.PathLike[str] | str) -> str | None:
    """The longest known suffix that `path` ends in, in either case; None where there is none."""
    name = Path(path).name.lower()
    return max((suffix for suffix in BY_SUFFIX if name.endswith(suffix)), key=len, default=None)


def read(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> Field:
    """The field in `path`. Every refusal is an IsocoreError whose message starts with the path.

    Where the suffix is not known or wrong, the content decides, and a warning says so.
    """
    options = options or ReadOptions()
    with _named(path):
        field, remark = _used(Path(path), lambda form: form.read(Path(path), options))
        if remark:
            field = replace(field, warnings=(remark, *field.warnings))
        if options.carry and isinstance(field, Volume):
            field = with_carried(field, Path(path), options, count_volumes, read)
        return without_ignored(field, options.ignore) if options.ignore and isinstance(field, Volume) else field


def count_volumes(path: os.PathLike[str] | str, options: ReadOptions | None = None) -> int:
    """How many volumes `path` holds, by its header; 1 for a mesh."""
    with _named(path):
        return _used(Path(path), lambda form: form.count(Path(path), options or ReadOptions()))[0]


def offered_fields(path: os.PathLike[str] | str) -> tuple[FieldInfo, ...]:
    """What a mesh offers to contour, fields of points before those of cells; () for a volume."""
    with _named(path):
        return _used(Path(path), lambda form: form.fields(Path(path)))[0]


def times_of(path: os.PathLike[str] | str) -> tuple[float, ...]:
    """The times of a series' steps, ascending; () for a file that is none."""
    with _named(path):
        return _used(Path(path), lambda form: form.times(Path(path)))[0]


def files_of(path: Path, step: int | None = None) -> tuple[Path, ...]:
    """`path`, then the files beside it that belong to it: detached samples, a sidecar; of a series those of one step.

    Never an error: where the file cannot tell, `path` stands alone, and reading it will say why.
    """
    suffix = suffix_of(path)
    try:
        if path.exists() and not path.is_file():  # a pipe would be waited for
            return (path,)
        found = (BY_SUFFIX[suffix], "") if suffix else _readable_as(path, BY_SUFFIX)
        if found is None:
            return (path,)
        form = found[0]
        if step is not None and form.step_files is not None:
            return (path, *form.step_files(path, step))
        return (path, *form.files(path))
    except Exception:  # whatever a damaged header leads to
        return (path,)


def listed_files(path: Path) -> tuple[Path, ...]:
    """The files that `path` lists as its pieces or steps: fields of their own, which it stands for. Never an error."""
    suffix = suffix_of(path)
    return files_of(path)[1:] if suffix is not None and BY_SUFFIX[suffix].lists else ()


def lists_surfaces(path: Path) -> bool:
    """Whether a file is a list of surfaces, such as isocore writes beside those of a series. Never an error."""
    if suffix_of(path) != ".pvd":
        return False
    from isocore.readers.series import lists_surfaces as lists  # late: most folders hold no series

    return lists(path)


def stranger_of(path: Path) -> str | None:
    """What a file or a folder of an unknown suffix is, and what to do about it; None where nothing is known."""
    return _what_it_is(path, BY_SUFFIX, None) if suffix_of(path) is None else None


def content_bytes(path: Path, step: int | None = None) -> int:
    """A guess at the bytes of an input with all that belongs to it, unpacked, by what costs no reading."""
    return sum(unpacked_bytes(file) for file in files_of(path, step))


def _used(path: Path, use: Callable[[Format], T]) -> tuple[T, str]:
    """What the format of `path` makes of it, and a remark where its content named the format and not its suffix."""
    _check_file(path)
    suffix = suffix_of(path)
    if suffix is None:
        found = _readable_as(path, BY_SUFFIX)
        if found is None:
            known = f"has no suffix known here; known are {', '.join(SEARCHED)}"
            raise InputError(_what_it_is(path, BY_SUFFIX, None) or known)
        return use(found[0]), f"has no suffix known here; its content is {found[1]}, and was read as that"
    try:
        return use(BY_SUFFIX[suffix]), ""
    except InputError:
        found = None if suffix in _BARE else _readable_as(path, BY_SUFFIX, BY_SUFFIX[suffix])
        if found is None:
            raise
    return use(found[0]), f"ends in {suffix}, but its content is {found[1]}, and was read as that"


def _check_file(path: Path) -> None:
    if path.is_dir():
        raise InputError("is a folder, not a file; name the file inside it")
    if not path.exists():
        raise InputError(absence(path))
    found = path.stat()
    if not stat.S_ISREG(found.st_mode):
        raise InputError("is a pipe or a device, not a file; write what it holds to a file first")
    if not found.st_size and suffix_of(path) is not None:
        raise InputError("is empty; copy it again")


@contextmanager
def _named(path: os.PathLike[str] | str) -> Iterator[None]:
    """Errors from below, with the path in front where it is not there yet."""
    name = os.fspath(path)
    with reading(path):
        try:
            yield
        except IsocoreError as error:
            if stranger := _stranger(Path(path), error):
                raise InputError(f"{name}: {stranger}") from error
            if about(name, error) == str(error):
                raise
            raise type(error)(about(name, error)) from error


def _stranger(path: Path, error: IsocoreError) -> str | None:
    """What was tried to be read, where it is something else than its suffix says, or what belongs to it is."""
    suffix = suffix_of(path)
    bare = suffix in _BARE
    if suffix is None or not path.is_file() or not (isinstance(error, InputError) or bare):
        return None
    if found := _what_it_is(path, BY_SUFFIX, BY_SUFFIX[suffix], bare=bare):
        return found
    beside = ((file, pointer(file)) for file in files_of(path)[1:])
    return next((f"its file {file.name} {found}" for file, found in beside if found), None)


__all__ = [
    "SEARCHED",
    "ReadOptions",
    "carried_files",
    "content_bytes",
    "count_volumes",
    "files_of",
    "listed_files",
    "lists_surfaces",
    "offered_fields",
    "read",
    "stranger_of",
    "suffix_of",
    "times_of",
]
