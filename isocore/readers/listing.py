"""VTK's short XML files that name others: the pieces of a data set, or the steps of a series."""

from __future__ import annotations

import os
from pathlib import Path
from xml.parsers import expat

from isocore.errors import InputError

_LONGEST = 64 << 20  # bytes

Element = tuple[str, dict[str, str]]


def elements(path: Path, kind: str, what: str) -> list[Element]:
    """All tags with their attributes, in order; the first is of a VTKFile of this kind, else InputError says so.

    what: completes the sentence that a file of this suffix ...
    """
    if path.stat().st_size > _LONGEST:
        raise InputError(f"{path}: is too long to be a list of files; check that it is what its suffix says")
    found: list[Element] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if not found:
            given = attributes.get("type", "object of no type")
            if tag != "VTKFile" or given != kind:
                held = f"holds a VTK {given}" if tag == "VTKFile" else f"starts with <{tag}>"
                raise InputError(f"{path}: {held}; a {path.suffix} {what}")
        found.append((tag, attributes))

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    try:
        parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as error:
        raise InputError(
            f"{path}: its XML is broken near line {error.lineno:,} ({expat.ErrorString(error.code)}); copy it again"
        ) from error
    return found


def beside(path: Path, name: str) -> Path:
    """A file that another one names, from that one's folder. Backslashes of Windows part folders, too."""
    if not name or "\0" in name:
        raise InputError(f"{path}: names the file {name[:40]!r}, which no file is called; write it again")
    file = path.parent / name
    return path.parent / name.replace("\\", "/") if "\\" in name and not file.exists() else file


def refuse_missing(path: str, files: list[Path], what: str) -> None:
    """InputError where a file is not there, or named twice: a short list of one piece over and over is a huge mesh.

    what: pieces, as a rule.
    """
    missing = [file for file in files if not file.is_file()]
    if missing:
        many = f"{len(missing):,} of its {len(files):,} {what} are missing, the first is"
        one = f"one of its {len(files):,} {what} is missing,"
        raise InputError(f"{path}: {one if len(missing) == 1 else many} {missing[0]}; copy it there")
    places: set[str] = set()
    for file in files:
        if (place := os.path.realpath(file)) in places:
            raise InputError(f"{path}: names {file} twice among its {len(files):,} {what}; leave one out")
        places.add(place)
