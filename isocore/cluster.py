"""The same jobs on a running dask scheduler, whose workers see the same files under the same paths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from isocore.errors import OptionError, one_line
from isocore.leftovers import remove_parts
from isocore.pipeline import Job, failed
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
        futures = {client.submit(convert_whole, job, pure=False): job for job in jobs}
        try:
            for future in as_completed(list(futures)):
                job = futures[future]
                runs = future.result() if future.status == "finished" else _lost(job, future.exception())
                for run in runs:
                    yield job, run
                future.release()
        finally:
            client.cancel(list(futures), force=True)


def convert_whole(job: Job) -> list[RunReport]:
    """All records of a job; runs on the cluster."""
    from isocore.batch import guarded

    remove_parts(target.output for target in job.targets)
    return list(guarded(job))


def _lost(job: Job, error: BaseException | None) -> list[RunReport]:
    remove_parts(target.output for target in job.targets)
    why = f"its workers on the cluster were lost ({one_line(error) if error else 'cancelled'}); see the scheduler's log"
    return [failed(job, target, RuntimeError(why), seconds={}) for target in job.targets]
