"""How the texts of options become values, and which words a shell may complete."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

import click

from isocore import choices, labels
from isocore.errors import OptionError

from .param_type import ParamType

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


class Worded(ParamType):
    """A type some of whose values are words, which a shell can complete."""

    words: tuple[str, ...] = ()

    def offered(self) -> tuple[str, ...]:
        """Its words; where they are imported late, they are only when a shell asks."""
        return self.words

    def shell_complete(
        self, context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """The words that begin so."""
        from click.shell_completion import CompletionItem  # late: only a shell asks for words

        return [CompletionItem(word) for word in self.offered() if word.startswith(incomplete.lower())]


class Numbers(ParamType):
    """Three numbers, as 64,64,32."""

    def __init__(self, kind: type[int] | type[float]) -> None:
        self._kind = kind
        self.name = "A,B,C"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """Split and check."""
        if isinstance(value, tuple):
            return value
        try:
            numbers = tuple(self._kind(part) for part in re.split(r"[,x]", value))
        except ValueError:
            numbers = ()
        if len(numbers) != 3:
            self.fail(f"{value}: needs three numbers, as 64,64,32", parameter, context)
        return numbers


class Offset(ParamType):
    """Bytes before a raw file's samples (352), or the point that vertices are written about (auto or X,Y,Z)."""

    name = "auto|X,Y,Z|BYTES"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """A number of bytes, or the point."""
        if str(value).isdecimal():
            return int(value)
        try:
            return choices.parse_about(str(value))
        except OptionError:
            self.fail(f"{value}: needs auto or X,Y,Z, or a number of bytes for raw files", parameter, context)


class Positive(ParamType):
    """A finite number above 0."""

    name = "EPS"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> float:
        """The number."""
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not 0 < number < math.inf:
            self.fail(f"{value}: needs a number above 0", parameter, context)
        return number


class Ignored(ParamType):
    """A finite number: what is not finite counts as outside anyway."""

    name = "VALUE"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> float:
        """The number."""
        try:
            number = float(value)
        except ValueError:
            self.fail(f"{value}: needs a number, as -9999", parameter, context)
        if not math.isfinite(number):
            self.fail(f"{value}: counts as outside anyway; leave it out", parameter, context)
        return number


class MaxErrorType(Worded):
    """Voxels (0.5), world units (0.3mm), or none."""

    name = "E"
    words = ("none",)

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> choices.MaxError:
        """The bound; whether a volume knows its unit is the backend's business."""
        try:
            return choices.parse_max_error(str(value).lower())
        except OptionError:
            self.fail(f"{value}: needs voxels (0.5), world units (0.3mm) or none", parameter, context)


class Isovalue(Worded):
    """A number, otsu, pNN or auto; A:B:N are several."""

    name = "V"
    words = ("auto", "otsu")

    def convert(
        self, value: Any, parameter: click.Parameter | None, context: click.Context | None
    ) -> tuple[choices.Choice, ...]:
        """The choices, one per surface."""
        return choices.spread(str(value))


class Colour(ParamType):
    """Red, green and blue."""

    name = "'#rrggbb'"

    def convert(
        self, value: Any, parameter: click.Parameter | None, context: click.Context | None
    ) -> tuple[int, int, int]:
        """Three numbers from 0 to 255."""
        return value if isinstance(value, tuple) else labels.parse_colour(str(value))


class LabelList(Worded):
    """Which labels of a label map."""

    name = "all|LIST"
    words = ("all",)

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> labels.Labels:
        """All, or numbers and ranges."""
        return labels.parse_labels(str(value))


class VolumeChoice(Worded):
    """Which volume of a 4-D file."""

    name = "K|all"
    words = ("all",)

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int | str:
        """A number from 0, or all."""
        if value == "all":
            return "all"
        if not re.fullmatch(r"\d{1,18}", str(value)):
            self.fail(f"{value}: needs a number from 0, or all", parameter, context)
        return int(value)


class Memory(ParamType):
    """Bytes, as 4G, 500M or a plain number."""

    name = "SIZE"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int:
        """The number of bytes."""
        match = re.fullmatch(r"(?P<number>\d{1,18}(\.\d+)?)\s*(?P<unit>[kmgt]?)(i?b)?", str(value).strip().lower())
        if not match:
            self.fail(f"{value}: needs a size, as 500M or 4G", parameter, context)
        return int(float(match["number"]) * 1024 ** " kmgt".index(match["unit"] or " "))


class Jobs(Worded):
    """How many inputs at once."""

    name = "N|auto"
    words = ("auto",)

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int | str:
        """A number from 1, or auto."""
        if isinstance(value, int):
            return value
        if value == "auto":
            return "auto"
        if not re.fullmatch(r"\d{1,18}", str(value)) or int(value) < 1:
            self.fail(f"{value}: needs a number from 1, or auto", parameter, context)
        return int(value)


class Words(Worded):
    """Several words, with commas or blanks between them; whoever reads them checks them."""

    name = "LIST"

    def __init__(self, words: tuple[str, ...]) -> None:
        self.words = words

    def shell_complete(
        self, context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Each word after those that are there already."""
        from click.shell_completion import CompletionItem

        before, comma, last = incomplete.rpartition(",")
        items = super().shell_complete(context, parameter, last)
        return [CompletionItem(before + comma + item.value) for item in items]
