"""Options that commands share."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import click

from isocore import choices
from isocore.memory import processors

from .groups import option_of
from .values import Ignored, Numbers, Offset, Positive, VolumeChoice

if TYPE_CHECKING:
    from isocore.readers.options import ReadOptions

#: How many threads there are unless fewer are asked for.
default_threads = processors

F = TypeVar("F", bound=Callable[..., Any])


class Reading(NamedTuple):
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
    corners: bool
    ignore: tuple[float, ...]

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
            ignore=self.ignore,
            mesh=MeshOptions(
                merge_points=self.merge_points, keep_duplicates=self.keep_duplicates, corners=self.corners
            ),
        )


def reading_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of Reading; it gets them as one argument, `reading`."""
    return with_all(_with_reading(command), (*_READING_OPTIONS, _RAW_OFFSET))


def reading_and_offset_options(command: Callable[..., None]) -> Callable[..., None]:
    """As reading_options, for a command with the option OFFSETS: `--offset` takes bytes or a point, each once.

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

    return with_all(with_offsets, _READING_OPTIONS)


def _with_reading(command: Callable[..., None]) -> Callable[..., None]:
    @wraps(command)
    def with_reading(*arguments: Any, **values: Any) -> None:
        reading = Reading(**{name: values.pop(name) for name in Reading._fields})
        if reading.merge_points is not None and reading.keep_duplicates:
            raise click.UsageError("--merge-points joins points and --keep-duplicates leaves them; give one of them")
        command(*arguments, reading=reading, **values)

    return with_reading


_input = option_of("Input")

_READING_OPTIONS = (
    _input(
        "--volume",
        type=VolumeChoice(),
        metavar="K|all",
        show_default="the only one",
        help="Which volume of a 4-D input, counted from 0, or all.",
    ),
    _input("--field", metavar="NAME", show_default="the only one", help="Which point field of a mesh."),
    _input(
        "--component",
        metavar="I|magnitude",
        help="Which component of a mesh's vector field, counted from 0, or its length; needed for one.",
    ),
    _input(
        "--ignore",
        type=Ignored(),
        show_default="none",
        metavar="VALUE",
        multiple=True,
        help="A value that means that nothing is there: outside, as NaN is; may be repeated.",
    ),
    _input(
        "--merge-points",
        type=Positive(),
        metavar="EPS",
        show_default="0",
        help="Meshes: join points within this distance, not only those at equal coordinates.",
    ),
    _input("--keep-duplicates", is_flag=True, help="Meshes: join no points."),
    _input("--corners", is_flag=True, help="Meshes: read curved cells by their corners alone."),
    _input("--shape", type=Numbers(int), metavar="X,Y,Z", help="Raw: samples per axis, as 64,64,32; needed."),
    _input("--dtype", metavar="T", help="Raw: int8 to int64, uint8 to uint64, float32 or float64; needed."),
    _input(
        "--spacing", type=Numbers(float), metavar="A,B,C", show_default="1,1,1", help="Raw: distance of samples."
    ),
    _input(
        "--origin", type=Numbers(float), metavar="A,B,C", show_default="0,0,0", help="Raw: place of the first sample."
    ),
    _input(
        "--byte-order",
        type=click.Choice(["little", "big"], case_sensitive=False),
        show_default="little",
        help="Raw: of each sample.",
    ),
)

_RAW_OFFSET = _input(
    "--offset",
    type=click.IntRange(min=0),
    metavar="BYTES",
    show_default="0",
    help="Raw: bytes before the samples. What a NAME.raw.json beside the file says needs no option.",
)
OFFSETS = option_of("Output")(
    "--offset",
    multiple=True,
    type=Offset(),
    metavar="auto|X,Y,Z|BYTES",
    show_default="0",
    help="Write vertices about this point, or one that isocore chooses; raw: bytes before the samples.",
)


def with_all(command: F, options: Iterable[Callable[[F], F]]) -> F:
    """The command with these options, which its help lists in this order."""
    for option in reversed(tuple(options)):
        command = option(command)
    return command


class PathType(click.Path):
    """A path, but not an empty one: that is what a variable without a value leaves, and means the working folder."""

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """The path. Whether it is there and may be read is found where it is read: one that is not stops no others."""
        if value == "":
            self.fail("is empty; name a file or a folder", parameter, context)
        return super().convert(value, parameter, context)


class OutputType(PathType):
    """A file to be written: with a slash at its end it would be a folder, and `-d` is meant."""

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        if str(value).endswith(("/", os.sep)):
            self.fail(f"{value} is a folder; name a file in it, or give the folder with -d", parameter, context)
        return super().convert(value, parameter, context)


PATH = PathType(path_type=Path, readable=False)
OUTPUT_FILE = OutputType(path_type=Path, readable=False)
