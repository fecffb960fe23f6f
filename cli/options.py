"""Options that commands share, and how their texts become values."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from isocore import choices
from isocore.errors import OptionError

F = TypeVar("F", bound=Callable[..., Any])


class Numbers(click.ParamType):
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


class MaxError(click.ParamType):
    """Voxels (0.5), world units (0.3mm), or none."""

    name = "E"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> choices.MaxError:
        """The bound; whether a volume knows its unit is the backend's business."""
        try:
            return choices.parse_max_error(str(value).lower())
        except OptionError:
            self.fail(f"{value}: needs voxels (0.5), world units (0.3mm) or none", parameter, context)


class Isovalue(click.ParamType):
    """A number, otsu, pNN or auto; A:B:N are several."""

    name = "V"

    def convert(
        self, value: Any, parameter: click.Parameter | None, context: click.Context | None
    ) -> tuple[choices.Choice, ...]:
        """The choices, one per surface."""
        return choices.spread(str(value))


class VolumeChoice(click.ParamType):
    """Which volume of a 4-D file."""

    name = "K|all"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int | str:
        """A number from 0, or all."""
        if value == "all":
            return "all"
        if not str(value).isdecimal():
            self.fail(f"{value}: needs a number from 0, or all", parameter, context)
        return int(value)


class Memory(click.ParamType):
    """Bytes, as 4G, 500M or a plain number."""

    name = "SIZE"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int:
        """The number of bytes."""
        match = re.fullmatch(r"(?P<number>\d+(\.\d+)?)\s*(?P<unit>[kmgt]?)(i?b)?", str(value).strip().lower())
        if not match:
            self.fail(f"{value}: needs a size, as 500M or 4G", parameter, context)
        return int(float(match["number"]) * 1024 ** " kmgt".index(match["unit"] or " "))


class Jobs(click.ParamType):
    """How many inputs at once."""

    name = "N|auto"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> int | str:
        """A number from 1, or auto."""
        if value == "auto" or isinstance(value, int):
            return value
        if not str(value).isdecimal() or int(value) < 1:
            self.fail(f"{value}: needs a number from 1, or auto", parameter, context)
        return int(value)


def reading_options(command: F) -> F:
    """What a file cannot tell about itself."""
    options = (
        click.option("--volume", type=VolumeChoice(), help="4-D input: which volume, from 0, or all."),
        click.option("--field", metavar="NAME", help="VTU: which point field."),
        click.option("--component", metavar="I|magnitude", help="VTU: which component of a vector field."),
        click.option("--shape", type=Numbers(int), metavar="X,Y,Z", help="Raw: samples per axis."),
        click.option("--dtype", metavar="T", help="Raw: uint8, int16, float32 and so on."),
        click.option("--spacing", type=Numbers(float), metavar="A,B,C", help="Raw: distance of samples per axis."),
        click.option("--origin", type=Numbers(float), metavar="A,B,C", help="Raw: place of the first sample."),
        click.option("--byte-order", type=click.Choice(["little", "big"]), help="Raw: default little."),
        click.option("--offset", type=click.IntRange(min=0), metavar="BYTES", help="Raw: bytes before the samples."),
    )
    return _with(command, options)


def _with(command: F, options: tuple[Callable[[F], F], ...]) -> F:
    for option in reversed(options):
        command = option(command)
    return command


def read_options(chosen: dict[str, Any]) -> Any:
    """The ReadOptions out of a command's arguments; `--volume all` is spread by the caller."""
    from isocore.readers.options import ReadOptions

    names = ("field", "component", "shape", "dtype", "spacing", "origin", "byte_order", "offset")
    volume = chosen["volume"]
    return ReadOptions(volume=volume if isinstance(volume, int) else None, **{name: chosen[name] for name in names})


def default_threads() -> int:
    """The processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def at_once(chosen: dict[str, Any]) -> int:
    """How many inputs are to run at once."""
    return default_threads() if chosen["jobs"] == "auto" else int(chosen["jobs"])


PATH = click.Path(path_type=Path)
