"""What a surface's file is called and where it goes: the templates of --name."""

from __future__ import annotations

import re
import string
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from isocore.batches.inputs import Input
from isocore.choices import Choice
from isocore.digits import exact
from isocore.errors import OptionError
from isocore.job import Job
from isocore.labels import Label

_OF_LABELS = ("label", "label_name")
NAME_FIELDS = ("stem", "name", "isovalue", "relpath", "parent", "backend", "volume", "step", "time", *_OF_LABELS)
#: What is a number, which may be written in so many digits.
_NUMBERED = ("volume", "step")
_DIGITS = r"0?\d{1,2}d?|"


class Naming(NamedTuple):
    """Where surfaces go. output: one file, or `-`; else output_dir and template, with the format as suffix.

    picture: where a still of each goes, as a template with its suffix, or None.
    """

    output: Path | None = None
    output_dir: Path | None = None
    template: str | None = None
    picture: str | None = None


class _NoVolume(str):
    """Of a file with one volume, or without steps: nothing, in whatever digits it is asked for."""

    def __format__(self, spec: str) -> str:
        return ""


def check_template(template: str, option: str = "--name") -> None:
    """Refuse a template of `option` with unknown fields, or with a format that its field does not take."""
    try:
        used = [part[1:] for part in string.Formatter().parse(template) if part[1] is not None]
    except ValueError as error:
        raise OptionError(f"{option} {template}: {error}; fields look like {{stem}}") from error
    for name, spec, conversion in used:
        if name not in NAME_FIELDS:
            known = " ".join(f"{{{field}}}" for field in NAME_FIELDS)
            raise OptionError(f"{option} {template}: {{{name}}} is no field; known are {known}")
        if conversion is not None or (spec and not (name in _NUMBERED and re.fullmatch(_DIGITS, spec))):
            given = f"{{{name}{f'!{conversion}' if conversion is not None else ''}{f':{spec}' if spec else ''}}}"
            advice = f"write {{{name}}}" + (f", or {{{name}:03}} for three digits" if name in _NUMBERED else "")
            raise OptionError(f"{option} {template}: {given} asks for a format that names do not take; {advice}")


def check_picture_template(template: str) -> None:
    """Refuse a template of --picture that is no PNG's, or names no field that there is."""
    if not template.lower().endswith(".png"):
        raise OptionError(f"--picture {template}: pictures are PNG; let the name end in .png")
    check_template(template, "--picture")


def output_of(item: Input, choice: Choice, pattern: Job, naming: Naming, *, several: bool) -> Path:
    """Where one surface goes. several: an input has more than one isovalue."""
    if naming.output is not None:
        return naming.output
    volumes, labels = pattern.read_options.volume is not None, isinstance(choice, Label)
    steps = pattern.read_options.step is not None
    template = naming.template or default_template(several=several, volumes=volumes, labels=labels, steps=steps)
    return folder_of(item, naming, template) / f"{_filled(template, item, choice, pattern)}.{pattern.format}"


def picture_of(item: Input, choice: Choice, pattern: Job, naming: Naming) -> Path | None:
    """Where the still of one surface goes."""
    return None if naming.picture is None else Path(_filled(naming.picture, item, choice, pattern))


def default_template(*, several: bool, volumes: bool, labels: bool = False, steps: bool = False) -> str:
    """The name where none is asked for."""
    which = "_{label_name}" if labels else "_{isovalue}" * several
    return "{stem}" + "_{step}" * steps + "_v{volume}" * volumes + which


def folder_of(item: Input, naming: Naming, template: str = "") -> Path:
    """Where the names of an input's outputs start: mirrored below the output folder, or beside the input."""
    below = "{relpath}" in template
    if naming.output_dir is not None:
        return naming.output_dir if below else naming.output_dir / item.relative_folder
    if not below:
        return item.path.parent
    up = len(item.below_common.parts)
    return [item.path.parent, *item.path.parent.parents][up] if up <= len(item.path.parent.parents) else Path()


def _filled(template: str, item: Input, choice: Choice, pattern: Job) -> str:
    volume, step = pattern.read_options.volume, pattern.read_options.step
    return template.format(
        stem=item.stem,
        name=item.path.name,
        isovalue=choice.value if isinstance(choice, Label) else str(choice),
        label=choice.value if isinstance(choice, Label) else "",
        label_name=choice.file_name if isinstance(choice, Label) else "",
        relpath=(item.below_common / item.stem).as_posix(),
        parent=item.parent,
        backend=pattern.backend or "auto",
        volume=_NoVolume() if volume is None else volume,
        step=_NoVolume() if step is None else step,
        time="" if pattern.time is None else exact(pattern.time),
    )


def other_templates(template: str) -> Iterator[str]:
    """Templates that tell more apart than this one, the shortest names first."""
    places = ("{stem}", "{relpath}", "{parent}_{stem}", "{name}", "{parent}_{name}", "{relpath}_{name}")
    kept = next((field for field in ("{stem}", "{name}", "{relpath}") if field in template), None)
    bases = [template.replace(kept, place, 1) if kept else f"{place}_{template}" for place in places]
    for more in ("", "_{isovalue}", "_v{volume}", "_{step}", "_v{volume}_{isovalue}", "_{step}_{isovalue}"):
        if not any(field in template for field in re.findall(r"{\w+", more)):
            yield from (base + more for base in bases)
