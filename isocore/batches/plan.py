"""From inputs to jobs, each with the places of its surfaces. What would overwrite something is refused here.

Everything here looks at names only (of some files at the header, which names others), so that a request that makes no
sense is refused before any work.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from isocore.batches.inputs import Input, find_inputs
from isocore.batches.naming import (
    Naming,
    check_template,
    default_template,
    folder_of,
    other_templates,
    output_of,
    picture_of,
)
from isocore.batches.places import Places
from isocore.choices import Auto, Choice
from isocore.errors import OptionError, told
from isocore.job import STDOUT, Job, ReadAhead, Target
from isocore.readers import ReadOptions, carried_files, count_volumes, files_of, times_of

if TYPE_CHECKING:
    from isocore.batches.label_targets import LabelRequest
    from isocore.batches.steps import StepChoice

#: An option that names a file, and the file.
Named = tuple[str, Path]


class _Clash(OptionError):
    """Two surfaces in one place, which other names would tell apart."""


def plan(
    inputs: list[Input],
    choices: tuple[Choice, ...],
    pattern: Job,
    naming: Naming,
    *,
    volumes: int | str | None = None,
    steps: StepChoice | None = None,
    labels: LabelRequest | None = None,
    merge: bool = False,
    written: Sequence[Named] = (),
    read: Sequence[Named] = (),
) -> list[Job]:
    """One job per input, with the settings of `pattern` and a target per choice, or per label of each input.

    volumes: "all" makes one job per volume, for which the header is read; a file whose header cannot be read
    stays one job, which will say why.
    merge: all isovalues of an input go into one file.
    written, read: further files that the command writes and reads.

    Raises OptionError where an output or a file of `written` would overwrite an input, a file that belongs to one,
    or each other; where names alone are the trouble the message says which would do.
    """
    several_allowed = merge or labels is not None
    if naming.output is not None and (len(inputs) != 1 or (len(choices) != 1 and not several_allowed)):
        advice = "; use -d, or --merge-isovalues" if len(inputs) == 1 else "; use -d"
        raise OptionError(
            f"-o {naming.output}: takes one input and one isovalue, not {len(inputs)} and {len(choices)}{advice}"
        )
    if merge and "{isovalue}" in (naming.template or ""):
        raise OptionError(f"--name {naming.template}: with --merge-isovalues one file has all; leave out {{isovalue}}")
    if merge or (naming.output is not None and labels is not None):
        pattern = replace(pattern, together=True)
    patterns = [(item, one) for item in inputs for one in _per_step(item, pattern, volumes, steps)]
    if naming.output is not None and len(patterns) > 1:
        raise OptionError(f"-o {naming.output}: is one file, the input has {len(patterns):,} surfaces; use -d")
    asked = _Asked(choices, labels, keep=len(patterns) == 1)
    jobs = [_job(item, asked, one, naming) for item, one in patterns]
    try:
        refuse_overwriting(jobs, written=written, read=read)
    except _Clash as clash:
        several, each = len(choices) > 1 and not merge, any(one.read_options.volume is not None for _, one in patterns)
        stepped = any(one.read_options.step is not None for _, one in patterns)
        default = default_template(several=several, volumes=each, labels=labels is not None, steps=stepped)
        for template in other_templates(naming.template or default):
            if merge and "{isovalue}" in template:
                continue
            other = [_job(item, asked, one, naming._replace(template=template)) for item, one in patterns]
            if _is_free(other, written, read):
                raise OptionError(f"{clash}; tell them apart with --name {template}") from clash
        raise OptionError(f"{clash}; convert them one by one, each with another -d") from clash
    return jobs


def _per_step(item: Input, pattern: Job, volumes: int | str | None, steps: StepChoice | None) -> list[Job]:
    """One job per step of a series that is meant, and per volume; a series that cannot be read stays one job."""
    try:
        times = () if item.refusal else times_of(item.path)
    except Exception:  # converting it will say why
        times = ()
    if not times:
        return _per_volume(item, pattern, volumes)
    each = []
    for step in range(len(times)) if steps is None else steps.of(item.path, times):
        one = replace(pattern, time=times[step], read_options=replace(pattern.read_options, step=step))
        each += _per_volume(item, one, volumes)
    return each


def _per_volume(item: Input, pattern: Job, volumes: int | str | None) -> list[Job]:
    if volumes != "all" or item.refusal:
        return [pattern]
    try:
        count = count_volumes(item.path, pattern.read_options)
    except Exception:  # converting it will say why
        count = 1
    if count == 1:
        return [pattern]
    return [replace(pattern, read_options=replace(pattern.read_options, volume=k)) for k in range(count)]


class _Asked:
    """What is asked of each input: the same isovalues of all, or the labels that each one has."""

    def __init__(self, choices: tuple[Choice, ...], labels: LabelRequest | None, *, keep: bool) -> None:
        """keep: whether what is read for that is kept for converting it, which is too much for many inputs."""
        self._choices, self._labels, self._keep = choices, labels, keep
        self.read_ahead: ReadAhead | None = None
        self._known: dict[tuple[Path, int | None, int | None], tuple[Choice, ...]] = {}

    def of(self, path: Path, options: ReadOptions) -> tuple[Choice, ...]:
        """The choices for one input; a label map is looked into once."""
        if self._labels is None:
            return self._choices
        key = path, options.volume, options.step
        if key not in self._known:
            from isocore.batches.label_targets import label_choices  # late: few commands are about labels

            self._known[key], ahead = label_choices(path, self._labels, options)
            self.read_ahead = ahead if self._keep else None
        return self._known[key]


def _job(item: Input, asked: _Asked, pattern: Job, naming: Naming) -> Job:
    pattern = replace(pattern, read_options=_carrying(item, pattern.read_options))
    if item.refusal:  # one row, whatever is asked of each file in the folder
        place = naming.output or folder_of(item, naming) / item.path.name
        return replace(pattern, source=item.path, targets=(Target(Auto(), place),), refusal=item.refusal)
    try:
        choices = asked.of(item.path, pattern.read_options)
    except OptionError:
        raise
    except Exception as error:
        return _job(item._replace(refusal=told(item.path, error)), asked, pattern, naming)
    several = len(choices) > 1 and not pattern.together
    pictures = [picture_of(item, choices[0] if pattern.together else choice, pattern, naming) for choice in choices]
    drawn = zip(choices, pictures, strict=True)
    targets = tuple(
        Target(choice, output_of(item, choice, pattern, naming, several=several), picture) for choice, picture in drawn
    )
    return replace(pattern, source=item.path, targets=targets, read_ahead=asked.read_ahead)


def _carrying(item: Input, options: ReadOptions) -> ReadOptions:
    """What an input is to carry: files may be named after it and the folder it lies in."""
    if not any("{" in name for name in options.carry):
        return options
    known = {"{stem}": item.stem, "{name}": item.path.name, "{parent}": item.parent, "{folder}": str(item.path.parent)}
    filled = []
    for name in options.carry:
        for field, text in known.items():
            name = name.replace(field, text)
        filled.append(name)
    return replace(options, carry=tuple(filled))


def refuse_overwriting(jobs: Iterable[Job], *, written: Sequence[Named] = (), read: Sequence[Named] = ()) -> None:
    """Refuse outputs and files of `written` that would overwrite what is read, or each other."""
    jobs = [job for job in jobs if not job.refusal]
    places = Places()
    for option, path in read:
        places.take(path, f"is what {option} reads")
    for file in {file: None for job in jobs for file in carried_files(job.read_options)}:
        places.take(file, "is what --carry reads")
    for job in {job.source: job for job in jobs}.values():
        for n, file in enumerate(files_of(job.source)):
            places.take(file, f"belongs to the input {job.source}" if n else "is also an input")
    for job in jobs:
        for target in job.targets[:1] if job.together else job.targets:
            taken = None if target.output == STDOUT else places.take(target.output, f"is the output of {job.source}")
            if taken is None:
                continue
            if taken.startswith("is the output of "):
                other = taken.removeprefix("is the output of ")
                both = f"{job.source} twice" if other == str(job.source) else f"{other} and {job.source}"
                raise _Clash(f"{target.output}: would be written by {both}")
            raise OptionError(f"{target.output}: {taken}; choose another -o or -d")
    _refuse_pictures(jobs, places)
    for option, path in written:
        taken = places.take(path, f"is also written by {option}")
        if taken is not None:
            raise OptionError(f"{option} {path}: {taken} and would be overwritten; choose another name")


def _refuse_pictures(jobs: Iterable[Job], places: Places) -> None:
    """Refuse pictures that would overwrite anything, or each other."""
    for job in jobs:
        for target in job.targets[:1] if job.together else job.targets:
            if target.picture is None:
                continue
            taken = places.take(target.picture, "is the picture of another surface, too")
            if taken is not None:
                fields = "use a template, as --picture '{stem}_{isovalue}.png'"
                how = fields if taken.startswith("is the picture") else "choose another name"
                raise OptionError(f"--picture {target.picture}: {taken}; {how}")


def _is_free(jobs: Iterable[Job], written: Sequence[Named], read: Sequence[Named]) -> bool:
    """Whether these jobs write over nothing."""
    jobs = list(jobs)
    outputs = [target.output for job in jobs for target in (job.targets[:1] if job.together else job.targets)]
    if len(set(outputs)) < len(outputs):
        return False
    try:
        refuse_overwriting(jobs, written=written, read=read)
    except OptionError:
        return False
    return True


__all__ = ["Input", "Naming", "check_template", "find_inputs", "plan", "refuse_overwriting"]
