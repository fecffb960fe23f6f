"""How a surface gets to its target: what its format makes of it, which is what is measured; then its bytes."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any, BinaryIO, cast

from isocore.ambiguities import find_ambiguities
from isocore.errors import OptionError, writing
from isocore.extraction import Field
from isocore.job import STDOUT, Job, Target
from isocore.labels import Label
from isocore.report.sections import Written
from isocore.surface import Part, Point, Surface, joined
from isocore.volume import Volume
from isocore.whole_file import whole_file
from isocore.writers import WRITERS
from isocore.writers.obj import write_materials, write_obj
from isocore.writers.ply import write_ply_points

_NO_NORMALS = "STL holds no vertex normals, only one for every triangle, so --normals adds none; write PLY or OBJ"


def format_warnings(job: Job) -> tuple[str, ...]:
    """What was asked for and the format does not hold."""
    return (_NO_NORMALS,) if job.options.normals and not job.normals else ()


class Sink:
    """Where a job's surfaces go: each to its target, or all of them, as parts, to the one that they share."""

    def __init__(self, job: Job) -> None:
        self._job = job
        self._parts: list[Surface] = []

    def write(self, surface: Surface, target: Target) -> Written | None:
        """Write a rounded surface; None where it waits for the others."""
        surface = self._dressed(surface, target)
        if not self._job.together:
            return write_target(surface, target, self._job)
        self._parts.append(surface)
        return None

    def finish(self) -> Written | None:
        """Write what waits; None where nothing does."""
        if not self._parts:
            return None
        whole = joined(self._parts)
        self._parts.clear()
        return write_target(whole, self._job.targets[0], self._job)

    def _dressed(self, surface: Surface, target: Target) -> Surface:
        """The surface with its name and colour, where it has them: labels, and whatever is given a colour."""
        choice, colour = target.choice, self._job.colour
        counts = {"vertices": len(surface.vertices), "triangles": len(surface.triangles)}
        if isinstance(choice, Label):
            name = choice.name or choice.file_name or f"label_{choice.value}"
            part = Part(name=name, colour=colour or choice.colour, label=choice.value, **counts)
        elif colour is not None or self._job.format == "glb":
            part = Part(name=self._job.source.name.split(".")[0] or "surface", colour=colour, **counts)
        else:
            return surface
        return replace(surface, parts=(part,))


def write_target(surface: Surface, target: Target, job: Job) -> Written:
    """Write a rounded surface to its target and hash what is written on its way."""
    to_stdout = target.output == STDOUT
    materials = materials_of(target.output, job) if surface.parts else None
    if materials:
        with whole_file(materials) as beside:
            write_materials(beside, surface)
    place: AbstractContextManager[BinaryIO | None] = writing("stdout") if to_stdout else whole_file(target.output)
    with place as opened:
        stream = _Hashed(opened or sys.stdout.buffer)
        if materials:
            write_obj(cast(BinaryIO, stream), surface, job.options.threads, materials.name)
        else:
            WRITERS[f".{job.format}"](cast(BinaryIO, stream), surface, job.options.threads)
        if to_stdout:
            sys.stdout.buffer.flush()
    return stream.written()


def materials_of(output: Path, job: Job) -> Path | None:
    """The file beside an OBJ that holds colours, where there are any to hold."""
    coloured = job.colour is not None or any(isinstance(target.choice, Label) for target in job.targets)
    return output.with_suffix(".mtl") if job.format == "obj" and coloured and output != STDOUT else None


def write_ambiguities(source: Field, isovalue: float, job: Job, offset: Point | None) -> None:
    """Write the faces that could be drawn in two ways, where the job asks for them."""
    if job.ambiguities is None:
        return
    if not isinstance(source, Volume):
        raise OptionError(f"--ambiguities {job.ambiguities}: is for volumes only; leave it out")
    found = find_ambiguities(source, isovalue, threads=job.options.threads)
    with whole_file(job.ambiguities) as stream:
        write_ply_points(
            stream,
            found.points,
            "saddle_distance",
            found.distances,
            space=found.space,
            unit=found.unit,
            offset=offset if offset and any(offset) else None,
        )


class _Hashed:
    """A stream that keeps the hash and the length of what passes."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._hash = sha256()
        self._bytes = 0

    def write(self, data: Any) -> int:
        """Pass the data on."""
        self._hash.update(data)
        self._bytes += memoryview(data).nbytes
        return self._stream.write(data)

    def written(self) -> Written:
        """Hash and length of everything so far."""
        return Written(sha256=self._hash.hexdigest(), bytes=self._bytes)
