"""Sound inputs to begin with: a small one of every reader in each of its encodings, an index, a stamp, a report.

They are written by the tests' own writers and by other people's libraries; nothing of what is tested writes an input.
"""

from __future__ import annotations

import bz2
import gzip
import json
import struct
import tempfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import curved_cells
import legacy_files
import numpy as np
import vtu_files
from fuzz.mutations import (
    Mutator,
    damaged_base64,
    damaged_bytes,
    damaged_json,
    damaged_numbers,
    damaged_text,
    damaged_xml,
    of_fields,
    some,
    within,
)
from scans import ramp, save

Files = dict[str, bytes]


@dataclass(frozen=True)
class Seed:
    """A sound input. files: by name, the one to read first. mutators: of each file that is to be damaged."""

    files: Files
    mutators: dict[str, Mutator]


def _span(kind: str, at: int, count: int = 1) -> list[tuple[int, str]]:
    return [(at + n * struct.calcsize(f"={kind}"), kind) for n in range(count)]


#: Offset and kind of the numbers in a header that decide something.
NIFTI_1 = [
    *_span("i", 0), *_span("h", 40, 8), *_span("h", 70, 2), *_span("f", 76, 8), *_span("f", 108, 3), *_span("b", 123),
    *_span("f", 124, 2), *_span("i", 140, 2), *_span("h", 252, 2), *_span("f", 256, 18), *_span("i", 344),
    *_span("i", 348),
]  # fmt: skip
NIFTI_2 = [
    *_span("i", 0), *_span("q", 4), *_span("h", 12, 2), *_span("q", 16, 8), *_span("d", 104, 8), *_span("q", 168),
    *_span("d", 176, 4), *_span("i", 344, 2), *_span("d", 352, 18), *_span("i", 500),
]  # fmt: skip


def _written(name: str, samples: np.ndarray) -> Files:
    """The files that a library writes under this name, the named one first."""
    with tempfile.TemporaryDirectory() as folder:
        path = save(Path(folder) / name, samples)
        ordered = sorted(Path(folder).iterdir(), key=lambda file: file != path)
        return {file.name: file.read_bytes() for file in ordered}


def _nifti_2(samples: np.ndarray) -> bytes:
    import nibabel as nib

    return bytes(nib.Nifti2Image(samples, np.diag([1.0, 2.0, 3.0, 1.0])).to_bytes())


def nifti() -> Iterator[Seed]:
    """One file: both versions, both byte orders, several types, packed or not, of one volume and of several."""
    for dtype, shape in (("<i2", (4, 5, 6)), (">f4", (3, 4, 5)), ("u1", (3, 3, 3, 2)), ("<f8", (2, 3, 4))):
        files = _written("a.nii", ramp(shape, dtype))
        header = some(of_fields(NIFTI_1, dtype[0] if dtype[0] == ">" else "<"), damaged_bytes)
        yield Seed(files, {"a.nii": header})
        packed = gzip.compress(files["a.nii"], 1, mtime=0)
        yield Seed({"a.nii.gz": packed}, {"a.nii.gz": some(within("gzip", header))})
    header = some(of_fields(NIFTI_2, "<"), damaged_bytes)
    yield Seed({"b.nii": _nifti_2(ramp((4, 5, 6), "f4"))}, {"b.nii": header})


def analyze() -> Iterator[Seed]:
    """Header and image apart: NIfTI pairs, and Analyze, which has no magic."""
    header = some(of_fields(NIFTI_1, "<"), damaged_bytes)
    for magic in (b"ni1\0", bytes(4)):
        files = _written("c.hdr", ramp((4, 5, 6)))
        files["c.hdr"] = files["c.hdr"][:344] + magic + files["c.hdr"][348:]
        yield Seed(files, {"c.hdr": header, "c.img": damaged_bytes})
        packed = {f"{name}.gz": gzip.compress(data, 1, mtime=0) for name, data in files.items()}
        yield Seed(packed, {"c.hdr.gz": within("gzip", header), "c.img.gz": within("gzip", damaged_bytes)})


