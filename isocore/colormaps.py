"""The names of colour maps, and what `--colormap` and `--color-range` take. No numpy: help waits for none."""

from __future__ import annotations

import math

from isocore.errors import OptionError

#: How numbers become colours, by the names that matplotlib has for them; each also backwards, with _r behind it.
COLORMAPS = (
    "viridis", "plasma", "inferno", "magma", "cividis", "turbo", "jet", "coolwarm", "gray", "bone", "hot", "bwr",
    "seismic", "RdBu", "RdYlBu", "PiYG", "Spectral", "Blues", "Reds", "Greens", "rainbow", "nipy_spectral", "twilight",
    "hsv",
)  # fmt: skip


def parse_colormap(text: str) -> str:
    """The name of a map as it is known here, in whatever case it was written. Raises OptionError for an unknown one."""
    known = {name.lower(): name for name in COLORMAPS} | {f"{name.lower()}_r": f"{name}_r" for name in COLORMAPS}
    found = known.get(text.strip().lower())
    if found is None:
        raise OptionError(f"--colormap {text}: is none of {' '.join(COLORMAPS)}, nor one of them with _r behind it")
    return found


def parse_color_range(text: str) -> tuple[float, float]:
    """The limits of a colour map, `A:B`. Raises OptionError for nonsense."""
    try:
        low, high = (float(part) for part in text.split(":"))
    except ValueError:
        raise OptionError(f"--color-range {text}: is no range; write A:B, as 0:100") from None
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise OptionError(f"--color-range {text}: must be two finite numbers, the smaller first; _r turns a map around")
    return low, high
