"""The header of a NIfTI-1, NIfTI-2 or Analyze 7.5 file, and where it puts the samples.

Field names and offsets follow nifti1.h and nifti2.h (NIfTI Data Format Working Group, 2003 and 2011); of each
header only the fields that say something about samples or place are read.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.layout import Placement

#: Sample types by datatype code; every other code is refused, these in `UNCONTOURABLE` by name.
DATATYPES = {
    2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 256: "i1", 512: "u2", 768: "u4", 1024: "i8", 1280: "u8",
    1536: "V16",
}  # fmt: skip
UNCONTOURABLE = {
    1: "single bits", 32: "complex64", 128: "RGB colours", 1792: "complex128", 2048: "complex256",
    2304: "RGBA colours",
}  # fmt: skip

Order = Literal["<", ">"]

#: xyzt_units, the lower three bits: millimetres per unit.
_MM_PER_UNIT = {1: 1000.0, 2: 1.0, 3: 0.001}


def _header_type(size: int, fields: dict[str, tuple[str, int]]) -> np.dtype[Any]:
    formats, offsets = zip(*fields.values(), strict=True)
    return np.dtype({"names": list(fields), "formats": formats, "offsets": offsets, "itemsize": size})


_NIFTI_1 = _header_type(
    348,
    {
        "dim": ("8i2", 40), "datatype": ("i2", 70), "pixdim": ("8f4", 76), "vox_offset": ("f4", 108),
        "slope": ("f4", 112), "intercept": ("f4", 116), "xyzt_units": ("u1", 123), "qform_code": ("i2", 252),
        "sform_code": ("i2", 254), "quatern": ("3f4", 256), "qoffset": ("3f4", 268), "srow": ("(3,4)f4", 280),
        "magic": ("V4", 344),
    },
)  # fmt: skip
_NIFTI_2 = _header_type(
    540,
    {
        "magic": ("V4", 4), "datatype": ("i2", 12), "dim": ("8i8", 16), "pixdim": ("8f8", 104),
        "vox_offset": ("i8", 168),
        "slope": ("f8", 176), "intercept": ("f8", 184), "qform_code": ("i4", 344), "sform_code": ("i4", 348),
        "quatern": ("3f8", 352), "qoffset": ("3f8", 376), "srow": ("(3,4)f8", 400), "xyzt_units": ("i4", 500),
    },
)  # fmt: skip


def parsed(head: bytes) -> tuple[Any, Order]:
    """The header's fields in its first bytes, and its byte order, "<" or ">".

    The field "magic" reads b"n+1" and b"n+2" where samples follow in the same file, b"ni1" and b"ni2" where
    they lie in an .img, and anything else in Analyze.
    """
    orders: tuple[Order, Order] = ("<", ">")
    for order in orders:
        size = int(np.frombuffer(head[:4], f"{order}i4")[0]) if len(head) >= 4 else 0
        layout = {348: _NIFTI_1, 540: _NIFTI_2}.get(size)
        if layout is None:
            continue
        if len(head) < size:
            raise InputError(f"ends early ({len(head)} of {size} bytes); copy it again")
        return np.frombuffer(head[:size], layout.newbyteorder(order))[0], order
    raise InputError("is no NIfTI or Analyze file (its header has no known size); check its suffix")


def sizes_of(header: Any) -> tuple[int, ...]:
    """Samples per axis, as many axes as the header counts; empty further axes count as one."""
    axes = int(header["dim"][0])
    if not 1 <= axes <= 7:
        raise InputError(f"header counts {axes} axes, where 1 to 7 are possible; it is damaged")
    sizes = [int(n) for n in header["dim"][1 : axes + 1]]
    sizes[3:] = [n or 1 for n in sizes[3:]]
    if min(sizes) < 0:
        raise InputError(f"header gives an axis {min(sizes)} samples; it is damaged")
    return tuple(sizes)


def is_analyze(header: Any) -> bool:
    """Whether the header is of Analyze 7.5, which has no magic, no orientation and no intercept."""
    return header["magic"].tobytes()[:3] not in (b"n+1", b"ni1", b"n+2", b"ni2")


def scaling(header: Any) -> tuple[float, float]:
    """Slope and intercept; (1, 0) where the header has none."""
    slope, intercept = float(header["slope"]), float(header["intercept"])
    if not np.isfinite(slope) or slope == 0:
        return 1.0, 0.0
    return slope, intercept if np.isfinite(intercept) and not is_analyze(header) else 0.0


def placement(header: Any) -> Placement:
    """Where the samples lie: by sform, else qform, else the spacing alone."""
    with np.errstate(invalid="ignore"):  # widening a signalling NaN
        return _placement(header)


def _placement(header: Any) -> Placement:
    spacing, repaired = _spacing(header)
    warnings = ["its header leaves an axis without a spacing; 1 was taken"] if repaired else []
    bare = np.diag([*spacing, 1.0])
    if is_analyze(header):
        warnings.append("Analyze files state no orientation; left and right may be exchanged")
        return Placement(bare, "native", "mm", tuple(warnings))
    affine = bare
    for name, stated in (("sform", _sform(header)), ("qform", _qform(header, spacing))):
        if stated is not None and _is_regular(stated):
            affine = stated
            break
        if stated is not None:
            warnings.append(f"its {name} is singular and was passed over")
    else:
        warnings.append("its header states no orientation; the axes were taken as right, anterior, superior")
    factor = _MM_PER_UNIT.get(int(header["xyzt_units"]) & 7)
    affine[:3] *= factor or 1.0
    return Placement(affine, "ras", "mm" if factor else "", tuple(warnings))


def _sform(header: Any) -> npt.NDArray[np.float64] | None:
    if header["sform_code"] <= 0:
        return None
    return np.vstack([header["srow"].astype(np.float64), [0.0, 0.0, 0.0, 1.0]])


def _qform(header: Any, spacing: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | None:
    if header["qform_code"] <= 0:
        return None
    affine = np.eye(4)
    mirror = -1.0 if header["pixdim"][0] < 0 else 1.0
    affine[:3, :3] = _rotation(header["quatern"]) * (spacing * [1.0, 1.0, mirror])
    affine[:3, 3] = header["qoffset"]
    return affine


def _spacing(header: Any) -> tuple[npt.NDArray[np.float64], bool]:
    spacing = np.abs(header["pixdim"][1:4].astype(np.float64))
    missing = ~np.isfinite(spacing) | (spacing == 0)
    spacing[missing] = 1.0
    return spacing, bool(missing.any())


def _rotation(bcd: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """The rotation of the unit quaternion with the parts b, c, d, rounded as the header stores them.

    A half turn has a = 0; what rounding leaves of 1 - b^2 - c^2 - d^2 would tilt it by its square root.
    """
    squares = float((bcd.astype(np.float64) ** 2).sum())
    rest = 1.0 - squares
    half_turn = rest < 3 * np.finfo(bcd.dtype).eps
    a = 0.0 if half_turn else np.sqrt(rest)
    b, c, d = bcd.astype(np.float64) / (np.sqrt(squares) if half_turn else 1.0)
    return np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - c * c - b * b],
        ]
    )


def _is_regular(affine: npt.NDArray[np.float64]) -> bool:
    return bool(np.isfinite(affine).all()) and abs(float(np.linalg.det(affine[:3, :3]))) > 1e-30
