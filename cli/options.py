"""Options that commands share, and how their texts become values."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import click

from isocore import choices
from isocore.errors import OptionError

if TYPE_CHECKING:
    from isocore.readers.options import ReadOptions

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


class Offset(click.ParamType):
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


class Positive(click.ParamType):
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


class MaxErrorType(click.ParamType):
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """What a file cannot tell about itself, as it was typed."""

    volume: int | Literal["all"] | None
    field: str | None
    component: str | None
    shape: tuple[int, ...] | None
    dtype: str | None
    spacing: tuple[float, ...] | None
    origin: tuple[float, ...] | None
    byte_order: str | None
    offset: int | None
    merge_points: float | None
    keep_duplicates: bool

    def read_options(self) -> ReadOptions:
        """The same for a reader; a volume of "all" is spread by whoever plans the jobs."""
        from isocore.readers.options import MeshOptions, ReadOptions  # late: readers bring numpy, which no help needs

        return ReadOptions(
            volume=None if self.volume == "all" else self.volume,
            field=self.field,
            component=self.component,
            shape=self.shape,
            dtype=self.dtype,
            spacing=self.spacing,
            origin=self.origin,
            byte_order=self.byte_order,
            offset=self.offset,
            mesh=MeshOptions(merge_points=self.merge_points, keep_duplicates=self.keep_duplicates),
        )


def reading_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of Reading; it gets them as one argument, `reading`."""
    return with_all(_with_reading(command), (*_READING_OPTIONS, _RAW_OFFSET))


def reading_and_offset_options(command: Callable[..., None]) -> Callable[..., None]:
    """As reading_options, for a command that writes vertices: `--offset` takes bytes or a point, each once.

    The command gets the point as one more argument, `about`.
    """
    inner = _with_reading(command)

    @wraps(command)
    def with_offsets(*arguments: Any, offset: tuple[int | choices.About, ...], **values: Any) -> None:
        raw = [given for given in offset if isinstance(given, int)]
        points = [given for given in offset if not isinstance(given, int)]
        if len(raw) > 1 or len(points) > 1:
            raise click.UsageError("--offset: is given twice; once for bytes and once for a point is all there is")
        inner(*arguments, offset=raw[0] if raw else None, about=points[0] if points else None, **values)

    return with_all(with_offsets, (*_READING_OPTIONS, _OFFSETS))


def _with_reading(command: Callable[..., None]) -> Callable[..., None]:
    @wraps(command)
    def with_reading(*arguments: Any, **values: Any) -> None:
        reading = Reading(**{item.name: values.pop(item.name) for item in fields(Reading)})
        if reading.merge_points is not None and reading.keep_duplicates:
            raise click.UsageError("--merge-points joins points and --keep-duplicates leaves them; give one of them")
        command(*arguments, reading=reading, **values)

    return with_reading


_READING_OPTIONS = (
    click.option("--volume", type=VolumeChoice(), help="4-D input: which volume, from 0, or all."),
    click.option("--field", metavar="NAME", help="VTU: which point field."),
    click.option("--component", metavar="I|magnitude", help="VTU: which component of a vector field."),
    click.option(
        "--merge-points",
        type=Positive(),
        metavar="EPS",
        help="Meshes: join points within this distance too, not only those at equal coordinates.",
    ),
    click.option("--keep-duplicates", is_flag=True, help="Meshes: join no points."),
    click.option("--shape", type=Numbers(int), metavar="X,Y,Z", help="Raw: samples per axis."),
    click.option("--dtype", metavar="T", help="Raw: uint8, int16, float32 and so on."),
    click.option("--spacing", type=Numbers(float), metavar="A,B,C", help="Raw: distance of samples per axis."),
    click.option("--origin", type=Numbers(float), metavar="A,B,C", help="Raw: place of the first sample."),
    click.option("--byte-order", type=click.Choice(["little", "big"]), help="Raw: default little."),
)

_RAW_OFFSET = click.option(
    "--offset", type=click.IntRange(min=0), metavar="BYTES", help="Raw: bytes before the samples."
)
_OFFSETS = click.option(
    "--offset", multiple=True, type=Offset(), help="Write vertices about this point; raw: bytes before the samples."
)


def with_all(command: F, options: Iterable[Callable[[F], F]]) -> F:
    """The command with these options, which its help lists in this order."""
    for option in reversed(tuple(options)):
        command = option(command)
    return command


def default_threads() -> int:
    """The processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


#: Whether a file is there and may be read is found where it is read: one that may not be stops no others.
PATH = click.Path(path_type=Path, readable=False)
