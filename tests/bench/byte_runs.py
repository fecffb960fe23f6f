"""What same_bytes.py runs: which inputs there are, and which options each of them is converted with."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

Arguments = tuple[str, ...]

#: Inputs made to exhaust memory or time. Converting them a few dozen times tells nothing about bytes.
TOO_COSTLY = ("small-files-much-work",)
#: Headerless files whose shape is known from their description.
RAW: dict[str, str] = {
    "volumes/dem/sthelens_heights_i16_327x467.raw": "--shape 327,467,1 --dtype int16",
    "volumes/mhd/HeadMRVolume.raw": "--shape 48,62,42 --dtype uint8",
    "volumes/nrrd.jl/io/small.raw": "--shape 10,10,10 --dtype float32",
    "volumes/pynrrd/BallBinary30x30x30.raw": "--shape 30,30,30 --dtype int16 --spacing 1,2,3 --origin 4,5,6",
    "volumes/seg3d/tooth.raw": "--shape 103,94,161 --dtype uint16 --byte-order big",
    "volumes/microct/trabecular_bone.raw.gz": "--shape 200,200,200 --dtype uint8 --spacing 0.02,0.02,0.02",
}
#: Volumes that are converted with every option there is: of several types, spaces, spacings and orientations.
IN_DEPTH = ("samples/", "FLAIR", "tooth.nhdr", "nifti_space/LIA", "anatomical", "totalsegmentator_42", "ras.hdr")
TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64")
MANY_SAMPLES = 4_000_000
MOST_FIELDS = 4

ISOVALUES = "-i auto -i p60 -i p95"
#: Of every volume, however large.
OF_ALL_VOLUMES = (
    "--threads 1",
    "--threads 2",
    "-b asc --max-error none -i p90 --no-reference --threads 2",
    "-b mc -i p90 --threads 1",
    "-b mc -i p90 --topology trilinear --threads 2",
    "-b thinning -i p90 --no-reference --threads 2",
)
#: Of volumes up to MANY_SAMPLES.
OF_VOLUMES = (
    *(f"-b asc --max-error none {ISOVALUES} --no-reference --threads {threads}" for threads in (1, 2)),
    f"-b asc {ISOVALUES} --no-reference --threads 2",
    "-b asc --max-error 0.3mm -i p70 --no-reference --threads 2",
    *(f"-b mc {ISOVALUES} --threads {threads}" for threads in (1, 2)),
    *(f"-b mc --topology trilinear {ISOVALUES} --threads {threads}" for threads in (1, 2)),
    *(f"-b thinning {ISOVALUES} --no-reference --threads {threads}" for threads in (1, 2)),
)
#: Of the volumes IN_DEPTH.
OF_VOLUMES_IN_DEPTH = (
    *(f"-b asc --block-size {size} --max-error {error} -i auto -i p80 --no-reference --threads 2"
      for size in (1, 2, 4, 8, 32) for error in ("none", "0.1")),
    *(f"-b {backend} -i p80 --cap --normals -f {format_} --threads {threads}"
      for backend in ("asc", "mc", "mc --topology trilinear", "thinning")
      for format_, threads in (("ply", 1), ("stl", 2), ("obj", 2))),
    *(f"-b asc -i p80 --space {space} --normals -f obj --no-reference" for space in ("ras", "lps", "las", "index")),
    *(f"-b mc -i p{percent} --ambiguities out/ambiguities.ply --threads {threads}"
      for percent in (50, 80) for threads in (1, 2)),
    "-b mc -i p80 --require watertight,manifold,nonempty --max-triangles 100",
    "-i p80 -i 1:3:2 --dry-run",
    "-i p80 --depfile out/rules.d --no-reference",
    "-b asc --topology trilinear",
)
OF_MESHES = (
    *(f"-b {backend} -i auto -i p30 -i p80 --threads {threads}"
      for backend in ("thinning", "mc") for threads in (1, 2)),
    *(f"-b {backend} -i p55 --normals -f {format_} --threads 2"
      for backend in ("thinning", "mc") for format_ in ("stl", "obj")),
    "-b thinning -i p10:p20:3",
    "-b thinning -i 0:1:12 --no-reference",
    "-b thinning -i p55 --cap",
    "-b asc -i p55",
)
#: The portable kernels: of every input, but less of each.
OF_VOLUMES_PORTABLE = (
    "--threads 1",
    "-b asc --max-error none -i p90 --no-reference --threads 2",
    "-b mc -i p90 --topology trilinear --threads 2",
    "-b thinning -i p90 --no-reference --threads 2",
)
OF_MESHES_PORTABLE = ("-b thinning -i auto -i p80 --threads 2", "-b mc -i auto -i p80 --threads 1")
#: Of a file with many small volumes: all of them in one command.
OF_GRIDS = tuple(
    f"{options} --volume all -i {isovalue} --no-reference --threads 1"
    for options, isovalue in (
        ("-b mc", "2"),
        ("-b mc --topology trilinear", "0.5"),
        ("-b asc --max-error none --block-size 4", "1.25"),
        ("-b asc --cap", "2"),
        ("-b thinning", "0.5"),
    )
)


def files(root: Path, *, only: str) -> Iterator[Path]:
    """Every file below the links `samples` and `data` in `root`, relative to it, in the order of their names."""
    for link in ("samples", "data"):
        found = (path for path in (root / link).resolve().rglob("*") if path.is_file())
        for path in sorted(Path(link, path.relative_to((root / link).resolve())) for path in found):
            if only in str(path) and not any(part in str(path) for part in TOO_COSTLY):
                yield path


def description(path: Path) -> Arguments:
    """What a headerless file needs to be read."""
    return tuple(RAW.get(str(path).removeprefix("data/"), "").split())


def further(message: str, given: Arguments) -> list[Arguments]:
    """What a refusal proposes: the volumes, fields or components that the file holds."""
    if found := re.search(r"holds (\d+) volumes", message):
        return [(*given, "--volume", "0"), (*given, "--volume", str(int(found[1]) - 1))]
    if found := re.search(r"holds \d+ (?:point|cell) fields \((.*)\); choose", message):
        return [(*given, "--field", name) for name in found[1].split(", ")[:MOST_FIELDS]]
    if "components; choose" in message:
        return [(*given, "--component", which) for which in ("0", "magnitude")]
    return []


def options_for(path: Path, kind: str, samples: int, *, portable: bool) -> Iterator[Arguments]:
    """The conversions of a file that was read. kind: "volume" or "mesh"; samples: of a volume."""
    chosen: tuple[str, ...]
    if kind == "mesh":
        chosen = OF_MESHES_PORTABLE if portable else OF_MESHES
    elif portable:
        chosen = OF_VOLUMES_PORTABLE
    else:
        chosen = OF_ALL_VOLUMES + (OF_VOLUMES if samples <= MANY_SAMPLES else ())
        chosen += OF_VOLUMES_IN_DEPTH if any(part in str(path) for part in IN_DEPTH) else ()
    yield from (tuple(options.split()) for options in chosen)


def make_grids(folder: Path, published: Path) -> Iterator[Path]:
    """Files of many small volumes: random samples of every type, in both byte orders, and every fifth published grid.

    Random samples are few different numbers, so that isovalues are met exactly and many faces are ambiguous.
    """
    folder.mkdir()
    for seed, name in enumerate(TYPES):
        values = np.random.default_rng(seed).integers(0, 4, (7, 6, 9, 24))
        for order, sign in (("little", "<"), ("big", ">")):
            yield _write_nrrd(folder / f"{name}_{order}.nrrd", values.astype(np.dtype(name).newbyteorder(sign)), order)
    if published.is_file():
        archive = np.load(published)
        grids = next(archive[name] for name in archive.files if archive[name].ndim == 4)
        spread = (3 * np.moveaxis(grids[::5], 0, -1) + 1).astype("<f8")  # from -1..1 to where OF_GRIDS has isovalues
        yield _write_nrrd(folder / "published.nrrd", spread, "little")


def _write_nrrd(path: Path, samples: npt.NDArray[np.generic], order: str) -> Path:
    """samples: (nx, ny, nz, n), in the byte order of that name."""
    kind = {"float32": "float", "float64": "double"}.get(samples.dtype.name, samples.dtype.name)
    sizes = " ".join(map(str, samples.shape))
    head = f"NRRD0004\ntype: {kind}\ndimension: 4\nsizes: {sizes}\nkinds: domain domain domain list\n"
    path.write_bytes(f"{head}endian: {order}\nencoding: raw\n\n".encode() + samples.tobytes(order="F"))
    return path
