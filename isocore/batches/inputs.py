"""From what a command names to the files it means: folders are searched, and what cannot be is said.

Names and headers only are looked at; a file that no reader takes is found out when it is converted.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path, PurePath
from typing import NamedTuple

from isocore.batches.places import Folders
from isocore.errors import OptionError
from isocore.readers import SEARCHED, files_of, listed_files, lists_surfaces, stranger_of, suffix_of

#: Files of a folder without inputs that are looked at, so that a message can say what they are.
_LOOKED_AT = 50


class Input(NamedTuple):
    """A file to convert, and the folder it was found in: outputs mirror the way from one to the other.

    common: the folder that all that the command names lies below, absolute; None where it has none.
    refusal: why it cannot be converted, where that is known already: a folder that cannot be searched.
    """

    path: Path
    root: Path
    common: Path | None = None
    refusal: str = ""

    @property
    def stem(self) -> str:
        """The name without the suffix of its format."""
        suffix = suffix_of(self.path)
        return self.path.name[: -len(suffix)] if suffix else self.path.stem

    @property
    def parent(self) -> str:
        """The name of the folder that the file lies in."""
        return _spelled_out(self.path.parent).name

    @property
    def relative_folder(self) -> PurePath:
        """The folders between the root and the file."""
        return self.path.parent.relative_to(self.root)

    @property
    def below_common(self) -> PurePath:
        """The folders between the common one and the file."""
        here = _spelled_out(self.path.parent)
        return here.relative_to(self.common) if self.common else self.relative_folder


def find_inputs(names: Iterable[Path]) -> list[Input]:
    """Files as they are named; folders searched for known suffixes, in sorted order. No name twice.

    Two names that are links to one file are two inputs: who asks for both, as stores that keep equal content once make
    them, gets both.

    What another of them lists as a piece or a step is left to that one.

    Raises OptionError for a folder without any.
    """
    named = [(name, _is_folder(name)) for name in names]
    common = _common([name if is_folder else name.parent for name, is_folder in named])
    folders = Folders()
    found: dict[object, Input] = {}
    for name, is_folder in named:
        inside = _search(name) if is_folder else [Input(name, name.parent)]
        if not inside:
            raise OptionError(f"{name}: {_nothing_in(name)}")
        for item in inside:
            found.setdefault(folders.place_of(item.path), item._replace(common=common))
    listed = {folders.place_of(file) for item in found.values() if not item.refusal for file in listed_files(item.path)}
    return [item for place, item in found.items() if place not in listed]


def _nothing_in(folder: Path) -> str:
    """Why there is nothing to convert in a folder: by its own name, or by the first file that can be named."""
    if found := stranger_of(folder):
        return found
    for path in islice(_walk(folder, []), _LOOKED_AT):
        if found := stranger_of(path):
            return f"holds no file isocore reads: {path.name} {found}"
    return f"holds no file isocore reads; known are {', '.join(SEARCHED)}"


def _is_folder(name: Path) -> bool:
    try:
        return name.is_dir()
    except OSError:  # a name that is too long, or below a folder that may not be entered
        return False


def _common(folders: list[Path]) -> Path | None:
    try:
        return Path(os.path.commonpath([_spelled_out(folder) for folder in folders]))
    except ValueError:  # on several drives
        return None


def _spelled_out(folder: Path) -> Path:
    """Absolute and without `..`; links stay as they are named."""
    with suppress(FileNotFoundError):  # the working folder is gone
        folder = folder.absolute()
    return Path(os.path.normpath(folder))


def _search(root: Path) -> list[Input]:
    """The files below a folder that lead to data, then the folders that could not be searched."""
    errors: list[OSError] = []
    files = [path for path in _walk(root, errors) if suffix_of(path) in SEARCHED and not lists_surfaces(path)]
    detached = {os.path.normpath(file) for path in files for file in files_of(path)[1:]}
    found = [Input(path, root) for path in files if os.path.normpath(path) not in detached]
    for error in errors:
        folder = Path(os.fsdecode(error.filename))
        why = f"{folder}: this folder cannot be searched ({error.strerror}); check its permissions"
        found.append(Input(folder, root.parent if folder == root else root, refusal=why))
    return found


def _walk(root: Path, errors: list[OSError]) -> Iterator[Path]:
    """All files that are not hidden, each folder in sorted order; folders behind links come last, and none twice."""
    waiting, seen, places = deque([root]), set(), Folders()
    while waiting:
        for here, folders, files in os.walk(waiting.popleft(), onerror=errors.append):
            folder = Path(here)
            place = places.place_of(folder / "file")
            if place in seen:
                folders.clear()
                continue
            seen.add(place)
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            waiting.extend(link for name in folders if (link := folder / name).is_symlink() and not _leads_up(link))
            yield from (folder / name for name in sorted(files) if not name.startswith("."))


def _leads_up(link: Path) -> bool:
    """Whether a link to a folder leads to one that it lies in, so that following it would have no end."""
    return link.parent.resolve().is_relative_to(link.resolve())
