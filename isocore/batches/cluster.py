"""The same jobs on a running dask scheduler, whose workers see the same files under the same paths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from isocore.batches.leftovers import remove_parts
from isocore.batches.one_job import guarded
from isocore.errors import OptionError, one_line
from isocore.job import Job
from isocore.pipeline import failed
from isocore.report.record import RunReport

_CONNECT_SECONDS = "10s"


def run_on_cluster(jobs: Sequence[Job], address: str) -> Iterator[tuple[Job, RunReport]]:
    """Convert all jobs; records come as jobs are done. A worker's death costs a job another try, then its rows.

    Raises OptionError where dask.distributed is missing or no scheduler answers.
    """
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise OptionError("--scheduler: needs dask.distributed; pip install 'isocore[cluster]'") from error
    try:
        client = Client(address, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise OptionError(f"--scheduler {address}: does not answer ({one_line(error)}); check the address") from error
    with client:
        futures = {client.submit(convert_whole, _anywhere(job), pure=False): job for job in jobs}
        try:
            for future in as_completed(list(futures), loop=client.loop):
                job = futures[future]
                finished = future.status == "finished"
                runs = _as_named(job, future.result()) if finished else _lost(job, future.exception())
                for run in runs:
                    yield job, run
                future.release()
        finally:
            client.cancel(list(futures), force=True)


def convert_whole(job: Job) -> list[RunReport]:
    """All records of a job; runs on the cluster."""
    remove_parts(target.output for target in job.targets)
    return list(guarded(job))


def _anywhere(job: Job) -> Job:
    """The job with paths that hold in any folder."""
    targets = tuple(
        replace(target, output=target.output.absolute(), picture=target.picture and target.picture.absolute())
        for target in job.targets
    )
    ambiguities = None if job.ambiguities is None else job.ambiguities.absolute()
    carry = (str(path.absolute()) if (path := Path(name)).is_file() else name for name in job.read_options.carry)
    reading = replace(job.read_options, carry=tuple(carry))
    return replace(job, source=job.source.absolute(), targets=targets, ambiguities=ambiguities, read_options=reading)


def _as_named(job: Job, runs: list[RunReport]) -> list[RunReport]:
    """The records with the paths that the command named."""
    named = []
    for target, run in zip(job.targets, runs, strict=True):
        message = run.message.replace(run.source, str(job.source)).replace(run.output, str(target.output))
        asked = replace(run.asked, source=str(job.source), output=str(target.output))
        named.append(replace(run, asked=asked, message=message))
    return named


def _lost(job: Job, error: BaseException | None) -> list[RunReport]:
    remove_parts(target.output for target in job.targets)
    why = f"its workers on the cluster were lost ({one_line(error) if error else 'cancelled'}); see the scheduler's log"
    return [failed(job, target, RuntimeError(why)) for target in job.targets]
