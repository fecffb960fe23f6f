"""`isocore info`: what a file holds, and which isovalues make sense."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from isocore.digits import exact, legible
from isocore.errors import printable, told

from .console import say, screen_width, styled, unarmed
from .groups import GroupedCommand, option_of
from .offers import commands
from .options import PATH, Reading, default_threads, reading_options
from .table import cells_of, folded

if TYPE_CHECKING:
    from isocore.describe import Description
    from isocore.histogram import Bars

_WIDEST, _NARROWEST = 64, 8
_BARS = " ▁▂▃▄▅▆▇█"
_ROWS = 6
#: Of lengths and scales: what a float32 holds.
_DIGITS = 9


@click.command(cls=GroupedCommand, short_help="What a file holds, and which isovalues make sense.")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@reading_options
@option_of("Report")("--json", "as_json", is_flag=True, help="The same as JSON on stdout.")
@click.pass_context
def info(context: click.Context, files: tuple[Path, ...], as_json: bool, reading: Reading) -> None:
    """Say what each FILE holds and which isovalues make sense.

    \b
    isocore info sample_volumes/knot.nii.gz
    """
    from isocore.describe import describe

    failures = 0
    described: list[dict[str, Any]] = []
    for path in files:
        try:
            found = describe(path, reading.read_options(), threads=default_threads())
        except Exception as error:  # one bad file never stops the others
            say(f"isocore: {told(path, error)}")
            failures += 1
            continue
        if as_json:
            described.append(_record(path, found, reading))
        else:
            click.echo("\n".join(map(unarmed, _lines(path, found, reading, screen_width(sys.stdout)))))
    if as_json:
        from isocore.report.texts import json_text

        click.echo(json_text(described, indent=2))
    context.exit(1 if failures else 0)


def _record(path: Path, found: Description, reading: Reading) -> dict[str, Any]:
    from isocore.report.keys import plain

    isovalues = [{"isovalue": one.isovalue, "option": str(one.asked), "why": one.why} for one in found.isovalues]
    record = {"source": str(path), **found.facts, "histogram": found.spread.coarse(), "isovalues": isovalues}
    record["commands"] = commands(path, found, reading)
    plain_record: dict[str, Any] = plain(record)
    return plain_record


def _lines(path: Path, found: Description, reading: Reading, width: int | None) -> list[str]:
    lines = [styled(unarmed(printable(path, stray=True)), bold=True)]
    facts = [(key, _line(key, value, found)) for key, value in found.facts.items() if _worth_a_line(key, value)]
    for key, text in [*facts, *(("warning", warning) for warning in found.facts["warnings"])]:
        lines += folded(f"  {key:<12} ", text, width)
    lines += drawn(found.spread.coarse(_bars(width)), width)
    isovalues = [(exact(choice.isovalue), f"-i {choice.asked}", choice.why) for choice in found.isovalues]
    number, option = (max((len(row[n]) for row in isovalues), default=0) for n in (0, 1))
    for value, asked, why in isovalues:
        lines += folded(f"  {'isovalue':<12} {value:<{number}}  {asked:<{option}}  ", why, width)
    if not isovalues:
        lines += folded(f"  {'isovalue':<12} ", "none: the samples do not differ", width)
    # Not folded: a command is pasted as it stands.
    return lines + [f"  {'command':<12} {command}" for command in commands(path, found, reading)]


def _line(key: str, value: Any, found: Description) -> str:
    if key == "range":
        from isocore.isovalue import pasted

        return " to ".join(pasted(end, found.spread) for end in value) if value else "no finite sample"
    if key == "times":
        return f"{exact(value[0])} to {exact(value[-1])}"
    if key == "labels":
        return f"{value:,} values, constant over regions: it looks like a label map"
    if key == "mask":
        return "two values, " + " and ".join(legible(*value)) + ": it is a mask"
    if key == "bounds":
        axes = [legible(*ends, digits=_DIGITS) for ends in zip(*value, strict=True)]
        low, high = (", ".join(corner) for corner in zip(*axes, strict=True))
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
    if isinstance(value, float):
        return f"{value:.{_DIGITS}g}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def _bars(width: int | None) -> int:
    """How many bars have room; each of the same number of bins."""
    bars = _WIDEST
    while width is not None and bars + 2 > width and bars > _NARROWEST:
        bars //= 2
    return bars


def drawn(bars: Bars, width: int | None = None) -> list[str]:
    """A histogram as lines of text; heights are logarithmic, since the background outnumbers all else.

    width: of the screen, which decides where the note beside the two ends has its place.
    """
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
    low, high = legible(bars.low or 0.0, bars.high or 0.0)
    ends = "  " + low + high.rjust(max(len(counts) - len(low), len(high) + 1))
    note = "  (log scale)"
    return [*lines, ends + note] if width is None or cells_of(ends + note) <= width else [*lines, ends, note]
