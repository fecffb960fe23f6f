"""What a file is that cannot be read as what its name says: a pointer instead of data, a web page, another format.

Asked only once reading has failed, or where a suffix is not known: what can be read is never turned away by a guess.
To read one of these formats, give it a row in formats.py; by its row here it is then known under any name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from isocore.readers.pointers import first_bytes, pointer

_TO_NIFTI = "convert it to NIfTI"
_TO_VTU = "write it as an unstructured grid (.vtu)"


@dataclass(frozen=True, slots=True)
class Stranger:
    """A kind of file. suffixes: in lower case, where a name alone tells it; test: of a file's first bytes."""

    what: str
    advice: str
    suffixes: tuple[str, ...] = ()
    test: Callable[[bytes], object] = lambda head: False

    @property
    def sentence(self) -> str:
        """What it is and what to do."""
        return f"is {self.what}; {self.advice}"


def _starts(*magics: bytes) -> Callable[[bytes], object]:
    return lambda head: head.startswith(magics)


def _matches(pattern: bytes) -> Callable[[bytes], object]:
    return lambda head: re.match(rb"\s*" + pattern, head.removeprefix(b"\xef\xbb\xbf"), re.IGNORECASE | re.DOTALL)


def _vtk(kind: bytes) -> Callable[[bytes], object]:
    return _matches(rb"(<\?xml[^>]*>\s*)?(<!--.*?-->\s*)*<VTKFile[^>]*\btype\s*=\s*.%b\b" % kind)


_SURFACE = "a surface has no isovalue, so give the volume or the mesh that it was made from"

