"""What can go wrong, as a small tree.

    IsocoreError
      InputError     the file cannot be read, or is not what it says
      FieldError     it was read, but cannot be contoured
      OptionError    the request makes no sense
      OutputError    the result cannot be written

A message is one line: the path first, then what happened, then what to do.
"""

from __future__ import annotations

import gzip
import lzma
import os
import zlib
from collections.abc import Iterator
from contextlib import contextmanager


class IsocoreError(Exception):
    """Anything isocore refuses, with a message fit for a user."""


class InputError(IsocoreError):
    """The file cannot be read, or is not what it says."""


class FieldError(IsocoreError):
    """The field was read, but cannot be contoured."""


class OptionError(IsocoreError):
    """The request makes no sense."""


class OutputError(IsocoreError):
    """The result cannot be written."""


def one_line(error: BaseException) -> str:
    """A foreign exception's text on one line, never empty."""
    text = " ".join(str(error).split())
    return text or type(error).__name__


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
    except (EOFError, zlib.error, lzma.LZMAError, gzip.BadGzipFile) as error:
        raise InputError(
            f"{name}: compressed data is damaged or ends early ({one_line(error)}); copy it again"
        ) from error
    except SystemExit as error:
        raise InputError(f"{name}: is not a file its format's reader accepts ({one_line(error)})") from error
    except RecursionError as error:
        raise InputError(f"{name}: is nested too deeply to be read") from error
    except Exception as error:
        raise InputError(
            f"{name}: cannot be read ({one_line(error)}); check that it is what its suffix says"
        ) from error


@contextmanager
def writing(path: os.PathLike[str] | str) -> Iterator[None]:
    """Translate a failure to write `path` into OutputError."""
    name = os.fspath(path)
    try:
        yield
    except IsocoreError:
        raise
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise OutputError(f"{name}: cannot be written ({reason}); check the folder and the free space") from error


__all__ = ["FieldError", "InputError", "IsocoreError", "OptionError", "OutputError", "one_line", "reading", "writing"]
