"""What an output was made from, kept in a small file beside it, so that a later run can leave it alone.

`.bone.ply.isocore` beside `bone.ply` holds hashes of the input, the options and the program, the output's own hash
and the record of the run. An output is up to date when all four hashes hold.
"""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any

from isocore.job import STDOUT, Job, Options, Target
from isocore.readers import files_of
from isocore.report.keys import run_as_dict, run_from_dict
from isocore.report.record import RunReport
from isocore.version import __version__
from isocore.whole_file import whole_file

#: The first keys of a stamp's options. The last two stopped being options; they stay, so that the stamps of earlier
#: runs hold.
_FIRST_KEYS = {"cap": False, "normals": False, "isovalues": 0, "index": None}


def stamp_path(output: Path) -> Path:
    """Where the stamp of an output lies."""
    return output.with_name(f".{output.name}.isocore")


def input_hash(source: Path) -> str:
    """Of the content of all files that the source consists of; "" where one cannot be read."""
    whole = sha256()
    try:
        for path in files_of(source):
            whole.update(bytes.fromhex(_file_hash(path)))
    except OSError:
        return ""
    return whole.hexdigest()


def _file_hash(path: Path) -> str:
    """Of its content. Raises OSError also for a pipe or a device, which would be waited for or never end."""
    if not path.is_file():
        raise FileNotFoundError(path)
    with path.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()


def options_hash(job: Job, target: Target) -> str:
    """Of what is asked of this output and can change its bytes; threads cannot.

    `job.ambiguities` and `job.reference` are not part of it, though they change what a run leaves beside the output
    and in its record: asked for later, they alone do not make a run.
    """
    options = _FIRST_KEYS | {item.name: getattr(job.options, item.name) for item in fields(Options)}
    del options["threads"]
    options["normals"] = job.normals
    asked: list[Any] = [options, asdict(job.read_options), job.format, job.backend, job.space, target.choice]
    if job.offset is not None:
        asked.append(job.offset)
    return sha256(json.dumps(asked, default=str).encode()).hexdigest()


def reason_to_run(job: Job, target: Target, source_hash: str) -> tuple[str, RunReport | None]:
    """Why the output must be made, or "" and the record of the run that made it."""
    if target.output == STDOUT:
        return "goes to stdout", None
    if not target.output.exists():
        return "no output yet", None
    if job.force:
        return "forced", None
    try:
        stamp: dict[str, Any] = json.loads(stamp_path(target.output).read_bytes())
        if stamp["version"] != __version__:
            return f"made by version {stamp['version']}", None
        if stamp["options"] != options_hash(job, target):
            return "options changed", None
        if not source_hash or stamp["input"] != source_hash:
            return "input changed", None
        if _file_hash(target.output) != stamp["run"]["sha256"]:
            return "output changed", None
        return "", run_from_dict(stamp["run"])
    except (OSError, ValueError, KeyError, TypeError):
        return "no record of how the output was made", None


def keep_stamp(job: Job, target: Target, source_hash: str, run: RunReport) -> None:
    """Write down what the output was made from."""
    stamp = {
        "version": __version__,
        "input": source_hash,
        "options": options_hash(job, target),
        "run": run_as_dict(run),
    }
    with whole_file(stamp_path(target.output)) as stream:
        stream.write(json.dumps(stamp, allow_nan=False).encode())
