"""What a program is started with: stdin, stdout, stderr and a folder.

Whoever starts it may have closed them, may have led them to a full disk, or may have deleted the folder.
"""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress

#: What a write to a stream may fail with.
CANNOT_WRITE = frozenset(
    getattr(errno, name, -1)
    for name in ("ENOSPC", "EDQUOT", "EFBIG", "EIO", "EBADF", "EPIPE", "EAGAIN", "EINVAL", "ENXIO", "ECONNRESET")
)

#: The code to exit with, without a word, where whoever read stdout has left: as of a program that SIGPIPE ended.
UNREAD = 141


def open_closed_streams() -> None:
    """Fill the places of closed streams, so that no output file takes one and gets what was meant for people.

    stdin and stdout are opened the wrong way round: whoever needs them is told. stderr leads nowhere.
    """
    for number, name, mode, flags in (
        (0, "stdin", "r", os.O_WRONLY),
        (1, "stdout", "w", os.O_RDONLY),
        (2, "stderr", "w", os.O_WRONLY),
    ):
        if getattr(sys, name) is None:
            _lead_nowhere(number, flags)
            setattr(sys, name, open(number, mode, encoding="utf-8", closefd=False))  # noqa: SIM115


def settle_streams() -> None:
    """What is left for a stream that takes nothing goes nowhere, so that Python does not complain of it at the end."""
    for number, stream in ((1, sys.stdout), (2, sys.stderr)):
        try:
            stream.flush()
        except (OSError, ValueError):
            _lead_nowhere(number, os.O_WRONLY)


def working_folder_is_there() -> bool:
    """Somebody may have deleted it, and then no relative path leads anywhere."""
    try:
        os.getcwd()  # noqa: PTH109 - pathlib takes longer to import than all of the help
    except OSError:
        return False
    return True


def _lead_nowhere(number: int, flags: int) -> None:
    with suppress(OSError):
        nowhere = os.open(os.devnull, flags)
        if nowhere != number:
            os.dup2(nowhere, number)
            os.close(nowhere)