_NRRD = (
    "NRRD0005\n# a comment\ntype: {type}\ndimension: 3\nspace: right-anterior-superior\nsizes: 4 5 6\n"
    "space directions: (1,0,0) (0,2,0) (0,0,3)\nkinds: domain domain domain\nendian: little\nencoding: {encoding}\n"
    'space origin: (1,2,3)\nspace units: "mm" "mm" "mm"\nkey:=value\n{more}'
)
_PLAIN_NRRD = (
    "NRRD0001\ntype: {type}\ndimension: 4\nsizes: 2 4 5 6\nspacings: nan 1 2 3\naxis mins: nan 0 0 0\nendian: big\n"
    "centers: none cell cell cell\nbyte skip: 0\nline skip: 0\nencoding: {encoding}\n{more}"
)


def _encoded(samples: np.ndarray, encoding: str) -> bytes:
    plain = samples.tobytes(order="F")
    numbers = " ".join(str(number) for number in samples.ravel(order="F").tolist())
    return {
        "raw": plain,
        "gzip": gzip.compress(plain, 1, mtime=0),
        "bzip2": bz2.compress(plain, 1),
        "ascii": numbers.encode(),
        "hex": plain.hex().encode(),
    }[encoding]


def nrrd() -> Iterator[Seed]:
    """Samples behind the header, in each encoding."""
    for encoding in ("raw", "gzip", "bzip2", "ascii", "hex"):
        for head, shape, dtype in ((_NRRD, (4, 5, 6), "<i2"), (_PLAIN_NRRD, (2, 4, 5, 6), ">f4")):
            text = head.format(type="short" if "i" in dtype else "float", encoding=encoding, more="\n").encode()
            content = text + _encoded(ramp(shape, dtype), encoding)
            yield Seed({"d.nrrd": content}, {"d.nrrd": some(_of_head(text), damaged_bytes)})


def _of_head(head: bytes) -> Mutator:
    """Damage to the text before the samples."""

    def mutate(random: object, content: bytes) -> bytes:
        return damaged_text(random, content[: len(head)]) + content[len(head) :]  # type: ignore[arg-type]

    return mutate


def nhdr() -> Iterator[Seed]:
    """Samples in one file beside the header, in a list of them, in numbered ones."""
    samples = ramp((4, 5, 6))
    slices = [samples[:, :, k].tobytes(order="F") for k in range(6)]
    for encoding in ("raw", "gzip"):
        packed = (lambda data: gzip.compress(data, 1, mtime=0)) if encoding == "gzip" else bytes
        for more, names in (
            ("data file: e.raw\n", ["e.raw"]),
            ("data file: LIST\n" + "".join(f"s{k}.raw\n" for k in range(6)), [f"s{k}.raw" for k in range(6)]),
            ("data file: s%d.raw 0 5 1\n", [f"s{k}.raw" for k in range(6)]),
        ):
            contents = slices if len(names) == 6 else [b"".join(slices)]
            files = {"e.nhdr": _NRRD.format(type="short", encoding=encoding, more=more).encode()}
            files |= {name: packed(content) for name, content in zip(names, contents, strict=True)}
            data = within("gzip", damaged_bytes) if encoding == "gzip" else damaged_bytes
            yield Seed(files, {"e.nhdr": some(damaged_text, damaged_text, damaged_bytes), names[-1]: data})


_METAIMAGE = (
    "ObjectType = Image\nNDims = 3\nBinaryData = {binary}\nBinaryDataByteOrderMSB = False\nCompressedData = {packed}\n"
    "TransformMatrix = 0 1 0 1 0 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 1 2 3\nHeaderSize = 0\nDimSize = 4 5 6\n"
    "ElementNumberOfChannels = 1\nElementType = MET_SHORT\nElementDataFile = {place}\n"
)


def metaimage() -> Iterator[Seed]:
    """Samples behind the header, plain, packed and as text; beside it in one file, in a list, in numbered ones."""
    samples = ramp((4, 5, 6))
    plain, slices = samples.tobytes(order="F"), [samples[:, :, k].tobytes(order="F") for k in range(6)]
    for binary, pack in ((True, bytes), (True, zlib.compress), (True, gzip.compress), (False, bytes)):
        text = _METAIMAGE.format(binary=binary, packed=pack is not bytes, place="LOCAL").encode()
        content = pack(plain) if binary else _encoded(samples, "ascii")
        yield Seed({"h.mha": text + content}, {"h.mha": some(_of_head(text), damaged_bytes)})
    listed = [f"s{k}.raw" for k in range(6)]
    for place, names in (("h.raw", ["h.raw"]), ("LIST\n" + "\n".join(listed), listed), ("s%d.raw 0 5 1", listed)):
        files = {"h.mhd": _METAIMAGE.format(binary=True, packed=False, place=place).encode()}
        files |= dict(zip(names, slices if len(names) == 6 else [plain], strict=True))
        yield Seed(files, {"h.mhd": some(damaged_text, damaged_text, damaged_bytes), names[-1]: damaged_bytes})


