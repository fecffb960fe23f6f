"""What is fuzzed: each reader, the index, the stamps, the reports; how an input is made of a number, and what is asked.

An input is a function of target, seed and number, so that whatever went wrong can be made again.
"""

from __future__ import annotations

import json
import os
import signal
import tempfile
import warnings
import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random

import numpy as np
from fuzz.mutations import damaged_bytes, damaged_json, some
from fuzz.seeds import READERS, Files, Seed, seeds_of
from meshes import mesh_of, with_values

from isocore.cell_mesh import CellMesh
from isocore.describe import describe
from isocore.errors import IsocoreError, printable
from isocore.extraction import Outlook
from isocore.job import Job, Options, Target
from isocore.methods.index_file import load_index, save_index
from isocore.methods.thinning import build_index, prepare_thinning
from isocore.pipeline import convert
from isocore.readers import ReadOptions, content_bytes, count_volumes, files_of, offered_fields, read
from isocore.report import load_report, merged, save_report
from isocore.report.compare import compared, comparison_rows
from isocore.report.record import BatchReport
from isocore.surface import Surface
from isocore.volume import Volume

#: One input of so many is not only read, but also described or converted.
_CONVERTED = 12


class Broken(AssertionError):
    """A promise that was not kept, without an exception of the program."""


@dataclass(frozen=True)
class Case:
    """A target. made: the files of an input, the one that is asked for first; asked: uses them, or refuses them."""

    made: Callable[[Random], Files]
    asked: Callable[[Path, Random], object]


def _mutated(seed: Seed, random: Random) -> Files:
    """One of the seed's files damaged, sometimes another too; now and then one of them is gone."""
    files = dict(seed.files)
    names = list(seed.mutators)
    for name in random.sample(names, 1 if random.random() < 0.8 else len(names)):
        files[name] = seed.mutators[name](random, files[name])
    if len(files) > 1 and random.random() < 0.02:
        del files[random.choice(list(files)[1:])]
    return files


def _made_for(reader: str) -> Callable[[Random], Files]:
    return lambda random: _mutated(random.choice(seeds_of(reader)), random)


def _attempt(path: Path, step: Callable[[], object]) -> bool:
    """Whether the step was done; a refusal must be one printable line of at most 300 characters about the file."""
    try:
        step()
    except IsocoreError as error:
        check_line(str(error))
        return False
    return True


def check_line(message: str) -> None:
    """A message as a user may see it."""
    if not message or message != printable(message) or len(message) > 300:  # wide spaces of names are printable
        raise Broken(f"no printable line of at most 300 characters: {message!r}")
    if "cannot be read (" in message and message.endswith("check that it is what its suffix says"):
        raise Broken(f"some library's own words: {message}")


def _read(path: Path, random: Random) -> None:
    """Every function of the readers, then the field itself; some fields are described and converted too."""
    options = ReadOptions(volume=0, step=random.choice((0, 0, 0, 1, None)))
    files_of(path)
    content_bytes(path)
    _attempt(path, lambda: count_volumes(path, options))
    fields = []
    _attempt(path, lambda: fields.extend(offered_fields(path)))
    if fields:
        field = random.choice(fields)
        component = random.choice(("0", "magnitude")) if field.components > 1 else None
        options = replace(options, field=field.name, component=component)
    found = []
    _attempt(path, lambda: found.append(read(path, options)))
    for field in found:
        _check_field(field)
    if not random.randrange(_CONVERTED):
        _attempt(path, lambda: describe(path, options))
        _converted(path, options, random)


def _check_field(field: Volume | CellMesh) -> None:
    for warning in field.warnings:
        if not warning.isprintable():
            raise Broken(f"a warning is no printable line: {warning!r}")
    places = field.affine if isinstance(field, Volume) else field.points
    if not np.isfinite(places).all():
        raise Broken("a place is not finite")


def _converted(path: Path, options: ReadOptions, random: Random) -> None:
    """The whole way to a surface; a run that failed says why in one line."""
    output = path.parent / "out" / f"a.{random.choice(('ply', 'obj', 'stl'))}"
    job = Job(
        source=path,
        targets=tuple(Target(text, output) for text in random.sample(("auto", "otsu", "p50", "1", "0.5"), 2)),  # type: ignore[arg-type]  # parsed
        format=output.suffix[1:],  # type: ignore[arg-type]  # one of them
        backend=random.choice((None, "mc", "thinning")),
        read_options=options,
        reference=random.random() < 0.5,
    )
    for run in convert(job):
        for line in (*([run.message] if run.status == "failed" else []), *run.warnings):
            if not line.isprintable():
                raise Broken(f"no printable line: {line!r}")
    for left in output.parent.glob("*"):
        left.unlink()


