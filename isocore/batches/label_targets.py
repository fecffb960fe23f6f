"""Which labels of a file become surfaces, and what they are called. Asking for all of them takes reading the file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from isocore.errors import IsocoreError
from isocore.job import ReadAhead
from isocore.labels import Label, Labels
from isocore.readers import read, suffix_of
from isocore.readers.label_names import names_inside
from isocore.readers.label_tables import LabelName
from isocore.readers.options import ReadOptions
from isocore.volume import Volume

_UNSAFE = re.compile(r"[^\w.+-]+")
#: Bytes of a label's name in a file's.
_LONGEST = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelRequest:
    """What `--labels` and its companions ask for. names: of a table that goes before names inside the file."""

    labels: Labels
    background: int = 0
    names: dict[int, LabelName] | None = None


def label_choices(
    path: Path, request: LabelRequest, options: ReadOptions
) -> tuple[tuple[Label, ...], ReadAhead | None]:
    """The labels of `path` that are asked for, in ascending order for `all`, else as they were written.

    And the volume, where it had to be read for that. A file that cannot be read, or holds no labels, gives one choice,
    of the background: converting it will say why.
    """
    values, ahead = request.labels.values, None
    if values is None:
        values, ahead = _all_labels(path, request.background, options)
    known = names_inside(path, suffix_of(path) or "", options.volume) | (request.names or {})
    choices = []
    for value in values:
        label = known.get(value)
        choices.append(Label(value, label.name if label else "", (label.colour if label else None) or palette(value)))
    return _with_file_names(choices or [Label(request.background)]), ahead


def _all_labels(path: Path, background: int, options: ReadOptions) -> tuple[tuple[int, ...], ReadAhead | None]:
    from isocore.methods.label_map import take_census

    start = perf_counter()
    try:
        field = read(path, options)
        seconds = perf_counter() - start
        if not isinstance(field, Volume):
            return (), None
        values = take_census(field, background).values
    except (IsocoreError, MemoryError):
        return (), None
    return tuple(int(value) for value in values if value != background), ReadAhead(field, seconds)


def _with_file_names(choices: Iterable[Label]) -> tuple[Label, ...]:
    """Each with a name that is one for a file too. Labels that share one get their number behind it."""
    plain = [(choice, _safe(choice.name) or f"label_{choice.value}") for choice in choices]
    alike = Counter(name.casefold() for _, name in plain)
    return tuple(
        choice._replace(file_name=f"{name}_{choice.value}" if alike[name.casefold()] > 1 else name)
        for choice, name in plain
    )


def _safe(name: str) -> str:
    """A name as a part of a file's, which has no room for more than 255 bytes."""
    return _UNSAFE.sub("_", name).encode()[:_LONGEST].decode(errors="ignore").strip("._")


def palette(value: int) -> tuple[int, int, int]:
    """A colour for a label without one: hues a golden section apart, so that neighbours differ."""
    hue = value * 0.6180339887498949 % 1.0
    parts = (abs(6 * ((hue + third) % 1.0) - 3) - 1 for third in (0.0, 2 / 3, 1 / 3))
    red, green, blue = (round(70 + 170 * min(1.0, max(0.0, part))) for part in parts)
    return red, green, blue
