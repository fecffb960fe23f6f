"""Which pieces of a surface `isocore convert` keeps: the options, and how large a piece must be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .groups import option_of
from .param_type import ParamType

if TYPE_CHECKING:
    from isocore.piece_sizes import MinPiece

_pieces = option_of("Pieces")


class MinPieceType(ParamType):
    """Triangles (20), or a volume in the world (20mm3)."""

    name = "SIZE"

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> MinPiece:
        """The size; whether a surface knows its unit is known when it is there."""
        from isocore.piece_sizes import parse_min_piece  # late: no help needs it

        return parse_min_piece(str(value))


PIECES = (
    _pieces(
        "--keep-largest",
        type=click.IntRange(min=1),
        metavar="N",
        show_default="all",
        help="Keep the N largest pieces of each surface, by enclosed volume, or by area where one is open. A piece is "
        "a solid with its bubbles.",
    ),
    _pieces(
        "--min-piece",
        type=MinPieceType(),
        metavar="SIZE",
        show_default="all",
        help="Drop pieces of fewer triangles (20), or of a smaller volume (20mm3).",
    ),
    _pieces("--fill-bubbles", is_flag=True, help="Drop the inner shells of the pieces kept, and all that is inside."),
)
