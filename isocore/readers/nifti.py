"""Read NIfTI-1, NIfTI-2 and Analyze 7.5: .nii, .hdr with .img, each also packed with gzip.

Samples keep their stored type; slope and intercept travel beside them. World is RAS in mm (`isocore.volume`).
"""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import Any

from isocore.errors import InputError
from isocore.readers.layout import Layout, chosen, load, spatial
from isocore.readers.nifti_header import LONGEST, has_samples, parsed, placement, sample_type, scaling, sizes_of
from isocore.readers.options import ReadOptions
from isocore.readers.packed import Packed, packing_by_suffix, packing_of
from isocore.readers.pointers import absence_beside
from isocore.readers.sample_types import contourable, from_float128
from isocore.volume import Volume

#: Extensions longer than this are not looked through.
_MOST_EXTENSION_BYTES = 1 << 24


def read_nifti(path: Path, options: ReadOptions) -> Volume:
    """The volume of a NIfTI or Analyze file; `path` is its .nii, its .hdr or its .img."""
    header_path, image_path = _pair(path)
    header = _header(header_path)
    layout = _layout(header)
    volume = chosen(layout, options.volume)
    start = _first_byte(header, image_path)
    with _samples(header_path, image_path) as source:
        source.promise(start + layout.total_bytes, kept_bytes=layout.volume_bytes)
        source.skip(start)
        samples: Any = load(source, layout, volume)
        source.finish()
        behind = source.warnings
    samples, lost = from_float128(samples, header.endianness) if samples.dtype.kind == "V" else contourable(samples)
    slope, intercept = scaling(header)
    place = placement(header)
    return Volume(
        samples,
        slope=slope,
        intercept=intercept,
        affine=place.affine,
        space=place.space,
        unit=place.unit,
        warnings=lost + place.warnings + behind,
    )


def count_nifti(path: Path, options: ReadOptions) -> int:
    """How many volumes the file holds."""
    return _layout(_header(_pair(path)[0])).volumes


def nifti_files(path: Path) -> tuple[Path, ...]:
    """The image of a header, or the header of an image, where it is there."""
    return tuple(file for file in _pair(path) if file not in (path, None) and file.is_file())


def extension_texts(path: Path) -> list[bytes]:
    """The contents of the extensions behind a single file's header, in their order; what is damaged ends the list."""
    with Packed(path, packing=packing_of(path)) as source:
        head = source.read(LONGEST)
        header = parsed(head)
        size = header.sizeof_hdr
        end = min(int(_first_byte(header, None)), size + _MOST_EXTENSION_BYTES)
        block = (head + source.read(max(0, end - len(head))))[:end]
    if block[size : size + 1] != b"\1":
        return []
    texts, at, order = [], size + 4, "<" if header.endianness == "<" else ">"
    while at + 8 <= len(block):
        length, _ = struct.unpack(f"{order}ii", block[at : at + 8])
        if length < 8 or at + length > len(block):
            break
        texts.append(block[at + 8 : at + length])
        at += length
    return texts


def _header(path: Path) -> Any:
    with Packed(path, packing=packing_of(path)) as source:
        return parsed(source.read(LONGEST))


def _first_byte(header: Any, image_path: Path | None) -> int:
    """Where the samples start in the file that holds them: the image, or the header's own (None)."""
    start = float(header["vox_offset"])
    smallest = 0
    if image_path is None:
        if not has_samples(header):
            raise InputError("is no NIfTI file (its header has no magic n+1 or n+2); check its suffix")
        smallest = header.single_vox_offset
        start = start or smallest
    if not (math.isfinite(start) and start >= smallest):
        raise InputError(f"header puts the samples at byte {start:g}, inside itself; it is damaged")
    return int(start)


def _samples(header_path: Path, image_path: Path | None) -> Packed:
    if image_path is None:
        return Packed(header_path, packing=packing_of(header_path))
    if not image_path.is_file():
        raise InputError(f"its samples are missing: {absence_beside(image_path)}")
    return Packed(image_path, packing=packing_by_suffix(image_path), subject=f"{image_path.name} ")


def _layout(header: Any) -> Layout:
    stored = sample_type(header)
    sizes = sizes_of(header)
    shape = spatial((*sizes, 1, 1)[:3])
    return Layout(shape, stored, volumes=math.prod(sizes[3:]))


def _pair(path: Path) -> tuple[Path, Path | None]:
    """Header and image file: two for .hdr and .img, else the same one (image None)."""
    suffix = ".gz" if path.name.lower().endswith(".gz") else ""
    bare = path.name[: -len(suffix)] if suffix else path.name
    stem, kind = bare[:-4], bare[-4:]
    if kind.lower() not in (".hdr", ".img"):
        return path, None
    partner = {".hdr": ".img", ".img": ".hdr", ".HDR": ".IMG", ".IMG": ".HDR"}.get(kind, ".img")
    beside = [path.with_name(stem + partner + end) for end in (suffix, ".gz", "")]
    found = next((file for file in beside if file.is_file()), beside[0])
    if kind.lower() == ".hdr":
        return path, found
    if not found.is_file():
        raise InputError(f"its header is missing: {absence_beside(found)}")
    return found, path