#: Offset and kind of the numbers in a header of FreeSurfer's.
MGH = [*_span("i", 0, 7), *_span("h", 28), *_span("f", 30, 15)]


def mgh() -> Iterator[Seed]:
    """One frame and several, packed and not."""
    for shape, dtype in (((4, 5, 6), "i2"), ((3, 4, 5), "f4"), ((3, 3, 3, 2), "u1"), ((2, 3, 4), "i4")):
        files = _written("i.mgh", ramp(shape, dtype))
        header = some(of_fields(MGH, ">"), damaged_bytes)
        yield Seed(files, {"i.mgh": header})
        yield Seed({"i.mgz": gzip.compress(files["i.mgh"], 1, mtime=0)}, {"i.mgz": within("gzip", header)})


def raw() -> Iterator[Seed]:
    """Bare samples under a sidecar, packed or not."""
    side = {"shape": [4, 5, 6], "dtype": "int16", "spacing": [1, 2, 3.5], "origin": [0, 0, 9], "byte_order": "little"}
    content = ramp((4, 5, 6)).tobytes(order="F")
    for offset in (0, 7):
        sidecar = json.dumps(side | {"offset": offset}).encode()
        plain = bytes(offset) + content
        yield Seed({"f.raw": plain, "f.raw.json": sidecar}, {"f.raw": damaged_bytes, "f.raw.json": some(damaged_json)})
        packed = gzip.compress(plain, 1, mtime=0)
        yield Seed(
            {"f.raw.gz": packed, "f.raw.json": sidecar},
            {"f.raw.gz": within("gzip", damaged_bytes), "f.raw.json": some(damaged_json)},
        )


def packed() -> Iterator[Seed]:
    """Members, checksums, tails and cuts of gzip and bzip2, around sound headers."""
    content = _written("g.nii", np.random.default_rng(1).integers(0, 9, (9, 9, 9)).astype("<i2"))["g.nii"]
    yield Seed({"g.nii.gz": gzip.compress(content, 6, mtime=0)}, {"g.nii.gz": some(within("gzip", bytes_alone))})
    yield Seed({"g.nii": bz2.compress(content)}, {"g.nii": some(within("bzip2", bytes_alone))})
    members = b"".join(gzip.compress(content[at : at + 500], 1, mtime=0) for at in range(0, len(content), 500))
    yield Seed({"g.nii.gz": members}, {"g.nii.gz": some(damaged_bytes)})


def bytes_alone(random: object, content: bytes) -> bytes:
    """Left as it is: the damage is to the packing."""
    return content


def _meshes() -> list[vtu_files.Mesh]:
    """Tetrahedra, and one of each other shape, each with a field of points, a vector and a field of cells."""
    found = []
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    for cells in (
        [(10, [0, 1, 2, 4]), (10, [1, 2, 4, 7]), (10, [1, 2, 3, 7])],
        [(12, [0, 1, 3, 2, 4, 5, 7, 6])],
        [(13, [0, 1, 2, 4, 5, 6]), (14, [1, 3, 7, 5, 2]), (11, [0, 1, 2, 3, 4, 5, 6, 7]), (5, [0, 1, 2])],
    ):
        found.append(
            vtu_files.Mesh(
                corners,
                cells,
                {"p": np.arange(8.0), "v": np.arange(24.0, dtype="f4").reshape(8, 3)},
                {"c": np.arange(len(cells), dtype="i4")},
            )
        )
    return found


def _vtu(meshes: vtu_files.Mesh | list[vtu_files.Mesh], encoding: vtu_files.Encoding) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return vtu_files.write(Path(folder) / "h.vtu", meshes, encoding).read_bytes()


