"""A make rule per output, naming every file it was made from.

make has no way to write some characters in a name; others it takes for patterns, for the start of a recipe or for the
end of a line. No name of a file may become a command: those that cannot be quoted are left out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from isocore.batches.collection import collections_of
from isocore.job import STDOUT, Job
from isocore.readers import carried_files, files_of

#: What cannot be quoted: ends of lines, tabs, starts of a recipe or an assignment, patterns; a backslash at the end.
_UNSPEAKABLE = re.compile(r"[\x00-\x1f\x7f;=|%]|\\$")
_SPECIAL = re.compile(r"(\\*)([ #:*?\[])")


def depfile_text(jobs: Sequence[Job]) -> tuple[str, list[Path]]:
    """Rules as compilers write them, and the files that are left out since make cannot name them.

    An input without a rule of its own stays optional, so that it may vanish.
    """
    rules: list[str] = []
    left_out: dict[Path, None] = {}
    for job in jobs:
        if job.refusal:
            continue
        files = (*files_of(job.source, job.read_options.step), *carried_files(job.read_options))
        outputs = dict.fromkeys(target.output for target in job.targets if target.output != STDOUT)
        outputs |= dict.fromkeys(target.picture for target in job.targets if target.picture is not None)
        left_out |= dict.fromkeys(path for path in (*files, *outputs) if _UNSPEAKABLE.search(str(path)))
        made, needed = ([_quoted(path) for path in paths if path not in left_out] for paths in (outputs, files))
        if made:
            rules.append(f"{' '.join(made)}: {' '.join(needed)}\n")
            rules += [f"{file}:\n" for file in needed]
    for collection in collections_of(jobs):
        surfaces = dict.fromkeys(target.output for job in collection.jobs for target in job.targets)
        left_out |= dict.fromkeys(path for path in (collection.path, *surfaces) if _UNSPEAKABLE.search(str(path)))
        if collection.path not in left_out:
            listed = " ".join(_quoted(path) for path in surfaces if path not in left_out)
            rules.append(f"{_quoted(collection.path)}: {listed}\n")
    return "".join(rules), list(left_out)


def _quoted(path: Path) -> str:
    """As make wants a name; backslashes before what is quoted are doubled, and no `~` stands for a home."""
    text = _SPECIAL.sub(lambda found: f"{found[1]}{found[1]}\\{found[2]}", str(path).replace("$", "$$"))
    return f"./{text}" if text.startswith("~") else text
