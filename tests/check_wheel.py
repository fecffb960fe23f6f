"""`make dist`: a wheel holds what it should, and works in a new environment without a compiler or this folder."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

SAMPLES = Path(__file__).resolve().parent.parent / "sample_volumes"


def problems(wheel: Path) -> list[str]:
    """What is wrong with a wheel's content; empty if nothing."""
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name and ".data/data/share/man/" not in name}
    found = []
    if tops != {"isocore"}:
        found.append(f"{wheel.name}: top-level names are {sorted(tops)}, not isocore alone")
    for needed in ("isocore/py.typed", "isocore/_kernels.pyi", "isocore/cli/main.py", "isocore/batches/worker.py"):
        if needed not in names:
            found.append(f"{wheel.name}: {needed} is missing")
    manual = {name.split("/")[-1] for name in names if "/share/man/man1/" in name}
    if not {"isocore.1", "isocore-convert.1"} <= manual:
        found.append(f"{wheel.name}: man pages are missing; it has {sorted(manual)}")
    for module in ("_processor", *(f"_kernels_{build}" for build in builds(wheel))):
        if not any(name.startswith(f"isocore/{module}.") and name.endswith((".so", ".pyd")) for name in names):
            found.append(f"{wheel.name}: the compiled module {module} is missing")
    found += [f"{wheel.name}: {name} does not belong into a wheel" for name in names if name.endswith((".cpp", ".hpp"))]
    return found


def builds(wheel: Path) -> list[str]:
    """The builds of the kernels that a wheel for its kind of processor must hold."""
    return ["base", "v3"] if wheel.stem.endswith(("x86_64", "amd64")) and "macosx" not in wheel.stem else ["base"]


def try_out(wheel: Path) -> str:
    """Install a wheel into a new environment, and convert the samples there with the kernels of each build.

    Only that environment's programs are on PATH. Raises CalledProcessError where a step fails, and AssertionError
    where two builds differ in a byte.
    """
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "venv"
        venv.create(home, with_pip=True)
        programs = home / ("Scripts" if os.name == "nt" else "bin")
        alone = {**os.environ, "PATH": str(programs)}
        python = programs / ("python.exe" if os.name == "nt" else "python")
        subprocess.run([python, "-m", "pip", "install", "-q", wheel.resolve()], check=True, cwd=folder, env=alone)
        digests, said = [], []
        ask = [python, "-P", "-c", "from isocore import _processor; print(_processor.supports_v3())"]
        runs_v3 = "True" in subprocess.check_output(ask, cwd=folder, env=alone, text=True)
        for build in builds(wheel) if runs_v3 else ["base"]:
            env = {**alone, "ISOCORE_KERNELS": build}
            out = Path(folder) / build
            command = [programs / "isocore", "convert", SAMPLES, "-d", out, "--report", out / "report.json"]
            subprocess.run(command, check=True, cwd=folder, env=env, capture_output=True)
            said.append(subprocess.check_output([programs / "isocore", "--version"], cwd=folder, env=env, text=True))
            assert f"(kernels: {build})" in said[-1], said
            digests.append({path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in out.glob("*.ply")})
            assert len(digests[-1]) == len(json.loads((out / "report.json").read_text())["outputs"]) > 0
        assert all(found == digests[0] for found in digests), digests
    return f"{wheel.name}, {wheel.stat().st_size / 1e6:.1f} MB: {len(digests[0])} samples by {', '.join(said)}"


def main() -> None:
    """Check every wheel of a folder; with `--try` also use each, which must fit this machine and Python."""
    wheels = sorted(Path(sys.argv[1]).glob("isocore-*.whl"))
    found = [problem for wheel in wheels for problem in problems(wheel)]
    print("\n".join(found) if found else f"{len(wheels)} wheel(s) hold what they should")
    if found or not wheels:
        sys.exit(1)
    if "--try" in sys.argv:
        for wheel in wheels:
            print(try_out(wheel).replace("\n", ""))


if __name__ == "__main__":
    main()
