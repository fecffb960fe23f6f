"""Half-written files of runs that were killed: whole_file's `.part` files, found by the name they were to have."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

_PART = re.compile(r"(?P<name>.+)\.[0-9a-f]{8}\.part", re.DOTALL)
_KEPT = 100


def remove_parts(targets: Iterable[Path]) -> None:
    """Delete what is left of attempts to write these files."""
    folders: dict[Path, set[str]] = {}
    for target in targets:
        folders.setdefault(target.parent, set()).add(target.name[:_KEPT])
    for folder, names in folders.items():
        try:
            parts = [path for path in folder.iterdir() if path.name.endswith(".part")]
        except OSError:
            continue
        for part in parts:
            match = _PART.fullmatch(part.name)
            if match and match["name"] in names:
                part.unlink(missing_ok=True)
