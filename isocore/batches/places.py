"""Which paths are one file: through links, in other spellings, by another mount, where a file system ignores case.

Two names that are hard links to one file are two places: a file is written beside its place and moved there, so the
other name keeps what it had.
"""

from __future__ import annotations

import os
import sys
import unicodedata
from pathlib import Path
from typing import TypeAlias

#: The nearest folder that is there, by device and number, and the names below it.
Place: TypeAlias = tuple[int, int, tuple[str, ...]]


def place_of_name(path: Path) -> Place:
    """What all spellings of a name in its folder have in common; where the name is a link, it is not followed."""
    device, number, _, names = _found(Path(os.path.realpath(path.parent)) / path.name)
    return device, number, names


def _found(real: Path) -> tuple[int, int, Path, tuple[str, ...]]:
    """Of a path without links: the nearest folder that is there, and the names below it."""
    folder, names = real.parent, [real.name]
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
        self._holders: dict[Place, list[tuple[tuple[str, ...], str]]] = {}

    def take(self, path: Path, holder: str) -> str | None:
        """Note the holder of a path's place; where it has one already, that one. Pipes and devices are nobody's."""
        if _is_stream(path):
            return None
        device, number, folder, names = _found(Path(os.path.realpath(path)))
        holders = self._holders.setdefault((device, number, tuple(map(_folded, names))), [])
        for others, other in holders:
            if others == names or ignores_case(folder):
                return other
        holders.append((names, holder))
        return None


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


def _is_stream(path: Path) -> bool:
    try:
        return path.exists() and not path.is_file() and not path.is_dir()
    except OSError:
        return False
