"""What a command would do, and why, without doing it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from isocore.batches import stamps
from isocore.batches.collection import collections_of
from isocore.batches.one_job import estimate
from isocore.job import Job


def plan_lines(jobs: Sequence[Job]) -> Iterator[str]:
    """What would be done and why, and how much memory it may take: the dry run."""
    for job in jobs:
        if job.refusal:
            yield f"fail: {job.refusal}"
            continue
        source_hash = stamps.input_hash(job) if job.if_changed else ""
        for target in job.targets:
            reason = stamps.reason_to_run(job, target, source_hash)[0] if job.if_changed else "asked for"
            what = f"run ({reason})" if reason else "skip (up to date)"
            memory = f", about {estimate(job) / 2**20:,.0f} MiB" if reason else ""
            drawn = "" if target.picture is None else f" and {target.picture}"
            yield f"{job.source} -> {target.output}{drawn}: isovalue {target.choice}, {what}{memory}"
    for collection in collections_of(jobs):
        yield f"{collection.jobs[0].source} -> {collection.path}: lists {collection.left:,} surfaces with their times"
