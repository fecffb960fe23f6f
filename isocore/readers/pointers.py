"""Data that is elsewhere: the pointers of git-lfs and git-annex, links that lead nowhere, links as text.

Repositories of data that are cloned without their large files are full of them, under the names of the data.
"""

from __future__ import annotations

import os
import re
import zlib
from pathlib import Path

from isocore.readers.members import MAGIC

_HEAD = 1024  # bytes that are looked at
_LFS = rb"version https://(?:git-lfs|hawser)\.github\.com/spec/v\d\s(?:.*\nsize (\d{1,18})\s)?"
_ANNEX = rb"[^\0\n]*annex[/\\]objects[/\\][^\0\n]*?(?:-s(\d{1,18})-[^\0\n]*)?(?:\n|\Z)"
#: A checkout without symbolic links has their text as files.
_LINK = rb"[\x20-\x7e\x80-\xff]+/[\x20-\x7e\x80-\xff]+\n?\Z"


def pointer(path: Path) -> str | None:
    """What to do where `path` is a pointer to data that is elsewhere; None where it is none."""
    head = first_bytes(path)
    if found := re.match(_LFS, head, re.DOTALL):
        return f"is a git-lfs pointer{_of_a_file(found[1])}; run git lfs pull"
    if found := re.match(_ANNEX, head):
        return f"is a git-annex pointer{_of_a_file(found[1])} that is not here; run git annex get"
    if len(head) < _HEAD and re.match(_LINK, head):
        target = os.fsdecode(head.rstrip(b"\n"))
        if target.lower().endswith(path.suffix.lower()):
            return f"is the text of a link to {target[:100]}; give that file, or check out with symbolic links"
    return None


def absence(path: Path) -> str:
    """Why there is no file `path`, and what to do."""
    if not path.is_symlink():
        return "no such file; check the path"
    target = os.fspath(path.readlink())
    if "annex/objects/" in target.replace("\\", "/"):
        return "is a git-annex link to a file that is not here; run git annex get"
    return f"is a link to {target[:100]}, which is not here; fetch that file, or mend the link"


def absence_beside(path: Path) -> str:
    """The same of a file that another one needs."""
    shown = path.name if path.name.isprintable() else ascii(path.name)
    return f"{shown} {absence(path)}" if path.is_symlink() else f"no {shown} beside it; put it there"


def _of_a_file(size: bytes | None) -> str:
    return f" of a file of {int(size):,} bytes" if size else " of a file"


def first_bytes(path: Path) -> bytes:
    """The first bytes, unpacked where they are gzip's; b"" where there are none to be had."""
    try:
        if not path.is_file():  # a pipe would be waited for
            return b""
        with path.open("rb") as file:
            head = file.read(_HEAD)
        return zlib.decompressobj(wbits=31).decompress(head, _HEAD) if head.startswith(MAGIC) else head
    except (OSError, zlib.error):
        return b""
