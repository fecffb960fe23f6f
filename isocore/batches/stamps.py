"""What an output was made from, kept in a small file beside it, so that a later run can leave it alone.

`.bone.ply.isocore` beside `bone.ply` holds the program's version, hashes of the input and the options, and the record
of the run with its own hash; the output's hash is in that record. An output is up to date when all of them hold.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any

from isocore.errors import IsocoreError
from isocore.job import STDOUT, Job, Options, Target
from isocore.readers import files_of
from isocore.report.keys import run_as_dict, run_from_dict
from isocore.report.record import RunReport
from isocore.report.schema import built, parsed
from isocore.version import __version__
from isocore.whole_file import whole_file

#: The first keys of a stamp's options. The last two stopped being options; they stay, so that the stamps of earlier
#: runs hold.
_FIRST_KEYS = {"cap": False, "normals": False, "isovalues": 0, "index": None}


@dataclass(frozen=True, slots=True)
class _Stamp:
    """A stamp by its keys. input, options, record: hashes; that of the record in `run` came with a later version."""

    version: str
    input: str
    options: str
    run: dict[str, Any]
    record: str


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
        stamp = _read_stamp(target.output)
        if stamp.version != __version__:
            return "made by another version", None
        if stamp.options != options_hash(job, target):
            return "options changed", None
        if not source_hash or stamp.input != source_hash:
            return "input changed", None
        run = run_from_dict(stamp.run, complete=True)
        if run.written is None or _file_hash(target.output) != run.written.sha256:
            return "output changed", None
    except (IsocoreError, OSError):
        return "no record of how the output was made", None
    return ("", run) if stamp.record == _hash_of(stamp.run) else ("the record of how it was made is damaged", None)


def _read_stamp(output: Path) -> _Stamp:
    """The stamp of an output. Raises InputError for what is none, OSError where there is none."""
    path = stamp_path(output)
    if not path.is_file():
        raise FileNotFoundError(path)
    return built(_Stamp, parsed(path.read_bytes()), "", needed=("version",))


def _hash_of(run: dict[str, Any]) -> str:
    """Of a record: a gate must not pass by a digit that was lost on the disk."""
    return sha256(json.dumps(run, allow_nan=False).encode()).hexdigest()


def keep_stamp(job: Job, target: Target, source_hash: str, run: RunReport) -> None:
    """Write down what the output was made from."""
    record = run_as_dict(run)
    stamp = _Stamp(__version__, source_hash, options_hash(job, target), record, _hash_of(record))
    with whole_file(stamp_path(target.output)) as stream:
        stream.write(json.dumps(asdict(stamp), allow_nan=False).encode())
