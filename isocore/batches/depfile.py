"""A make rule per output, naming every file it was made from."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from isocore.job import STDOUT, Job
from isocore.readers import files_of


def depfile_text(jobs: Iterable[Job]) -> str:
    """Rules as compilers write them; an input without a rule of its own stays optional, so that it may vanish."""
    rules: list[str] = []
    for job in jobs:
        if job.refusal:
            continue
        files = files_of(job.source, job.read_options.step)
        outputs = [target.output for target in job.targets if target.output != STDOUT]
        if outputs:
            rules.append(f"{' '.join(map(_quoted, outputs))}: {' '.join(map(_quoted, files))}\n")
            rules += [f"{_quoted(file)}:\n" for file in files]
    return "".join(rules)


def _quoted(path: Path) -> str:
    text = str(path).replace("$", "$$")
    for character in " #:":
        text = text.replace(character, "\\" + character)
    return text
