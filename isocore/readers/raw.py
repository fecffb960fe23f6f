"""Read raw samples: what the file cannot tell comes from options or a sidecar NAME.raw.json beside it."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, replace
from errno import ENAMETOOLONG
from pathlib import Path
from typing import Any, Literal

import numpy as np

from isocore.errors import InputError, OptionError
from isocore.readers.layout import Layout, chosen, load, spatial
from isocore.readers.options import ReadOptions
from isocore.readers.packed import Packed, packing_by_suffix
from isocore.readers.sample_types import contourable
from isocore.volume import Volume

_ADVICE = "check --shape, --dtype and --offset"
_SIDECAR_KEYS = ("shape", "dtype", "spacing", "origin", "byte_order", "offset")
_TYPE_NAMES = re.compile(r"u?int(8|16|32|64)|float(16|32|64)")
_NUMPY_NAMES = re.compile(r"(?P<order>[<>=|]?)(?P<kind>[ui][1248]|f[248])")
_C_NAMES = {
    "uchar": "u1",
    "schar": "i1",
    "short": "i2",
    "ushort": "u2",
    "uint": "u4",
    "int": "i4",
    "float": "f4",
    "double": "f8",
}
_ORDERS: dict[str, Literal["<", ">"]] = {"little": "<", "big": ">"}


@dataclass(frozen=True, slots=True)
class _Description:
    """A raw file, fully described."""

    layout: Layout
    spacing: tuple[float, ...]
    origin: tuple[float, ...]
    offset: int


def read_raw(path: Path, options: ReadOptions) -> Volume:
    """The volume of a raw file, i fastest; world is index times spacing plus origin."""
    told = _described(path, options)
    volume = chosen(told.layout, options.volume)
    with Packed(path, packing=packing_by_suffix(path), advice=_ADVICE) as source:
        source.promise(told.offset + told.layout.total_bytes, kept_bytes=told.layout.volume_bytes)
        source.skip(told.offset)
        samples: Any = load(source, told.layout, volume)
        following = told.layout.volume_bytes * (told.layout.volumes - 1 - volume)
        surplus = source.rest(following) - following
        warnings = source.warnings
    if surplus > 0:
        warnings += (f"has {surplus:,} bytes more than it should; {_ADVICE}",)
    samples, lost = contourable(samples)
    affine = np.diag([*told.spacing, 1.0])
    affine[:3, 3] = told.origin
    return Volume(samples, affine=affine, warnings=warnings + lost)


def count_raw(path: Path, options: ReadOptions) -> int:
    """How many volumes the file is said to hold."""
    return _described(path, options).layout.volumes


def raw_files(path: Path) -> tuple[Path, ...]:
    """Its sidecar, where there is one."""
    sidecar = _sidecar(path)
    return (sidecar,) if _is_there(sidecar) else ()


def _described(path: Path, options: ReadOptions) -> _Description:
    told = _with_sidecar(path, options)
    missing = [f"--{key}" for key in ("shape", "dtype") if getattr(told, key) is None]
    if missing:
        raise OptionError(f"needs {' and '.join(missing)}; a raw file cannot tell its own")
    assert told.shape is not None and told.dtype is not None
    if len(told.shape) not in (3, 4) or min(told.shape) < 0 or 0 in told.shape[3:]:
        raise OptionError(f"--shape is {_listed(told.shape)}; it takes X,Y,Z or X,Y,Z,volumes")
    spacing, origin = told.spacing or (1.0, 1.0, 1.0), told.origin or (0.0, 0.0, 0.0)
    if len(spacing) != 3 or not all(math.isfinite(step) and step > 0 for step in spacing):
        raise OptionError(f"--spacing is {_listed(spacing)}; it takes three lengths above 0")
    if len(origin) != 3 or not all(map(math.isfinite, origin)):
        raise OptionError(f"--origin is {_listed(origin)}; it takes three coordinates")
    offset = told.offset or 0
    if offset < 0:
        raise OptionError(f"--offset is {offset}; it takes the bytes before the first sample")
    volumes = told.shape[3] if len(told.shape) == 4 else 1
    layout = Layout(spatial(told.shape[:3]), _sample_type(told.dtype, told.byte_order), volumes=volumes)
    return _Description(layout, spacing, origin, offset)


def _sample_type(name: str, byte_order: str | None) -> np.dtype[Any]:
    """The type `name` means; platform-dependent names such as "long" are not taken."""
    if byte_order is not None and byte_order not in _ORDERS:
        raise OptionError(f"--byte-order is {byte_order}; it takes little or big")
    order = _ORDERS.get(byte_order or "little", "<")
    lowered = name.strip().lower()
    if _TYPE_NAMES.fullmatch(lowered):
        return np.dtype(lowered).newbyteorder(order)
    if lowered in _C_NAMES:
        return np.dtype(_C_NAMES[lowered]).newbyteorder(order)
    coded = _NUMPY_NAMES.fullmatch(lowered)
    if coded is None:
        raise OptionError(f"--dtype is {name}; it takes uint8, int16, float32 and their like, or <u2")
    if coded["order"] in ("<", ">"):
        if byte_order is not None and coded["order"] != order:
            raise OptionError(f"--dtype {name} and --byte-order {byte_order} contradict each other; leave one out")
        order = "<" if coded["order"] == "<" else ">"
    return np.dtype(coded["kind"]).newbyteorder(order)


def _sidecar(path: Path) -> Path:
    bare = path.name[:-3] if path.name.lower().endswith(".gz") else path.name
    return path.with_name(bare + ".json")


def _is_there(sidecar: Path) -> bool:
    try:
        return sidecar.is_file()
    except OSError as error:
        if error.errno == ENAMETOOLONG:  # the samples' name leaves no room for a longer one
            return False
        raise


def _with_sidecar(path: Path, options: ReadOptions) -> ReadOptions:
    """`options`, filled up with what NAME.raw.json says."""
    sidecar = _sidecar(path)
    if not _is_there(sidecar):
        return options
    try:
        said = json.loads(sidecar.read_text("utf-8"))
    except ValueError as error:
        raise InputError(f"its sidecar {sidecar.name} is not JSON ({error}); mend it") from error
    if not isinstance(said, dict):
        raise InputError(f"its sidecar {sidecar.name} is no JSON object; mend it")
    found = {key.replace("-", "_"): value for key, value in said.items()}
    for key, value in found.items():
        if key not in _SIDECAR_KEYS:
            raise InputError(f"its sidecar {sidecar.name} has the key {key}; it takes {', '.join(_SIDECAR_KEYS)}")
        if not _fits(key, value):
            raise InputError(f"its sidecar {sidecar.name} gives {key} as {json.dumps(value)}; mend it")
    told: dict[str, Any] = {key: tuple(one) if isinstance(one, list) else one for key, one in found.items()}
    return replace(options, **{key: one for key, one in told.items() if getattr(options, key) is None})


def _fits(key: str, value: object) -> bool:
    if key in ("dtype", "byte_order"):
        return isinstance(value, str)
    if key == "offset":
        return type(value) is int
    kinds = (int,) if key == "shape" else (int, float)
    return isinstance(value, list) and all(type(one) in kinds for one in value)


def _listed(numbers: tuple[float, ...]) -> str:
    return ",".join(f"{one:g}" for one in numbers)
