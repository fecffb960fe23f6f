"""Who may import whom, and a few promises that hold over the whole tree."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import isocore

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted(path for folder in ("isocore", "cli") for path in (ROOT / folder).rglob("*.py"))

NOUNS = {"errors", "late", "version", "digits", "choices", "colormaps", "labels", "piece_sizes", "views"} | {
    "volume", "cell_mesh", "carried", "surface", "job", "extraction", "measurements"
}  # fmt: skip
KERNELS = {"_kernels", "_processor"}
FIELD_ROOMS = {"apart", "histogram", "isovalue", "extrema", "field_facts", "remarks", "segmentation"}
#: What the one path is made of.
STAGES = {"copies", "readers", "backends", "writers", "report", "ambiguities", "requirements", "timer", "memory"} | {
    "asked", "pictures", "whole_file"
}  # fmt: skip
#: What becomes of coordinates on their way to the file.
PLACES = {"offset", "outputs", "pieces", "rounded_error"}
#: Importing one file of a batch tells nothing about another: each says for itself what it knows of the others.
BATCHED = NOUNS | {"report", "whole_file"}

#: room -> rooms it may import besides itself; a file may have a list of its own, which then names also the files of its
#: room. A room is the first part of a module's name below isocore; the command line alone may import any.
MAY_IMPORT: dict[str, set[str]] = {
    "_kernels": set(),
    "errors": set(),
    "late": set(),
    "version": set(),
    "digits": set(),
    "colormaps": {"errors"},
    "views": {"errors"},
    "pictures": {"errors", "surface", "views"},
    "choices": {"digits", "errors", "labels"},
    "labels": {"errors"},
    "piece_sizes": {"choices", "errors"},
    "whole_file": {"errors"},
    "arrays": {"errors"},
    "volume": {"arrays", "carried", "digits", "errors"},
    "cell_mesh": {"carried", "errors"},
    "carried": {"errors"},
    "memory": {"_kernels"},
    "placing": KERNELS,
    "surface": {"exchange", "placing", "volume"} | KERNELS,
    "measurements": {"surface"} | KERNELS,
    "requirements": {"measurements"},
    "job": {"choices", "errors", "labels", "piece_sizes", "readers/options", "views", "volume"},
    "extraction": {"cell_mesh", "surface", "volume"},
    "ambiguities": {"volume"} | KERNELS,
    "copies": {"surface"} | KERNELS,
    "readers": {"late", "arrays", "digits", "errors", "volume", "cell_mesh", "carried"} | KERNELS,
    "readers/options": set(),
    "apart": KERNELS,
    "histogram": {"apart", "cell_mesh", "volume"} | KERNELS,
    "isovalue": {"apart", "choices", "labels", "digits", "errors", "histogram"} | KERNELS,
    "segmentation": {"labels", "digits", "extraction", "histogram", "isovalue", "volume"},
    "extrema": {"cell_mesh"},
    "field_facts": {"cell_mesh", "extraction", "histogram", "volume"},
    "writers": {"late", "choices", "colormaps", "errors", "surface", "volume", "whole_file"} | KERNELS,
    "report": {"cell_mesh", "errors", "version", "extraction", "measurements", "histogram", "field_facts", "whole_file"}
    | {"copies", "late", "digits", "surface", "writers/colormaps", "writers/read_back"}
    | KERNELS,
    "report/sections": set(),
    "timer": {"report/sections"},
    "asked": NOUNS | {"report/sections"},
    "methods": NOUNS | KERNELS | {"placing", "whole_file"},
    "backends": NOUNS | {"methods"},
    "benches": NOUNS | KERNELS | {"histogram", "methods"},
    "remarks": NOUNS | {"field_facts", "histogram", "isovalue", "measurements"},
    "offset": NOUNS | {"methods/marching_cells", "placing"} | KERNELS,
    "outputs": NOUNS | {"ambiguities", "copies", "pictures", "report/sections", "whole_file", "writers"},
    "pieces": NOUNS | KERNELS,
    "rounded_error": NOUNS | {"methods/normals"} | KERNELS,
    "pipeline": NOUNS | FIELD_ROOMS | STAGES | PLACES | {"methods/index_file"},
    "api": NOUNS | FIELD_ROOMS | {"backends", "pieces"},
    "many": NOUNS | {"api", "backends", "batches", "copies", "memory", "pictures", "readers/options", "report"},
    "exchange": {"errors"},
    "describe": NOUNS | FIELD_ROOMS | {"readers"},
    "batches": set(),
    "batches/frames": set(),
    "batches/leftovers": {"whole_file"},
    "batches/stamps": BATCHED | {"readers"},
    "batches/collection": BATCHED | {"readers", "batches/places"},
    "batches/depfile": BATCHED | {"readers", "batches/collection"},
    "batches/places": {"errors"},
    "batches/inputs": BATCHED | {"readers", "batches/places"},
    "batches/naming": BATCHED | {"batches/inputs"},
    "batches/label_targets": BATCHED | {"readers", "methods/label_map"},
    "batches/plan": BATCHED
    | {"readers", "batches/inputs", "batches/label_targets", "batches/naming", "batches/places", "batches/steps"},
    "batches/steps": {"digits", "errors"},
    "batches/one_job": BATCHED | {"readers", "memory", "pipeline", "batches/stamps"},
    "batches/dry_run": BATCHED | {"batches/collection", "batches/one_job", "batches/stamps"},
    "batches/worker": BATCHED | {"memory", "batches/frames", "batches/one_job"},
    "batches/worker_process": BATCHED | {"batches/frames"},
    "batches/workers": BATCHED | {"pipeline", "batches/frames", "batches/leftovers", "batches/worker_process"},
    "batches/cluster": BATCHED | {"batches/leftovers", "pipeline", "batches/one_job"},
    "batches/run": BATCHED
    | {"batches/cluster", "batches/collection", "batches/leftovers", "batches/one_job", "batches/stamps"}
    | {"batches/workers"},
}

#: Modules without a Python file.
COMPILED = {"isocore._kernels_base", "isocore._kernels_v3", "isocore._processor"}

#: Foreign modules that only one room imports.
ONLY_IN = {
    "click": {"cli"},
    "rich": {"cli/console.py"},
    "nibabel": {"isocore/readers"},
    "nrrd": {"isocore/readers"},
    "meshio": {"isocore/readers", "isocore/exchange.py", "isocore/surface.py"},
    "pyvista": {"isocore/exchange.py", "isocore/surface.py"},
    "trimesh": {"isocore/exchange.py", "isocore/surface.py"},
    "isal": {"isocore/readers"},
    "embreex": {"isocore/pictures.py"},
    "distributed": {"isocore/batches/cluster.py"},
}


def module_of(path: Path, root: Path = ROOT) -> str:
    """A file's name for import statements; cli/ is installed as isocore.cli."""
    parts = path.relative_to(root).with_suffix("").parts
    parts = parts if parts[0] == "isocore" else ("isocore", *parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path, root: Path = ROOT) -> Iterator[tuple[int, str]]:
    """Line and absolute name of everything a file imports, also inside functions; type-checking imports too.

    `from package import name` gives package.name, whether that is a module or not.
    """
    module = module_of(path, root)
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            yield from ((node.lineno, f"{base}.{alias.name}") for alias in node.names)


