"""`isocore convert`: volumes and meshes to surfaces."""

from __future__ import annotations

import stat
from collections import Counter
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

from isocore.choices import FORMATS, Choice, Format, distinct
from isocore.requirements import REQUIREMENTS

from .console import say
from .convert_fields import check_colours
from .convert_labels import label_request
from .convert_options import ConvertOptions, convert_options
from .convert_pictures import check_picture
from .groups import GroupedCommand
from .lists import listed
from .options import default_threads

if TYPE_CHECKING:
    from isocore.batches.steps import StepChoice
    from isocore.job import Job


@click.command(cls=GroupedCommand, short_help="Volumes and meshes to surfaces.")
@click.pass_context
@convert_options
def convert(context: click.Context, options: ConvertOptions) -> None:
    """Extract isosurfaces from volumes and meshes.

    \b
    isocore convert sample_volumes/knot.nii.gz -i 200 -o knot.ply
    isocore convert sample_volumes/ -d meshes/ -f stl --report run.json
    """
    start = perf_counter()
    jobs = planned_jobs(options)
    if options.dry_run:
        from isocore.batches.dry_run import plan_lines

        from .console import tell

        for line in plan_lines(jobs):
            tell(line)
        return
    from .running import exit_code, run_and_report

    batch, all_written = run_and_report(jobs, options, start)
    if options.as_json:
        from isocore.report.render_json import render_json

        click.echo(render_json(batch), nl=False)
    context.exit(exit_code(batch) if all_written else 1)


