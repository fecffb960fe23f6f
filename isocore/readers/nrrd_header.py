"""The text at the head of a NRRD file: its fields.

Follows "Definition of NRRD File Format" (Kindlmann, Teem project), versions 1 to 5.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

from isocore.errors import InputError

#: The data file of a header whose following lines name data files.
LIST = re.compile(r"LIST(\s+\d+)?")

#: A header longer than this is none.
_MOST_BYTES = 1 << 24


@dataclass(frozen=True, slots=True)
class Head:
    """A header's text.

    fields: by name, in lower case and without blanks ("spacedirections").
    size: bytes of the head.
    files: the lines after "data file: LIST".
    """

    fields: dict[str, str]
    size: int
    files: tuple[str, ...]

    def need(self, name: str) -> str:
        """A field without which there is nothing to read."""
        if name not in self.fields:
            raise InputError(f"header lacks the field {name}; it is damaged")
        return self.fields[name]

    def integers(self, name: str) -> tuple[int, ...]:
        """A field's whole numbers."""
        try:
            return tuple(int(word) for word in self.need(name).split())
        except ValueError:
            raise self._unlike(name, "whole numbers") from None

    def numbers(self, name: str) -> list[float] | None:
        """A field's numbers, NaN where an axis has none; None without the field."""
        try:
            return [float(word) for word in self.fields[name].split()] if name in self.fields else None
        except ValueError:
            raise self._unlike(name, "numbers") from None

    def vectors(self, name: str) -> list[list[float] | None] | None:
        """A field's vectors, (1,0,0) none (0,0,1); None without the field."""
        if name not in self.fields:
            return None
        words = re.findall(r"\([^()]*\)|\S+", self.fields[name])
        try:
            return [None if word == "none" else _vector(word) for word in words]
        except ValueError:
            raise self._unlike(name, "vectors") from None

    def words(self, name: str) -> list[str]:
        """A field's words, quoted where they hold blanks; none without the field."""
        text = self.fields.get(name, "")
        try:
            return shlex.split(text) if '"' in text else text.split()
        except ValueError:
            raise self._unlike(name, "quoted words") from None

    def _unlike(self, name: str, kind: str) -> InputError:
        return InputError(f"header field {name} is no list of {kind} ({self.fields[name][:40]!a}); mend it")


def _vector(word: str) -> list[float]:
    if not (word.startswith("(") and word.endswith(")")):
        raise ValueError(word)
    return [float(number) for number in word[1:-1].split(",")]


def parsed(path: Path) -> Head:
    """The head of `path`, up to its first empty line or the file's end."""
    fields: dict[str, str] = {}
    files: list[str] | None = None
    with path.open("rb") as file:
        if not re.fullmatch(rb"NRRD000[1-5]", file.readline(20).rstrip()):
            raise InputError("is no NRRD file (it begins with none of NRRD0001 to NRRD0005); check its suffix")
        while line := file.readline(_MOST_BYTES).rstrip():
            if file.tell() > _MOST_BYTES:
                raise InputError("header does not end; it is damaged")
            text = _decoded(line)
            if files is not None:
                files.append(text)
            elif not text.startswith("#"):
                name, colon, value = text.partition(":")
                if not colon:
                    raise InputError(f"header line is no field: {text[:40]!a}; it is damaged")
                name = name.strip().lower().replace(" ", "")
                if not value.startswith("="):
                    fields[name] = value.strip()
                    files = [] if name == "datafile" and LIST.fullmatch(fields[name]) else None
        return Head(fields, file.tell(), tuple(files or ()))


def _decoded(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")
