"""Running the jobs of a command: what is shown meanwhile, what is saved after every input, what stands at the end."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import click

from isocore.batches.run import Batch, run_jobs
from isocore.errors import IsocoreError, one_line, printable
from isocore.job import Job, Target
from isocore.memory import free_bytes, share_one_heap
from isocore.report import BatchReport, RunReport, save_report
from isocore.report.record import working_folder
from isocore.whole_file import whole_file

from .console import Progress, say, say_table
from .convert_options import ConvertOptions
from .streams import UNREAD
from .warned import Warned, is_unread, said_at_once, warnings_of

#: A report that takes longer to save than this is left for so many times as long.
_QUICK_SECONDS = 0.02
_SAVING_SHARE = 10


class Records:
    """The records so far, and the report files that show them. tell: says a line to the user."""

    def __init__(
        self, jobs: list[Job], paths: tuple[Path, ...], mesh_bytes: int, start: float, *, tell: Callable[[str], None]
    ) -> None:
        self._places = {
            (id(job), str(target.output), str(target.choice)): n for n, (job, target) in enumerate(_targets(jobs))
        }
        self._runs: dict[int, RunReport] = {}
        self._paths = paths
        self._mesh_bytes = mesh_bytes
        self._start = start
        self._tell = tell
        self._end: float | None = None
        self._due = dict.fromkeys(paths, 0.0)
        self._warned: set[Path] = set()
        #: What became of each report that could not be saved when it was last tried.
        self.unsaved: dict[Path, str] = {}

    def add(self, job: Job, run: RunReport) -> None:
        """Keep a record and save the reports, each as often as it is quick to save."""
        self._runs[self._places[id(job), run.output, run.asked.asked]] = run
        self.save(all_of_them=False)

    def batch(self) -> BatchReport:
        """The records in the order of the command."""
        runs = tuple(run for _, run in sorted(self._runs.items()))
        end = perf_counter() if self._end is None else self._end
        return BatchReport(runs, arguments=tuple(sys.argv[1:]), seconds=end - self._start, folder=working_folder())

    def finish(self) -> None:
        """No record comes any more: stop the clock, and save every report once more."""
        self._end = perf_counter()
        self.save(all_of_them=True)

    def save(self, *, all_of_them: bool) -> None:
        """Rewrite the report files; a page gets its surfaces at the end only."""
        for path in self._paths:
            begin = perf_counter()
            if all_of_them or begin >= self._due[path]:
                self._try_to_save(path)
                end = perf_counter()
                self._due[path] = end + _SAVING_SHARE * max(0.0, end - begin - _QUICK_SECONDS)

    def _try_to_save(self, path: Path) -> None:
        """Save one report. Where that fails nothing else suffers: the next time may do better."""
        mesh_bytes = 0 if self._end is None else self._mesh_bytes
        self.unsaved.pop(path, None)
        try:
            save_report(self.batch(), path, mesh_bytes=mesh_bytes)
            if mesh_bytes:
                _save_copies(self.batch(), path)
        except IsocoreError as error:
            self.unsaved[path] = str(error)
        except Exception as error:  # of a report no fault is worth a batch
            self.unsaved[path] = f"{path}: cannot be made ({type(error).__name__}: {one_line(error)}); please report it"
        if path in self.unsaved and self._end is None and path not in self._warned:
            self._warned.add(path)
            self._tell(f"isocore: warning: {self.unsaved[path]}; the batch goes on, and the report is tried again")


def run_and_report(jobs: list[Job], options: ConvertOptions, start: float) -> tuple[BatchReport, bool]:
    """Run the jobs of `isocore convert`; also whether every report and the depfile could be written.

    Interrupted, the reports hold what was done until then.
    """
    warned = Warned()
    total = sum(len(job.targets) for job in jobs)
    asked = _batch(jobs, options)
    if not asked.workers:
        share_one_heap()
    with Progress(total, wanted=not (options.quiet or options.no_progress)) as progress:
        records = Records(jobs, options.reports, options.page_size, start, tell=progress.say)
        try:
            for job, run in run_jobs(jobs, asked, at=progress.at):
                records.add(job, run)
                warned.add(run)
                progress.step()
                for line in [*said_at_once(run), *(_in_full(run) if options.verbose else ())]:
                    progress.say(line)
        finally:
            records.finish()
            progress.stop()
            if not options.verbose:
                _say_warnings(warned, [path for path in options.reports if path not in records.unsaved])
    batch = records.batch()
    unwritten = [*records.unsaved.values(), *_write_depfile(jobs, options.depfile)]
    if os.environ.get("GITHUB_ACTIONS") == "true":
        from isocore.report.render_github import github_annotations

        for line in github_annotations(batch):
            click.echo(line, err=True)
    if not options.quiet and not any(map(is_unread, batch.outputs)):
        say_table(batch)
    for line in unwritten:
        say(f"isocore: {line}")
    return batch, not unwritten


def _save_copies(batch: BatchReport, path: Path) -> None:
    """Keep the surfaces of a page beside a report that a page is made from later."""
    from isocore.report.copies_found import has_copies_beside, save_copies

    if has_copies_beside(path):
        save_copies(batch, path)


def exit_code(batch: BatchReport) -> int:
    """141 when nobody reads stdout any more, 1 when some output failed, 3 when one missed a requirement, else 0."""
    if any(map(is_unread, batch.outputs)):
        return UNREAD
    if any(run.status == "failed" for run in batch.outputs):
        return 1
    return 3 if any(run.missed for run in batch.outputs) else 0


def _write_depfile(jobs: list[Job], path: Path | None) -> list[str]:
    """Write the rules; what is in the way, if anything is."""
    if path is None:
        return []
    from isocore.batches.depfile import depfile_text

    text, left_out = depfile_text(jobs)
    try:
        with whole_file(path) as stream:
            stream.write(os.fsencode(text))
    except IsocoreError as error:
        return [str(error)]
    if left_out:
        more = f" and {len(left_out) - 1} more" if len(left_out) > 1 else ""
        say(f"isocore: warning: {path}: leaves out {left_out[0]}{more}, since make cannot write such a name; rename it")
    return []


def _in_full(run: RunReport) -> list[str]:
    """What --verbose says of an output: what became of it, and each of its warnings."""
    seconds = run.seconds.total if run.seconds else 0.0
    done = f"{run.source} -> {run.output}: {run.status}, {run.chosen}, {seconds:.3f} s"
    warnings = [] if run.status == "skipped" else warnings_of(run)
    return [printable(done), *(f"isocore: warning: {printable(f'{run.source}: {text}')}" for text in warnings)]


def _say_warnings(warned: Warned, saved: list[Path]) -> None:
    for line in warned.lines():
        say(line)
    if warned.several:
        listed = str(saved[0]) if saved else "--report FILE or -v"
        say(f"isocore: {listed} lists which warning is about which surface")


def _batch(jobs: list[Job], options: ConvertOptions) -> Batch:
    alone = len(jobs) == 1 and options.timeout is None
    limit = options.memory_limit
    return Batch(
        workers=0 if alone else min(options.at_once, len(jobs)),
        seconds_per_job=options.timeout,
        memory_bytes=free_bytes() if limit is None else limit,
        scheduler=options.scheduler,
        fail_fast=options.fail_fast,
    )


def _targets(jobs: list[Job]) -> list[tuple[Job, Target]]:
    return [(job, target) for job in jobs for target in job.targets]
