"""What killed runs leave behind, and what living ones are at, which nobody takes from them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable
from pathlib import Path
from time import time

from isocore.whole_file import PART, SUFFIX, kept_name, lock, this_machine

#: Where locks do not tell, a part that grew in the last so many seconds is being written.
_STILL_SECONDS = 600.0


def remove_parts(targets: Iterable[Path]) -> None:
    """Delete what is left of attempts to write these files, but nothing that a process is writing now."""
    folders: dict[Path, set[str]] = {}
    for target in targets:
        path = Path(os.path.realpath(target))
        folders.setdefault(path.parent, set()).add(kept_name(path))
    for folder, names in folders.items():
        try:
            parts = [path for path in folder.iterdir() if path.name.endswith(SUFFIX)]
        except OSError:
            continue
        for part in parts:
            match = PART.fullmatch(part.name)
            if match and match["name"] in names:
                with contextlib.suppress(OSError):
                    _remove_left(part, match["machine"])


def _remove_left(part: Path, machine: str | None) -> None:
    """Delete a part unless it is being written. Locks may hold on one machine only, and some disks have none."""
    with part.open("r+b") as stream:
        locked = lock(stream, wait=False)
        here = machine in (None, this_machine())
        young = time() - os.fstat(stream.fileno()).st_mtime < _STILL_SECONDS
        if locked is False or (young and not (locked and here)):
            return
        if os.name != "nt":
            part.unlink()
    part.unlink(missing_ok=True)
