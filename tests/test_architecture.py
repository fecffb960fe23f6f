"""Who may import whom, and a few promises that hold over the whole tree."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import isocore

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted(path for folder in ("isocore", "cli") for path in (ROOT / folder).rglob("*.py"))

NOUNS = {"volume", "cell_mesh", "surface", "errors", "extraction", "measurements", "choices"}
KERNELS = {"_kernels", "_kernels_base", "_kernels_v3"}
FIELD_ROOMS = {"histogram", "isovalue", "extrema"}
#: Rooms that only the command line uses.
FOR_THE_CLI = {"batches", "benches", "describe", "cli"}
ABOVE_BACKENDS = FOR_THE_CLI | {"pipeline", "compose", "readers", "writers", "report"}

#: room -> rooms it may import. A room is the first part of a module's name below isocore.
MAY_IMPORT: dict[str, set[str]] = {
    "errors": set(),
    "choices": {"errors"},
    "job": {"choices", "readers", "volume"},
    **dict.fromkeys(("volume", "cell_mesh", "surface", "extraction", "measurements"), NOUNS | KERNELS),
    "readers": NOUNS | KERNELS,
    "writers": {"surface", "errors", "whole_file", "choices"} | KERNELS,
    "whole_file": {"errors"},
    "report": {"surface", "errors", "whole_file"} | KERNELS,
    "methods": NOUNS | KERNELS | {"job", "whole_file"},
    "backends": NOUNS | {"job", "methods"},
    "benches": NOUNS | KERNELS | {"methods"},
    **dict.fromkeys(FIELD_ROOMS, NOUNS | KERNELS | FIELD_ROOMS),
}

#: Foreign modules that only one room imports.
ONLY_IN = {
    "click": {"cli"},
    "rich": {"cli/console.py"},
    "nibabel": {"isocore/readers"},
    "nrrd": {"isocore/readers"},
    "meshio": {"isocore/readers"},
    "isal": {"isocore/readers"},
    "distributed": {"isocore/batches/cluster.py"},
}


def imports(path: Path) -> Iterator[tuple[int, str]]:
    """Line and absolute name of everything a file imports, also inside functions; type-checking imports too."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            if node.module == "isocore":
                yield from ((node.lineno, f"isocore.{alias.name}") for alias in node.names)
            else:
                yield node.lineno, node.module or ""


IMPORTS = [(path, line, module) for path in SOURCES for line, module in imports(path)]


def room_of(module: str) -> str:
    parts = module.split(".")
    return parts[1] if len(parts) > 1 and parts[0] == "isocore" else ""


def test_imports_go_downward_only() -> None:
    """The offending lines are named."""
    offences = []
    for path, line, module in IMPORTS:
        parts = path.relative_to(ROOT).parts
        own = parts[1].removesuffix(".py") if parts[0] == "isocore" else parts[0]
        room = room_of(module)
        allowed = MAY_IMPORT.get(own)
        if not room or room in (own, "__version__") or own in ("__init__", "cli"):
            continue
        fine = room in allowed if allowed is not None else own in ABOVE_BACKENDS or room not in ABOVE_BACKENDS
        if not fine or room in FOR_THE_CLI:
            offences.append(f"{path}:{line}: {own} may not import {module}")
    assert not offences


def test_foreign_modules_stay_in_their_room() -> None:
    """Click and rich in the command line, a format library in its reader."""
    for path, line, module in IMPORTS:
        place = path.relative_to(ROOT).as_posix()
        rooms = ONLY_IN.get(module.split(".")[0])
        assert rooms is None or any(place.startswith(room) for room in rooms), f"{path}:{line}: imports {module}"


def test_only_the_pipeline_knows_readers_and_writers() -> None:
    """Nothing else reads a field and writes a surface; the lazy package itself only names both."""
    for source in SOURCES:
        rooms = {room_of(module) for path, _, module in IMPORTS if path == source}
        if source.name not in ("pipeline.py", "__init__.py"):
            assert not {"readers", "writers"} <= rooms, f"{source} imports readers and writers"


def test_the_core_is_silent() -> None:
    """No print and no exit outside the command line."""
    for path in (ROOT / "isocore").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in ("print", "exit", "quit"), f"{path}:{node.lineno}: {node.func.id}()"


def test_files_stay_short() -> None:
    """A file that outgrows 250 lines holds two thoughts."""
    long = {path.name: n for path in SOURCES if (n := len(path.read_text(encoding="utf-8").splitlines())) > 250}
    assert not long


def test_an_algorithm_never_includes_another() -> None:
    """Kernels share by way of common/, samples/ and tables/."""
    kernels = ROOT / "isocore" / "kernels"
    shared = {"common", "samples", "tables"}
    folders = {path.name for path in kernels.iterdir() if path.is_dir()} - shared - {"python", "tests"}
    for source in kernels.rglob("*.[ch]pp"):
        own = source.relative_to(kernels).parts[0]
        for line in source.read_text(encoding="utf-8").splitlines():
            match = re.match(r'#include "([a-z_]+)/', line)
            if match and own in folders:
                assert match[1] in {own, *shared}, f"{source}: {line}"


def test_the_api_is_sorted_and_complete() -> None:
    """Every name in __all__ is there, in order, and documented."""
    assert isocore.__all__ == sorted(isocore.__all__)
    for name in isocore.__all__:
        assert getattr(isocore, name).__doc__ or name == "BACKENDS", name


def test_functions_of_the_api_survive_their_modules() -> None:
    """A submodule of the same name must not take a function's place, whatever was imported before."""
    code = "import isocore.pipeline, isocore; assert callable(isocore.measure) and callable(isocore.extract)"
    assert subprocess.run([sys.executable, "-P", "-c", code], timeout=60, check=False).returncode == 0


def test_importing_the_package_is_quick() -> None:
    """`import isocore` brings no numpy."""
    code = "import sys, isocore; assert 'numpy' not in sys.modules"
    assert subprocess.run([sys.executable, "-P", "-c", code], timeout=60, check=False).returncode == 0


def test_the_version_stands_once() -> None:
    """In the package and in pyproject.toml alike."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["version"] == isocore.__version__
