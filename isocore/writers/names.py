"""Names of fields as files can say them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any
from unicodedata import normalize

import numpy.typing as npt

_UNSAFE = r"[^A-Za-z0-9_]+"
_AXES = "xyz"


def column_names(fields: Mapping[str, npt.NDArray[Any]], taken: Iterable[str] = ()) -> dict[str, list[str]]:
    """Of each field the names of its columns, of letters, digits and `_` alone, no two alike and none taken.

    fields: by name (v,) or (v, k). Vectors of two and three have columns _x, _y, _z; more than three are numbered.
    """
    known, found = {name.lower() for name in taken}, {}
    for name, values in fields.items():
        count = 1 if values.ndim == 1 else values.shape[1]
        ends = _ends(values.ndim, count)
        base = re.sub(_UNSAFE, "_", normalize("NFKD", name).encode("ascii", "ignore").decode()).strip("_") or "field"
        stem, number = base, 1
        while known & {f"{stem}{end}".lower() for end in ends}:
            number += 1
            stem = f"{base}_{number}"
        found[name] = [f"{stem}{end}" for end in ends]
        known |= {column.lower() for column in found[name]}
    return found


def _ends(axes: int, count: int) -> list[str]:
    if axes == 1:
        return [""]
    return [f"_{_AXES[n] if count <= len(_AXES) else n}" for n in range(count)]
