"""Options of `isocore convert` for stills of the surfaces."""

from __future__ import annotations

import re
from typing import Any

import click
from click.core import ParameterSource

from isocore.errors import OptionError

from .groups import option_of
from .param_type import ParamType
from .values import Worded

_output = option_of("Output")
_MOST_PIXELS = 16384


class ViewList(Worded):
    """Views, as A,L,S or 30:15."""

    name = "LIST"

    def offered(self) -> tuple[str, ...]:
        """The words of views."""
        from isocore.views import VIEW_WORDS  # late: no help needs them

        return VIEW_WORDS

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """The views."""
        from isocore.views import Views, parse_views

        if isinstance(value, Views):
            return value
        try:
            return parse_views(value)
        except OptionError as error:
            self.fail(str(error).removeprefix("--view "), parameter, context)


class Size(ParamType):
    """Width and height, as 1024x768."""

    name = "WxH"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> Any:
        """Two numbers of pixels."""
        if isinstance(value, tuple):
            return value
        match = re.fullmatch(r"(\d{1,6})[x,](\d{1,6})", value)
        size = (int(match[1]), int(match[2])) if match else (0, 0)
        if not all(16 <= side <= _MOST_PIXELS for side in size):
            self.fail(f"{value}: needs two numbers of pixels, 16 to {_MOST_PIXELS}, as 1024x768", parameter, context)
        return size


PICTURES = (
    _output(
        "--picture",
        metavar="FILE.png",
        show_default="none",
        help="Draw a still of each surface; of several with the fields of --name, as '{stem}_{isovalue}.png'.",
    ),
    _output(
        "--view",
        type=ViewList(),
        default="corner",
        show_default=True,
        metavar="LIST",
        help="Of the picture, from where: A P L R S I, +x -x +y -y +z -z, corner, or TURN:TILT in degrees from the "
        "front; several, as A,L,S, stand side by side.",
    ),
    _output("--picture-size", type=Size(), default="1024x768", show_default=True, metavar="WxH", help="In pixels."),
)


def check_picture(context: click.Context, template: str | None) -> None:
    """Refuse a picture that is no PNG, names no field that there is, or cannot be drawn here."""
    if template is None:
        for name in ("view", "picture_size"):
            if context.get_parameter_source(name) is ParameterSource.COMMANDLINE:
                option = name.replace("_", "-")
                raise click.UsageError(f"--{option}: says how a picture is drawn; add --picture FILE.png")
        return
    from isocore.batches.naming import check_picture_template  # late: readers bring numpy
    from isocore.pictures import check_installed

    check_picture_template(template)
    check_installed()
