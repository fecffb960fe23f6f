"""What the header of a NIfTI-1, NIfTI-2 or Analyze 7.5 file says about samples and place.

nibabel takes the header apart. Here stand the choice between what a header states twice, the checks that keep
a damaged one from being believed, and the few fields that nibabel refuses but files have.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import InputError
from isocore.readers.layout import Placement
from isocore.readers.sample_types import refuse

#: Bytes of the longest header.
LONGEST = 540

#: Sample types without an isosurface, by nibabel's labels.
_UNCONTOURABLE = {
    "binary": "single bits", "RGB": "RGB colours", "RGBA": "RGBA colours",
    "complex64": "complex64", "complex128": "complex128", "complex256": "complex256",
}  # fmt: skip

_MM_PER_UNIT = {"meter": 1000.0, "mm": 1.0, "micron": 0.001}


def parsed(head: bytes) -> Any:
    """nibabel's header of a file's first bytes; of Analyze, the one with SPM2's scale."""
    from nibabel.nifti1 import Nifti1Header
    from nibabel.nifti2 import Nifti2Header
    from nibabel.spm2analyze import Spm2AnalyzeHeader

    kinds: tuple[Any, Any] = (
        Nifti1Header if Nifti1Header.may_contain_header(head) else Spm2AnalyzeHeader,  # type: ignore[no-untyped-call]
        Nifti2Header,
    )
    for kind in kinds:
        # Left to itself, nibabel tells the byte order by the number of axes, which may be damaged.
        if order := {kind.sizeof_hdr.to_bytes(4, order): order for order in ("little", "big")}.get(head[:4]):
            if len(head) < kind.sizeof_hdr:
                raise InputError(f"ends early ({len(head)} of {kind.sizeof_hdr} bytes); copy it again")
            return kind(head[: kind.sizeof_hdr], order, check=False)
    raise InputError("is no NIfTI or Analyze file (its header has no known size); check its suffix")


def has_samples(header: Any) -> bool:
    """Whether the magic says that the samples follow the header in the same file."""
    return is_nifti(header) and header["magic"].item() == header.single_magic


def is_nifti(header: Any) -> bool:
    """False for Analyze 7.5, which has no magic and no orientation."""
    return "magic" in header


def sample_type(header: Any) -> np.dtype[Any]:
    """As stored, with its byte order."""
    from nibabel.nifti1 import data_type_codes

    known: Any = data_type_codes  # Analyze's are a part of NIfTI's
    code = int(header["datatype"])
    label = known.label[code] if code in known else ""
    if label in _UNCONTOURABLE:
        raise refuse(_UNCONTOURABLE[label], "convert them to numbers first")
    # Of 16-byte floats nibabel knows the machine's own at most.
    stored: np.dtype[Any] = np.dtype("V16" if label == "float128" else known.dtype[code] if label else "V0")
    if not stored.itemsize:
        raise InputError(f"header names the sample type {code}, which NIfTI does not know; it is damaged")
    return stored.newbyteorder(header.endianness)


def sizes_of(header: Any) -> tuple[int, ...]:
    """Samples per axis, as many axes as the header counts; empty further axes count as one."""
    axes = int(header["dim"][0])
    if not 1 <= axes <= 7:
        raise InputError(f"header counts {axes} axes, where 1 to 7 are possible; it is damaged")
    sizes = list(header.get_data_shape())
    sizes[3:] = [n or 1 for n in sizes[3:]]
    if min(sizes) < 0:
        raise InputError(f"header gives an axis {min(sizes)} samples; it is damaged")
    return tuple(sizes)


def scaling(header: Any) -> tuple[float, float]:
    """Slope and intercept; (1, 0) where the header has none."""
    if not np.isfinite(header["scl_inter"]):
        header["scl_inter"] = 0  # nibabel refuses a slope beside an intercept that is no number
    with np.errstate(all="ignore"):
        slope, intercept = (float(number or 0.0) for number in header.get_slope_inter())
    return (slope, intercept) if slope and np.isfinite([slope, intercept]).all() else (1.0, 0.0)


def placement(header: Any) -> Placement:
    """Where the samples lie: by sform, else qform, else the spacing alone."""
    with np.errstate(all="ignore"):  # a damaged header may hold any number
        warnings = ["its header leaves an axis without a spacing; 1 was taken"] if _mended(header) else []
        bare = np.diag([*header["pixdim"][1:4].astype(np.float64), 1.0])
        if not is_nifti(header):
            warnings.append("Analyze files state no orientation; left and right may be exchanged")
            return Placement(bare, "native", "mm", tuple(warnings))
        affine = bare
        for name, stated in (("sform", _sform(header)), ("qform", _qform(header))):
            if stated is not None and _is_regular(stated):
                affine = stated
                break
            if stated is not None:
                warnings.append(f"its {name} is singular and was passed over")
        else:
            warnings.append("its header states no orientation; the axes were taken as right, anterior, superior")
    factor = _mm_per_unit(header)
    affine[:3] *= factor or 1.0
    return Placement(affine, "ras", "mm" if factor else "", tuple(warnings))


def _mended(header: Any) -> bool:
    """Make each axis' spacing a length; whether one had none."""
    spacing = np.abs(header["pixdim"][1:4])
    missing = ~np.isfinite(spacing) | (spacing == 0)
    header["pixdim"][1:4] = np.where(missing, 1.0, spacing)
    return bool(missing.any())


def _sform(header: Any) -> npt.NDArray[np.float64] | None:
    return header.get_sform() if header["sform_code"] > 0 else None


def _qform(header: Any) -> npt.NDArray[np.float64] | None:
    """As nibabel has it, once two things are mended that nifti1.h allows for and get_qform refuses.

    A mirror (pixdim[0]) other than 1 and -1 means 1; a quaternion longer than 1 by rounding is a half turn.
    """
    if header["qform_code"] <= 0:
        return None
    header["pixdim"][0] = -1.0 if header["pixdim"][0] < 0 else 1.0
    length = math.hypot(*(float(header[f"quatern_{part}"]) for part in "bcd"))
    for part in "bcd" if length > 1 else "":
        header[f"quatern_{part}"] = header[f"quatern_{part}"] / length
    affine: npt.NDArray[np.float64] = header.get_qform()
    return affine


def _mm_per_unit(header: Any) -> float | None:
    """Of the lower three bits: get_xyzt_units fails where the unit of time beside them is not known."""
    from nibabel.nifti1 import unit_codes

    code = int(header["xyzt_units"]) & 7
    return _MM_PER_UNIT.get(str(unit_codes.label[code])) if code in unit_codes else None


def _is_regular(affine: npt.NDArray[np.float64]) -> bool:
    return bool(np.isfinite(affine).all()) and 1e-30 < abs(float(np.linalg.det(affine[:3, :3]))) < math.inf
