"""Read FreeSurfer's MGH: .mgh, and .mgz, which is the same packed with gzip. World is the scanner's RAS, in mm.

Follows "MGH / MGZ volume format" of the FreeSurfer wiki: a header of 284 bytes, big-endian, then one frame after the
other; what follows the samples is left unread.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.arrays import contourable
from isocore.errors import FieldError, InputError
from isocore.readers.layout import Layout, chosen, load, spatial
from isocore.readers.options import ReadOptions
from isocore.readers.packed import Packed, packing_of
from isocore.volume import Volume

_HEADER_BYTES = 284
_VERSION = 1
#: Version, width, height, depth, frames, type, degrees of freedom, whether the rest counts, and the rest.
_FIELDS = struct.Struct(">7ih15f")
_TYPES = {0: "u1", 1: "i4", 2: "i8", 3: "f4", 4: "i2", 10: "u2"}
#: Where the header says nothing: samples 1 mm apart, in a coronal scan about the origin.
_DELTA = (1.0, 1.0, 1.0)
_CORONAL = ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0))


@dataclass(frozen=True, slots=True)
class Head:
    """layout: of the samples; affine: (4, 4) float64, index to RAS, in mm; warnings: on its place."""

    layout: Layout
    affine: npt.NDArray[np.float64]
    warnings: tuple[str, ...]


def read_mgh(path: Path, options: ReadOptions) -> Volume:
    """The volume of a .mgh or a .mgz; of several frames the one that is asked for."""
    with Packed(path, packing=packing_of(path)) as source:
        head = _head(source.read(_HEADER_BYTES))
        frame = chosen(head.layout, options.volume)
        source.promise(_HEADER_BYTES + head.layout.total_bytes, kept_bytes=head.layout.volume_bytes)
        samples: Any = load(source, head.layout, frame)
        source.finish()
        behind = source.warnings
    samples, lost = contourable(samples)
    return Volume(samples, affine=head.affine, space="ras", unit="mm", warnings=head.warnings + lost + behind)


def count_mgh(path: Path, options: ReadOptions) -> int:
    """How many frames the file holds."""
    with Packed(path, packing=packing_of(path)) as source:
        return _head(source.read(_HEADER_BYTES)).layout.volumes


def _head(data: bytes) -> Head:
    if len(data) < _HEADER_BYTES:
        raise InputError(f"ends early ({len(data):,} of {_HEADER_BYTES} bytes of its header); copy it again")
    version, width, height, depth, frames, kind, _, good, *floats = _FIELDS.unpack_from(data)
    if version != _VERSION:
        raise InputError(f"is no MGH file (its header has version {version}, not {_VERSION}); check its suffix")
    if min(width, height, depth, frames) < 0:
        raise InputError(f"header has an axis of {min(width, height, depth, frames)} samples; it is damaged")
    if kind not in _TYPES:
        raise FieldError(f"samples are of FreeSurfer's type {kind}, which is not read; convert it with mri_convert")
    layout = Layout(spatial((width, height, depth)), np.dtype(f">{_TYPES[kind]}"), frames)
    if good != 1:
        warning = "its header states no orientation; a coronal scan with samples 1 mm apart was taken, as by FreeSurfer"
        return Head(layout, _affine(layout.shape, _DELTA, np.array(_CORONAL), (0.0, 0.0, 0.0)), (warning,))
    if not np.isfinite(floats).all():
        raise InputError("header has a place that is no number; it is damaged")
    return Head(layout, _affine(layout.shape, floats[:3], np.reshape(floats[3:12], (3, 3)), floats[12:]), ())


def _affine(shape: tuple[int, ...], delta: Any, directions: Any, centre: Any) -> npt.NDArray[np.float64]:
    """directions: (3, 3), a row for each axis; centre: the world's place of index shape / 2."""
    affine = np.eye(4)
    affine[:3, :3] = np.asarray(directions, dtype=np.float64).T * np.asarray(delta, dtype=np.float64)
    affine[:3, 3] = np.asarray(centre, dtype=np.float64) - affine[:3, :3] @ (np.array(shape) / 2)
    return affine
