"""How large a piece of a surface must be to be kept, in words: triangles (`20`) or an enclosed volume (`20mm3`).

Each value prints back to the text it came from. The command line's help reads this file, so it imports no numpy.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple, TypeAlias

from isocore.choices import MILLIMETRES
from isocore.errors import OptionError

_VOLUME = r"(?P<number>[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?)\s*((?P<unit>[a-zµ]+)\s*(?P<power>\^?3|³)?)?"


class FewestTriangles(NamedTuple):
    """A piece that is kept has at least so many triangles."""

    triangles: int
    text: str

    def __str__(self) -> str:
        return self.text


class SmallestVolume(NamedTuple):
    """A piece that is kept encloses at least so much; unit: one of MILLIMETRES, whose cube is meant."""

    volume: float
    unit: str
    text: str

    def __str__(self) -> str:
        return self.text


MinPiece: TypeAlias = FewestTriangles | SmallestVolume


def parse_min_piece(text: str) -> MinPiece:
    """How large a piece must be. Raises OptionError for nonsense; whether a surface has the unit is checked later."""
    text = text.strip()
    match = re.fullmatch(_VOLUME, text, re.IGNORECASE)
    if match is None:
        raise OptionError(f"--min-piece {text}: is no size; write a number of triangles (20), or a volume (20mm3)")
    number, unit = float(match["number"]), (match["unit"] or "").lower()
    if not math.isfinite(number) or number < 0:
        raise OptionError(f"--min-piece {text}: must be finite, and not negative")
    if not unit:
        if number != int(number):
            raise OptionError(f"--min-piece {text}: triangles are whole; a volume has a unit, as 20.5mm3")
        return FewestTriangles(int(number), text)
    if unit not in MILLIMETRES:
        raise OptionError(f"--min-piece {text}: {match['unit']} is no unit known here; write 20mm3")
    if not match["power"]:
        raise OptionError(f"--min-piece {text}: is a length; write a volume (20mm3), or a number of triangles (20)")
    return SmallestVolume(number, unit, text)