STRANGERS = (
    Stranger(
        "a web page (HTML) under the name of a download", "open it to see why, and download the file again",
        (".html", ".htm"), _matches(rb"(<\?xml[^>]*>\s*)?(<!--.*?-->\s*)*<(!doctype\s+html|html|head|body)\b"),
    ),
    Stranger(
        "the error message of a server under the name of a download", "download the file again", (),
        _matches(rb"(<\?xml[^>]*>\s*<Error>|\{\s*\"(error|errors|message|detail)\"\s*:|(HTTP/\S+ )?[45]\d\d:? \w+)"),
    ),
    Stranger(
        "a DICOM file, one slice as a rule", "convert the series to NIfTI, with dcm2niix for example",
        (".dcm", ".dicom", ".ima"), lambda head: head[128:132] == b"DICM",
    ),
    Stranger(
        "a list of DICOM files (DICOMDIR)", "convert the series to NIfTI, with dcm2niix for example", ("dicomdir",),
    ),
    Stranger("a NIfTI file", "", (".nii",), lambda head: head[344:347] == b"n+1" or head[4:7] == b"n+2"),
    Stranger("a NRRD file", "", (".nrrd",), _matches(rb"NRRD000\d")),
    Stranger("a MetaImage", "", (".mha", ".mhd"), _matches(rb"(ObjectType|NDims|Comment)\s*=")),
    Stranger("a VTK image (ImageData)", "", (".vti",), _vtk(rb"ImageData")),
    Stranger("a list of the pieces of a VTK image", "", (".pvti",), _vtk(rb"PImageData")),
    Stranger("a list of the pieces of a VTK mesh", "", (".pvtu",),
             _vtk(b"PUnstructuredGrid")),
    Stranger("a list of the steps of a VTK series", "", (".pvd",),
             _vtk(b"Collection")),
    Stranger("an unstructured grid of VTK", "", (".vtu",), _vtk(b"UnstructuredGrid")),
    Stranger("a structured grid of VTK", _TO_VTU, (".vts", ".pvts"), _vtk(b"P?StructuredGrid")),
    Stranger("a rectilinear grid of VTK", _TO_VTU, (".vtr", ".pvtr"), _vtk(b"P?RectilinearGrid")),
    Stranger("a multi-block data set of VTK", "give the .vtu files that it names", (".vtm", ".vtmb", ".vtpc"),
             _vtk(rb"vtk(MultiBlock|PartitionedDataSet)\w*")),
    Stranger("a VTK HDF file", _TO_VTU, (".vtkhdf",)),
    Stranger("a legacy VTK file", "", (".vtk",), _starts(b"# vtk DataFile")),
    Stranger(
        "an HDF5 file, MINC 2 or NetCDF 4 for example", "convert it to NIfTI, with mnc2nii for example",
        (".h5", ".hdf5", ".hdf"), _starts(b"\x89HDF\r\n\x1a\n"),
    ),
    Stranger("a MINC volume", "convert it to NIfTI, with mnc2nii for example", (".mnc", ".mnc.gz"), lambda head: False),
    Stranger(
        "a NetCDF file, MINC 1 or Exodus for example", "convert it to NIfTI, or to .vtu if it is a mesh",
        (".nc", ".cdf", ".e", ".exo", ".ex2"), _starts(b"CDF\x01", b"CDF\x02", b"CDF\x05"),
    ),
    Stranger(
        "a FreeSurfer volume", "", (".mgz", ".mgh"),
        lambda head: head[:4] == b"\0\0\0\1" and head[20:24] in (bytes((0, 0, 0, n)) for n in (0, 1, 3, 4, 10)),
    ),
    Stranger("an AFNI volume", "convert it to NIfTI, with 3dAFNItoNIFTI for example", (".brik", ".brik.gz", ".head")),
    Stranger("an Amira file", "export it as NRRD, or as .vtu if it is a mesh", (".am",),
             _matches(rb"# (AmiraMesh|Avizo|HyperMesh|HyperSurface)")),
    Stranger("an INR image", _TO_NIFTI, (".inr", ".inr.gz"), _starts(b"#INRIMAGE")),
    Stranger("a map of electron density", "convert it to NRRD", (".mrc", ".ccp4", ".map"),
             lambda head: head[208:212] == b"MAP "),
    Stranger("a GIFTI surface", _SURFACE, (".gii", ".gii.gz"), _matches(rb"(<\?xml[^>]*>\s*)?(<!.*?>\s*)*<GIFTI\b")),
    Stranger("a PLY surface", _SURFACE, (".ply",), _starts(b"ply\n", b"ply\r")),
    Stranger("an STL surface", _SURFACE, (".stl",), _matches(rb"solid\b.*?\bfacet\s+normal\b")),
    Stranger("a VTK surface (PolyData)", _SURFACE, (".vtp", ".pvtp"), _vtk(b"P?PolyData")),
    Stranger("a surface", _SURFACE, (".obj", ".off", ".glb", ".gltf", ".3mf", ".3ds", ".fbx", ".dae", ".wrl", ".x3d")),
    Stranger("a Gmsh mesh", "write it as .vtu, with meshio for example", (".msh",), _starts(b"$MeshFormat")),
    Stranger("a mesh of another program", "write it as .vtu, with meshio for example",
             (".inp", ".cgns", ".xdmf", ".xmf", ".med", ".bdf", ".fem", ".node", ".ele", ".mesh", ".case", ".foam")),
    Stranger("a numpy array", "write its samples with tofile() as .raw, and give --shape and --dtype", (".npy",),
             _starts(b"\x93NUMPY")),
    Stranger("a Matlab file", "write its array as NRRD or NIfTI", (".mat",), _starts(b"MATLAB 5.0")),
    Stranger("an OME-Zarr image", "write one of its levels as NIfTI or NRRD", (".zarr",)),
    Stranger("a picture, TIFF", "convert the stack to NRRD, with Fiji for example",
             (".tif", ".tiff", ".ome.tif", ".lsm"), _starts(b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")),
    Stranger("a picture, one slice at most", "convert the stack of slices to NRRD, with Fiji for example",
             (".png", ".jpg", ".jpeg", ".bmp", ".gif", ".jp2"),
             _starts(b"\x89PNG\r\n", b"\xff\xd8\xff", b"GIF8", b"\0\0\0\x0cjP")),
    Stranger("a microscope's file", "export it as NRRD, with Fiji for example",
             (".czi", ".nd2", ".lif", ".oib", ".ims")),
    Stranger("a note of DVC that a file is elsewhere", "run dvc pull, and give the file that it names", (".dvc",)),
    Stranger("what macOS keeps beside a file", "give the file without ._ before its name", (),
             _starts(b"\0\x05\x16\x07")),
    Stranger("zeros from its first byte on, as a copy that was broken off leaves them", "copy it again", (),
             lambda head: len(head) >= 348 and not any(head)),
    Stranger("a PDF document", "give the data instead", (".pdf",), _starts(b"%PDF-")),
    Stranger("an archive (zip)", "unpack it and give the files inside", (".zip",),
             _starts(b"PK\x03\x04", b"PK\x05\x06")),
    Stranger("an archive (tar)", "unpack it and give the files inside",
             (".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tar.xz"), lambda head: head[257:262] == b"ustar"),
    Stranger("an archive (7z or rar)", "unpack it and give the files inside", (".7z", ".rar"),
             _starts(b"7z\xbc\xaf\x27\x1c", b"Rar!\x1a\x07")),
    Stranger("packed with xz", "unpack it with unxz first", (".xz",), _starts(b"\xfd7zXZ\0")),
    Stranger("packed with zstd", "unpack it with unzstd first", (".zst",), _starts(b"\x28\xb5\x2f\xfd")),
    Stranger("packed with lz4", "unpack it with unlz4 first", (".lz4",), _starts(b"\x04\x22\x4d\x18")),
)  # fmt: skip
#: Of files without a header anything may be the first bytes: of those only words count.
_WORDS = STRANGERS[:2]


Row = TypeVar("Row")


def readable_as(path: Path, rows: Mapping[str, Row], row: Row | None = None) -> tuple[Row, str] | None:
    """By its content, the format that the file `path` can be read as, and what that is called; None where no other.

    rows: the format of each suffix that is read; row: the one that `path` was read as, if any.
    """
    head = first_bytes(path)
    for stranger in STRANGERS:
        own = next((rows[suffix] for suffix in stranger.suffixes if suffix in rows), None)
        if stranger.test(head):
            return None if own is None or own is row else (own, stranger.what)
    return None


def what_it_is(path: Path, rows: Mapping[str, object], row: object, *, bare: bool = False) -> str | None:
    """What the file `path` is and what to do about it; None where nothing is known, or where it can be read.

    rows: the format of each suffix that is read; row: the one that `path` was read as, if any. bare: it has no header.
    """
    head = first_bytes(path)
    if found := pointer(path):
        return found
    for stranger in _WORDS if bare else STRANGERS:
        if stranger.test(head) and not any(suffix in rows for suffix in stranger.suffixes):
            return stranger.sentence
    return None if row is not None else _by_name(path, rows)


def _by_name(path: Path, rows: Mapping[str, object]) -> str | None:
    name = path.name.lower()
    unread = ((suffix, one) for one in STRANGERS for suffix in one.suffixes if suffix not in rows)
    named = [(suffix, one) for suffix, one in unread if name.endswith(suffix)]
    return max(named, key=lambda one: len(one[0]))[1].sentence if named else None
