"""Files that appear whole or not at all: written beside their place under another name, then moved there.

The other name is the file's own, as much of it as fits, then eight hexadecimal digits for this machine, eight random
ones and `.part`. What a killed run leaves behind is found by it (batches/leftovers.py); what a living one is writing is
known by its lock.
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from pathlib import Path
from platform import node
from typing import BinaryIO

from isocore.errors import OutputError, writing

try:
    import fcntl
except ImportError:  # Windows, where a file that is open cannot be deleted anyway
    fcntl = None  # type: ignore[assignment]

SUFFIX = ".part"
#: The machine's digits are missing in the parts of earlier versions.
PART = re.compile(rf"(?P<name>.+)\.(?P<machine>[0-9a-f]{{8}})??[0-9a-f]{{8}}{re.escape(SUFFIX)}", re.DOTALL)
_KEPT_BYTES = 150


@contextmanager
def whole_file(target: os.PathLike[str] | str) -> Iterator[BinaryIO]:
    """Open a stream whose bytes become `target` when the block ends, and leave nothing behind if it fails.

    Missing folders are made. A link is followed. What is no file (a pipe, a device) is written to as it is.
    Raises OutputError if the disk refuses.
    """
    path = Path(os.path.realpath(target))
    with writing(target):
        if path.is_dir():
            raise OutputError(f"{target}: is a folder; name a file in it")
        if path.exists() and not path.is_file():
            with path.open("wb") as device:
                yield device
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        part, stream = _new_part(path)
        with _locked_until_moved(stream):
            try:
                with stream:
                    yield stream
                part.replace(path)
            except BaseException:
                with contextlib.suppress(OSError):
                    part.unlink()
                raise


def _new_part(path: Path) -> tuple[Path, BinaryIO]:
    """A new file beside `path`, open and locked."""
    while True:
        part = path.with_name(f"{kept_name(path)}.{this_machine()}{os.urandom(4).hex()}{SUFFIX}")
        stream = part.open("xb")
        try:
            lock(stream, wait=True)
            if os.name == "nt" or part.exists():  # nobody took it away before it was locked
                return part, stream
        except BaseException:
            stream.close()
            part.unlink(missing_ok=True)
            raise
        stream.close()


@contextmanager
def _locked_until_moved(stream: BinaryIO) -> Iterator[None]:
    """Keep the lock beyond the end of the stream: a file that is being moved is no leftover yet.

    The stream is closed first, since some disks say only then that they are full.
    """
    if fcntl is None:
        yield
        return
    held = os.dup(stream.fileno())
    try:
        yield
    finally:
        os.close(held)


def lock(stream: BinaryIO, *, wait: bool) -> bool | None:
    """Lock a file until it is closed: whether that was had, or None where the disk knows no locks."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


@cache
def this_machine() -> str:
    return sha256(node().encode(errors="surrogateescape")).hexdigest()[:8]


def kept_name(path: Path) -> str:
    """As much of the name as a part's own may hold, so that no file system finds it too long."""
    name = path.name
    while len(os.fsencode(name)) > _KEPT_BYTES:
        name = name[: _KEPT_BYTES if len(name) > _KEPT_BYTES else -1]
    return name
