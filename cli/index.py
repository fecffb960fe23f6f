"""`isocore index`: thin meshes now, and keep the index beside them."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

import click

from isocore.errors import told

from .console import say, tell
from .groups import GroupedCommand
from .options import PATH, Reading, reading_options


@click.command(cls=GroupedCommand, short_help="Build the thinning index beside a mesh.")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@reading_options
@click.pass_context
def index(context: click.Context, files: tuple[Path, ...], reading: Reading) -> None:
    """Thin each mesh FILE and write FILE.isoindex, which convert uses while mesh and field stay as they are.

    \b
    isocore index sample_volumes/torus.vtu
    """
    failures = 0
    for path in files:
        try:
            made = _index(path, reading)
        except Exception as error:  # one bad file never stops the others
            say(f"isocore: {told(path, error)}")
            failures += 1
        else:
            tell(made)
    context.exit(1 if failures else 0)


def _index(path: Path, reading: Reading) -> str:
    """Writes the index of one mesh and says what it holds."""
    from isocore.cell_mesh import CellMesh
    from isocore.errors import FieldError
    from isocore.memory import processors
    from isocore.methods.index_file import index_path, save_index
    from isocore.methods.thinning import build_index
    from isocore.readers import read

    mesh = read(path, reading.read_options())
    if not isinstance(mesh, CellMesh):
        raise FieldError(f"{path}: is a volume, whose cells need no index; index meshes only")
    start = perf_counter()
    built = build_index(mesh, processors())
    seconds = perf_counter() - start
    target = index_path(path)
    save_index(target, built, mesh)
    return (
        f"{target}: {built.skeleton_cells:,} skeleton cells of {mesh.cells:,}, {built.extrema:,} extrema, "
        f"{target.stat().st_size / 1e6:.1f} MB, thinned in {seconds:.2f} s"
    )
