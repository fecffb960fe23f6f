"""The portable build of the kernels and the one for wide vectors differ in speed only."""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import shapes_mesh
from shapes import integer_noise

import isocore
from isocore import _kernels, _processor
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


def installed_builds() -> list[str]:
    return [build for build in ("v3", "base") if find_spec(f"isocore._kernels_{build}")]


def test_both_builds_give_the_same_bytes() -> None:
    """Surfaces, measurements and files, of every method."""
    if not _processor.supports_v3():
        pytest.skip("this processor runs only one build of the kernels")
    if len(installed_builds()) < 2:
        assert not os.environ.get("CI"), "continuous integration builds with ISOCORE_ISA=all"
        pytest.skip(f"only one build is installed, {_kernels.BUILD}: ISOCORE_ISA=all makes both")
    printed = {}
    for build in ("base", "v3"):
        environment = {**os.environ, "ISOCORE_KERNELS": build}
        command = [sys.executable, "-P", __file__]
        environment["PYTHONPATH"] = str(Path(__file__).parents[1])
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        printed[build] = json.loads(done.stdout)
    assert printed["base"] == printed["v3"]
    assert len(printed["v3"]) > 60


@pytest.mark.parametrize(
    ("installed", "runs_v3", "asked", "chosen"),
    [
        (["v3", "base"], True, "", "v3"),
        (["v3", "base"], False, "", "base"),
        (["v3", "base"], True, "base", "base"),
        (["v3"], True, "v3", "v3"),
        (["base"], True, "", "base"),
    ],
)
def test_the_widest_build_that_runs_is_chosen(installed: list[str], runs_v3: bool, asked: str, chosen: str) -> None:
    """Of those installed, unless one is asked for."""
    assert _kernels._choose(installed, runs_v3, asked) == chosen


@pytest.mark.parametrize(
    ("installed", "runs_v3", "asked", "message"),
    [
        (["v3"], True, "base", "ISOCORE_KERNELS=base: it was not built; there is: v3"),
        (["v3", "base"], False, "v3", "ISOCORE_KERNELS=v3: this processor lacks AVX2; there is: base"),
        (["v3"], False, "", "for processors with AVX2 alone, which this one lacks; .*ISOCORE_ISA=all"),
        ([], True, "", "without kernels; .*ISOCORE_ISA=all"),
    ],
)
def test_a_build_that_cannot_run_is_refused(installed: list[str], runs_v3: bool, asked: str, message: str) -> None:
    """By name and with the way out, before any of its code is loaded."""
    with pytest.raises(ImportError, match=message):
        _kernels._choose(installed, runs_v3, asked)


def test_sources_without_kernels_say_so(tmp_path: Path) -> None:
    """As in a clone, where Python finds the sources before what was installed from them."""
    shutil.copytree(Path(isocore.__file__).parent, tmp_path / "isocore", ignore=shutil.ignore_patterns("*.so", "*.pyd"))
    command = [sys.executable, "-S", "-c", "import isocore._kernels"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "are isocore's sources, without compiled kernels; start Python else" in done.stderr


def test_the_version_says_which_kernels_run() -> None:
    """And a build that is not there is one line, not a traceback."""
    for build in ("v3", "base"):
        command = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "--version"]
        environment = {**os.environ, "ISOCORE_KERNELS": build}
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if build in installed_builds() and (build == "base" or _processor.supports_v3()):
            assert done.stdout == f"isocore {isocore.__version__} (kernels: {build})\n"
        else:
            assert done.returncode == 1
            assert done.stderr.startswith(f"isocore: ISOCORE_KERNELS={build}: ")
            assert done.stderr.count("\n") == 1


if __name__ == "__main__":
    print(json.dumps(digests()))
