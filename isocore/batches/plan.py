"""From what a command names to jobs: which inputs there are, and where each surface goes.

Everything here looks at names only, so that a request that makes no sense is refused before any file is opened.
"""

from __future__ import annotations

import os
import string
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path, PurePath

from isocore.choices import Choice
from isocore.errors import IsocoreError, OptionError
from isocore.job import STDOUT, Job, Target
from isocore.readers import SEARCHED, count_volumes, files_of, suffix_of

NAME_FIELDS = ("stem", "name", "isovalue", "relpath", "backend", "volume")


@dataclass(frozen=True, slots=True)
class Input:
    """A file to convert, and the folder it was found in: outputs mirror the way from one to the other."""

    path: Path
    root: Path

    @property
    def stem(self) -> str:
        """The name without the suffix of its format."""
        suffix = suffix_of(self.path)
        return self.path.name[: -len(suffix)] if suffix else self.path.stem

    @property
    def relative_folder(self) -> PurePath:
        """The folders between the root and the file."""
        return self.path.parent.relative_to(self.root)


@dataclass(frozen=True, slots=True, kw_only=True)
class Naming:
    """Where surfaces go. output: one file, or `-`; else output_dir and template, with the format as suffix."""

    output: Path | None = None
    output_dir: Path | None = None
    template: str | None = None


def find_inputs(names: Iterable[Path]) -> list[Input]:
    """Files as they are named; folders searched for known suffixes, in sorted order. No file twice."""
    found: dict[str, Input] = {}
    for name in names:
        if name.is_dir():
            inside = [Input(path, name) for path in _search(name)]
            if not inside:
                raise OptionError(f"{name}: holds no file isocore reads; known are {', '.join(SEARCHED)}")
        else:
            inside = [Input(name, name.parent)]
        for item in inside:
            found.setdefault(_place(item.path), item)
    return list(found.values())


def _search(folder: Path) -> Iterator[Path]:
    for here, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        known = [Path(here, name) for name in sorted(files) if suffix_of(name) in SEARCHED]
        detached = {os.path.normpath(file) for path in known for file in files_of(path)[1:]}
        for path in known:
            if not path.name.startswith(".") and os.path.normpath(path) not in detached:
                yield path


def check_template(template: str) -> None:
    """Refuse a name template with unknown fields."""
    try:
        used = [name for _, name, _, _ in string.Formatter().parse(template) if name is not None]
    except ValueError as error:
        raise OptionError(f"--name {template}: {error}; fields look like {{stem}}") from error
    for name in used:
        if name not in NAME_FIELDS:
            known = " ".join(f"{{{field}}}" for field in NAME_FIELDS)
            raise OptionError(f"--name {template}: {{{name}}} is no field; known are {known}")


def plan(
    inputs: list[Input], choices: tuple[Choice, ...], pattern: Job, naming: Naming, *, volumes: int | str | None = None
) -> list[Job]:
    """One job per input, with the settings of `pattern` and a target per choice. Raises OptionError on a clash.

    volumes: "all" makes one job per volume, for which the header is read; a file whose header cannot be read
    stays one job, which will say why.
    """
    if naming.output is not None and (len(inputs) != 1 or len(choices) != 1):
        raise OptionError(
            f"-o {naming.output}: takes one input and one isovalue, not {len(inputs)} and {len(choices)}; use -d"
        )
    patterns = [(item, one) for item in inputs for one in _per_volume(item, pattern, volumes)]
    jobs = [_job(item, choices, one, naming) for item, one in patterns]
    _check_clashes(jobs)
    return jobs


def _per_volume(item: Input, pattern: Job, volumes: int | str | None) -> list[Job]:
    if volumes != "all":
        return [pattern]
    try:
        count = count_volumes(item.path, pattern.read_options)
    except IsocoreError:
        count = 1
    if count == 1:
        return [pattern]
    return [replace(pattern, read_options=replace(pattern.read_options, volume=k)) for k in range(count)]


def _job(item: Input, choices: tuple[Choice, ...], pattern: Job, naming: Naming) -> Job:
    targets = tuple(Target(choice, _output(item, choice, pattern, naming, len(choices) > 1)) for choice in choices)
    return replace(pattern, source=item.path, targets=targets)


def _output(item: Input, choice: Choice, pattern: Job, naming: Naming, several: bool) -> Path:
    if naming.output is not None:
        return naming.output
    volume = pattern.read_options.volume
    template = naming.template or "{stem}" + ("_v{volume}" if volume is not None else "") + ("_{isovalue}" * several)
    name = template.format(
        stem=item.stem,
        name=item.path.name,
        isovalue=str(choice),
        relpath=(item.relative_folder / item.stem).as_posix(),
        backend=pattern.backend or "auto",
        volume="" if volume is None else volume,
    )
    folder = naming.output_dir if naming.output_dir is not None else item.path.parent
    mirrored = naming.output_dir is not None and "{relpath}" not in template
    place = folder / item.relative_folder if mirrored else folder
    return place / f"{name}.{pattern.format}"


def _check_clashes(jobs: list[Job]) -> None:
    """Two outputs in one place, or an output over an input."""
    sources = {_place(job.source): job.source for job in jobs}
    taken: dict[str, Path] = {}
    for job in jobs:
        for target in job.targets:
            if target.output == STDOUT:
                continue
            place = _place(target.output)
            if place in taken:
                both = f"{taken[place]} and {job.source}" if taken[place] != job.source else f"{job.source} twice"
                raise OptionError(f"{target.output}: would be written by {both}; tell them apart with --name {{name}}")
            if place in sources:
                raise OptionError(f"{target.output}: is also an input; choose another -o or -d")
            taken[place] = job.source


def _place(path: Path) -> str:
    return os.path.normcase(os.path.realpath(path))
