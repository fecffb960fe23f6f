"""`isocore info`: what a file holds, and which isovalues make sense."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .options import PATH, Reading, default_threads, reading_options

if TYPE_CHECKING:
    from isocore.describe import Description
    from isocore.histogram import Bars

_WIDTH = 64
_BARS = " ▁▂▃▄▅▆▇█"
_ROWS = 6


@click.command(short_help="What a file holds, and which isovalues make sense.")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@reading_options
@click.option("--json", "as_json", is_flag=True, help="The same as JSON on stdout.")
@click.pass_context
def info(context: click.Context, files: tuple[Path, ...], as_json: bool, reading: Reading) -> None:
    """Say what each FILE holds and which isovalues make sense.

    \b
    isocore info sample_volumes/knot.nii.gz
    """
    from isocore.describe import describe
    from isocore.errors import IsocoreError

    failures = 0
    described: list[dict[str, Any]] = []
    for path in files:
        try:
            found = describe(path, reading.read_options(), threads=default_threads())
        except IsocoreError as error:
            click.echo(f"isocore: {error}", err=True)
            failures += 1
            continue
        if as_json:
            described.append(_record(path, found))
        else:
            click.echo("\n".join(_lines(path, found)))
    if as_json:
        from isocore.report.texts import json_text

        click.echo(json_text(described, indent=2))
    context.exit(1 if failures else 0)


def _record(path: Path, found: Description) -> dict[str, Any]:
    from isocore.report.keys import plain

    isovalues = [{"isovalue": one.isovalue, "option": str(one.asked), "why": one.why} for one in found.isovalues]
    record = {"source": str(path), **found.facts, "histogram": found.spread.coarse(), "isovalues": isovalues}
    plain_record: dict[str, Any] = plain(record)
    return plain_record


def _lines(path: Path, found: Description) -> list[str]:
    lines = [str(path) if os.environ.get("NO_COLOR") else click.style(str(path), bold=True)]
    lines += [f"  {key:<12} {_line(key, value)}" for key, value in found.facts.items() if _worth_a_line(key, value)]
    lines += [f"  {'warning':<12} {warning}" for warning in found.facts["warnings"]]
    lines += drawn(found.spread.coarse(_WIDTH))
    for choice in found.isovalues:
        lines.append(f"  {'isovalue':<12} {choice.isovalue:<12.6g} -i {choice.asked!s:<6} {choice.why}")
    if not found.isovalues:
        lines.append(f"  {'isovalue':<12} none: the samples do not differ")
    return lines


def _line(key: str, value: Any) -> str:
    if key == "range":
        return f"{_text(value[0])} to {_text(value[1])}" if value else "no finite sample"
    if key == "bounds":
        low, high = (", ".join(_text(part) for part in corner) for corner in value)
        return f"({low}) to ({high})"
    return _text(value)


def _worth_a_line(key: str, value: Any) -> bool:
    usual = {"slope": 1.0, "intercept": 0.0, "oblique": False}
    return key != "warnings" and value not in ("", [], None) and (key not in usual or value != usual[key])


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{number:,} {name}" for name, number in value.items())
    if isinstance(value, (list, tuple)):
        return (", " if value and isinstance(value[0], str) else " x ").join(_text(item) for item in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}" if isinstance(value, float) else str(value)


def drawn(bars: Bars) -> list[str]:
    """A histogram as lines of text; heights are logarithmic, since the background outnumbers all else."""
    from math import log1p

    counts = bars.counts
    if not counts:
        return []
    top = max(log1p(count) for count in counts)
    steps = (len(_BARS) - 1) * _ROWS
    heights = [max(1, round(log1p(count) / top * steps)) if count else 0 for count in counts]
    lines = []
    for row in reversed(range(_ROWS)):
        cells = (min(max(height - row * (len(_BARS) - 1), 0), len(_BARS) - 1) for height in heights)
        lines.append("  " + "".join(_BARS[cell] for cell in cells).rstrip())
    low, high = f"{bars.low:.6g}", f"{bars.high:.6g}"
    return [*lines, "  " + low + high.rjust(max(len(counts) - len(low), len(high) + 1)) + "  (counts, log scale)"]
