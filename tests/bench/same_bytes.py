"""Whether two installs write the same bytes, over every sample, volume and mesh at hand, all backends and options.

    old/python tests/bench/same_bytes.py write before.tsv --data ../shared/data
    new/python tests/bench/same_bytes.py write after.tsv --data ../shared/data
    python tests/bench/same_bytes.py compare before.tsv after.tsv

`write` calls the installed command line in one process, and once more with the portable kernels: compare installs that
have both. A row is what was run, the sha256 of what came of it, and a hint for people. What came of it is an output
file, a record of the report without the keys that time and memory stand in, or the exit code with everything on the
screen: refusals are compared word by word. `compare` exits with 1 where any row differs or is missing on either side.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from hashlib import sha256
from pathlib import Path
from typing import Any, TextIO

from byte_runs import OF_GRIDS, Arguments, description, files, further, make_grids, options_for

ROOT = Path(__file__).resolve().parent.parent.parent
#: Where Python says that it warns: a path and a line of the install, which differ without a difference.
WARNED_AT = re.compile(r"^\S+\.py:\d+: (?=\w+Warning: )", re.MULTILINE)
COMMANDS = ("convert", "info", "index", "report", "bench")
TIMED = {"seconds", "peak_rss_bytes"}
OUT = Path("out")
MOST_SHOWN = 60


def isocore(*arguments: str) -> tuple[int, str]:
    """Run the command line in this process: its exit code, and what it printed."""
    from isocore.cli.main import main

    printed = io.StringIO()
    sys.argv = ["isocore", *arguments]
    with redirect_stdout(printed), redirect_stderr(printed):
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0), WARNED_AT.sub("", printed.getvalue())
        except Exception as error:  # what a user would see as a traceback is compared by its last line
            return 1, f"{printed.getvalue()}{type(error).__name__}: {error}"
    raise AssertionError("the command line ends by SystemExit")


def untimed(value: Any) -> Any:
    """A record without its seconds and its memory, at any depth."""
    if isinstance(value, dict):
        return {key: untimed(part) for key, part in value.items() if key not in TIMED}
    return value


def digest(data: bytes | str) -> str:
    """The sha256 of bytes, or of a text as UTF-8."""
    return sha256(data.encode() if isinstance(data, str) else data).hexdigest()


class Rows:
    """Rows of one run, written as they come so that a crash shows where it happened."""

    def __init__(self, stream: TextIO, part: str) -> None:
        self._stream, self._part = stream, part

    def add(self, *key: str, data: bytes | str, hint: str = "") -> None:
        """A row: what was run, the hash of `data`, and a hint."""
        name = json.dumps(" | ".join((self._part, *key)))
        self._stream.write(f"{name}\t{digest(data)}\t{json.dumps(hint)}\n")
        self._stream.flush()

    def convert(self, path: Path, *options: str) -> list[dict[str, Any]]:
        """Convert, add a row for the screen, each file and each record, and return the records."""
        shutil.rmtree(OUT, ignore_errors=True)
        OUT.mkdir()
        report = Path("report.json")
        report.unlink(missing_ok=True)
        names = ("-d", str(OUT), "--name", "{stem}_v{volume}_{isovalue}")
        code, screen = isocore("convert", str(path), *options, *names, "-q", "--report", str(report))
        what = (str(path), " ".join(options))
        self.add(*what, "screen", data=f"{code}\n{screen}", hint=f"{code} {screen}"[:300])
        for file in sorted(OUT.iterdir()):
            self.add(*what, str(file), data=file.read_bytes(), hint=f"{file.stat().st_size} bytes")
        records: list[dict[str, Any]] = json.loads(report.read_text())["outputs"] if report.exists() else []
        for record in map(untimed, records):
            each = {key: json.dumps(value, sort_keys=True) for key, value in record.items()}
            parts = " ".join(f"{key}={digest(text)[:8]}" for key, text in sorted(each.items()))
            self.add(*what, str(record["output"]), "record", data=json.dumps(record, sort_keys=True), hint=parts)
        return records

    def screen(self, *arguments: str) -> None:
        """Add what a command without seconds prints."""
        code, screen = isocore(*arguments)
        self.add(*arguments, data=f"{code}\n{screen}", hint=f"{code} {screen}"[:300])


def every_file(rows: Rows, only: str, *, portable: bool) -> None:
    """Each file as it is, then with what its refusal proposes, then with all options that its kind takes."""
    for path in files(Path.cwd(), only=only):
        rows.add(str(path), "input", data=path.read_bytes())
        waiting: list[Arguments] = [description(path)]
        while waiting:
            given = waiting.pop(0)
            record = (rows.convert(path, *given) or [{"kind": None, "message": ""}])[0]
            if record["kind"] is None:
                waiting += further(record["message"] or "", given)
                continue
            samples = 1
            for length in record["shape"]:
                samples *= length
            if not portable:
                rows.screen("info", str(path), *given)
                rows.screen("info", str(path), *given, "--json")
                if record["kind"] == "mesh":
                    index(rows, path, given)
            for options in options_for(path, record["kind"], samples, portable=portable):
                rows.convert(path, *given, *options)


def index(rows: Rows, path: Path, given: Arguments) -> None:
    """The index of a copy of the mesh, and surfaces by way of it."""
    shutil.rmtree("indexed", ignore_errors=True)
    folder = Path("indexed", path.parent)
    folder.mkdir(parents=True)
    copy = Path(shutil.copy(path, folder))
    code, screen = isocore("index", str(copy), *given)
    rows.add(str(path), *given, "index", "screen", data=re.sub(r"in [\d.]+ s", "", f"{code}\n{screen}"), hint=screen)
    for file in sorted(folder.iterdir()):
        rows.add(str(path), *given, str(file), data=file.read_bytes(), hint=f"{file.stat().st_size} bytes")
    rows.convert(copy, *given, "-b", "thinning", "-i", "p30", "-i", "p80", "--no-reference", "--threads", "2")


def reports(rows: Rows) -> None:
    """A report of the samples, with every second set to 1, in every format; and the help of every command."""
    shutil.rmtree(OUT, ignore_errors=True)
    isocore("convert", "samples", "-d", str(OUT), "-q", "--threads", "1", "--report", "report.json")
    report = json.loads(Path("report.json").read_text())
    same = {"host": dict.fromkeys(report["host"], "1"), "tool": report["tool"] | {"kernels": "any"}}
    Path("same.json").write_text(json.dumps(_seconds_one(report | same | {"arguments": []})))
    targets = [f"as/{name}" for name in ("a.json", "a.jsonl", "a.csv", "a.md", "a.html", "a.xml", "bench.json")]
    Path("as").mkdir(exist_ok=True)
    rows.screen("report", "same.json", *(part for target in targets for part in ("--to", target)))
    for target in map(Path, targets):
        data = target.read_bytes() if target.exists() else b"missing"
        rows.add("report", str(target), data=data, hint=f"{len(data)} bytes")
    rows.screen("report", "--compare", "same.json", "same.json", "--fail-if", "triangles>+2%")
    for command in COMMANDS:
        rows.screen(command, "--help")


def _seconds_one(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _ones(part) if key in TIMED else _seconds_one(part) for key, part in value.items()}
    return [_seconds_one(part) for part in value] if isinstance(value, list) else value


def _ones(value: Any) -> Any:
    return dict.fromkeys(value, 1) if isinstance(value, dict) else 1


def run_part(stream: TextIO, part: str, data: Path, only: str) -> None:
    """All rows of one part, in a folder that is removed afterwards."""
    portable = part == "portable"
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("samples").symlink_to(ROOT / "sample_volumes")
        Path("data").symlink_to(data)
        code, screen = isocore("info", "samples/knot.nii.gz")
        if code:
            sys.exit(f"{part}: this install converts nothing: {screen}")
        rows = Rows(stream, part)
        every_file(rows, only, portable=portable)
        for path in make_grids(Path("grids"), data / "topology" / "random_5x5x5_shared_2000.npz"):
            for options in OF_GRIDS:
                if only in str(path) and not (portable and "big" in path.name):
                    records = rows.convert(path, *options.split())
                    assert any(record["status"] == "done" for record in records), (path, options)
        if not portable and not only:
            reports(rows)
        os.chdir(ROOT)


def write(target: Path, data: Path, only: str) -> None:
    """Both parts into one file, each in a process of its own: the kernels are chosen once per process."""
    target.write_text("")
    for part, kernels in (("widest", ""), ("portable", "base")):
        command = [sys.executable, __file__, "write", str(target), "--data", str(data), "--only", only, "--part", part]
        settings = os.environ | {"ISOCORE_KERNELS": kernels, "NO_COLOR": "1", "COLUMNS": "100"}
        subprocess.run(command, env=settings, check=True)
    print(f"{target}: {len(target.read_text().splitlines()):,} rows")


def read_rows(path: Path) -> dict[str, tuple[str, str]]:
    """What was run -> hash and hint. Raises ValueError where one thing was run twice."""
    rows: dict[str, tuple[str, str]] = {}
    for line in path.read_text().splitlines():
        name, hashed, hint = line.split("\t")
        if name in rows:
            raise ValueError(f"{path}: {name} stands there twice")
        rows[name] = hashed, hint
    return rows


def differences(before: dict[str, tuple[str, str]], after: dict[str, tuple[str, str]]) -> Iterator[str]:
    """A paragraph per row that differs or is missing; of records, the keys that differ."""
    for name in before | after:
        if name not in after or name not in before:
            yield f"{name}\n    only in the {'first' if name in before else 'second'}"
        elif before[name][0] != after[name][0]:
            old, new = (json.loads(side[name][1]) for side in (before, after))
            if name.endswith('| record"'):
                changed = {part.split("=")[0] for part in set(old.split()) ^ set(new.split())}
                yield f"{name}\n    differs in {', '.join(sorted(changed))}"
            else:
                yield f"{name}\n    {old!r}\n    {new!r}"


def main() -> None:
    """Write rows, or compare two files of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    writing = commands.add_parser("write", help="run everything and write a row for each result")
    writing.add_argument("file", type=Path)
    writing.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="folder of further inputs")
    writing.add_argument("--only", default="", help="only inputs whose path contains this")
    writing.add_argument("--part", choices=("widest", "portable"), help="one part, appended to the file")
    comparing = commands.add_parser("compare", help="list the rows that differ; exit code 1 if there are any")
    comparing.add_argument("first", type=Path)
    comparing.add_argument("second", type=Path)
    asked = parser.parse_args()
    if asked.command == "compare":
        before, after = read_rows(asked.first), read_rows(asked.second)
        found = list(differences(before, after))
        for paragraph in found[:MOST_SHOWN]:
            print(paragraph)
        print(f"{len(before):,} and {len(after):,} rows, {len(found):,} differ or are missing")
        sys.exit(1 if found or not before else 0)
    if asked.part is None:
        write(asked.file.resolve(), asked.data.resolve(), asked.only)
    else:
        with asked.file.open("a") as stream:
            run_part(stream, asked.part, asked.data, asked.only)


if __name__ == "__main__":
    main()
