"""Small volumes in every format that is read, written by other people's libraries where there are some."""

from __future__ import annotations

import gzip
import json
import zlib
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
    elif name.endswith((".mha", ".mhd")):
        _save_metaimage(path, samples, affine)
    elif name.endswith((".mgz", ".mgh")):
        nib.MGHImage(samples[..., 0] if samples.shape[3:] == (1,) else samples, affine).to_filename(path)
    else:
        content = samples.tobytes(order="F")
        path.write_bytes(gzip.compress(content) if name.endswith(".gz") else content)
        said = {"shape": samples.shape, "dtype": samples.dtype.str}
        path.with_name(path.name.removesuffix(".gz") + ".json").write_text(json.dumps(said))
    return path


#: MetaImage's names of types.
METAIMAGE = {
    "i1": "CHAR", "u1": "UCHAR", "i2": "SHORT", "u2": "USHORT", "i4": "INT", "u4": "UINT", "i8": "LONG_LONG",
    "u8": "ULONG_LONG", "f4": "FLOAT", "f8": "DOUBLE",
}  # fmt: skip


def _save_metaimage(path: Path, samples: npt.NDArray[Any], affine: npt.NDArray[np.float64]) -> None:
    """As ITK writes it: a .mha packed with zlib, a .mhd with plain samples beside; a row of the matrix is an axis."""
    world = np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine
    spacing = np.linalg.norm(world[:3, :3], axis=0)
    axes, local = samples.ndim, path.name.lower().endswith(".mha")
    directions, places = np.eye(axes), np.zeros(axes)
    directions[:3, :3], places[:3] = (world[:3, :3] / spacing).T, world[:3, 3]
    numbers = {
        "TransformMatrix": directions.ravel(),
        "Offset": places,
        "ElementSpacing": [*spacing, *[1.0] * (axes - 3)],
        "DimSize": samples.shape,
    }
    fields = {
        "ObjectType": "Image",
        "NDims": axes,
        "BinaryData": True,
        "BinaryDataByteOrderMSB": samples.dtype.byteorder == ">",
        "CompressedData": local,
        **{name: " ".join(map(str, np.asarray(values).tolist())) for name, values in numbers.items()},
        "ElementType": f"MET_{METAIMAGE[samples.dtype.str[1:]]}",
        "ElementDataFile": "LOCAL" if local else f"{path.name}.samples",
    }
    content = samples.tobytes(order="F")
    text = "".join(f"{name} = {value}\n" for name, value in fields.items()).encode()
    path.write_bytes(text + zlib.compress(content) if local else text)
    if not local:
        path.with_name(f"{path.name}.samples").write_bytes(content)


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
