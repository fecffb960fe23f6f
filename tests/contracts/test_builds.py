"""The portable build of the kernels and the one for wide vectors differ in speed only."""

from __future__ import annotations

import hashlib
import io
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapes_mesh
from shapes import integer_noise

import isocore
from isocore import _kernels, _kernels_base
from isocore.backends import BACKENDS, Options, prepare
from isocore.measurements import measure
from isocore.surface import Surface
from isocore.volume import Volume
from isocore.writers import FORMATS, write_to

SAMPLES = Path(__file__).parents[2] / "sample_volumes"
FILES = {"knot.nii.gz": 199.5, "landscape.nrrd": None, "torus.vtu": 0.4, "void.vtu": 0.4}


def surfaces() -> Iterator[tuple[str, Surface]]:
    """Every backend on samples of every kind, and meshes with everything wrong."""
    fields = {name: (isocore.read(SAMPLES / name), isovalue) for name, isovalue in FILES.items()}
    fields["noise"] = (integer_noise(20, 1), 4.0)
    for file, (field, isovalue) in fields.items():
        values = field.samples if isinstance(field, Volume) else field.values
        wanted = float(np.median(values)) if isovalue is None else isovalue
        for backend in BACKENDS:
            if type(field) in BACKENDS[backend].accepts:
                yield f"{backend} {file}", prepare(field, backend, Options())(wanted).surface
    rng = np.random.default_rng(5)
    for spread in (1, 5000):
        soup = spread * rng.integers(0, 12, (60, 3))
        yield f"soup {spread}", shapes_mesh.surface(rng.standard_normal((12 * spread, 3)), soup)
    damaged = shapes_mesh.torus(60, 40)
    triangles = damaged.triangles.copy()
    triangles[::97] = triangles[::97, ::-1]
    triangles[::89, 0] = 7
    yield "damaged", replace(damaged, triangles=triangles)


def digests() -> dict[str, str]:
    """One digest for the arrays, the measurements and each file of every surface."""
    found = {}
    for name, surface in surfaces():
        found[name] = hashlib.sha256(surface.vertices.tobytes() + surface.triangles.tobytes()).hexdigest()
        found[f"measure {name}"] = repr(measure(surface))
        shaded = replace(surface, normals=_kernels.triangle_normals(surface.vertices, surface.triangles))
        for format in FORMATS:
            stream = io.BytesIO()
            write_to(stream, shaded, format)
            found[f"{format} {name}"] = hashlib.sha256(stream.getvalue()).hexdigest()
    return found


@pytest.mark.skipif(not _kernels_base.supports_v3(), reason="this processor has only one build to run")
def test_both_builds_give_the_same_bytes() -> None:
    """Surfaces, measurements and files, of every method."""
    printed = {}
    for build in ("base", "v3"):
        environment = {**os.environ, "ISOCORE_KERNELS": build}
        command = [sys.executable, "-P", __file__]
        environment["PYTHONPATH"] = str(Path(__file__).parents[1])
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        printed[build] = json.loads(done.stdout)
    assert printed["base"] == printed["v3"]
    assert len(printed["v3"]) > 60


if __name__ == "__main__":
    print(json.dumps(digests()))
