"""From where a picture looks: the grammar of --view, and what its words mean in a space."""

from __future__ import annotations

import math
import re
from typing import Literal, NamedTuple

from isocore.errors import FieldError, OptionError

Direction = tuple[float, float, float]

#: A view from the front, turned to a side and raised.
CORNER = "corner"
_CORNER_ANGLES = (35.0, 20.0)
_AXES: dict[str, Direction] = {
    f"{sign}{letter}": (number * (axis == 0), number * (axis == 1), number * (axis == 2))
    for axis, letter in enumerate("xyz")
    for sign, number in (("+", 1.0), ("-", -1.0))
}
#: What the axes' positive ends are called; the third is S in each.
_ENDS = {"ras": ("R", "A"), "lps": ("L", "P"), "las": ("L", "A")}
_OPPOSITE = {"R": "L", "L": "R", "A": "P", "P": "A", "S": "I", "I": "S"}
_ANGLES = r"(?P<turn>[+-]?\d+(\.\d+)?):(?P<tilt>[+-]?\d+(\.\d+)?)"
#: Words that a shell may complete.
VIEW_WORDS = (CORNER, *_OPPOSITE, *_AXES)
MOST_VIEWS = 12


class Views(NamedTuple):
    """One or several views, side by side in a picture. names: each as it is written; text: all of them."""

    names: tuple[str, ...] = (CORNER,)

    def __str__(self) -> str:
        return ",".join(self.names)


class Still(NamedTuple):
    """How a surface is drawn. size: width and height in pixels. kind: of the file."""

    views: Views = Views()
    size: tuple[int, int] = (1024, 768)
    kind: Literal["png"] = "png"

    def __str__(self) -> str:
        return f"{self.views} {self.size[0]}x{self.size[1]}"


def parse_views(text: str) -> Views:
    """`A`, `A,L,S`, `+x`, `corner`, `TURN:TILT` in degrees, or a list. Raises OptionError for nonsense."""
    names: list[str] = []
    for part in text.split(","):
        word = part.strip()
        known = next((name for name in VIEW_WORDS if name.lower() == word.lower()), None)
        angles = re.fullmatch(_ANGLES, word)
        if known is None and (angles is None or abs(float(angles["tilt"])) > 90):
            words = " ".join(VIEW_WORDS)
            raise OptionError(f"--view {text}: {word or 'nothing'} is no view; use {words}, or TURN:TILT, as 30:15")
        names.append(known or word)
    if len(names) > MOST_VIEWS:
        raise OptionError(f"--view {text}: has more than {MOST_VIEWS} views; leave some out")
    return Views(tuple(names))


def directions(views: Views, space: str) -> list[tuple[Direction, Direction]]:
    """Of each view the direction to the eye, and the one that is up, both of length 1, in the world of this space.

    Raises FieldError for an anatomical view where the space does not say which way its axes point.
    """
    return [_direction(name, space) for name in views.names]


def _direction(name: str, space: str) -> tuple[Direction, Direction]:
    ends = _ENDS.get(space)
    ahead = 1.0 if ends is not None and ends[1] == "A" else -1.0  # along y, to the front
    if name in _AXES:
        to_eye = _AXES[name]
    elif name in _OPPOSITE:
        if ends is None:
            raise FieldError(f"--view {name}: the file does not say where its axes point; use +x -x +y -y +z -z")
        to_eye = _anatomical(name, ends)
    else:
        angles = re.fullmatch(_ANGLES, name)
        turn, tilt = (float(angles["turn"]), float(angles["tilt"])) if angles else _CORNER_ANGLES
        return _turned(math.radians(turn), math.radians(tilt), ahead)
    up = (0.0, ahead, 0.0) if to_eye[2] else (0.0, 0.0, 1.0)
    return to_eye, up


def _anatomical(name: str, ends: tuple[str, str]) -> Direction:
    for axis, end in enumerate((*ends, "S")):
        if name in (end, _OPPOSITE[end]):
            sign = 1.0 if name == end else -1.0
            return (sign * (axis == 0), sign * (axis == 1), sign * (axis == 2))
    raise AssertionError(name)


def _turned(turn: float, tilt: float, ahead: float) -> tuple[Direction, Direction]:
    """From the front, turned towards +x and raised."""
    across, along = math.sin(turn), ahead * math.cos(turn)
    low, high = math.cos(tilt), math.sin(tilt)
    return (low * across, low * along, high), (-high * across, -high * along, low)
