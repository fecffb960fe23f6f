"""`isocore report`: turn JSON reports into tables, pages and CI formats; compare two."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .console import say
from .groups import GroupedCommand
from .options import PATH
from .values import Memory

if TYPE_CHECKING:
    from isocore.report import BatchReport

#: Of the columns of a comparison: whether set to the right, in which place it leaves a narrow screen, and whether it
#: holds names.
_COMPARED = (
    (False, 0, True),
    (True, 5, False),
    (True, 0, False),
    (True, 2, False),
    (True, 0, False),
    (True, 4, False),
    (True, 1, False),
    (True, 3, False),
    (False, 0, False),
)


@click.command(cls=GroupedCommand, short_help="Turn JSON reports into tables, pages and CI formats; compare two.")
@click.argument("reports", nargs=-1, required=True, type=PATH, metavar="REPORT...")
@click.option("--to", "targets", multiple=True, type=PATH, metavar="FILE", help="By suffix, or bench.json; repeatable.")
@click.option("--compare", is_flag=True, help="Set the second REPORT beside the first.")
@click.option(
    "--fail-if", "limits", multiple=True, metavar="LIMIT", help="As 'triangles>+2%'; exit code 3. Repeatable."
)
@click.option("--page-size", type=Memory(), default="16M", show_default=True, help="For surfaces in an HTML page.")
@click.pass_context
def report(
    context: click.Context,
    reports: tuple[Path, ...],
    targets: tuple[Path, ...],
    compare: bool,
    limits: tuple[str, ...],
    page_size: int,
) -> None:
    """Show JSON reports as one table, write them in other formats, or compare two.

    \b
    isocore report run.json --to run.html --to run.csv
    isocore report --compare old.json new.json --fail-if 'triangles>+2%' --fail-if 'seconds>+20%'
    """
    from isocore.batches.places import refuse_overwriting_files
    from isocore.errors import IsocoreError
    from isocore.report import load_report, merged, renderer_for, save_report
    from isocore.report.copies_found import with_copies
    from isocore.report.limits import check_limits, parse_limit

    from .console import say_table

    parsed = [parse_limit(limit) for limit in limits]
    refuse_overwriting_files(
        [("is a report that is read", path) for path in reports], [("--to", path) for path in targets]
    )
    for target in targets:
        renderer_for(target)
    if compare and len(reports) != 2:
        raise click.UsageError(f"--compare needs two reports, the earlier one first, not {len(reports)}")
    if compare and targets:
        raise click.UsageError("--compare shows a table and writes no --to FILE; leave one of them out")
    if limits and not compare:
        raise click.UsageError("--fail-if goes with --compare")
    batches = [load_report(path) for path in reports]
    if compare:
        from isocore.report.compare import HEADINGS, compared, comparison_rows, faults

        from .console import screen_width
        from .table import Column, set_table

        check_limits(parsed, *batches)
        found = compared(batches[0], batches[1])
        columns = [Column(name, *set_) for name, set_ in zip(HEADINGS, _COMPARED, strict=True)]
        click.echo("\n".join(set_table(columns, comparison_rows(found), screen_width(sys.stdout))))
        broken = faults(found, parsed)
        for line in broken:
            say(f"isocore: {line}")
        if found.share_nothing and not parsed:
            say("isocore: warning: the reports share no output, so nothing was compared")
        context.exit(3 if broken else 0)
    pages = [target for target in targets if target.suffix.lower() == ".html"]
    if pages and page_size:
        room = page_size // len(batches)
        batches = [with_copies(one, room, path) for one, path in zip(batches, reports, strict=True)]
    batch = merged(batches)
    if pages and page_size:
        _say_lacking(batch, pages[0])
    unwritten = False
    for target in targets:
        try:
            save_report(batch, target, mesh_bytes=page_size)
        except IsocoreError as error:
            say(f"isocore: {error}")
            unwritten = True
    if not targets:
        say_table(batch, as_result=True)
    context.exit(1 if unwritten else 0)


def _say_lacking(batch: BatchReport, page: Path) -> None:
    """How many surfaces a page is to show and cannot, and what to do."""
    lacking = [run for run in batch.outputs if run.triangles and run.output != "-" and run.copy is None]
    if lacking:
        total = sum(run.triangles > 0 for run in batch.outputs)
        say(
            f"isocore: warning: {page}: has no copy of {len(lacking)} of {total} surfaces: {lacking[0].output} is not "
            "where the report says, or changed; let convert write the page, or keep its .json.copies file beside it"
        )
