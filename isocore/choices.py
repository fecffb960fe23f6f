"""What may be asked for in words: each grammar stands here once, and each value prints back to the text it came from.

An isovalue is asked for as a number, `otsu`, `pNN` (percentile), `auto`, `A:B:N` (N numbers from A to B), or `A:B:+S`
(numbers from A towards B in steps of S). The bound on the error is a length in voxels (`0.5`) or in world units
(`0.3mm`), or `none`. The point that vertices are written about is `auto` or three numbers. Choices of different kinds
are never equal, because their texts differ. The command line's help reads this file, so it imports no numpy.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Literal, NamedTuple, TypeAlias, get_args

from isocore.digits import exact
from isocore.errors import OptionError
from isocore.labels import Label

Format: TypeAlias = Literal["ply", "obj", "stl", "glb", "gii", "vtp"]
#: What surfaces are written as; the first is the default.
FORMATS: tuple[Format, ...] = get_args(Format)
#: Those that hold a normal for every vertex.
SHADED_FORMATS = frozenset({"ply", "obj", "glb", "gii", "vtp"})
#: Those that hold fields of the vertices.
FIELD_FORMATS = frozenset({"ply", "glb", "gii", "vtp"})
#: Methods by name; the first is chosen by the field and by what is asked of it.
BACKEND_NAMES = ("auto", "asc", "thinning", "mc")
#: What the coordinates of vertices may mean; as volume.Space.
SPACES = ("ras", "lps", "las", "native", "index")
BLOCK_SIZES = (1, 2, 4, 8, 16, 32)
TOPOLOGIES = ("faces", "trilinear")
#: Millimetres in one unit of length.
MILLIMETRES = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "m": 1e3}

_MOST_OF_A_RANGE = 10_000
#: Regular expressions are compiled when they are used: the help needs none.
_RANGE = r"(?P<first>[^:]+):(?P<last>[^:]+):((?P<count>\d{1,18})|\+(?P<step>[^:]+))"
_LENGTH = r"(?P<number>[^a-zµ]+?(e[-+]?\d+)?)\s*(?P<unit>[a-zµ]*)"


class Number(NamedTuple):
    """An isovalue given as such; text: as it was written, since 50 and 50.0 name different outputs."""

    value: float
    text: str

    def __str__(self) -> str:
        return self.text


class Percentile(NamedTuple):
    """The value below which `percent` (0 to 100) of the finite samples lie; text: as it was written, p90."""

    percent: float
    text: str

    def __str__(self) -> str:
        return self.text


class Otsu(NamedTuple):
    """Otsu's threshold."""

    text: str = "otsu"

    def __str__(self) -> str:
        return self.text


class Auto(NamedTuple):
    """The middle of two values where there are only two, else Otsu's threshold."""

    text: str = "auto"

    def __str__(self) -> str:
        return self.text


Choice: TypeAlias = Number | Percentile | Otsu | Auto | Label


class Voxels(NamedTuple):
    """A bound of so many voxels, counted along the index axes."""

    distance: float
    text: str

    def __str__(self) -> str:
        return self.text


class WorldLength(NamedTuple):
    """A bound in the world; unit: one of MILLIMETRES."""

    distance: float
    unit: str
    text: str

    def __str__(self) -> str:
        return self.text


class Unbounded(NamedTuple):
    """No bound on the error."""

    text: str = "none"

    def __str__(self) -> str:
        return self.text


MaxError: TypeAlias = Voxels | WorldLength | Unbounded


class About(NamedTuple):
    """The point that vertices are written about; None is one chosen by the field; text: as it was written."""

    point: tuple[float, float, float] | None
    text: str

    def __str__(self) -> str:
        return self.text


def parse_choices(texts: Iterable[str]) -> tuple[Choice, ...]:
    """One choice per surface, ranges spread, no two alike; `auto` where nothing is asked for."""
    return distinct(choice for text in texts for choice in spread(text))


def distinct(choices: Iterable[Choice]) -> tuple[Choice, ...]:
    """Each choice once, in the order they are named; `auto` where none is."""
    return tuple(dict.fromkeys(choices)) or (Auto(),)


def parse_choice(text: str) -> Choice:
    """A single choice. Raises OptionError for nonsense, and for a range of several."""
    choice, *others = spread(text)
    if others:
        raise OptionError(f"isovalue {text}: is {1 + len(others)} isovalues; ask for one")
    return choice


