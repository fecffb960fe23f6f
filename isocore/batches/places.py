"""Which paths are one file: through links, in other spellings, by another mount, where a file system ignores case.

Two names that are hard links to one file are two places: a file is written beside its place and moved there, so the
other name keeps what it had.
"""

from __future__ import annotations

import os
import stat
import sys
import unicodedata
from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

from isocore.errors import OptionError

#: The nearest folder that is there, by device and number, and the names below it.
Place: TypeAlias = tuple[int, int, tuple[str, ...]]


class Folders:
    """The places of names in folders, each of which is looked up once."""

    def __init__(self) -> None:
        self._known: dict[Path, tuple[int, int, Path, tuple[str, ...]]] = {}

    def place_of(self, path: Path) -> Place:
        """What all spellings of a name in its folder have in common; where the name is a link, it is not followed."""
        device, number, _, names = self.found(path)
        return device, number, names

    def found(self, path: Path) -> tuple[int, int, Path, tuple[str, ...]]:
        """As place_of, with the path of the nearest folder that is there."""
        if path.parent not in self._known:
            self._known[path.parent] = _nearest(Path(os.path.realpath(path.parent)))
        device, number, folder, names = self._known[path.parent]
        return device, number, folder, (*names, path.name)


def _nearest(folder: Path) -> tuple[int, int, Path, tuple[str, ...]]:
    """The nearest folder that is there, and the names below it."""
    names: list[str] = []
    while True:
        try:
            found = folder.stat()
        except OSError:
            if folder == folder.parent:
                return 0, 0, folder, tuple(reversed(names))
            names.append(folder.name)
            folder = folder.parent
        else:
            return found.st_dev, found.st_ino, folder, tuple(reversed(names))


class Places:
    """Who has which place; the first to take it keeps it."""

    def __init__(self) -> None:
        self._folders = Folders()
        self._holders: dict[Place, list[tuple[tuple[str, ...], str]]] = {}

    def take(self, path: Path, holder: str) -> str | None:
        """Note the holder of a path's place; where it has one already, that one. Pipes and devices are nobody's."""
        kind = _kind(path)
        if stat.S_ISLNK(kind) or not path.name or path.name == "..":
            path = Path(os.path.realpath(path))
            kind = _kind(path)
        if kind and not stat.S_ISREG(kind) and not stat.S_ISDIR(kind):
            return None
        device, number, folder, names = self._folders.found(path)
        holders = self._holders.setdefault((device, number, tuple(map(_folded, names))), [])
        for others, other in holders:
            if others == names or ignores_case(folder):
                return other
        holders.append((names, holder))
        return None


def _kind(path: Path) -> int:
    """What is there, a link as itself; 0 for nothing."""
    try:
        return path.lstat().st_mode
    except (OSError, ValueError):
        return 0


def refuse_overwriting_files(read: Iterable[tuple[str, Path]], written: Iterable[tuple[str, Path]]) -> None:
    """Refuse what is written, an option and its file each, where it is read, too, or written twice.

    read: what a file is, as the message says it, and the file. Raises OptionError.
    """
    places = Places()
    for what, path in read:
        places.take(path, what)
    for option, path in written:
        taken = places.take(path, f"is also written by {option}")
        if taken is not None:
            raise OptionError(f"{option} {path}: {taken} and would be overwritten; choose another name")


def ignores_case(folder: Path) -> bool:
    """Whether `a` and `A` are one file in a folder that is there, as its own names or its way there tell."""
    try:
        inside = [folder / entry.name for entry in os.scandir(folder)]
    except OSError:
        inside = []
    for path in (*inside, folder, *folder.parents):
        other = path.with_name(path.name.swapcase()) if path.name else path
        if other != path:
            try:
                return other.samefile(path)
            except OSError:
                return False
    return sys.platform in ("darwin", "win32")


def _folded(name: str) -> str:
    return unicodedata.normalize("NFC", name).lower()