def planned_jobs(options: ConvertOptions) -> list[Job]:
    """Everything that can be refused without opening a file, then one job per input and volume."""
    names = [*options.inputs, *listed(options.files_from, null=options.null)]
    if not names:
        raise click.UsageError("name an INPUT, or a list of them with --files-from")
    format_ = _format(options)
    requirements = _requirements(options.require)
    _check_stdout(options)
    maps = {"colormap": options.colormap, "color_by": options.color_by, "color_range": options.color_range}
    check_colours(options.carry, options.colour, **maps)

    from isocore.batches.plan import Naming, check_template, find_inputs, plan  # late: readers bring numpy

    labels = label_request(options)
    pattern = _pattern(options, format_, requirements)
    check_template(options.name or "")
    _check_places(options)
    check_picture(click.get_current_context(), options.picture)
    naming = Naming(
        output=options.output, output_dir=options.output_dir, template=options.name, picture=options.picture
    )
    choices = _choices_of(options)
    written = [("--report", path) for path in options.reports]
    pages = [path for path in options.reports if path.suffix.lower() == ".html"]
    if pages:
        from isocore.report.copies_found import copies_path, has_copies_beside

        written += [("--report", copies_path(path)) for path in options.reports if has_copies_beside(path)]
    more = (("--depfile", options.depfile), ("--ambiguities", options.ambiguities))
    written += [(option, path) for option, path in more if path is not None]
    lists = [("--files-from", path) for path in (options.files_from,) if path not in (None, Path("-"))]
    inputs = find_inputs(names)
    lists += [("--names", path) for path in (options.label_table,) if path is not None]
    jobs = plan(
        inputs,
        choices,
        pattern,
        naming,
        volumes=options.reading.volume,
        steps=_steps(options),
        labels=labels,
        merge=options.merge_isovalues,
        written=written,
        read=lists,
    )
    if options.ambiguities and (len(jobs) != 1 or len(jobs[0].targets) != 1):
        raise click.UsageError(f"--ambiguities {options.ambiguities}: is one file; give one input and one isovalue")
    page_triangles = 0
    if pages:
        from isocore.copies import triangles_each

        page_triangles = triangles_each(options.page_size, sum(len(job.targets) for job in jobs))
    threads = options.threads or max(1, default_threads() // min(options.at_once, len(jobs)))
    return [replace(job, options=replace(job.options, threads=threads), page_triangles=page_triangles) for job in jobs]


def _steps(options: ConvertOptions) -> StepChoice | None:
    """The steps of series that are meant; None for all."""
    if not options.steps and not options.times:
        return None
    from isocore.batches.steps import StepChoice

    return StepChoice(options.steps or (), options.times or ())


def _choices_of(options: ConvertOptions) -> tuple[Choice, ...]:
    """Each isovalue once; a word about those that were asked for twice."""
    asked = [choice for several in options.isovalues for choice in several]
    twice = [str(choice) for choice, times in Counter(asked).items() if times > 1]
    if twice:
        shown = ", ".join(twice[:5]) + (f" and {len(twice) - 5:,} more" if len(twice) > 5 else "")
        say(f"isocore: warning: -i {shown}: asked for more than once, drawn once")
    return distinct(asked)


def _format(options: ConvertOptions) -> Format:
    output = options.output
    if output is not None and options.output_dir is not None:
        raise click.UsageError("-o names one file and -d a folder; give one of them")
    if options.format is not None:
        return options.format
    if output is None:
        return FORMATS[0]
    if output == Path("-"):
        raise click.UsageError(f"-o -: needs -f, one of {', '.join(FORMATS)}")
    suffix = output.suffix.lower().lstrip(".")
    for known in FORMATS:
        if suffix == known:
            return known
    raise click.UsageError(f"-o {output}: its suffix is none of {', '.join(FORMATS)}; choose a format with -f")


def _requirements(text: str | None) -> tuple[str, ...]:
    names = tuple(name for name in (text or "").replace(",", " ").split())
    if text is not None and not names:
        raise click.UsageError(f"--require: names nothing to require; choose of {', '.join(REQUIREMENTS)}")
    for name in names:
        if name not in REQUIREMENTS:
            raise click.UsageError(f"--require {name}: is none of {', '.join(REQUIREMENTS)}")
    return names


def _check_stdout(options: ConvertOptions) -> None:
    """A surface on stdout leaves no room for a report there, and comes from this process."""
    if options.output == Path("-"):
        for given, name in ((options.as_json, "json"), (options.timeout, "timeout"), (options.scheduler, "scheduler")):
            if given:
                raise click.UsageError(f"-o -: does not go with --{name}; use -o FILE")


def _pattern(asked: ConvertOptions, format_: Format, requirements: tuple[str, ...]) -> Job:
    """The job that all jobs are like, but for their source and targets."""
    from isocore.backends import check_options
    from isocore.job import Job, Options
    from isocore.views import Still

    options = Options(
        cap=asked.cap,
        normals=asked.normals,
        block_size=int(asked.block_size) if asked.block_size else None,
        max_error=asked.max_error,
        simplify=asked.simplify,
        triangles=asked.triangles,
        topology=asked.topology,
        smooth=asked.smooth or None,
        background=asked.background,
        keep_largest=asked.keep_largest,
        min_piece=asked.min_piece,
        fill_bubbles=asked.fill_bubbles,
    )
    backend = "labels" if asked.labels is not None else None if asked.backend == "auto" else asked.backend
    if backend is not None:
        check_options(backend, options)
    return Job(
        source=Path(),
        targets=(),
        format=format_,
        backend=backend,
        options=options,
        read_options=replace(asked.reading.read_options(), carry=tuple(dict.fromkeys(asked.carry))),
        space=asked.space,
        offset=asked.about,
        reference=asked.reference,
        self_intersections=asked.self_intersections,
        require=requirements,
        max_triangles=asked.max_triangles,
        if_changed=asked.if_changed or asked.force,
        force=asked.force,
        ambiguities=asked.ambiguities,
        colour=asked.colour,
        still=Still(views=asked.view, size=asked.picture_size),
        compress=asked.compress,
        colormap=asked.colormap,
        color_by=asked.color_by,
        color_range=asked.color_range,
    )


def _check_places(options: ConvertOptions) -> None:
    """Refuse a report of no known format, and folders that can be none."""
    from isocore.report import renderer_for

    for path in options.reports:
        renderer_for(path)
        _check_folder(path.parent)
    for file in (options.output, options.depfile, options.ambiguities):
        _check_folder((file or Path("-")).parent)
    _check_folder(options.output_dir or Path())


def _check_folder(folder: Path) -> None:
    """Refuse a folder that is a file, or below one, or that no file system would make."""
    for part in (folder, *folder.parents):
        try:
            found = part.stat()
        except (FileNotFoundError, NotADirectoryError):
            continue
        except OSError as error:
            raise click.UsageError(f"{folder}: cannot be a folder ({error.strerror}); choose another") from error
        if not stat.S_ISDIR(found.st_mode):
            raise click.UsageError(f"{folder}: cannot be a folder, since {part} is a file")
        return
