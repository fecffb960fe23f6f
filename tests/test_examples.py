"""The examples and the one-liners of the documents, run as they stand."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from small_files import ball, write_nifti

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"
PAGES = (EXAMPLES / "one-liners.md", *(ROOT / "docs" / name for name in ("fields.md", "labels.md", "pieces.md")))
CODE = "import sys; from isocore.cli.main import main; sys.exit(main())"
pytestmark = pytest.mark.skipif(os.name == "nt", reason="the examples are for a POSIX shell")
#: Of a command, what it needs besides isocore.
NEEDS = {"jq": shutil.which("jq"), "make": shutil.which("make")}


def commands() -> list[str]:
    """Every indented line of the pages that runs isocore, without the comment behind it; and those in README's text."""
    lines = [line for page in PAGES for line in page.read_text(encoding="utf-8").splitlines() if line[:4] == "    "]
    shown = [line for line in lines if re.search(r"(^ +|\| )isocore (convert|report) ", line)]
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    named = [" ".join(command.split()) for command in re.findall(r"`((?:isocore )?convert \S[^`]* -d [^`]*)`", text)]
    named = [command if command.startswith("isocore") else f"isocore {command}" for command in named]
    return [*(re.sub(r"\s+#.*", "", line.strip()) for line in shown), *named]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with every file that the examples name, and isocore on the PATH."""
    folder = tmp_path_factory.mktemp("examples")
    (folder / "bin").mkdir()
    (folder / "bin" / "isocore").write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -c "{CODE}" "$@"\n')
    (folder / "bin" / "isocore").chmod(0o755)
    (folder / "sample_volumes").symlink_to(ROOT / "sample_volumes")
    scan = np.rint(8 * ball(16, radius=5)).astype(np.int16)
    write_nifti(folder / "scans" / "a.nii.gz", scan)
    write_nifti(folder / "scans" / "b.nii.gz", scan[::-1].copy())
    noise = np.random.default_rng(1).integers(0, 256, (112, 112, 112)).astype(np.int16)
    noise[40:70, 40:70, 40:70] = 1000
    write_nifti(folder / "scans" / "big_T1.nii.gz", noise)  # one that `find -size +1M` finds
    for name in ("ct", "T1", "FA", "one/T1", "two/T1"):
        write_nifti(folder / f"{name}.nii.gz", scan)
    labels = np.zeros((16, 16, 16), np.uint8)
    for value in range(1, 10):
        labels[value : value + 1, 2:12, 2:12] = value
    for name in ("seg", "aseg"):
        write_nifti(folder / f"{name}.nii.gz", labels)
    (folder / "FreeSurferColorLUT.txt").write_text("1 Left-Cerebral-Exterior 70 130 180 0\n")
    (folder / "list.txt").write_text("scans/a.nii.gz\n")
    points = meshio.read(ROOT / "sample_volumes" / "torus.vtu")
    x = points.points[:, 0]
    fields = {"p": x - x.min(), "temperature": x, "velocity": points.points}
    meshio.Mesh(points.points, points.cells, point_data=fields).write(folder / "flow.vtu")
    (folder / "scans" / "failed.nii").write_bytes(b"junk")
    run("isocore convert scans/failed.nii -d meshes --report failed.json -q", folder, code=1)
    write_nifti(folder / "scans" / "failed.nii", scan)
    run("isocore convert scans/a.nii.gz -i 300 -o a.ply --report yesterday.json -q", folder)
    shutil.copy(folder / "yesterday.json", folder / "today.json")
    return folder


def run(command: str, folder: Path, code: int = 0, **variables: str) -> str:
    """What a shell command prints, stderr too; it must end with this code."""
    environment = os.environ | {"PATH": f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}", **variables}
    shell = ["bash", "-o", "pipefail", "-c", command]
    done = subprocess.run(
        shell, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False
    )
    said = done.stdout.decode(errors="replace")
    assert done.returncode == code, f"{command}\n{said}"
    return said


def test_the_pages_have_commands() -> None:
    """So that none is missed because it is written otherwise."""
    texts = [page.read_text(encoding="utf-8") for page in PAGES]
    assert len(commands()) >= 18 and all("    isocore " in text for text in texts)


@pytest.mark.parametrize("command", commands())
def test_a_command_of_a_page_runs(command: str, place: Path) -> None:
    """In a shell, with the files that it names; a cluster that is not there is a wrong command."""
    for tool, found in NEEDS.items():
        if re.search(rf"\b{tool}\b", command) and not found:
            pytest.skip(f"{tool} is not installed")
    if "--scheduler" in command:
        pytest.importorskip("distributed", reason="dask.distributed is not installed (isocore[cluster])")
        assert "does not answer" in run(command.replace("head-node:8786", "127.0.0.1:9"), place, code=2)
        return
    if "--picture" in command:
        pytest.importorskip("embreex", reason="pictures are drawn by embreex: pip install 'isocore[picture]'")
    if "run.json |" in command:
        shutil.copy(place / "failed.json", place / "run.json")
    run(command, place)


@pytest.mark.skipif(not NEEDS["make"], reason="make is not installed")
def test_the_makefile_makes_again_what_changed(place: Path) -> None:
    """A further option makes all again, a touched scan makes its own, and nothing is made twice."""
    folder = place / "made"
    folder.mkdir()
    for name in ("Makefile", "meshes.mk"):
        shutil.copy(EXAMPLES / name, folder / name)
    (folder / "scans").mkdir()
    for name in ("a.nii.gz", "b.nii.gz"):
        shutil.copy(place / "scans" / name, folder / "scans" / name)
    (folder / "bin").symlink_to(place / "bin")
    assert run("make", folder).count("isocore convert") == 2
    assert "isocore convert" not in run("make", folder)
    assert {path.name for path in (folder / "meshes").glob("*.stl")} == {"a.stl", "b.stl"}
    said = run("make OPTIONS='--cap --block-size 8'", folder)
    assert said.count("--cap --block-size 8") == 2
    os.utime(folder / "scans" / "a.nii.gz", (2e9, 2e9))
    assert run("make OPTIONS='--cap --block-size 8'", folder).count("isocore convert") == 1
    command = "make -f meshes.mk -j2 SCANS=scans OUT=other ISO=300 OPTIONS='--max-triangles 5'"
    run(command, folder, code=2)
    for suffix in re.search(r"^KNOWN .*:= (.*)$", (EXAMPLES / "meshes.mk").read_text(), re.MULTILINE)[1].split():  # type: ignore[index]
        assert f".{suffix}" in known_suffixes()


def known_suffixes() -> set[str]:
    from isocore.readers.formats import FORMATS

    return {suffix for format_ in FORMATS for suffix in format_.suffixes}


def steps(text: str) -> list[str]:
    """The `run:` of each step of a workflow, folded lines joined."""
    found = re.findall(r"^( +)- run: (?:>\n((?:\1 {3,}.*\n)+)|(.*)\n)", text, re.MULTILINE)
    return [" ".join(folded.split()) or plain for _, folded, plain in found]


def test_the_workflow_runs(place: Path) -> None:
    """Its steps, in their order, but for the installation; and its artifacts are there."""
    text = (EXAMPLES / "github-workflow.yml").read_text(encoding="utf-8")
    install, convert, report = steps(text)
    assert install == "pip install isocore" and convert.startswith("isocore convert") and "--report run.xml" in convert
    options = re.search(r"^  OPTIONS: ([^#]*)", text, re.MULTILINE)
    assert options
    run(convert, place, OPTIONS=options[1].strip())
    run(report, place)
    kept = re.search(r"path: \|\n((?: +\S+\n)+)", text)
    assert kept and all((place / name).exists() for name in kept[1].split())
    assert json.loads((place / "bench.json").read_text())


def test_the_snakefiles_commands_run(place: Path) -> None:
    """Each rule's, with what snakemake puts into it; and snakemake itself where it is installed."""
    text = (EXAMPLES / "Snakefile").read_text(encoding="utf-8")
    mesh, page = re.findall(r'shell:\n +"(.*)"', text)
    for name in ("a", "b"):
        output = SimpleNamespace(mesh=f"meshes/{name}.ply", report=f"reports/{name}.json")
        run(mesh.format(input=f"scans/{name}.nii.gz", output=output, OPTIONS="--cap"), place)
    run(page.format(input="reports/a.json reports/b.json", output="all.html"), place)
    assert "meshes/b.ply" in (place / "all.html").read_text(encoding="utf-8")
    if shutil.which("snakemake"):
        run(f"snakemake --cores 1 -s {EXAMPLES / 'Snakefile'} --config options=--cap", place)
        assert (place / "run.html").is_file()