@cache
def _indexed() -> tuple[CellMesh, bytes, tuple[tuple[float, bytes], ...]]:
    """A mesh of both kinds of cells, the bytes of its index, and the triangles at some isovalues."""
    boxes = np.ones((3, 3, 2), bool)
    tets, hexes = mesh_of(boxes), mesh_of(boxes, hexes=True)
    mesh = CellMesh(
        np.concatenate([tets.points, np.add(hexes.points, [0, 0, 5.0])]),
        tets.tets,
        hexes.hexes + np.int32(len(tets.points)),
        np.zeros(len(tets.points) + len(hexes.points)),
    )
    mesh = with_values(mesh, np.sin(mesh.points * 1.7).sum(axis=1))
    path = Path(_scratch()) / "made.isoindex"
    save_index(path, build_index(mesh), mesh)
    extract = prepare_thinning(mesh, Options(), Outlook())
    surfaces = ((isovalue, _bytes_of(extract(isovalue).surface)) for isovalue in (-0.7, 0.1, 0.9))
    return mesh, path.read_bytes(), tuple(surfaces)


def _bytes_of(surface: Surface) -> bytes:
    return surface.vertices.tobytes() + surface.triangles.tobytes()


def _index(random: Random) -> Files:
    """Damage to any byte, to a number of the header, to one of the arrays under checksums that hold."""
    content = _indexed()[1]
    if random.random() < 0.3:
        return {"i.isoindex": some(damaged_bytes)(random, content)}
    magic, text, _, arrays = content.split(b"\n", 3)
    if random.random() < 0.5:
        text = damaged_json(random, text).replace(b"\n", b" ")
    else:
        arrays = _other_number(random, arrays)
        header = json.loads(text)
        text = json.dumps(header | {"checksum": zlib.crc32(arrays)}).encode()
    return {"i.isoindex": b"%b\n%b\n%08x\n%b" % (magic, text, zlib.crc32(text), arrays)}


