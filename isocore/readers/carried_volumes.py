"""A volume that carries others: files on the same grid, as a second contrast of one scan."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from isocore.carried import CarriedField, distinct_names
from isocore.cell_mesh import CellMesh
from isocore.errors import FieldError, InputError, IsocoreError, OptionError
from isocore.readers.options import ReadOptions
from isocore.volume import Volume

#: Grids are the same where their corners lie apart by less than this part of a voxel: headers keep seven digits.
_APART = 1e-2

Read: TypeAlias = Callable[[Path, ReadOptions], Volume | CellMesh]
Count: TypeAlias = Callable[[Path, ReadOptions], int]


def carried_files(options: ReadOptions) -> tuple[Path, ...]:
    """The files among what is to be carried, as far as they are there."""
    return tuple(path for name in options.carry if name != "all" and (path := Path(name)).is_file())


def with_carried(volume: Volume, path: Path, options: ReadOptions, count: Count, read: Read) -> Volume:
    """The volume with what `options` ask it to carry: its reader has found the fields of its own file already.

    count, read: how many volumes a file holds, and one of them. Raises OptionError for what is neither a field nor a
    file, FieldError where a file's grid is another.
    """
    own = {field.name for field in volume.carried}
    found, warnings = list(volume.carried), volume.warnings
    for name in options.carry:
        if name == "all":
            if not volume.carried:
                warnings += ("--carry all: the file holds no other field; for a volume name another file, on its grid",)
        elif Path(name).is_file():
            other = _other(Path(name), path, options, count, read)
            _check_grid(volume, other, name)
            found.append(_as_field(other, Path(name)))
            warnings += tuple(f"{name}: {warning}" for warning in other.warnings)
        elif name not in own:
            have = ", ".join(sorted(own)) or "none besides the contoured one"
            raise OptionError(f"--carry {name}: is no field of the file, which holds {have}, and no file that is there")
    return replace(volume, carried=distinct_names(found), warnings=warnings)


def _other(file: Path, path: Path, options: ReadOptions, count: Count, read: Read) -> Volume:
    """The volume that is carried; of several the one of the same number."""
    asked = replace(options, carry=(), ignore=(), field=None, component=None, step=None)
    try:
        several = count(file, asked)
        if several > 1 and options.volume is None:
            raise OptionError(f"{file}: holds {several:,} volumes; choose one with --volume")
        other = read(file, asked if several > 1 else replace(asked, volume=None))
    except IsocoreError as error:
        raise InputError(f"{path}: --carry {error}") from error
    if not isinstance(other, Volume):
        raise FieldError(f"--carry {file}: is a mesh; a volume carries volumes on its own grid")
    return other


def _check_grid(volume: Volume, other: Volume, name: str) -> None:
    """Raises FieldError where the two lie on different grids."""
    if other.shape != volume.shape:
        theirs, ours = ("x".join(map(str, one.shape)) for one in (other, volume))
        raise FieldError(f"--carry {name}: has {theirs} samples, the volume has {ours}; resample it to the same grid")
    if "native" not in (volume.space, other.space):
        other = other.in_space(volume.space)
    if volume.unit and other.unit and volume.unit != other.unit:
        units = f"is in {other.unit}, the volume in {volume.unit}"
        raise FieldError(f"--carry {name}: {units}; resample it to the same grid")
    ends = np.array([[i, j, k, 1] for i in (0, 1) for j in (0, 1) for k in (0, 1)]) * [*np.array(volume.shape) - 1, 1]
    apart = float(np.linalg.norm(((volume.affine - other.affine) @ ends.T)[:3], axis=0).max())
    if not apart <= _APART * min(volume.spacing):
        unit = f" {volume.unit}" if volume.unit else ""
        raise FieldError(
            f"--carry {name}: lies elsewhere than the volume, by up to {apart:.3g}{unit} at its corners; "
            "resample it to the same grid"
        )


def _as_field(other: Volume, file: Path) -> CarriedField:
    """Named after its field or its file."""
    name = other.field_name or os.fspath(file.name).split(".")[0] or file.name
    return CarriedField(name, other.samples.reshape(-1, order="F"), "points", other.slope, other.intercept)
