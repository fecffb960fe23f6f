"""Files that appear whole or not at all: written beside their place under another name, then moved there.

The other name is the file's own, at most 100 characters of it, then eight random hexadecimal digits and `.part`. What a
killed run leaves behind is found by it.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from isocore.errors import OutputError, writing

_SUFFIX = ".part"
_PART = re.compile(rf"(?P<name>.+)\.[0-9a-f]{{8}}{re.escape(_SUFFIX)}", re.DOTALL)


def _kept_name(path: Path) -> str:
    """As much of the name as a part's own may hold, so that no file system finds it too long."""
    return path.name[:100]


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
        part = path.with_name(f"{_kept_name(path)}.{secrets.token_hex(4)}{_SUFFIX}")
        try:
            with part.open("xb") as stream:
                yield stream
            part.replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                part.unlink()
            raise


def remove_parts(targets: Iterable[Path]) -> None:
    """Delete what is left of attempts to write these files."""
    folders: dict[Path, set[str]] = {}
    for target in targets:
        folders.setdefault(target.parent, set()).add(_kept_name(target))
    for folder, names in folders.items():
        try:
            parts = [path for path in folder.iterdir() if path.name.endswith(_SUFFIX)]
        except OSError:
            continue
        for part in parts:
            match = _PART.fullmatch(part.name)
            if match and match["name"] in names:
                part.unlink(missing_ok=True)
