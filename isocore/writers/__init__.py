"""The table of mesh formats, and how a surface gets into a file.

To add one: a function in its own file and a row below. Writers see a stream, never a path, and write neither
times nor names: the same surface gives the same bytes.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from isocore.choices import FORMATS, Format
from isocore.errors import OptionError, writing
from isocore.late import late
from isocore.surface import Surface
from isocore.whole_file import whole_file
from isocore.writers.rounding import rounded

Writer = Callable[[BinaryIO, Surface, int], None]

#: suffix -> writer(stream, surface, threads); coordinates are rounded before (rounding.py).
WRITERS: dict[str, Writer] = {
    ".ply": late("writers.ply", "write_ply"),
    ".obj": late("writers.obj", "write_obj"),
    ".stl": late("writers.stl", "write_stl"),
    ".glb": late("writers.glb", "write_glb"),
    ".gii": late("writers.gifti", "write_gifti"),
    ".vtp": late("writers.vtp", "write_vtp"),
}


def write(
    surface: Surface, target: os.PathLike[str] | str, format: str | None = None, *, threads: int = 1
) -> tuple[str, ...]:
    """Write `surface` to the file `target`, in `format` or by the suffix; returns warnings.

    The file appears whole or not at all; missing folders are made, and an existing file is replaced.
    Raises OptionError for an unknown format, OutputError if the disk refuses.
    """
    name = format_for(target, format)
    surface, warnings = rounded(surface, name, threads)
    with whole_file(target) as stream:
        WRITERS[f".{name}"](stream, surface, threads)
    return tuple(f"{os.fspath(target)}: {warning}" for warning in warnings)


def write_to(stream: BinaryIO, surface: Surface, format: str, *, threads: int = 1) -> tuple[str, ...]:
    """Write `surface` to an open binary stream, such as stdout's; returns warnings."""
    name = format_for("-", format)
    surface, warnings = rounded(surface, name, threads)
    with writing("-"):
        WRITERS[f".{name}"](stream, surface, threads)
        stream.flush()
    return warnings


def format_for(target: os.PathLike[str] | str, format: str | None = None) -> Format:
    """The format that is asked for, by name or else by the suffix of `target`; OptionError if there is none."""
    name = os.fspath(target)
    suffix = Path(name).suffix.lower() if format is None else f".{format.lower()}"
    for known in FORMATS:
        if suffix == f".{known}":
            return known
    seen = f"{format or suffix} is not a format isocore writes" if format or suffix else "has no suffix"
    raise OptionError(f"{name}: {seen}; choose one of {', '.join(sorted(FORMATS))} with --format")
