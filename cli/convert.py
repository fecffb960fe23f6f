"""`isocore convert`: volumes and meshes to surfaces."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from isocore.choices import BLOCK_SIZES, FORMATS, TOPOLOGIES, distinct

from .options import PATH, Isovalue, Jobs, MaxError, Memory, at_once, default_threads, read_options, reading_options

if TYPE_CHECKING:
    from isocore.job import Job
    from isocore.report import BatchReport

REQUIREMENTS = ("watertight", "manifold", "nonempty")


@click.command(short_help="Volumes and meshes to surfaces.")
@click.argument("inputs", nargs=-1, type=PATH, metavar="INPUT...")
@click.option("--files-from", type=PATH, metavar="FILE|-", help="Read further inputs from a file, one a line.")
@click.option(
    "-i", "--isovalue", "isovalues", multiple=True, type=Isovalue(), help="A number, otsu, pNN, A:B:N; repeatable."
)
@click.option("-o", "--output", type=PATH, metavar="FILE", help="For one input and one isovalue; - is stdout.")
@click.option("-d", "--output-dir", type=PATH, metavar="DIR", help="For many; mirrors the input tree.")
@click.option("-f", "--format", type=click.Choice(FORMATS), help="Default ply, or the suffix of -o.")
@click.option("--name", metavar="TEMPLATE", help="Default {stem}; also {name} {isovalue} {relpath} {backend} {volume}.")
@click.option("-b", "--backend", metavar="NAME", help="The method; default by kind of input.")
@click.option("--block-size", type=click.Choice([str(size) for size in BLOCK_SIZES]), help="asc: cells per block.")
@click.option("--max-error", type=MaxError(), help="asc: in voxels (0.5), world units (0.3mm) or none.")
@click.option("--topology", type=click.Choice(TOPOLOGIES), help="mc: disks in a cell, or tubes too.")
@click.option(
    "--space", type=click.Choice(["ras", "lps", "las", "native", "index"]), default="native", show_default=True
)
@click.option("--normals/--no-normals", help="Write vertex normals from the samples' gradient.")
@click.option("--cap/--no-cap", help="Close the surface at the volume's border.")
@reading_options
@click.option("--ambiguities", type=PATH, metavar="FILE", help="Write the ambiguous places as points, PLY.")
@click.option("--reference/--no-reference", default=True, help="Run marching cubes too, to compare; default on.")
@click.option("--require", metavar="LIST", help=f"Any of {' '.join(REQUIREMENTS)}; a miss is exit code 3.")
@click.option("--max-triangles", type=click.IntRange(min=0), metavar="N", help="More is exit code 3.")
@click.option("-j", "--jobs", type=Jobs(), default=1, help="Inputs at once, each in a process of its own.")
@click.option("--timeout", type=click.FloatRange(min=0, min_open=True), metavar="SECONDS", help="Give up an input.")
@click.option("--memory-limit", type=Memory(), help="For all inputs at once; default what is free.")
@click.option("--scheduler", metavar="ADDRESS", help="Send inputs to a dask scheduler instead.")
@click.option("--if-changed", is_flag=True, help="Skip outputs that are up to date.")
@click.option("--force", is_flag=True, help="Convert also what --if-changed would skip.")
@click.option("--threads", type=click.IntRange(min=1), metavar="N", help="Threads inside one input; default all.")
@click.option("--report", "reports", multiple=True, type=PATH, metavar="FILE", help="By suffix; repeatable.")
@click.option("--page-size", type=Memory(), default="16M", show_default=True, help="For surfaces in an HTML report.")
@click.option("--json", "as_json", is_flag=True, help="The JSON report on stdout.")
@click.option("--depfile", type=PATH, metavar="FILE", help="Write make rules: which outputs need which files.")
@click.option("--dry-run", is_flag=True, help="Only say what would be done.")
@click.option("--fail-fast", is_flag=True, help="Stop at the first input that fails.")
@click.option("-q", "--quiet", is_flag=True, help="Only errors and warnings.")
@click.option("-v", "--verbose", is_flag=True, help="One line per output as it is done.")
@click.option("--no-progress", is_flag=True, help="No live progress bar.")
@click.pass_context
def convert(context: click.Context, **chosen: Any) -> None:
    """Extract isosurfaces from volumes and meshes.

    \b
    isocore convert sample_volumes/knot.nii.gz -i 200 -o knot.ply
    isocore convert sample_volumes/ -d meshes/ -f stl --report run.json
    """
    start = perf_counter()
    jobs = planned_jobs(chosen)
    if chosen["dry_run"]:
        from isocore.batches.run import plan_lines

        for line in plan_lines(jobs):
            click.echo(line)
        return
    from .running import run_and_report

    batch = run_and_report(jobs, chosen, start)
    if chosen["as_json"]:
        from isocore.report import render_json

        click.echo(render_json(batch), nl=False)
    context.exit(exit_code(batch))


def exit_code(batch: BatchReport) -> int:
    """1 when some output failed, else 3 when one missed a requirement, else 0."""
    if any(run.status == "failed" for run in batch.outputs):
        return 1
    return 3 if any(run.missed for run in batch.outputs) else 0


def planned_jobs(chosen: dict[str, Any]) -> list[Job]:
    """Everything that can be refused without opening a file, then one job per input and volume."""
    names = list(chosen["inputs"]) + _listed(chosen["files_from"])
    if not names:
        raise click.UsageError("name an INPUT, or a list of them with --files-from")
    format_ = _format(chosen)
    requirements = _requirements(chosen["require"])
    if chosen["output"] == Path("-"):
        for option in ("as_json", "timeout", "scheduler"):
            if chosen[option]:
                raise click.UsageError(f"-o -: does not go with --{option.removeprefix('as_')}; use -o FILE")

    from isocore.backends import BACKENDS, check_options
    from isocore.batches.plan import Naming, check_template, find_inputs, plan
    from isocore.errors import OptionError
    from isocore.job import Job, Options
    from isocore.report import renderer_for

    options = Options(
        cap=chosen["cap"],
        normals=chosen["normals"],
        block_size=int(chosen["block_size"]) if chosen["block_size"] else None,
        max_error=chosen["max_error"],
        topology=chosen["topology"],
    )
    if chosen["backend"] is not None:
        if chosen["backend"] not in BACKENDS:
            raise OptionError(f"-b {chosen['backend']}: no such backend; choose one of {', '.join(BACKENDS)}")
        check_options(chosen["backend"], options)
    check_template(chosen["name"] or "")
    for path in chosen["reports"]:
        renderer_for(path)
        _check_folder(path.parent)
    _check_folder(chosen["output_dir"] or (chosen["output"] or Path("-")).parent)
    pattern = Job(
        source=Path(),
        targets=(),
        format=format_,
        backend=chosen["backend"],
        options=options,
        read_options=read_options(chosen),
        space=chosen["space"],
        reference=chosen["reference"],
        require=requirements,
        max_triangles=chosen["max_triangles"],
        if_changed=chosen["if_changed"] or chosen["force"],
        force=chosen["force"],
        ambiguities=chosen["ambiguities"],
    )
    naming = Naming(output=chosen["output"], output_dir=chosen["output_dir"], template=chosen["name"])
    choices = distinct(choice for asked in chosen["isovalues"] for choice in asked)
    jobs = plan(find_inputs(names), choices, pattern, naming, volumes=chosen["volume"])
    if chosen["ambiguities"] and (len(jobs) != 1 or len(jobs[0].targets) != 1):
        raise click.UsageError(f"--ambiguities {chosen['ambiguities']}: is one file; give one input and one isovalue")
    threads = chosen["threads"] or max(1, default_threads() // min(at_once(chosen), len(jobs)))
    return [replace(job, options=replace(options, threads=threads)) for job in jobs]


def _listed(path: Path | None) -> list[Path]:
    if path is None:
        return []
    try:
        text = sys.stdin.read() if path == Path("-") else path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise click.UsageError(f"--files-from {path}: cannot be read ({error})") from error
    return [Path(line) for line in text.splitlines() if line.strip()]


def _format(chosen: dict[str, Any]) -> str:
    output: Path | None = chosen["output"]
    if output is not None and chosen["output_dir"] is not None:
        raise click.UsageError("-o names one file and -d a folder; give one of them")
    if output is None:
        return chosen["format"] or "ply"
    suffix = output.suffix.lower().lstrip(".")
    if output == Path("-") and chosen["format"] is None:
        raise click.UsageError(f"-o -: needs -f, one of {', '.join(FORMATS)}")
    if chosen["format"] is None and suffix not in FORMATS:
        raise click.UsageError(f"-o {output}: its suffix is none of {', '.join(FORMATS)}; choose a format with -f")
    return chosen["format"] or suffix


def _requirements(text: str | None) -> tuple[str, ...]:
    names = tuple(name for name in (text or "").replace(",", " ").split())
    for name in names:
        if name not in REQUIREMENTS:
            raise click.UsageError(f"--require {name}: is none of {', '.join(REQUIREMENTS)}")
    return names


def _check_folder(folder: Path) -> None:
    """Refuse a folder that is a file, or below one."""
    for part in (folder, *folder.parents):
        if part.exists():
            if not part.is_dir():
                raise click.UsageError(f"{folder}: cannot be a folder, since {part} is a file")
            return
