"""stdin, stdout and stderr, also where whoever started the program closed them, or where nothing can be written."""

from __future__ import annotations

import os
import sys
from contextlib import suppress


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


def _lead_nowhere(number: int, flags: int) -> None:
    with suppress(OSError):
        nowhere = os.open(os.devnull, flags)
        if nowhere != number:
            os.dup2(nowhere, number)
            os.close(nowhere)
