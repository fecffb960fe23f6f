"""Lists of inputs, as other programs write them: `ls`, `find -print0`, an editor, PowerShell."""

from __future__ import annotations

import codecs
import os
import sys
from pathlib import Path

import click


def listed(path: Path | None, *, null: bool) -> list[Path]:
    """The names in a list, `-` for stdin: one a line, or each followed by a NUL.

    Names are bytes, as the system has them; a byte order mark says that they are text, UTF-8 or UTF-16.
    Raises UsageError where there is no such list, or no name in it.
    """
    if path is None:
        if null:
            raise click.UsageError("--null says how the names of --files-from end; give that too")
        return []
    try:
        data = sys.stdin.buffer.read() if path == Path("-") else path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is closed"
        raise click.UsageError(f"--files-from {path}: cannot be read ({reason}); check the path") from error
    names = _names(path, data, null=null)
    if not names:
        raise click.UsageError(f"--files-from {path}: names no file; write one name a line")
    return [Path(os.fsdecode(name)) for name in names]


def _names(path: Path, data: bytes, *, null: bool) -> list[bytes]:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            data = data.decode("utf-16").encode()
        except UnicodeDecodeError as error:
            raise click.UsageError(f"--files-from {path}: starts as UTF-16 and is none; save it as UTF-8") from error
    data = data.removeprefix(codecs.BOM_UTF8)
    if null:
        return [name for name in data.split(b"\0") if name]
    if b"\0" in data:
        raise click.UsageError(f"--files-from {path}: holds NUL bytes; give -0 with it, as for `find -print0`")
    return [name.removesuffix(b"\r") for name in data.split(b"\n") if name.strip()]