def spread(text: str) -> tuple[Choice, ...]:
    """The choices that one text asks for: several for a range. Raises OptionError for nonsense."""
    text = text.strip()
    if text.lower() == "auto":
        return (Auto(),)
    if text.lower() == "otsu":
        return (Otsu(),)
    if text[:1] in ("p", "P") and re.fullmatch(r"[pP][\d.]+", text):
        percent = _number(text, text[1:])
        if not 0 <= percent <= 100:
            raise OptionError(f"isovalue {text}: a percentile lies between p0 and p100")
        return (Percentile(percent, text.lower()),)
    if ":" in text and (match := re.fullmatch(_RANGE, text)):
        return _spread_range(text, match)
    return (Number(_number(text, text), text),)


def _spread_range(text: str, match: re.Match[str]) -> tuple[Choice, ...]:
    """The doubles nearest to the numbers that divide the range in equal steps; each is named so that it reads back."""
    from fractions import Fraction  # late, so that the command line's help stays quick

    # As decimal fractions: 0.1:0.3:3 means 0.2 in the middle, not what rounded ends would make of it.
    start, end = (Fraction(repr(_number(text, match[name]))) for name in ("first", "last"))
    if match["step"] is None:
        count = int(match["count"])
        step = (end - start) / max(count - 1, 1)
    else:
        step = Fraction(repr(_number(text, match["step"])))
        if step <= 0:
            raise OptionError(f"isovalue {text}: the step must lie above 0; it goes from A towards B")
        count = int(abs(end - start) / step) + 1
        step = step if end > start else -step
    if not 1 <= count <= _MOST_OF_A_RANGE:
        raise OptionError(f"isovalue {text}: ask for 1 to {_MOST_OF_A_RANGE} values")
    values = [float(start + step * number) for number in range(count)]
    if len(set(values)) < count:
        raise OptionError(f"isovalue {text}: its {count} values are not all different; ask for fewer or a wider range")
    return tuple(Number(value, exact(value)) for value in values)


def _number(text: str, part: str) -> float:
    try:
        value = float(part)
    except ValueError:
        raise OptionError(f"isovalue {text}: {_advice(text)}") from None
    if not math.isfinite(value):
        raise OptionError(f"isovalue {text}: must be finite")
    return value


def _advice(text: str) -> str:
    """What to write in place of a text that is no isovalue."""
    if "," in text:
        return "has a comma; give each of several isovalues by itself (-i 100 -i 200), and decimals with a point"
    if text.endswith("%"):
        share = text.removesuffix("%").strip().lower().removeprefix("p")
        return f"may mean many things; p{share} is the value below which {share} percent of the samples lie"
    if ":" in text:
        return "is no range; write A:B:N for N values from A to B, or A:B:+S for steps of S"
    return "is not a number, otsu, pNN, A:B:N or A:B:+S"


def parse_max_error(text: str) -> MaxError:
    """A bound on the error. Raises OptionError for nonsense; whether a volume has the unit is checked by its method."""
    text = text.strip()
    if text.lower() == "none":
        return Unbounded(text)
    match = re.fullmatch(_LENGTH, text, re.IGNORECASE)
    wrong = OptionError(f"--max-error {text}: is no length; write voxels (0.5), world units (0.3mm), or none")
    if match is None:
        raise wrong
    unit = match["unit"].lower()
    if unit not in ("", "voxel", "voxels", *MILLIMETRES):
        raise OptionError(f"--max-error {text}: {match['unit']} is no unit known here; write voxels (0.5) or 0.3mm")
    try:
        number = float(match["number"])
    except ValueError:
        raise wrong from None
    if not math.isfinite(number) or number < 0:
        raise OptionError(f"--max-error {text}: must be a finite length, not negative; none lifts the bound")
    return WorldLength(number, unit, text) if unit in MILLIMETRES else Voxels(number, text)


def parse_about(text: str) -> About:
    """The point that vertices are written about: `auto` or `X,Y,Z`. Raises OptionError for nonsense."""
    text = text.strip()
    if text.lower() == "auto":
        return About(None, "auto")
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise OptionError(f"--offset {text}: is no point; write auto, or three numbers as 448000,5412000,0") from None
    if not all(math.isfinite(number) for number in (x, y, z)):
        raise OptionError(f"--offset {text}: must be finite")
    return About((x, y, z), text)
