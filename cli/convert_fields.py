"""What `isocore convert` may be asked of other fields on its surfaces: which, and how they colour them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from isocore import colormaps
from isocore.errors import OptionError

from .groups import option_of
from .values import Worded

_output = option_of("Output")


class Parsed(Worded):
    """What a parser takes. words: what a shell may complete."""

    def __init__(self, name: str, parser: Callable[[str], Any], words: tuple[str, ...] = ()) -> None:
        self.name, self._parser, self.words = name, parser, words

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """Parse the text."""
        if not isinstance(value, str):
            return value
        try:
            return self._parser(value)
        except OptionError as error:
            self.fail(str(error), parameter, context)


FIELDS = (
    _output(
        "--carry",
        multiple=True,
        metavar="NAME|FILE|all",
        show_default="none",
        help="Another field of the input, or all of them, at each vertex; for a volume also another one's file, on the "
        "same grid, as '{folder}/{stem}_FA.nii.gz' for each input. In ply, vtp, glb and gii; repeatable.",
    ),
    _output(
        "--colormap",
        type=Parsed("NAME", colormaps.parse_colormap, colormaps.COLORMAPS),
        metavar="NAME",
        show_default=f"{colormaps.COLORMAPS[0]}, in glb",
        help="Colour vertices, in glb and ply, by what is carried: viridis, plasma, turbo, coolwarm, gray ..., or "
        "backwards, as viridis_r.",
    ),
    _output("--color-by", metavar="NAME", show_default="the first", help="Which of the fields that are carried."),
    _output(
        "--color-range",
        type=Parsed("A:B", colormaps.parse_color_range),
        metavar="A:B",
        show_default="what is on the surface",
        help="Which values the ends of the colour map stand for.",
    ),
)


def check_colours(carry: tuple[str, ...], colour: object, **maps: object) -> None:
    """A map needs numbers, and a colour leaves no room for one. maps: options by their names. Raises UsageError."""
    for name, given in maps.items():
        option = "--" + name.replace("_", "-")
        if given is not None and not carry:
            raise click.UsageError(f"{option}: colours vertices by a field that is carried; add --carry")
        if given is not None and colour is not None:
            raise click.UsageError(f"--color and {option}: are two ways to colour a surface; give one of them")
    if "" in carry:
        raise click.UsageError("--carry: is empty; name a field or a file")
