"""The table of formats that are read. To add one: its functions in a file of their own, and a row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from isocore.cell_mesh import CellMesh
from isocore.readers.nifti import count_nifti, nifti_files, read_nifti
from isocore.readers.nrrd import count_nrrd, nrrd_files, read_nrrd
from isocore.readers.options import ReadOptions
from isocore.readers.raw import count_raw, raw_files, read_raw
from isocore.volume import Volume

if TYPE_CHECKING:
    from isocore.readers.vtk_fields import FieldInfo

Field: TypeAlias = Volume | CellMesh


def _one_volume(path: Path, options: ReadOptions) -> int:
    return 1


def _no_steps(path: Path) -> tuple[float, ...]:
    return ()


def _nothing_beside(path: Path) -> tuple[Path, ...]:
    return ()


def _no_choice(path: Path) -> tuple[FieldInfo, ...]:
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """A file format, as the functions that know it. Their errors need not name the path: the package's functions do.

    suffixes: in lower case; the longest one that a name ends in decides.
    read: the field in a file.
    count: how many volumes a file holds, by its header; 1 for a mesh.
    files: those beside it that belong to it and exist, such as detached samples.
    fields: what a mesh offers to contour, fields of points before those of cells; () for a volume.
    times: of a series' steps, ascending; () for a file that is none. step_files: those of one of its steps.
    lists: its files are fields of their own, which are not to be converted a second time.
    unsearched: suffixes a folder is not searched for, because another file leads to those.
    """

    suffixes: tuple[str, ...]
    read: Callable[[Path, ReadOptions], Field]
    count: Callable[[Path, ReadOptions], int] = _one_volume
    files: Callable[[Path], tuple[Path, ...]] = _nothing_beside
    fields: Callable[[Path], tuple[FieldInfo, ...]] = _no_choice
    times: Callable[[Path], tuple[float, ...]] = _no_steps
    step_files: Callable[[Path, int], tuple[Path, ...]] | None = None
    lists: bool = False
    unsearched: tuple[str, ...] = ()


def _late(module: str, function: str) -> Callable[..., Any]:
    """A function of a reader that is imported when it is first called: most files need few of the readers."""

    def call(*arguments: Any) -> Any:
        return getattr(import_module(f"isocore.readers.{module}"), function)(*arguments)

    return call


FORMATS = (
    Format(
        suffixes=(".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"),
        read=read_nifti,
        count=count_nifti,
        files=nifti_files,
        unsearched=(".img", ".img.gz"),
    ),
    Format(suffixes=(".nrrd", ".nhdr"), read=read_nrrd, count=count_nrrd, files=nrrd_files),
    Format(
        suffixes=(".mha", ".mhd"),
        read=_late("metaimage", "read_metaimage"),
        count=_late("metaimage", "count_metaimage"),
        files=_late("metaimage", "metaimage_files"),
    ),
    Format(suffixes=(".mgz", ".mgh"), read=_late("mgh", "read_mgh"), count=_late("mgh", "count_mgh")),
    Format(suffixes=(".raw", ".raw.gz"), read=read_raw, count=count_raw, files=raw_files),
    Format(suffixes=(".vtu",), read=_late("vtu", "read_vtu"), fields=_late("vtu", "vtu_fields")),
    Format(
        suffixes=(".pvtu",),
        read=_late("pvtu", "read_pvtu"),
        files=_late("pvtu", "pvtu_files"),
        fields=_late("pvtu", "pvtu_fields"),
        lists=True,
    ),
    Format(
        suffixes=(".vtk",), read=_late("vtk_legacy", "read_legacy"), fields=_late("vtk_legacy", "legacy_fields")
    ),
    Format(suffixes=(".vti",), read=_late("vti", "read_vti"), fields=_late("vti", "vti_fields")),
    Format(
        suffixes=(".pvti",),
        read=_late("vti", "read_pvti"),
        files=_late("vti", "pvti_files"),
        fields=_late("vti", "pvti_fields"),
        lists=True,
    ),
    Format(
        suffixes=(".pvd", *(f"{suffix}.series" for suffix in (".vtu", ".pvtu", ".vti", ".pvti", ".vtk"))),
        read=_late("series", "read_step"),
        count=_late("series", "count_step"),
        files=_late("series", "series_files"),
        fields=_late("series", "series_fields"),
        times=_late("series", "times"),
        step_files=_late("series", "series_files"),
        lists=True,
    ),
)

#: The row of each suffix.
BY_SUFFIX = {suffix: form for form in FORMATS for suffix in form.suffixes}

#: What a folder is searched for: an .img is found through its .hdr.
SEARCHED = tuple(suffix for suffix, form in BY_SUFFIX.items() if suffix not in form.unsearched)
