"""Small volumes in every format that is read, written by other people's libraries where there are some."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import nibabel as nib
import nrrd
import numpy as np
import numpy.typing as npt

#: The project's real data; tests that need it are skipped where it is not.
REAL_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"

#: Not its own mirror image, in millimetres, with a rotation and three spacings.
AFFINE = np.array([[0.0, -2.0, 0.0, 10.0], [1.5, 0.0, 0.0, -20.0], [0.0, 0.0, 3.0, 30.0], [0.0, 0.0, 0.0, 1.0]])


def ramp(shape: tuple[int, ...] = (4, 5, 6), dtype: Any = "int16") -> npt.NDArray[Any]:
    """shape, Fortran order: the samples count up in the order of memory, so that any exchange shows."""
    return np.arange(np.prod(shape), dtype=dtype).reshape(shape, order="F")


def save(path: Path, samples: npt.NDArray[Any], *, affine: npt.NDArray[np.float64] = AFFINE) -> Path:
    """Write samples in the format that `path` names; an .img is written by its .hdr."""
    name = path.name.lower()
    if name.endswith((".nii", ".nii.gz")):
        nib.Nifti1Image(samples, affine, _header(samples, affine)).to_filename(path)
    elif ".hdr" in name or ".img" in name:
        nib.Nifti1Pair(samples, affine, _header(samples, affine)).to_filename(path)
    elif name.endswith((".nrrd", ".nhdr")):
        directions = np.vstack([affine[:3, :3].T, np.full((samples.ndim - 3, 3), np.nan)])
        header = {
            "space": "RAS",
            "space directions": directions,
            "space origin": affine[:3, 3],
            "encoding": "gzip",
        }
        nrrd.write(str(path), samples, header, index_order="F")
    else:
        content = samples.tobytes(order="F")
        path.write_bytes(gzip.compress(content) if name.endswith(".gz") else content)
        said = {"shape": samples.shape, "dtype": samples.dtype.str}
        path.with_name(path.name.removesuffix(".gz") + ".json").write_text(json.dumps(said))
    return path


def _header(samples: npt.NDArray[Any], affine: npt.NDArray[np.float64]) -> nib.Nifti1Header:
    header = nib.Nifti1Header(endianness=">" if samples.dtype.byteorder == ">" else "<")
    header.set_data_dtype(samples.dtype)
    header.set_xyzt_units("mm")
    header.set_data_shape(samples.shape)
    header.set_zooms([*nib.affines.voxel_sizes(affine), 1.0][: samples.ndim])
    header.set_sform(affine, 1)
    return header


def patched(path: Path, at: int, value: bytes) -> Path:
    """Overwrite some bytes of a file that is not packed."""
    content = bytearray(path.read_bytes())
    content[at : at + len(value)] = value
    path.write_bytes(bytes(content))
    return path
