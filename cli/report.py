"""`isocore report`: turn JSON reports into tables and CI formats."""

from __future__ import annotations

from pathlib import Path

import click

from .options import PATH


@click.command(short_help="Turn JSON reports into tables, pages and CI formats.")
@click.argument("reports", nargs=-1, required=True, type=PATH, metavar="REPORT...")
@click.option("--to", "targets", multiple=True, type=PATH, metavar="FILE", help="By suffix; repeatable.")
def report(reports: tuple[Path, ...], targets: tuple[Path, ...]) -> None:
    """Show JSON reports as one table, or write them in other formats.

    \b
    isocore report run.json --to run.md --to run.csv
    """
    from isocore.report import load_report, merged, renderer_for, save_report

    from .console import say_table

    for target in targets:
        renderer_for(target)
    batch = merged([load_report(path) for path in reports])
    for target in targets:
        save_report(batch, target)
    if not targets:
        say_table(batch)
