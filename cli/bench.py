"""`isocore bench`: the papers' tables on the user's own data."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from isocore.errors import printable, told

from .console import say, screen_width, styled, unarmed
from .groups import GroupedCommand, option_of
from .options import PATH, Reading, default_threads, reading_options
from .table import columns_of, set_table

if TYPE_CHECKING:
    from isocore.benches.thinning import Table
    from isocore.volume import Volume


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """Which tables, of what, and where a volume's goes besides the screen."""

    reading: Reading
    backend: Literal["asc", "thinning"]
    isovalue: str | None
    isovalues: int
    threads: int
    csv: Path | None
    markdown: Path | None
    plot: Path | None

    def check(self, files: int) -> None:
        """Refuse options that do not go together."""
        in_files = self.csv or self.markdown or self.plot
        if files > 1 and in_files:
            raise click.UsageError("--csv, --markdown and --plot name one file; give one FILE")
        if self.backend == "thinning" and (self.isovalue or in_files):
            raise click.UsageError("-i, --csv, --markdown and --plot belong to -b asc; -b thinning takes --isovalues")


@click.command(cls=GroupedCommand, short_help="The papers' tables on your own data.")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@reading_options
@option_of("Isovalue")(
    "-i", "--isovalue", metavar="V", show_default="auto", help="Volumes: a number, otsu, pNN or auto, as in convert."
)
@option_of("Isovalue")(
    "--isovalues", default=20, show_default=True, type=click.IntRange(1), metavar="N", help="Meshes, thinning: number."
)
@option_of("Method")(
    "-b",
    "--backend",
    type=click.Choice(["asc", "thinning"]),
    default="asc",
    show_default=True,
    help="Volumes: climbing against marching cubes, or thinning against its rivals.",
)
@option_of("Method")(
    "--threads", type=click.IntRange(1), metavar="N", show_default="all processors", help="Threads for drawing."
)
@option_of("Report")("--csv", type=PATH, metavar="FILE", help="Volumes: the table as CSV.")
@option_of("Report")("--markdown", type=PATH, metavar="FILE", help="Volumes: the table as Markdown.")
@option_of("Report")("--plot", type=PATH, metavar="FILE", help="Volumes: triangles and time by block size, SVG.")
@option_of("Report")("--json", "as_json", is_flag=True, help="The same as JSON on stdout.")
@click.pass_context
def bench(
    context: click.Context, /, files: tuple[Path, ...], threads: int | None, as_json: bool, **chosen: Any
) -> None:
    """Print the papers' tables for each FILE: a volume's triangles, time and error by block size and error bound, or
    the time every way to find an isosurface's cells takes in a mesh.

    \b
    isocore bench sample_volumes/knot.nii.gz -i 200 --plot knot.svg
    isocore bench sample_volumes/torus.vtu
    isocore bench sample_volumes/knot.nii.gz -b thinning
    """
    wanted = Wanted(threads=threads or default_threads(), **chosen)
    wanted.check(len(files))
    _refuse_overwriting(files, wanted)

    failures = 0
    records = []
    for path in files:
        try:
            tables = _tables(path, wanted)
        except Exception as error:  # one bad file never stops the others
            say(f"isocore: {told(path, error)}")
            failures += 1
            continue
        if as_json:
            records.append({"source": str(path), "tables": [_record(table) for table in tables]})
        else:
            click.echo("\n\n".join([styled(unarmed(printable(path, stray=True)), bold=True), *map(_text, tables)]))
    if as_json:
        import json

        click.echo(json.dumps(records, indent=2))
    context.exit(1 if failures else 0)


def _refuse_overwriting(files: tuple[Path, ...], wanted: Wanted) -> None:
    from isocore.batches.places import refuse_overwriting_files
    from isocore.readers import files_of

    named = (("--csv", wanted.csv), ("--markdown", wanted.markdown), ("--plot", wanted.plot))
    refuse_overwriting_files(
        [("belongs to the input", file) for path in files for file in files_of(path)],
        [(option, path) for option, path in named if path is not None],
    )


def _tables(path: Path, wanted: Wanted) -> list[Table]:
    from isocore.benches.grid_thinning import grid_bench
    from isocore.benches.thinning import mesh_bench
    from isocore.cell_mesh import CellMesh
    from isocore.errors import FieldError
    from isocore.readers import read

    field = read(path, wanted.reading.read_options())
    try:
        if isinstance(field, CellMesh):
            return mesh_bench(field, isovalues=wanted.isovalues, threads=wanted.threads)
        if wanted.backend == "thinning":
            return grid_bench(field, isovalues=wanted.isovalues, threads=wanted.threads)
        return [_volume_table(path, field, wanted)]
    except FieldError as error:
        raise FieldError(f"{path}: {error}") from error


def _volume_table(path: Path, volume: Volume, wanted: Wanted) -> Table:
    from isocore.benches.climbing import render_csv, render_markdown, volume_bench
    from isocore.benches.climbing_plot import render_svg
    from isocore.choices import parse_choices
    from isocore.histogram import histogram
    from isocore.isovalue import choose
    from isocore.whole_file import whole_file

    asked = parse_choices([wanted.isovalue] if wanted.isovalue else [])
    if len(asked) != 1:
        raise click.UsageError(f"-i {wanted.isovalue}: bench takes one isovalue")
    threads = wanted.threads
    chosen = choose(asked[0], histogram(volume, threads=threads))
    for warning in (*volume.warnings, *chosen.warnings):
        say(f"isocore: warning: {printable(f'{path}: {warning}')}")
    found = volume_bench(volume, chosen.isovalue, threads=threads)
    table = found.table()
    for target, text in (
        (wanted.csv, render_csv(table)),
        (wanted.markdown, render_markdown(table)),
        (wanted.plot, render_svg(found)),
    ):
        if target is not None:
            with whole_file(target) as stream:
                stream.write(text.encode())
    return table


def _record(table: Table) -> dict[str, Any]:
    return {"title": table.title, "rows": [dict(zip(table.columns, row, strict=True)) for row in table.rows]}


def _text(table: Table) -> str:
    """Columns under their headings, numbers to the right, in the width of the terminal."""
    rows = [tuple(map(_cell, row)) for row in table.rows]
    numeric = (column for column, entry in zip(table.columns, table.rows[0], strict=True) if not isinstance(entry, str))
    columns = columns_of(table.columns, frozenset(numeric), table.leaving)
    return "\n".join([table.title, *set_table(columns, rows, screen_width(sys.stdout))])


def _cell(entry: str | int | float) -> str:
    return entry if isinstance(entry, str) else f"{entry:,}" if isinstance(entry, int) else f"{entry:.4g}"
