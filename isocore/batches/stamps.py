"""What an output was made from, kept in a small file beside it, so that a later run can leave it alone.

`.bone.ply.isocore` beside `bone.ply` holds the program's version, hashes of the input and the options, and the record
of the run with its own hash; the output's hash is in that record. An output is up to date when all of them hold.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, fields, replace
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any

from isocore.errors import IsocoreError
from isocore.job import STDOUT, Job, Target
from isocore.labels import Label
from isocore.readers import carried_files, files_of
from isocore.report.record import RunReport
from isocore.version import __version__
from isocore.whole_file import whole_file

#: What of a job does not change what is written: where it comes from and goes, how it is judged, whether it is done.
#: The last three change what else is made, and are asked about one by one; whatever else a job may be asked for counts.
UNHASHED = frozenset(
    ("source", "targets", "require", "max_triangles", "if_changed", "force", "page_triangles", "refusal", "still")
) | {"read_ahead", "ambiguities", "reference", "self_intersections"}
#: Bytes of a file's name beyond which file systems refuse it.
_LONGEST_NAME = 255


@dataclass(frozen=True, slots=True)
class _Stamp:
    """A stamp by its keys. input, options, record: hashes, the last one of `run`.

    ambiguities: the hash of the file that was asked for beside the output, else "". reference: was one asked for?
    picture: the hash of the still, or ""; still: how it was drawn.
    """

    version: str
    input: str
    options: str
    run: dict[str, Any]
    record: str
    ambiguities: str
    reference: bool
    picture: str = ""
    still: str = ""


def stamp_path(output: Path, part: str = "") -> Path:
    """Where the stamp of an output lies: hidden, and named after it, by a hash where that would be too long.

    part: of several that are parts of the output, which one.
    """
    name = f".{output.name}{part}.isocore"
    if len(os.fsencode(name)) > _LONGEST_NAME:
        name = f".{sha256(os.fsencode(output.name + part)).hexdigest()}.isocore"
    return output.with_name(name)


def _stamp_path(job: Job, target: Target) -> Path:
    """Where the stamp of a target lies; targets that share an output have one each."""
    choice = target.choice
    part = str(choice.value if isinstance(choice, Label) else choice)
    return stamp_path(target.output, f".{part}" if job.together else "")


def input_hash(job: Job) -> str:
    """Of the content of all files that the source consists of; "" where one cannot be read.

    Of a series the files of the job's step alone: it may grow, and the earlier steps stay up to date.
    """
    whole = sha256()
    files = files_of(job.source, job.read_options.step)
    if job.read_options.step is not None:
        files = files[1:]
    try:
        for path in (*(files or (job.source,)), *carried_files(job.read_options)):
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
    """Of what is asked of this output and can change its bytes; threads cannot."""
    asked = {item.name: getattr(job, item.name) for item in fields(Job) if item.name not in UNHASHED}
    asked["options"] = asdict(replace(job.options, threads=1, normals=job.normals))
    files = set(map(str, carried_files(job.read_options)))  # whose content is hashed; of where they lie only the name
    carry = [Path(name).name if str(Path(name)) in files else name for name in job.read_options.carry]
    asked["read_options"] = asdict(job.read_options) | {"carry": carry}
    asked["choice"] = target.choice
    asked["beside"] = [one.choice for one in job.targets] if job.together else []
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
        stamp = _read_stamp(_stamp_path(job, target))
        if stamp.version != __version__:
            return "made by another version", None
        if stamp.options != options_hash(job, target):
            return "options changed", None
        if not source_hash or stamp.input != source_hash:
            return "input changed", None
        if job.reference and not stamp.reference:
            return "no reference yet", None
        if job.ambiguities is not None and not _is_as_made(job.ambiguities, stamp.ambiguities):
            return "no ambiguities yet, or changed", None
        if target.picture is not None and not (
            stamp.still == str(job.still) and _is_as_made(target.picture, stamp.picture)
        ):
            return "no picture yet, or changed", None
        from isocore.report.keys import run_from_dict

        run = run_from_dict(stamp.run, complete=True)
        if job.counts_intersections and run.surface is not None and run.surface.self_intersections is None:
            return "self-intersections not counted yet", None
        if run.written is None or _file_hash(target.output) != run.written.sha256:
            return "output changed", None
    except (IsocoreError, OSError):
        return "no record of how the output was made", None
    return ("", run) if stamp.record == _hash_of(stamp.run) else ("the record of how it was made is damaged", None)


def _is_as_made(path: Path, digest: str) -> bool:
    """Whether a file has this content; what is no file, as a device, has nothing to keep."""
    return (path.exists() and not path.is_file()) or bool(digest and path.is_file() and _file_hash(path) == digest)


def _read_stamp(path: Path) -> _Stamp:
    """The stamp in a file. Raises InputError for what is none, OSError where there is none."""
    if not path.is_file():
        raise FileNotFoundError(path)
    from isocore.report.schema import built, parsed  # late: most runs leave no stamp

    return built(_Stamp, parsed(path.read_bytes()), "", needed=("version",))


def _hash_of(run: dict[str, Any]) -> str:
    """Of a record: a gate must not pass by a digit that was lost on the disk."""
    return sha256(json.dumps(run, allow_nan=False).encode()).hexdigest()


def keep_stamp(job: Job, target: Target, source_hash: str, run: RunReport) -> None:
    """Write down what the output was made from."""
    from isocore.report.keys import run_as_dict

    record = run_as_dict(run)
    beside, drawn = job.ambiguities, target.picture
    stamp = _Stamp(
        version=__version__,
        input=source_hash,
        options=options_hash(job, target),
        run=record,
        record=_hash_of(record),
        ambiguities=_file_hash(beside) if beside is not None and beside.is_file() else "",
        reference=job.reference,
        picture=_file_hash(drawn) if drawn is not None and drawn.is_file() else "",
        still=str(job.still),
    )
    with whole_file(_stamp_path(job, target)) as stream:
        stream.write(json.dumps(asdict(stamp), allow_nan=False).encode())
