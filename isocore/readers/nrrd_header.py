"""The text at the head of a NRRD file: its fields, as pynrrd parses them.

What pynrrd does not know of "Definition of NRRD File Format" (Kindlmann, Teem project) is put right here, line by
line, before it sees a field: names in any spelling, key:=value remarks, lists of data files, text beyond ASCII.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from isocore.errors import InputError, one_line

#: Data file of a header whose following lines name data files.
LIST = re.compile(r"LIST(\s+\d+)?")

#: The fields that say something about samples or place, by their names without blanks. Others are left unread.
_SPELLING = {
    name.replace(" ", ""): name
    for name in (
        "type", "dimension", "sizes", "encoding", "endian", "line skip", "byte skip", "data file", "kinds",
        "centerings", "spacings", "axis mins", "axis maxs", "units", "space", "space units", "space origin",
        "space directions",
    )
}  # fmt: skip

#: Lines that are no fields, by names that no field has.
_LISTED, _STRAY = "a data file of the list", "neither"

#: A header longer than this is none.
_MOST_BYTES = 1 << 24


@dataclass(frozen=True, slots=True)
class Head:
    """A header's text.

    fields: of pynrrd's types, by the names of the format's definition ("space directions").
    size: bytes of the head.
    files: the lines after "data file: LIST".
    """

    fields: dict[str, Any]
    size: int
    files: tuple[str, ...]

    def need(self, name: str) -> Any:
        """A field without which there is nothing to read."""
        if name not in self.fields:
            raise InputError(f"header lacks the field {name}; it is damaged")
        return self.fields[name]

    def word(self, name: str) -> str:
        """A field of one word, in lower case; "" without the field."""
        return str(self.fields.get(name, "")).lower()


def parsed(path: Path) -> Head:
    """The head of `path`, up to its first empty line or the file's end."""
    texts: dict[str, str] = {}
    files: list[str] = []
    with path.open("rb") as file:
        magic = _magic(file)
        for name, text in _fields(file):
            if name == _STRAY:
                raise InputError(f"header line is no field: {text[:40]!a}; it is damaged")
            if name == _LISTED:
                files.append(text)
            else:
                texts[name] = text  # of a field that stands there a million times one is read
        fields = {name: _value(magic, name, text) for name, text in texts.items()}
        return Head(fields, file.tell(), tuple(files))


def remarks(path: Path) -> dict[str, str]:
    """The key:=value lines of the head of `path`."""
    with path.open("rb") as file:
        file.readline(_MOST_BYTES)
        pairs = (line.partition(":=") for line in _lines(file))
        return {key.strip(): value.strip() for key, mark, value in pairs if mark}


def data_files_of(path: Path) -> Head:
    """Only what the head of `path` says about data files, however damaged the rest of it is."""
    with path.open("rb") as file:
        file.readline(_MOST_BYTES)
        found = list(_fields(file))
    named = {name: text for name, text in found if name == "data file"}
    return Head(named, 0, tuple(text for name, text in found if name == _LISTED))


def _magic(file: IO[bytes]) -> str:
    import nrrd

    magic = _decoded(file.readline(20).rstrip())
    try:
        nrrd.read_header([magic])
    except nrrd.errors.NRRDError as error:
        raise InputError("is no NRRD file (it begins with none of NRRD0001 to NRRD0005); check its suffix") from error
    return magic


def _fields(file: IO[bytes]) -> Iterator[tuple[str, str]]:
    """The known fields in order, each with its text. Names after "data file: LIST" are _LISTED, other lines _STRAY."""
    listing = False
    for line in _lines(file):
        if listing:
            yield _LISTED, line
            continue
        name, colon, value = line.partition(":")
        spelled = _SPELLING.get("".join(name.lower().split()))
        if not colon:
            yield _STRAY, line
        elif spelled and not value.startswith("="):
            yield spelled, value.strip()
            listing = spelled == "data file" and LIST.fullmatch(value.strip()) is not None


def _lines(file: IO[bytes]) -> Iterator[str]:
    """The head's lines behind the first, without comments."""
    while line := file.readline(_MOST_BYTES).rstrip():
        if file.tell() > _MOST_BYTES:
            raise InputError("header does not end; it is damaged")
        if not line.startswith(b"#"):
            yield _decoded(line)


def _value(magic: str, name: str, value: str) -> Any:
    """What pynrrd makes of one field; one at a time, so that a message can name it."""
    import nrrd

    if name == "space directions":  # blanks inside of a vector split it
        value = re.sub(r"\([^()]*\)", lambda vector: "".join(vector[0].split()), value)
    try:
        if name == "sizes":  # of 4.7 it makes 4
            value = " ".join(str(int(size)) for size in value.split())
        with np.errstate(invalid="raise"):  # a number too long for an integer
            return nrrd.read_header([magic, f"{name}: {value}"])[name]
    except (ValueError, ArithmeticError, IndexError, nrrd.errors.NRRDError) as error:
        line, why = f"{name}: {value}"[:60], one_line(error)[:80]
        raise InputError(f"header line {line!a} cannot be read ({why}); mend it") from error


def _decoded(line: bytes) -> str:
    """UTF-8, else Latin 1: pynrrd would leave out the first letter of μm and make metres of it."""
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")
