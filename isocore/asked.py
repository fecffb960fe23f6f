"""What was asked of a surface, as its record says it."""

from __future__ import annotations

from isocore.job import Job, Target
from isocore.labels import Label
from isocore.report.sections import Asked, Given


def asked_of(job: Job, target: Target) -> Asked:
    """The keys of the record that the job and its target decide."""
    options = job.options
    return Asked(
        source=str(job.source),
        output=str(target.output),
        asked=str(target.choice),
        volume=job.read_options.volume,
        step=job.read_options.step,
        time=job.time,
        options=Given(
            threads=options.threads,
            cap=options.cap,
            normals=job.normals,
            block_size=options.block_size,
            max_error=None if options.max_error is None else str(options.max_error),
            simplify=options.simplify,
            triangles=options.triangles,
            topology=options.topology,
            smooth=options.smooth,
            background=options.background,
            keep_largest=options.keep_largest,
            min_piece=None if options.min_piece is None else str(options.min_piece),
            fill_bubbles=options.fill_bubbles or None,
            format=job.format,
            space=job.space,
            offset=None if job.offset is None else str(job.offset),
            ignore=job.read_options.ignore or None,
            carry=job.read_options.carry or None,
            compress=job.compress or None,
            merge_isovalues=(job.together and not any(isinstance(one.choice, Label) for one in job.targets)) or None,
        ),
    )
