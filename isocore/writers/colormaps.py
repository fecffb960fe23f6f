"""Numbers as colours: the maps that matplotlib's users know by these names, as tables of 256 colours.

colormaps.rgb holds the tables one behind the other in the order of isocore/colormaps.py, three bytes a colour, sRGB.
Viridis, plasma, inferno, magma: van der Walt, Smith 2015, public domain (CC0). Cividis: Nunez, Anderton, Renslow 2018.
Turbo: Mikhailov 2019. Coolwarm: Moreland 2009.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.colormaps import COLORMAPS

_COLOURS = 256
#: Of what is no number.
_NONE = (128, 128, 128)


def colormap(name: str) -> npt.NDArray[np.uint8]:
    """(256, 3) red, green, blue of the map of that name; with _r behind it, from its end to its start."""
    number = COLORMAPS.index(name.removesuffix("_r"))
    data = (Path(__file__).parent / "colormaps.rgb").read_bytes()
    tables = np.frombuffer(data, np.uint8).reshape(-1, _COLOURS, 3)
    table = tables[number]
    return np.ascontiguousarray(table[::-1] if name.endswith("_r") else table)


def magnitudes(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(v,) the numbers that a field is coloured by: a scalar's own, the length of a vector."""
    if values.ndim == 1:
        return values
    return values[:, 0] if values.shape[1] == 1 else np.sqrt((values.astype(np.float64) ** 2).sum(axis=1))


def range_of(values: npt.NDArray[Any]) -> tuple[float, float] | None:
    """The smallest and the largest finite number; None where there is none."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if len(finite) else None


def coloured(values: npt.NDArray[Any], name: str, limits: tuple[float, float] | None) -> npt.NDArray[np.uint8]:
    """(v, 3) the colours of values (v,) between two limits; beyond them the first and the last, grey what is no number.

    Where both limits are one number, the colour amid the map.
    """
    table = np.concatenate([colormap(name), np.array([_NONE], np.uint8)])
    low, high = limits or (0.0, 0.0)
    with np.errstate(invalid="ignore", over="ignore"):
        share = (values.astype(np.float64) - low) / (high - low) if high > low else np.full(len(values), 0.5)
        place = np.clip(np.floor(share * _COLOURS), 0, _COLOURS - 1)
    return table[np.where(np.isfinite(values), np.nan_to_num(place), _COLOURS).astype(np.intp)]
