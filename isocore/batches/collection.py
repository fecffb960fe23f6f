"""The `.pvd` beside the surfaces of a series: it lists their VTP files with the time of each, as ParaView opens them.

It is written again as steps are done, whole each time, and names what is there: steps that this run made, and those
that it left alone because they are up to date.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter

from isocore.batches.places import Places
from isocore.errors import OutputError
from isocore.job import STDOUT, Job, Target
from isocore.readers import files_of, lists_surfaces, suffix_of
from isocore.report.record import RunReport
from isocore.whole_file import whole_file

_HEAD = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">\n<Collection>\n'
_END = "</Collection>\n</VTKFile>\n"
#: A list that takes longer to write than this is left for so many times as long.
_QUICK_SECONDS = 0.02
_SAVING_SHARE = 10


@dataclass(slots=True)
class Collection:
    """One list. jobs: its steps. left: how many surfaces are still to come; there: the outputs that are."""

    path: Path
    jobs: list[Job]
    left: int = 0
    there: set[Path] = field(default_factory=set)
    due: float = 0.0

    def text(self) -> str:
        """The file, by ascending time."""
        rows = sorted(_entries(self.jobs), key=lambda entry: entry[0])
        lines = [_line(self.path, entry) for entry in rows if entry[2].output in self.there]
        return "".join((_HEAD, *lines, _END))

    def save(self) -> None:
        """Write it; raises OutputError if the disk refuses."""
        begin = perf_counter()
        with whole_file(self.path) as stream:
            stream.write(os.fsencode(self.text()))
        end = perf_counter()
        self.due = end + _SAVING_SHARE * max(0.0, end - begin - _QUICK_SECONDS)


class Collections:
    """The lists of a batch."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        self._of_job: dict[int, Collection] = {}
        for collection in collections_of(jobs):
            for job in collection.jobs:
                self._of_job[id(job)] = collection

    def add(self, job: Job, run: RunReport) -> RunReport:
        """Note an output, and write the list that it belongs to; a list that cannot be written is a warning."""
        collection = self._of_job.get(id(job))
        if collection is None:
            return run
        collection.left -= 1
        if run.status != "failed":
            collection.there.add(Path(run.output))
        if not collection.there or (collection.left and perf_counter() < collection.due):
            return run
        try:
            collection.save()
        except OutputError as error:
            return replace(run, warnings=(*run.warnings, f"{error}; the surfaces themselves are whole"))
        return run

    def finish(self) -> None:
        """A run that ends early leaves lists of what there is."""
        for collection in {id(one): one for one in self._of_job.values()}.values():
            if collection.left and collection.there:
                with suppress(OutputError):
                    collection.save()


def collections_of(jobs: Sequence[Job]) -> list[Collection]:
    """A list for each series whose steps become VTP, and each of its volumes: none that would overwrite anything."""
    series: dict[tuple[Path, int | None], list[Job]] = {}
    for job in jobs:
        if job.format == "vtp" and job.read_options.step is not None and job.targets[0].output != STDOUT:
            series.setdefault((job.source, job.read_options.volume), []).append(job)
    if not series:
        return []
    places = Places()
    for path in _taken(jobs):
        places.take(path, "")
    found = []
    for (source, volume), steps in series.items():
        folder = _common(target.output.parent for job in steps for target in job.targets)
        names = _names(source, volume)
        paths = (folder / f"{name}.pvd" for name in names)
        path = next(path for path in paths if not _is_anothers(path) and places.take(path, "") is None)
        found.append(Collection(path, steps, left=sum(len(job.targets) for job in steps)))
    return found


def _is_anothers(path: Path) -> bool:
    """Is something there that is no list of surfaces, such as a solver's own series?"""
    return path.exists() and not lists_surfaces(path)


def _taken(jobs: Iterable[Job]) -> Iterator[Path]:
    for source in {job.source: None for job in jobs}:
        yield from files_of(source)
    for job in jobs:
        yield from (target.output for target in job.targets if target.output != STDOUT)


def _names(source: Path, volume: int | None) -> Iterator[str]:
    """What the list may be called: after the series, unless that is taken, as by the series itself where it lies."""
    suffix = suffix_of(source)
    stem = (source.name[: -len(suffix)] if suffix else source.stem) + ("" if volume is None else f"_v{volume}")
    yield from (stem, f"{stem}_surfaces", f"{source.absolute().parent.name}_{stem}")
    number = 1
    while True:
        number += 1
        yield f"{stem}_{number}"


def _common(folders: Iterable[Path]) -> Path:
    several = list(dict.fromkeys(folders))
    return several[0] if len(several) == 1 else Path(os.path.commonpath([one.absolute() for one in several]))


def _entries(jobs: Iterable[Job]) -> Iterator[tuple[float, int, Target]]:
    """Time, number among the surfaces of its step, and the surface; each output once."""
    for job in jobs:
        outputs: dict[Path, Target] = {}
        for target in job.targets:
            outputs.setdefault(target.output, target)
        for part, target in enumerate(outputs.values()):
            yield job.time or 0.0, part, target


def _line(path: Path, entry: tuple[float, int, Target]) -> str:
    from xml.sax.saxutils import quoteattr  # late, since it brings all that fetches from the network

    time, part, target = entry
    file = Path(os.path.relpath(target.output.absolute(), path.parent.absolute())).as_posix()
    return f'<DataSet timestep="{time!r}" group="" part="{part}" file={quoteattr(file)}/>\n'
