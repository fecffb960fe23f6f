"""The table of formats that are read. To add one: its functions in a file of their own, and a row here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from isocore.cell_mesh import CellMesh
from isocore.late import late
from isocore.readers.options import ReadOptions
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


FORMATS = (
    Format(
        suffixes=(".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"),
        read=late("readers.nifti", "read_nifti"),
        count=late("readers.nifti", "count_nifti"),
        files=late("readers.nifti", "nifti_files"),
        unsearched=(".img", ".img.gz"),
    ),
    Format(
        suffixes=(".nrrd", ".nhdr"),
        read=late("readers.nrrd", "read_nrrd"),
        count=late("readers.nrrd", "count_nrrd"),
        files=late("readers.nrrd", "nrrd_files"),
    ),
    Format(
        suffixes=(".mha", ".mhd"),
        read=late("readers.metaimage", "read_metaimage"),
        count=late("readers.metaimage", "count_metaimage"),
        files=late("readers.metaimage", "metaimage_files"),
    ),
    Format(suffixes=(".mgz", ".mgh"), read=late("readers.mgh", "read_mgh"), count=late("readers.mgh", "count_mgh")),
    Format(
        suffixes=(".raw", ".raw.gz"),
        read=late("readers.raw", "read_raw"),
        count=late("readers.raw", "count_raw"),
        files=late("readers.raw", "raw_files"),
    ),
    Format(suffixes=(".vtu",), read=late("readers.vtu", "read_vtu"), fields=late("readers.vtu", "vtu_fields")),
    Format(
        suffixes=(".pvtu",),
        read=late("readers.pvtu", "read_pvtu"),
        files=late("readers.pvtu", "pvtu_files"),
        fields=late("readers.pvtu", "pvtu_fields"),
        lists=True,
    ),
    Format(
        suffixes=(".vtk",),
        read=late("readers.vtk_legacy", "read_legacy"),
        fields=late("readers.vtk_legacy", "legacy_fields"),
    ),
    Format(suffixes=(".vti",), read=late("readers.vti", "read_vti"), fields=late("readers.vti", "vti_fields")),
    Format(
        suffixes=(".pvti",),
        read=late("readers.vti", "read_pvti"),
        files=late("readers.vti", "pvti_files"),
        fields=late("readers.vti", "pvti_fields"),
        lists=True,
    ),
    Format(
        suffixes=(".pvd", *(f"{suffix}.series" for suffix in (".vtu", ".pvtu", ".vti", ".pvti", ".vtk"))),
        read=late("readers.series", "read_step"),
        count=late("readers.series", "count_step"),
        files=late("readers.series", "series_files"),
        fields=late("readers.series", "series_fields"),
        times=late("readers.series", "times"),
        step_files=late("readers.series", "series_files"),
        lists=True,
    ),
)

#: The row of each suffix.
BY_SUFFIX = {suffix: form for form in FORMATS for suffix in form.suffixes}

#: What a folder is searched for: an .img is found through its .hdr.
SEARCHED = tuple(suffix for suffix, form in BY_SUFFIX.items() if suffix not in form.unsearched)