def vtu() -> Iterator[Seed]:
    """Every encoding, one piece and two."""
    meshes = _meshes()
    for number, encoding in enumerate(vtu_files.every_encoding()):
        content = _vtu(meshes if number % 4 == 0 else meshes[number % 3], encoding)
        mutators = [damaged_xml, damaged_numbers, damaged_numbers, damaged_text]
        mutators.append(damaged_base64 if encoding.format == "binary" else damaged_bytes)
        yield Seed({"h.vtu": content}, {"h.vtu": some(*mutators)})
    wide = _vtu(meshes[0], vtu_files.Encoding()).decode()
    for unusual in (wide.encode("utf-16"), wide.replace("<Points>", "<Points><!-- 1 -->").encode()):
        yield Seed({"h.vtu": unusual}, {"h.vtu": some(damaged_xml, damaged_bytes)})


def cells() -> Iterator[Seed]:
    """What the files of simulations hold besides: polyhedra in both listings, curved cells, prisms, ghosts."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    points = np.concatenate([corners, np.add(corners, (1, 0, 0))])
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [1, 5, 7, 3], [3, 7, 6, 2], [2, 6, 4, 0]]
    faces = [sides, [[n + 8 for n in side] for side in sides]]
    solid = [(42, list(range(8))), (42, list(range(8, 16)))]
    every = [side for some_sides in faces for side in some_sides]
    stream = [[6, *(n for side in some_sides for n in (4, *side))] for some_sides in faces]
    lists = (
        {"faces": np.concatenate(stream), "faceoffsets": np.cumsum([len(one) for one in stream])},
        {
            "face_connectivity": np.concatenate(every),
            "face_offsets": np.arange(4, 49, 4),
            "polyhedron_to_faces": np.arange(12),
            "polyhedron_offsets": np.array([6, 12]),
        },
    )
    fields = {"u": points.sum(axis=1), "vtkGhostType": np.zeros(16, "u1")}
    meshes = [vtu_files.Mesh(points, solid, fields, {"vtkGhostType": np.zeros(2, "u1")}, more) for more in lists]
    meshes.append(vtu_files.Mesh(corners, [(41, list(range(8)))], {"u": np.arange(8.0)}))
    for kind in ("tet10", "hex27", "wedge15", "pyramid13", "hex72-124", "tet71-3"):
        mesh, _ = curved_cells.box(kind, 1)
        meshes.append(mesh.with_field("u", mesh.points.sum(axis=1)))
    encodings = (vtu_files.Encoding(), vtu_files.Encoding("appended", "raw"), *vtu_files.every_encoding()[5:9])
    for mesh in meshes:
        for encoding in encodings:
            mutators = [damaged_xml, damaged_numbers, damaged_numbers, damaged_text]
            mutators.append(damaged_base64 if encoding.format == "binary" else damaged_bytes)
            yield Seed({"j.vtu": _vtu(mesh, encoding)}, {"j.vtu": some(*mutators)})


def _array(name: str, values: np.ndarray, encoding: vtu_files.Encoding) -> str:
    kind = f"{ {'f': 'Float', 'i': 'Int', 'u': 'UInt'}[values.dtype.kind] }{8 * values.dtype.itemsize}"
    text = " ".join(map(str, values.ravel().tolist()))
    if encoding.format == "binary":
        text = encoding.block(values, base64_text=True).decode()
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    return f'<DataArray type="{kind}" Name="{name}"{components} format="{encoding.format}">{text}</DataArray>'


def _vti(extent: str, encoding: vtu_files.Encoding, *, of_cells: bool) -> bytes:
    """An image of 4 x 3 x 3 points from this extent's begin on, which a piece of another image may be."""
    section, size = ("CellData", 12) if of_cells else ("PointData", 36)
    values = _array("p", np.arange(float(size)), encoding)
    values += _array("v", np.arange(2.0 * size).reshape(size, 2), encoding)
    compressor = f' compressor="{vtu_files.COMPRESSORS[encoding.compressor][0]}"' if encoding.compressor else ""
    return (
        f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" byte_order="{encoding.byte_order}"'
        f' header_type="{encoding.header}"{compressor}>\n<ImageData WholeExtent="{extent}" Origin="1 2 3"'
        f' Spacing="1 0.5 2" Direction="0 -1 0 1 0 0 0 0 1">\n<Piece Extent="{extent}"><{section}>{values}</{section}>'
        "</Piece></ImageData></VTKFile>"
    ).encode()


