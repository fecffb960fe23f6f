"""One job of a batch: what it may take, its records whatever happens, and none of its work where it is up to date."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from isocore.batches import stamps
from isocore.errors import OutputError, told
from isocore.job import STDOUT, Job, Target
from isocore.memory import estimated_bytes
from isocore.pipeline import convert, failed, requirements_checked
from isocore.readers import carried_files, content_bytes
from isocore.report.record import RunReport


def estimate(job: Job) -> int:
    """Bytes that a job may take at its peak."""
    copied = 2 if job.read_options.ignore else 1  # 8 bits become the 32 of a type that has NaN
    beside = sum(map(content_bytes, carried_files(job.read_options)))
    return estimated_bytes(copied * content_bytes(job.source, job.read_options.step) + beside)


def guarded(job: Job) -> Iterator[RunReport]:
    """The records of a job, also where it meets an error nobody foresaw."""
    done = 0
    try:
        for run in _changed(job) if job.if_changed else convert(job):
            yield run
            done += 1
    except Exception as error:
        unforeseen = RuntimeError(told(job.source, error))
        for target in job.targets[done:]:
            yield failed(job, target, unforeseen)


def _changed(job: Job) -> Iterator[RunReport]:
    """As convert, but outputs that are up to date are skipped, with the record of the run that made them."""
    source_hash = stamps.input_hash(job)
    left: list[Target] = []
    skipped: dict[Target, RunReport] = {}
    for target in job.targets:
        _, earlier = stamps.reason_to_run(job, target, source_hash)
        if earlier is None:
            left.append(target)
        else:
            asked = replace(earlier.asked, source=str(job.source), output=str(target.output))  # as they are named now
            earlier = replace(earlier, asked=asked, status="skipped", message="up to date")
            skipped[target] = requirements_checked(earlier, job)
    if job.together and left:  # one file, so all or nothing
        left, skipped = list(job.targets), {}
    if job.page_triangles:
        skipped = _with_copies(skipped, job)
    made = convert(replace(job, targets=tuple(left))) if left else iter(())
    for target in job.targets:
        if target in skipped:
            yield skipped[target]
            continue
        run = next(made)
        if run.status in ("done", "empty") and target.output != STDOUT:
            run = _stamped(job, target, source_hash, run)
        yield run


def _with_copies(skipped: dict[Target, RunReport], job: Job) -> dict[Target, RunReport]:
    """What is up to date, with copies of the surfaces for a page; targets of one file have a part of it each."""
    from isocore.report.copies_found import file_copies  # late: few commands make a page

    files: dict[str, list[Target]] = {}
    for target, run in skipped.items():
        files.setdefault(run.output, []).append(target)
    for output, targets in files.items():
        copies = file_copies(output, [skipped[target] for target in targets], job.page_triangles)
        for target, copy in zip(targets, copies, strict=True):
            skipped[target] = replace(skipped[target], copy=copy)
    return skipped


def _stamped(job: Job, target: Target, source_hash: str, run: RunReport) -> RunReport:
    """The run, kept beside its output; where that is refused the output is as good, but will be made again."""
    try:
        stamps.keep_stamp(job, target, source_hash, run)
    except OutputError as error:
        return replace(run, warnings=(*run.warnings, f"{error}; without it --if-changed makes the output again"))
    return run
