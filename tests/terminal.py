"""A terminal of any width for a program to write to, and what one would read on its screen afterwards."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
from dataclasses import dataclass, field

_CONTROL = re.compile(r"\x1b\[(?P<numbers>[?\d;]*)(?P<letter>[A-Za-z])")


@dataclass
class Screen:
    """The few controls that isocore and its bar use; lines are as one reads them, also those that have scrolled away.

    broken: rows that go on in the next one, since they were longer than the screen is wide.
    """

    width: int
    rows: list[list[str]] = field(default_factory=lambda: [[]])
    broken: set[int] = field(default_factory=set)
    row: int = 0
    column: int = 0

    def show(self, text: str) -> None:
        """Take in what a program wrote."""
        place = 0
        while place < len(text):
            if control := _CONTROL.match(text, place):
                self._obey(control["letter"], control["numbers"])
                place = control.end()
                continue
            self._put(text[place])
            place += 1

    def _obey(self, letter: str, numbers: str) -> None:
        if letter == "A":
            self.row = max(0, self.row - int(numbers or 1))
        elif letter == "K":
            assert numbers == "2", "only whole lines are erased"
            self.rows[self.row] = []
            self.broken.discard(self.row)
        else:
            assert letter in "mhl", f"unknown control {letter}"

    def _put(self, character: str) -> None:
        if character == "\r":
            self.column = 0
        elif character == "\n":
            self._down()
        else:
            if self.column == self.width:
                self.broken.add(self.row)
                self._down()
                self.column = 0
            row = self.rows[self.row]
            row.extend(" " * (self.column + 1 - len(row)))
            row[self.column] = character
            self.column += 1

    def _down(self) -> None:
        self.row += 1
        if self.row == len(self.rows):
            self.rows.append([])

    @property
    def lines(self) -> list[str]:
        """What was written as one line is one, however many rows it takes."""
        lines = [""]
        for n, row in enumerate(self.rows):
            lines[-1] += "".join(row)
            if n not in self.broken:
                lines.append("")
        return [line.rstrip() for line in lines]


def on_a_terminal(width: int, *arguments: object, code: str = "") -> tuple[Screen, str]:
    """Run isocore with all its streams on a terminal so wide: the screen at its end, and all that was written.

    code: Python that runs first, in the same process.
    """
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, width, 0, 0))
    program = f"{code}\nfrom isocore.cli.main import main\nmain()"
    environment = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "LINES", "NO_COLOR")}
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", program, *map(str, arguments)],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env=environment | {"TERM": "xterm-256color"},
    )
    os.close(theirs)
    written = b""
    while True:
        assert select.select([ours], [], [], 60)[0], f"silent for a minute after {written[-200:]!r}"
        try:
            part = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        written += part
    os.close(ours)
    process.wait(timeout=60)
    screen = Screen(width)
    screen.show(written.decode())
    return screen, written.decode()
