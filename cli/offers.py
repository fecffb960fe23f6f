"""What `isocore info` offers for masks and label maps: whole commands, to be pasted."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from isocore.digits import exact

if TYPE_CHECKING:
    from isocore.describe import Description

    from .options import Reading


def commands(path: Path, found: Description, reading: Reading) -> list[str]:
    """Of a label map that for all its labels, of a mask that for a smooth surface; none of other fields.

    reading: what was said of the file, which the command says again.
    """
    if "labels" in found.facts:
        asked = ["--labels", "all", "--smooth", "20"]
    elif "mask" in found.facts:
        asked = ["--smooth", "20"]
    else:
        return []
    name = str(path)
    name = f"./{name}" if name.startswith("-") else name
    return [shlex.join(["isocore", "convert", name, *_said(found, reading), *asked])]


def _said(found: Description, reading: Reading) -> list[str]:
    """The options that say how the file was read, with the volume that was described."""
    said: list[str] = []
    for option in ("volume", "shape", "dtype", "spacing", "origin", "byte_order", "offset"):
        value = found.facts.get(option) if option == "volume" else getattr(reading, option)
        if value is None:
            continue
        several = value if isinstance(value, tuple) else (value,)
        text = ",".join(exact(one) if isinstance(one, float) else str(one) for one in several)
        said += [f"--{option.replace('_', '-')}", text]
    for value in reading.ignore:
        said += ["--ignore", exact(value)]
    return said