def images() -> Iterator[Seed]:
    """Images in VTK's XML, whole and in two pieces that share a layer of points."""
    ascii_, *others = vtu_files.every_encoding()
    damage = some(damaged_xml, damaged_numbers, damaged_numbers, damaged_text, damaged_base64)
    for encoding in (ascii_, *(one for one in others if one.format == "binary")):
        for of_cells in (False, True):
            yield Seed({"l.vti": _vti("0 3 0 2 0 2", encoding, of_cells=of_cells)}, {"l.vti": damage})
    extents = ("0 3 0 2 0 2", "0 3 0 2 2 4")
    listed = "".join(f'<Piece Extent="{extent}" Source="m{n}.vti"/>' for n, extent in enumerate(extents))
    header = (
        '<VTKFile type="PImageData" version="1.0" byte_order="LittleEndian">\n<PImageData WholeExtent="0 3 0 2 0 4"'
        ' GhostLevel="0" Origin="1 2 3" Spacing="1 0.5 2">\n<PPointData><PDataArray type="Float64" Name="p"/>'
        f"</PPointData>\n{listed}\n</PImageData></VTKFile>"
    )
    files = {f"m{n}.vti": _vti(extent, ascii_, of_cells=False) for n, extent in enumerate(extents)}
    yield Seed({"m.pvti": header.encode(), **files}, {"m.pvti": damage, "m1.vti": damage})


def pieces() -> Iterator[Seed]:
    """A mesh in pieces, each a file of its own under one that lists them."""
    damage = some(damaged_xml, damaged_xml, damaged_numbers, damaged_text)
    for mesh in _meshes():
        listed = "".join(f'<Piece Source="n{n}.vtu"/>\n' for n in range(2))
        header = (
            '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">\n'
            f'<PUnstructuredGrid GhostLevel="0">\n<PPoints/>\n{listed}</PUnstructuredGrid></VTKFile>'
        )
        part = _vtu(mesh, vtu_files.Encoding())
        yield Seed({"n.pvtu": header.encode(), "n0.vtu": part, "n1.vtu": part}, {"n.pvtu": damage, "n1.vtu": damage})


def legacy() -> Iterator[Seed]:
    """Legacy VTK files of both listings of cells, as text and in bytes, and structured points."""
    with tempfile.TemporaryDirectory() as folder:
        for mesh in _meshes():
            for version, mode in legacy_files.WAYS:
                content = legacy_files.write_grid(Path(folder) / "o.vtk", mesh, version, mode).read_bytes()
                damage = some(damaged_text, damaged_numbers, damaged_bytes)
                yield Seed({"o.vtk": content}, {"o.vtk": damage})
    for mode in ("ASCII", "BINARY"):
        for kind in ("STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID"):
            fields = {"p": np.arange(36.0), "v": np.arange(72.0).reshape(36, 2)}
            grid = legacy_files.structured(kind, mode, (4, 3, 3), fields, {"c": np.arange(12, dtype="i4")})
            yield Seed({"o.vtk": grid}, {"o.vtk": some(damaged_text, damaged_numbers, damaged_bytes)})


def series() -> Iterator[Seed]:
    """Steps of a series, listed in both ways, and parts of one step."""
    parts = {f"q{n}.vtu": _vtu(mesh, vtu_files.Encoding()) for n, mesh in enumerate(_meshes()[:2])}
    sets = "".join(f'<DataSet timestep="{n // 2}" part="{n % 2}" file="q{n % 2}.vtu"/>\n' for n in range(2))
    pvd = f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>{sets}</Collection></VTKFile>'
    damage = some(damaged_xml, damaged_numbers, damaged_text)
    yield Seed({"q.pvd": pvd.encode(), **parts}, {"q.pvd": damage, "q0.vtu": damage})
    listed = {"file-series-version": "1.0", "files": [{"name": "q0.vtu", "time": 0.5}]}
    files = {"q.vtu.series": json.dumps(listed).encode(), "q0.vtu": parts["q0.vtu"]}
    yield Seed(files, {"q.vtu.series": some(damaged_json), "q0.vtu": damage})


@cache
def seeds_of(reader: str) -> tuple[Seed, ...]:
    """All seeds of one reader."""
    return tuple(READERS[reader]())


READERS = {
    "nifti": nifti, "analyze": analyze, "nrrd": nrrd, "nhdr": nhdr, "metaimage": metaimage, "mgh": mgh,
    "raw": raw, "gzip": packed, "vtu": vtu, "cells": cells, "vti": images, "pvtu": pieces, "vtk": legacy,
    "pvd": series,
}  # fmt: skip
