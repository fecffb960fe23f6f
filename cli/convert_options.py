"""All that `isocore convert` was asked, in the order of its help."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import click

from isocore.choices import About, Choice, Format, MaxError

from .convert_fields import FIELDS
from .convert_groups import BATCH, INPUT, ISOVALUE, LABELS, OUTPUT, REPORT
from .convert_method import METHOD
from .convert_pictures import PICTURES
from .convert_pieces import PIECES
from .options import Reading, default_threads, with_all
from .steps import Range

if TYPE_CHECKING:
    from isocore.labels import Labels
    from isocore.piece_sizes import MinPiece
    from isocore.views import Views
    from isocore.volume import Space


class ConvertOptions(NamedTuple):
    """All of a command line, by the options' long names; checked one by one, not yet against each other."""

    inputs: tuple[Path, ...]
    files_from: Path | None
    null: bool
    reading: Reading
    steps: tuple[Range, ...]
    times: tuple[float, ...]
    isovalues: tuple[tuple[Choice, ...], ...]
    labels: Labels | None
    background: int | None
    label_table: Path | None
    backend: str
    max_error: MaxError | None
    simplify: bool | None
    triangles: int | None
    block_size: str | None
    topology: str | None
    smooth: int | None
    cap: bool
    keep_largest: int | None
    min_piece: MinPiece | None
    fill_bubbles: bool
    output: Path | None
    output_dir: Path | None
    merge_isovalues: bool
    compress: bool
    format: Format | None
    name: str | None
    space: Space
    about: About | None
    normals: bool | None
    colour: tuple[int, int, int] | None
    carry: tuple[str, ...]
    colormap: str | None
    color_by: str | None
    color_range: tuple[float, float] | None
    picture: str | None
    view: Views
    picture_size: tuple[int, int]
    ambiguities: Path | None
    jobs: int | Literal["auto"]
    threads: int | None
    timeout: float | None
    memory_limit: int | None
    scheduler: str | None
    if_changed: bool
    force: bool
    fail_fast: bool
    dry_run: bool
    depfile: Path | None
    reports: tuple[Path, ...]
    page_size: int
    as_json: bool
    reference: bool
    self_intersections: bool
    require: str | None
    max_triangles: int | None
    quiet: bool
    verbose: bool
    no_progress: bool

    @property
    def at_once(self) -> int:
        """How many inputs are to run at once."""
        return default_threads() if self.jobs == "auto" else self.jobs


def convert_options(command: Callable[[click.Context, ConvertOptions], None]) -> Callable[..., None]:
    """Give a command these options; it gets them as one ConvertOptions."""

    @wraps(command)
    def with_record(context: click.Context, /, **values: Any) -> None:
        command(context, ConvertOptions(**values))

    output = (*OUTPUT, *FIELDS, *PICTURES)
    options: tuple[Any, ...] = (*INPUT, *ISOVALUE, *LABELS, *METHOD, *PIECES, *output, *BATCH, *REPORT)
    return with_all(with_record, options)
