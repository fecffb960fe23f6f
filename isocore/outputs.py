"""How a surface gets to its target: what its format makes of it, which is what is measured; then its bytes."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from isocore.errors import OptionError, writing
from isocore.extraction import Field
from isocore.job import STDOUT, Job, Target
from isocore.labels import Label
from isocore.report.sections import Carried, Colors, Written
from isocore.surface import Part, Point, Surface, joined
from isocore.volume import Volume
from isocore.whole_file import whole_file
from isocore.writers import WRITERS
from isocore.writers.colormaps import coloured, magnitudes, range_of

if TYPE_CHECKING:
    from isocore.copies import Copy

_NO_NORMALS = "STL holds no vertex normals, only one for every triangle, so --normals adds none; write PLY, VTP or OBJ"


def format_warnings(job: Job) -> tuple[str, ...]:
    """What was asked for and the format does not hold."""
    without_normals = (_NO_NORMALS,) * bool(job.options.normals and not job.normals)
    no_fields = f"{job.format.upper()} holds no fields, so --carry adds none; write PLY, VTP, GLB or GIFTI"
    return without_normals + (no_fields,) * bool(job.read_options.carry and not job.holds_fields)


def carried_facts(surface: Surface, source: Field) -> tuple[Carried, ...]:
    """What is known of the fields on a surface."""
    kinds = {field.name: field.of for field in source.carried}
    found = []
    for name, values in surface.fields.items():
        numbers = magnitudes(values)
        found.append(
            Carried(
                name=name,
                of="cells" if kinds[name] == "cells" else "points",
                components=1 if values.ndim == 1 else values.shape[1],
                range=range_of(numbers),
                nonfinite=int(np.count_nonzero(~np.isfinite(numbers))),
            )
        )
    return tuple(found)


def check_colours(source: Field, job: Job) -> None:
    """Raises OptionError where vertices are to be coloured by a field that is not carried."""
    names = [field.name for field in source.carried]
    if job.color_by is not None and job.color_by not in names:
        raise OptionError(f"--color-by {job.color_by}: is not carried; carried are {', '.join(names) or 'none'}")


def colors_of(surface: Surface, job: Job) -> Colors | None:
    """How the surface is coloured by a carried field, in its file or on the report's page; None where it is not."""
    by = job.color_by or next(iter(surface.fields), None)
    if by is None or not job.colours_by_field:
        return None
    limits = job.color_range or range_of(magnitudes(surface.fields[by]))
    return Colors(by=by, colormap=job.colormap or "viridis", range=limits)


def page_copy(surface: Surface, target: Target, job: Job) -> Copy | None:
    """A copy of the surface for the report's page, with what it is coloured by; None where none is asked for."""
    if not job.page_triangles:
        return None
    from isocore.copies import copied  # late, as all that few jobs ask for

    colors = colors_of(surface, job)
    values = None if colors is None else magnitudes(surface.fields[colors.by])
    return copied(surface, job.page_triangles, colour_of(target, job), values)


def _with_colours(surface: Surface, job: Job) -> Surface:
    """The surface with a colour for every vertex, where it gets one."""
    colors = colors_of(surface, job) if job.colours_vertices else None
    if colors is None:
        return surface
    numbers = magnitudes(surface.fields[colors.by])
    return replace(surface, colours=coloured(numbers, colors.colormap, colors.range))


