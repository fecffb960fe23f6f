"""What can go wrong, as a small tree.

    IsocoreError
      InputError     the file cannot be read, or is not what it says
      FieldError     it was read, but cannot be contoured
      OptionError    the request makes no sense
      OutputError    the result cannot be written

A message is one line: the path first, then what happened, then what to do. Whatever a file or its name brings into
it, it is printable and at most LONGEST characters; a report's `source` and `output` hold the paths as they are.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager

#: Characters of a message, and of a path that has to make room in one.
LONGEST = 300
_SHORTEST_PATH = 80
#: What Python makes of bytes of a name that are not in the system's encoding.
_STRAY_BYTES = frozenset(map(chr, range(0xDC80, 0xDD00)))


class IsocoreError(Exception):
    """Anything isocore refuses, with a message fit for a user: one printable line."""

    def __init__(self, message: object = "") -> None:
        super().__init__(shortened(message))


class InputError(IsocoreError):
    """The file cannot be read, or is not what it says."""


class FieldError(IsocoreError):
    """The field was read, but cannot be contoured."""


class OptionError(IsocoreError):
    """The request makes no sense."""


class OutputError(IsocoreError):
    """The result cannot be written."""


def printable(text: object, *, stray: bool = False) -> str:
    """The text on one line: what would move a cursor, turn a line around or end it is shown as its escape.

    stray: leave the bytes of a name that are no text (PEP 383) as they are, for a stream that gives them back.
    """
    found = str(text)
    if found.isprintable():
        return found
    return "".join(one if stray and one in _STRAY_BYTES else _shown(one) for one in found)


def shortened(text: object) -> str:
    """As printable, and cut to what a message may be: first inside its path, since the other end says what to do."""
    found = str(text)
    if len(found) > 4 * LONGEST:  # no megabyte is made printable first
        found = found[: 2 * LONGEST] + found[-2 * LONGEST :]
    found = printable(found)
    if len(found) <= LONGEST:
        return found
    path, colon, rest = found.partition(": ")
    return _cut(_cut(path, max(LONGEST - len(colon) - len(rest), _SHORTEST_PATH)) + colon + rest, LONGEST)


def about(path: object, text: object, *others: object) -> str:
    """The message with the path before it, unless it starts with that or one of the others already."""
    message = shortened(text)
    for known in (path, *others):
        start = printable(known)
        if message.startswith(f"{start}:" if len(start) <= _SHORTEST_PATH else start[: _SHORTEST_PATH // 3]):
            return message
    return shortened(f"{path}: {text}")


def told(path: object, error: BaseException) -> str:
    """The message of any error at all about a path; of one that nobody foresaw it has the type, for a report of it."""
    if isinstance(error, IsocoreError):
        return about(path, error)
    if isinstance(error, MemoryError):
        return about(path, "does not fit into memory; free some or crop the data")
    return about(path, f"internal error ({type(error).__name__}: {one_line(error)}); please report it")


def one_line(error: BaseException) -> str:
    """A foreign exception's text on one line, never empty."""
    text = shortened(" ".join(str(error).split()))
    return text or type(error).__name__


def _cut(text: str, most: int) -> str:
    """Without its middle where it is longer than `most`."""
    return text if len(text) <= most else f"{text[: most // 3]} ... {text[most // 3 + 5 - most :]}"


def _shown(character: str) -> str:
    import unicodedata  # late, so that the command line's help stays quick

    if character.isprintable() or unicodedata.category(character) == "Zs":
        return character
    if character in _STRAY_BYTES:
        return f"\\x{ord(character) - 0xDC00:02x}"
    return repr(character)[1:-1]


def _damaged_archives() -> tuple[type[Exception], ...]:
    """What packed data raises that is damaged or ends early; the libraries are imported late, for a quick help."""
    import gzip
    import lzma
    import zlib

    return EOFError, zlib.error, lzma.LZMAError, gzip.BadGzipFile


@contextmanager
def reading(path: os.PathLike[str] | str) -> Iterator[None]:
    """Translate whatever a format library raises while it reads `path` into InputError.

    A truncated file has many names (EOFError, OSError, struct and format errors), and a
    library may try to exit the process; both end here.
    """
    name = os.fspath(path)
    try:
        yield
    except IsocoreError:
        raise
    except FileNotFoundError as error:
        missing = error.filename or name
        raise InputError(f"{missing}: no such file; check the path") from error
    except IsADirectoryError as error:
        raise InputError(f"{name}: is a folder, not a file; name the file inside it") from error
    except PermissionError as error:
        raise InputError(f"{name}: may not be read; check its permissions") from error
    except MemoryError as error:
        raise InputError(f"{name}: does not fit into memory; free some or crop the data") from error
    except _damaged_archives() as error:
        raise InputError(
            f"{name}: compressed data is damaged or ends early ({one_line(error)}); copy it again"
        ) from error
    except SystemExit as error:
        raise InputError(f"{name}: is not a file its format's reader accepts ({one_line(error)})") from error
    except RecursionError as error:
        raise InputError(f"{name}: is nested too deeply to be read") from error
    except Exception as error:
        system = error.strerror if isinstance(error, OSError) else None
        what, todo = system or one_line(error), "the path and the disk" if system else "that it is what its suffix says"
        raise InputError(f"{name}: cannot be read ({what}); check {todo}") from error


#: What became of an output that goes through a pipe, as into `head`.
READER_LEFT = "whoever read it has left"


@contextmanager
def writing(path: os.PathLike[str] | str) -> Iterator[None]:
    """Translate a failure to write `path` into OutputError."""
    name = os.fspath(path)
    try:
        yield
    except IsocoreError:
        raise
    except BrokenPipeError as error:
        raise OutputError(f"{name}: {READER_LEFT}") from error
    except OSError as error:
        reason = error.strerror or one_line(error)
        todo = "choose a shorter name" if error.errno == errno.ENAMETOOLONG else "check the folder and the free space"
        raise OutputError(f"{name}: cannot be written ({reason}); {todo}") from error


__all__ = [
    "LONGEST",
    "READER_LEFT",
    "FieldError",
    "InputError",
    "IsocoreError",
    "OptionError",
    "OutputError",
    "about",
    "one_line",
    "printable",
    "reading",
    "shortened",
    "told",
    "writing",
]
