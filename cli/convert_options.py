"""What `isocore convert` may be asked: an option and its field beside each other, in the order of the help."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any, Literal

import click

from isocore.choices import BLOCK_SIZES, FORMATS, TOPOLOGIES, About, Choice, Format, MaxError
from isocore.requirements import REQUIREMENTS

from .options import (
    PATH,
    Isovalue,
    Jobs,
    MaxErrorType,
    Memory,
    Reading,
    default_threads,
    reading_and_offset_options,
    with_all,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvertOptions:
    """All of a command line, by the options' long names; checked one by one, not yet against each other."""

    inputs: tuple[Path, ...]
    files_from: Path | None
    isovalues: tuple[tuple[Choice, ...], ...]
    output: Path | None
    output_dir: Path | None
    format: Format | None
    name: str | None
    backend: str | None
    block_size: str | None
    max_error: MaxError | None
    topology: str | None
    space: Literal["ras", "lps", "las", "native", "index"]
    normals: bool | None
    cap: bool
    reading: Reading
    about: About | None
    ambiguities: Path | None
    reference: bool
    require: str | None
    max_triangles: int | None
    jobs: int | Literal["auto"]
    timeout: float | None
    memory_limit: int | None
    scheduler: str | None
    if_changed: bool
    force: bool
    threads: int | None
    reports: tuple[Path, ...]
    page_size: int
    as_json: bool
    depfile: Path | None
    dry_run: bool
    fail_fast: bool
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

    return with_all(with_record, (*_WHAT_AND_WHERE, *_HOW, reading_and_offset_options, *_CHECKED, *_AT_ONCE, *_TOLD))


_WHAT_AND_WHERE = (
    click.argument("inputs", nargs=-1, type=PATH, metavar="INPUT..."),
    click.option("--files-from", type=PATH, metavar="FILE|-", help="Read further inputs from a file, one a line."),
    click.option(
        "-i", "--isovalue", "isovalues", multiple=True, type=Isovalue(), help="A number, otsu, pNN, A:B:N; repeatable."
    ),
    click.option("-o", "--output", type=PATH, metavar="FILE", help="For one input and one isovalue; - is stdout."),
    click.option("-d", "--output-dir", type=PATH, metavar="DIR", help="For many; mirrors the input tree."),
    click.option("-f", "--format", type=click.Choice(FORMATS), help="Default ply, or the suffix of -o."),
    click.option(
        "--name", metavar="TEMPLATE", help="Default {stem}; also {name} {isovalue} {relpath} {backend} {volume}."
    ),
)

_HOW = (
    click.option("-b", "--backend", metavar="NAME", help="The method: asc, thinning, mc; default auto."),
    click.option(
        "--block-size", type=click.Choice([str(size) for size in BLOCK_SIZES]), help="asc: cells per block."
    ),
    click.option("--max-error", type=MaxErrorType(), help="asc: in voxels (0.5), world units (0.3mm) or none."),
    click.option("--topology", type=click.Choice(TOPOLOGIES), help="mc: disks in a cell, or tubes too."),
    click.option(
        "--space", type=click.Choice(["ras", "lps", "las", "native", "index"]), default="native", show_default=True
    ),
    click.option("--normals/--no-normals", default=None, help="Vertex normals; default on where the format has them."),
    click.option("--cap/--no-cap", help="Close the surface at the volume's border."),
)

_CHECKED = (
    click.option("--ambiguities", type=PATH, metavar="FILE", help="Write the ambiguous places as points, PLY."),
    click.option("--reference/--no-reference", default=True, help="Run marching cubes too, to compare; default on."),
    click.option("--require", metavar="LIST", help=f"Any of {' '.join(REQUIREMENTS)}; a miss is exit code 3."),
    click.option("--max-triangles", type=click.IntRange(min=0), metavar="N", help="More is exit code 3."),
)

_AT_ONCE = (
    click.option("-j", "--jobs", type=Jobs(), default=1, help="Inputs at once, each in a process of its own."),
    click.option(
        "--timeout", type=click.FloatRange(min=0, min_open=True), metavar="SECONDS", help="Give up an input."
    ),
    click.option("--memory-limit", type=Memory(), help="For all inputs at once; default what is free."),
    click.option("--scheduler", metavar="ADDRESS", help="Send inputs to a dask scheduler instead."),
    click.option("--if-changed", is_flag=True, help="Skip outputs that are up to date."),
    click.option("--force", is_flag=True, help="Convert also what --if-changed would skip."),
    click.option(
        "--threads", type=click.IntRange(min=1), metavar="N", help="Threads inside one input; default all."
    ),
)

_TOLD = (
    click.option("--report", "reports", multiple=True, type=PATH, metavar="FILE", help="By suffix; repeatable."),
    click.option(
        "--page-size", type=Memory(), default="16M", show_default=True, help="For surfaces in an HTML report."
    ),
    click.option("--json", "as_json", is_flag=True, help="The JSON report on stdout."),
    click.option("--depfile", type=PATH, metavar="FILE", help="Write make rules: which outputs need which files."),
    click.option("--dry-run", is_flag=True, help="Only say what would be done."),
    click.option("--fail-fast", is_flag=True, help="Stop at the first input that fails."),
    click.option("-q", "--quiet", is_flag=True, help="Only errors and warnings."),
    click.option("-v", "--verbose", is_flag=True, help="One line per output as it is done."),
    click.option("--no-progress", is_flag=True, help="No live progress bar."),
)