def _other_number(random: Random, arrays: bytes) -> bytes:
    """One or a few int32 exchanged for others, for their neighbours, or for what might be right."""
    numbers = np.frombuffer(arrays[: len(arrays) // 4 * 4], "<i4").copy()
    for _ in range(random.choice((1, 1, 2, 5))):
        at = random.randrange(len(numbers))
        numbers[at] = random.choice(
            (0, -1, 1, 2**31 - 1, -(2**31), random.randrange(-300, 300), ~numbers[at], numbers[at] ^ 1, numbers[at - 1])
        )
    return numbers.tobytes() + arrays[len(numbers) * 4 :]


def _walked(path: Path, random: Random) -> None:
    """The surface is the right one, whatever the index says; a forger can only leave out cells of the skeleton."""
    mesh, whole, surfaces = _indexed()
    _attempt(path, lambda: load_index(path, mesh))
    extract = prepare_thinning(mesh, Options(threads=1 if random.randrange(8) else 2), Outlook(index=path))
    for isovalue, right in random.sample(surfaces, len(surfaces)):
        found = extract(isovalue)
        for warning in found.warnings:
            check_line(warning)
        if _bytes_of(found.surface) == right:
            continue
        if _skeletons(path.read_bytes()) == _skeletons(whole) or not _is_sound(found.surface):
            raise Broken(f"another surface at {isovalue}")


def _skeletons(content: bytes) -> list[bytes]:
    """The skeletons' cells in an index whose header is sound."""
    _, text, _, arrays = content.split(b"\n", 3)
    found, at = [], 0
    for kind in ("tets", "hexes"):
        for name, shape in json.loads(text)[kind]["arrays"].items():
            size = int(np.prod(shape)) * (8 if name in ("low", "high") else 4)
            found += [arrays[at : at + size]] * (name == "skeleton")
            at += size
    return found


def _is_sound(surface: Surface) -> bool:
    """Whether triangles name vertices that are there."""
    triangles = surface.triangles
    return not len(triangles) or 0 <= triangles.min() <= triangles.max() < len(surface.vertices)


@cache
def _scratch() -> str:
    return tempfile.mkdtemp(prefix="isocore-fuzz-")


@cache
def _made_once() -> tuple[Files, Job]:
    """A volume, its surface, and the stamp that a batch leaves beside it; the job of that run."""
    from isocore.batches.stamps import input_hash, keep_stamp, stamp_path

    source, output = Path(_scratch()) / "s.nrrd", Path(_scratch()) / "s.ply"
    source.write_bytes(seeds_of("nrrd")[0].files["d.nrrd"])
    job = Job(source=source, targets=(Target("60", output),), if_changed=True)  # type: ignore[arg-type]  # parsed
    (run,) = convert(job)
    keep_stamp(job, job.targets[0], input_hash(job), run)
    return {stamp_path(output).name: stamp_path(output).read_bytes()}, job


def _stamp(random: Random) -> Files:
    return {"stamp": some(damaged_json)(random, next(iter(_made_once()[0].values())))}


def _stamped(path: Path, random: Random) -> None:
    """A stamp holds or does not; the record of one that holds is written as any other."""
    from isocore.batches.stamps import input_hash, reason_to_run, stamp_path

    _, job = _made_once()
    stamp_path(job.targets[0].output).write_bytes(path.read_bytes())
    reason, run = reason_to_run(job, job.targets[0], input_hash(job))
    if reason:
        check_line(reason)
    if run is not None:
        save_report(BatchReport((run,)), path.with_name("r.json"))


@cache
def _reported() -> tuple[bytes, ...]:
    """Reports of a volume, of a mesh, of failed runs, and of all of them."""
    folder = Path(_scratch())
    runs = []
    for reader, name in (("nrrd", "d.nrrd"), ("vtu", "h.vtu"), ("nifti", "a.nii")):
        source = folder / name
        source.write_bytes(seeds_of(reader)[0].files[name])
        fields = ReadOptions(field="p" if reader == "vtu" else None)
        choices = ("3", "auto", "p40")
        targets = tuple(Target(text, folder / f"{name}{text}.ply") for text in choices)  # type: ignore[arg-type]  # parsed
        for backend in (None, "mc", "thinning", "nope"):
            runs += convert(Job(source=source, targets=targets, read_options=fields, backend=backend))
    found = []
    for batch in (*(BatchReport((run,)) for run in runs[::5]), BatchReport(tuple(runs[::4]))):
        save_report(batch, folder / "made.json")
        found.append((folder / "made.json").read_bytes())
    return tuple(found)


def _report(random: Random) -> Files:
    return {"r.json": some(damaged_json)(random, random.choice(_reported()))}


def _rendered(path: Path, random: Random) -> None:
    """A report is refused, or every renderer writes it; set beside itself it is the same."""
    batches: list[BatchReport] = []
    if not _attempt(path, lambda: batches.append(load_report(path))):
        return
    suffix = random.choice((".json", ".jsonl", ".csv", ".md", ".html", ".xml"))
    path.with_name("out").mkdir(exist_ok=True)
    written = path.with_name("out") / f"r{suffix}"
    _attempt(path, lambda: save_report(merged(batches), written))
    if suffix == ".json":
        load_report(written)
    comparison_rows(compared(batches[0], batches[0]))


TARGETS: dict[str, Case] = {
    **{reader: Case(_made_for(reader), _read) for reader in READERS},
    "index": Case(_index, _walked),
    "stamps": Case(_stamp, _stamped),
    "reports": Case(_report, _rendered),
}


def random_of(target: str, seed: int, number: int) -> Random:
    """What decides about one input."""
    return Random(f"{target}:{seed}:{number}")


def _misbehaving(what: Callable[[], object]) -> Case:
    """A target that goes wrong at every other input, which the fuzzer has to notice."""
    return Case(lambda random: {"f": b""}, lambda path, random: random.random() < 0.5 and what())


#: What is wrong -> a target that does it: only the fuzzer's own test asks for these.
MISBEHAVING: dict[str, Case] = {
    "crash": _misbehaving(lambda: os.kill(os.getpid(), signal.SIGSEGV)),
    "exit": _misbehaving(lambda: os._exit(3)),
    "ZeroDivisionError": _misbehaving(lambda: 1 // 0),
    "memory": _misbehaving(lambda: np.ones(10_000_000)),
    "promise": _misbehaving(lambda: check_line("two\nlines")),
    "warning": _misbehaving(lambda: warnings.warn("leaked", stacklevel=1)),
}
CASES = TARGETS | MISBEHAVING