def rows(path: Path) -> Iterator[tuple[int, str]]:
    """Line and absolute name of every function that a table of this file names by `late("module", "function")`."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "late":
            yield node.lineno, ".".join(["isocore", *(str(ast.literal_eval(part)) for part in node.args)])


IMPORTS = [(path, line, module) for path in SOURCES for line, module in (*imports(path), *rows(path))]


def file_graph(sources: list[Path], root: Path = ROOT) -> dict[str, dict[str, int]]:
    """For each module the modules whose files it imports, and the line that does.

    A file of another package brings that package's own file along, since Python runs it first. The outermost package
    is left out of this: every import runs it.
    """
    modules = {module_of(path, root) for path in sources}
    graph: dict[str, dict[str, int]] = {}
    for path in sources:
        module = module_of(path, root)
        graph[module] = {}
        for line, name in imports(path, root):
            if name in COMPILED:
                continue
            found = name if name in modules else name.rpartition(".")[0]
            packages = [found.rsplit(".", n)[0] for n in range(1, found.count("."))]
            for target in (found, *(package for package in packages if not f"{module}.".startswith(f"{package}."))):
                if target in modules and target != module:
                    graph[module].setdefault(target, line)
    return graph


def circle_in(graph: dict[str, dict[str, int]]) -> list[str]:
    """Modules that import one another in this order, each with the line of its import; nothing where none do."""
    done: set[str] = set()

    def search(module: str, way: list[str]) -> list[str]:
        if module in way:
            circle = [*way[way.index(module) :], module]
            return [f"{one}:{graph[one][other]} imports {other}" for one, other in pairwise(circle)]
        if module in done:
            return []
        found = next(filter(None, (search(target, [*way, module]) for target in graph[module])), [])
        done.add(module)
        return found

    return next(filter(None, (search(module, []) for module in graph)), [])


def test_rows_of_tables_name_functions_that_are_there() -> None:
    """What is imported by name, when it is first called, is found before that."""
    named = [name for path in SOURCES for _, name in rows(path)]
    assert len(named) > 30
    for name in named:
        module, function = name.rsplit(".", 1)
        assert callable(getattr(import_module(module), function)), name


def test_no_file_imports_itself_by_way_of_others() -> None:
    """Neither at once nor when some function is called: a circle of files is one file that is hard to read."""
    assert not circle_in(file_graph(SOURCES))


def test_a_circle_behind_a_function_is_found(tmp_path: Path) -> None:
    """Also one that runs through a package's own file and through the command line's relative imports."""
    sources = {
        "isocore/__init__.py": "",
        "isocore/low.py": "def f():\n    from isocore.room.part import g",
        "isocore/room/__init__.py": "from isocore.room.other import h",
        "isocore/room/part.py": "",
        "isocore/room/other.py": "from isocore import low",
    }
    for name, text in sources.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    circle = circle_in(file_graph([tmp_path / name for name in sources], tmp_path))
    assert circle == [
        "isocore.low:2 imports isocore.room",
        "isocore.room:1 imports isocore.room.other",
        "isocore.room.other:1 imports isocore.low",
    ]
    (tmp_path / "isocore/room/other.py").write_text("")
    assert not circle_in(file_graph([tmp_path / name for name in sources], tmp_path))


def place_of(module: str) -> str:
    """room/file below isocore, or the room alone."""
    return "/".join(module.split(".")[1:3])


def room_of(module: str) -> str:
    return place_of(module).split("/")[0]


def test_imports_go_downward_only() -> None:
    """The offending lines are named; a room without a list fails, too."""
    offences = []
    for module, targets in file_graph(SOURCES).items():
        own, room = place_of(module), room_of(module)
        if room in ("", "cli"):
            continue
        allowed = MAY_IMPORT[own] if "/" in own and own in MAY_IMPORT else MAY_IMPORT[room] | {room}
        for target, line in targets.items():
            implied = any(name.startswith(f"{place_of(target)}/") for name in allowed)
            if not {place_of(target), room_of(target)} & allowed and not implied:
                offences.append(f"{module}:{line}: {own} may not import {target}")
    assert not offences


def test_every_list_of_imports_is_of_a_room() -> None:
    """A list that outlives its room would say nothing."""
    places = {place_of(module_of(path)) for path in SOURCES}
    assert MAY_IMPORT.keys() <= places | {place.split("/")[0] for place in places}


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
