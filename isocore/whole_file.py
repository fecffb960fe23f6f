"""Files that appear whole or not at all: written beside their place under another name, then moved there."""

from __future__ import annotations

import contextlib
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from isocore.errors import OutputError, writing


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
        part = path.with_name(f"{path.name[:100]}.{secrets.token_hex(4)}.part")
        try:
            with part.open("xb") as stream:
                yield stream
            part.replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                part.unlink()
            raise
