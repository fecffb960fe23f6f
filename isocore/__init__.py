"""isocore: isosurfaces of volumes and meshes.

    field = isocore.read("knee.nii.gz")
    surface = isocore.extract(field, 300)
    isocore.write(surface, "bone.ply")

Names are imported when they are first used, so that `import isocore` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from isocore.version import __version__ as __version__

if TYPE_CHECKING:
    from isocore.api import extract
    from isocore.backends import BACKENDS, Backend, Extraction
    from isocore.cell_mesh import CellMesh
    from isocore.errors import FieldError, InputError, IsocoreError, OptionError, OutputError
    from isocore.job import Job, Options, Target
    from isocore.many import convert_files
    from isocore.measurements import Measurements, measure
    from isocore.pipeline import convert
    from isocore.readers import ReadOptions, read
    from isocore.report import BatchReport, RunReport
    from isocore.surface import Surface
    from isocore.volume import Volume
    from isocore.writers import write

__all__ = [
    "BACKENDS",
    "Backend",
    "BatchReport",
    "CellMesh",
    "Extraction",
    "FieldError",
    "InputError",
    "IsocoreError",
    "Job",
    "Measurements",
    "OptionError",
    "Options",
    "OutputError",
    "ReadOptions",
    "RunReport",
    "Surface",
    "Target",
    "Volume",
    "convert",
    "convert_files",
    "extract",
    "measure",
    "read",
    "write",
]

_HOMES = {
    "api": ("extract",),
    "backends": ("BACKENDS", "Backend", "Extraction"),
    "cell_mesh": ("CellMesh",),
    "errors": ("FieldError", "InputError", "IsocoreError", "OptionError", "OutputError"),
    "job": ("Job", "Options", "Target"),
    "many": ("convert_files",),
    "measurements": ("Measurements", "measure"),
    "pipeline": ("convert",),
    "readers": ("ReadOptions", "read"),
    "report": ("BatchReport", "RunReport"),
    "surface": ("Surface",),
    "volume": ("Volume",),
    "writers": ("write",),
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(f"isocore.{home}"), name)
            globals()[name] = value
            return value
    raise AttributeError(f"module 'isocore' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
