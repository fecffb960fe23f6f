"""Golden counts: vertices, triangles, Euler number and boundary edges of every sample, by every backend.

They say *changed*; the invariants say *broken*. `make golden` rewrites counts.toml, and the commit says why.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import isocore
from isocore.backends import BACKENDS, Options, prepare
from isocore.measurements import measure

HERE = Path(__file__).parent
SAMPLES = HERE.parent.parent / "sample_volumes"
GOLDEN = HERE / "counts.toml"

#: Isovalues worth looking at in each sample; the last lies on no sample.
ISOVALUES: dict[str, tuple[float, ...]] = {
    "knot.nii.gz": (200, 127.5),
    "landscape.nrrd": (0, 30.5),
    "head.raw": (30, 150, 75.5),
    "vessels.nhdr": (140, 60.5),
    "torus.vtu": (0.5, -0.75),
    "void.vtu": (40, 71.25),
}

Counts = dict[str, dict[str, int]]


def count(sample: str) -> Counts:
    """The counts of one sample, by "backend isovalue"."""
    field = isocore.read(SAMPLES / sample)
    counts: Counts = {}
    for name, backend in BACKENDS.items():
        if not isinstance(field, backend.accepts):
            continue
        extract = prepare(field, name, Options())
        for isovalue in ISOVALUES[sample]:
            measured = measure(extract(isovalue).surface)
            counts[f"{name} {isovalue:g}"] = {
                "vertices": measured.vertices,
                "triangles": measured.triangles,
                "euler": measured.euler,
                "boundary_edges": measured.boundary_edges,
            }
    return counts


def load() -> dict[str, Counts]:
    """What counts.toml holds, by sample."""
    return tomllib.loads(GOLDEN.read_text())


def save() -> None:
    """Write counts.toml anew."""
    lines = ["# Written by `make golden`. A change here needs its reason in the commit."]
    for sample in ISOVALUES:
        lines += ["", f'["{sample}"]']
        for key, counts in count(sample).items():
            row = ", ".join(f"{name} = {value}" for name, value in counts.items())
            lines.append(f'"{key}" = {{ {row} }}')
    GOLDEN.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    save()
