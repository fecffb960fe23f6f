"""`make dist`: a wheel holds one top-level package with its compiled modules, and no kernel source."""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path


def problems(wheel: Path) -> list[str]:
    """What is wrong with a wheel's content; empty if nothing."""
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info/" not in name}
    found = []
    if tops != {"isocore"}:
        found.append(f"{wheel.name}: top-level names are {sorted(tops)}, not isocore alone")
    for needed in ("isocore/py.typed", "isocore/_kernels.pyi", "isocore/cli/main.py", "isocore/batches/worker.py"):
        if needed not in names:
            found.append(f"{wheel.name}: {needed} is missing")
    if not any(name.startswith("isocore/_kernels_base.") and name.endswith((".so", ".pyd")) for name in names):
        found.append(f"{wheel.name}: the compiled module is missing")
    found += [f"{wheel.name}: {name} does not belong into a wheel" for name in names if name.endswith((".cpp", ".hpp"))]
    return found


if __name__ == "__main__":
    wheels = sorted(Path(sys.argv[1]).glob("isocore-*.whl"))
    found = [problem for wheel in wheels for problem in problems(wheel)]
    print("\n".join(found) if found else f"{len(wheels)} wheel(s) hold what they should")
    sys.exit(1 if found or not wheels else 0)
