"""Read one step of a series: a PVD file, or ParaView's JSON (`.vtu.series` and its like), which name a file per step.

Several files of one time in a PVD are the parts of one mesh. Steps are counted from 0 in the order of their times.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from pathlib import Path
from typing import Any

from isocore.errors import FieldError, InputError, OptionError, reading
from isocore.readers.formats import BY_SUFFIX, Field, Format
from isocore.readers.listing import beside, elements, refuse_missing
from isocore.readers.options import ReadOptions
from isocore.readers.pvtu import PiecesSource, pvtu_pieces, read_pieces
from isocore.readers.vtk_fields import FieldInfo

_LONGEST = 64 << 20  # bytes of JSON


@dataclass(frozen=True, slots=True)
class Step:
    """A time, and the files of its parts."""

    time: float
    files: tuple[Path, ...]


def read_step(path: Path, options: ReadOptions) -> Field:
    """The field of the step that `options` name."""
    with reading(path):
        step = _chosen(path, options.step)
        refuse_missing(os.fspath(path), list(step.files), "files of the step")
        if len(step.files) == 1:
            with reading(step.files[0]):
                return _format(path, step.files[0]).read(step.files[0], options)
        return read_pieces(PiecesSource(os.fspath(path), _parts(path, step)), options)


def count_step(path: Path, options: ReadOptions) -> int:
    """How many volumes the step holds."""
    step = _chosen(path, options.step)
    return _format(path, step.files[0]).count(step.files[0], options) if len(step.files) == 1 else 1


def times(path: Path) -> tuple[float, ...]:
    """Of all steps, ascending."""
    with reading(path):
        return tuple(step.time for step in _steps(path))


def series_fields(path: Path) -> tuple[FieldInfo, ...]:
    """The fields of the first step."""
    with reading(path):
        first = _steps(path)[0].files[0]
        refuse_missing(os.fspath(path), [first], "files of the first step")
        return _format(path, first).fields(first)


def series_files(path: Path, step: int | None = None) -> tuple[Path, ...]:
    """The files of one step, or of all, and those that these name, as far as they are there."""
    steps = _steps(path)
    chosen = steps if step is None else steps[step : step + 1]
    found: dict[Path, None] = {}
    for file in (file for one in chosen for file in one.files if file.is_file()):
        found[file] = None
        found.update(dict.fromkeys(_format(path, file).files(file)))
    return tuple(found)


def lists_surfaces(path: Path) -> bool:
    """Does it list surfaces, as isocore does beside those of a series, and nothing to contour? Never an error."""
    try:
        return all(file.name.lower().endswith(".vtp") for step in _steps(path) for file in step.files)
    except Exception:  # whatever a damaged file leads to
        return False


def _chosen(path: Path, number: int | None) -> Step:
    steps = _steps(path)
    if number is None and len(steps) > 1:
        raise OptionError(
            f"{path}: holds {len(steps):,} steps (0 to {len(steps) - 1}), which convert takes one by one;"
            f" elsewhere name the file of one, as {steps[0].files[0]}"
        )
    if not 0 <= (number or 0) < len(steps):
        raise OptionError(f"{path}: has no step {number}; it holds 0 to {len(steps) - 1}")
    return steps[number or 0]


def _parts(path: Path, step: Step) -> list[Path]:
    """The VTU files of all parts of a step."""
    found: list[Path] = []
    for file in step.files:
        name = file.name.lower()
        if not name.endswith("vtu"):
            parts = f"{step.files[0].name} and {file.name}"
            raise FieldError(f"{path}: a step has the parts {parts}, which are no one mesh; give them one by one")
        found += pvtu_pieces(file) if name.endswith(".pvtu") else [file]
    return found


def _format(path: Path, file: Path) -> Format:
    """The row of a step's file."""
    name = file.name.lower()
    suffix = max((suffix for suffix in BY_SUFFIX if name.endswith(suffix)), key=len, default=None)
    if suffix is None or BY_SUFFIX[suffix].times(file):
        if name.endswith(".vtp"):
            raise InputError(f"{path}: lists surfaces, as {file.name}; name the series that they were made from")
        raise InputError(f"{path}: names {file}, which is not read; it may name VTU, PVTU, VTI and legacy VTK files")
    return BY_SUFFIX[suffix]


def _steps(path: Path) -> tuple[Step, ...]:
    """All steps by ascending time; InputError where the file is no series, or names nothing."""
    found = path.stat()
    return _steps_of(path, found.st_mtime_ns, found.st_size)


@lru_cache(maxsize=8)
def _steps_of(path: Path, changed: int, size: int) -> tuple[Step, ...]:
    """Read once for as long as the file stays as it is: every step of a long series asks for it several times."""
    steps = _from_json(path) if path.name.lower().endswith(".series") else _from_pvd(path)
    if not steps:
        raise InputError(f"{path}: names no steps, so there is nothing to contour; write it again")
    return tuple(sorted(steps, key=lambda step: step.time))


def _from_pvd(path: Path) -> list[Step]:
    """Files of one time are parts of one step; a file that is named twice for it, after a restart, is one part."""
    found: dict[float, dict[Path, None]] = {}
    for tag, attributes in elements(path, "Collection", "lists the steps of a series"):
        if tag == "DataSet":
            time = _time(path, attributes.get("timestep", "0"))
            found.setdefault(time, {})[beside(path, attributes.get("file", "").strip())] = None
    return [Step(time, tuple(files)) for time, files in found.items()]


def _from_json(path: Path) -> list[Step]:
    if path.stat().st_size > _LONGEST:
        raise InputError(f"{path}: is too long to be a list of files; check that it is what its suffix says")
    try:
        said: Any = json.loads(path.read_bytes())
    except RecursionError as error:
        raise InputError(f"{path}: is nested too deeply to be a list of files; write it again") from error
    except ValueError as error:
        raise InputError(f"{path}: is not JSON ({error}); write it again") from error
    files = said.get("files") if isinstance(said, dict) else None
    if not isinstance(files, list):
        raise InputError(f'{path}: lacks "files", a list; write it again')
    steps = []
    for number, entry in enumerate(files):
        if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
            raise InputError(f'{path}: entry {number:,} of its "files" has no "name"; write it again')
        steps.append(Step(_time(path, entry.get("time", number)), (beside(path, entry["name"]),)))
    return steps


def _time(path: Path, given: object) -> float:
    try:
        time = float(given) if isinstance(given, (int, float, str)) and not isinstance(given, bool) else float("nan")
    except (ValueError, OverflowError):
        time = float("nan")
    if not isfinite(time):
        raise InputError(f"{path}: gives {str(given)[:40]!r} as a time, which is no number; write it again")
    return time