class Sink:
    """Where a job's surfaces go: each to its target, or all of them, as parts, to the one that they share."""

    def __init__(self, job: Job) -> None:
        self._job = job
        self._parts: list[Surface] = []

    def write(self, surface: Surface, target: Target, isovalue: float) -> tuple[Written | None, Colors | None]:
        """Write a rounded surface, and how its vertices are coloured; None where it waits for the others."""
        surface = self._dressed(surface, target, isovalue)
        if not self._job.together:
            return self._written(surface, target), colors_of(surface, self._job)
        self._parts.append(surface)
        return None, None

    def finish(self) -> tuple[Written | None, Colors | None]:
        """Write what waits; None where nothing does."""
        if not self._parts:
            return None, None
        whole = joined(self._parts)  # which leaves none
        colors = colors_of(whole, self._job)
        return self._written(whole, self._job.targets[0]), colors

    def _written(self, surface: Surface, target: Target) -> Written:
        """Write the surface, and draw it where a picture is asked for."""
        written = write_target(_with_colours(surface, self._job), target, self._job)
        if target.picture is not None:
            draw_picture(surface, target.picture, self._job)
        return written

    def _dressed(self, surface: Surface, target: Target, isovalue: float) -> Surface:
        """The surface with what is known of it: labels, what is given a colour, and isovalues that share a file."""
        choice, colour = target.choice, colour_of(target, self._job)
        counts = {"vertices": len(surface.vertices), "triangles": len(surface.triangles)}
        if isinstance(choice, Label):
            name = choice.name or choice.file_name or f"label_{choice.value}"
            part = Part(name=name, colour=colour, label=choice.value, **counts)
        elif self._job.together:
            name = f"{self._job.source.name.split('.')[0]}_{choice}".lstrip("_")
            part = Part(name=name, colour=colour, isovalue=isovalue, **counts)
        elif colour is not None or self._job.format in ("glb", "vtp"):
            own = isovalue if self._job.format == "vtp" else None
            part = Part(name=self._job.source.name.split(".")[0] or "surface", colour=colour, isovalue=own, **counts)
        else:
            return surface
        return replace(surface, parts=(part,))


def colour_of(target: Target, job: Job) -> tuple[int, int, int] | None:
    """What a surface is given: the job's colour, or its label's."""
    return job.colour or (target.choice.colour if isinstance(target.choice, Label) else None)


def write_target(surface: Surface, target: Target, job: Job) -> Written:
    """Write a rounded surface to its target and hash what is written on its way."""
    to_stdout = target.output == STDOUT
    materials = materials_of(target.output, job) if surface.parts else None
    if materials:
        from isocore.writers.obj import write_materials

        with whole_file(materials) as beside:
            write_materials(beside, surface)
    place: AbstractContextManager[BinaryIO | None] = writing("stdout") if to_stdout else whole_file(target.output)
    with place as opened:
        stream = _Hashed(opened or sys.stdout.buffer)
        if materials:
            from isocore.writers.obj import write_obj

            write_obj(cast(BinaryIO, stream), surface, job.options.threads, materials.name)
        elif job.format == "vtp":
            from isocore.writers.vtp import write_vtp

            write_vtp(cast(BinaryIO, stream), surface, job.options.threads, compress=job.compress, time=job.time)
        else:
            WRITERS[f".{job.format}"](cast(BinaryIO, stream), surface, job.options.threads)
        if to_stdout:
            sys.stdout.buffer.flush()
    return stream.written()


def check_pictures(job: Job, space: str) -> None:
    """Raises OptionError or FieldError where a picture is asked for and cannot be drawn; before anything is written."""
    if any(target.picture is not None for target in job.targets):
        from isocore.pictures import check_installed
        from isocore.views import directions

        check_installed()
        directions(job.still.views, space)


def draw_picture(surface: Surface, picture: Path, job: Job) -> None:
    """Draw a still of the surface, in the colours of what it carries."""
    from isocore.pictures import draw, write_png
    from isocore.views import directions

    colors = colors_of(surface, job)
    if colors is not None and len(surface.vertices):
        numbers = magnitudes(surface.fields[colors.by])
        surface = replace(surface, colours=coloured(numbers, colors.colormap, colors.range))
    pixels = draw(surface, directions(job.still.views, surface.space), job.still.size)
    with whole_file(picture) as stream:
        write_png(stream, pixels)


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
    from isocore.ambiguities import find_ambiguities
    from isocore.writers.ply import write_ply_points

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
