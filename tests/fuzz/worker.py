"""A process that runs inputs one after the other, and tells what went wrong: run.py starts it, and starts it again.

    python worker.py TARGETS SEED FIRST STEP LAST FOLDER

It writes the number it is at into FOLDER/at, and a line of JSON for each finding on stdout.
"""

from __future__ import annotations

import json
import os
import re
import resource
import struct
import sys
import time
import traceback
import warnings
from contextlib import suppress
from mmap import mmap
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzz.targets import CASES, TARGETS, Broken, random_of

#: No input takes longer; processor time, since the machine may be busy.
MOST_SECONDS = 10.0
#: Memory a small input may take whatever it is, and the bytes that one of a packed input may become.
_ANYWAY, _INFLATED = 16 << 20, 1032
_STATUS, _PEAK = Path("/proc/self/status"), re.compile(rb"VmHWM:\s*(\d+) kB")
_CLOCK_EVERY = 50  # inputs: reading this clock takes as long as some of them
_GUARD_BYTES = 6 << 30
AT = struct.Struct("<qq")  # number, milliseconds since it was begun


class Memory:
    """The peak of the process beyond what it was before a run."""

    def __init__(self) -> None:
        self._status = os.open(_STATUS, os.O_RDONLY) if _STATUS.exists() else None
        self._forget()

    def _forget(self) -> None:
        with suppress(OSError):
            Path("/proc/self/clear_refs").write_text("5")
        self._before = self._peak()

    def _peak(self) -> int:
        """By the system's own account of this process: getrusage begins with the peak of the one that started it."""
        if self._status is None:
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        found = _PEAK.search(os.pread(self._status, 4096, 0))
        return int(found[1]) * 1024 if found else 0

    def grown(self) -> int:
        """Bytes since the last call; forgets a peak that would hide the next."""
        peak = self._peak()
        grown = peak - self._before
        if grown > 1 << 22:
            self._forget()
        return grown


def main() -> None:
    """Run inputs FIRST, FIRST + STEP and so on, below LAST."""
    names, seed, first, step, last, place = sys.argv[1:]
    targets = names.split(",")
    folder = Path(place)
    address = resource.getrlimit(resource.RLIMIT_AS)[1]
    resource.setrlimit(resource.RLIMIT_AS, (_GUARD_BYTES, address))
    leaked: list[str] = []
    warnings.simplefilter("always")
    warnings.showwarning = lambda message, *_, **__: leaked.append(str(message))
    for target in TARGETS.keys() & set(targets):  # what is made once is no part of an input's memory
        _run(target, int(seed), -1, folder / "in")
    memory = Memory()
    with (folder / "at").open("r+b") as file, mmap(file.fileno(), AT.size) as at:
        for done, number in enumerate(range(int(first), int(last), int(step))):
            if done % _CLOCK_EVERY == 0:
                processor = time.process_time()
            at[:] = AT.pack(number, int(time.monotonic() * 1000))
            target = targets[number % len(targets)]
            leaked.clear()
            begun = time.monotonic()
            kind, detail, justified = _run(target, int(seed), number, folder / "in")
            if time.monotonic() - begun > MOST_SECONDS and (seconds := time.process_time() - processor) > MOST_SECONDS:
                _tell(target, seed, number, "slow", f"{seconds:.1f} seconds")
                processor = time.process_time()
            if (grown := memory.grown()) > justified:
                _tell(target, seed, number, "memory", f"{grown:,} bytes where {justified:,} are justified")
            if leaked:
                _tell(target, seed, number, "warning", leaked[0])
            if kind:
                _tell(target, seed, number, kind, detail)
        at[:] = AT.pack(int(last), int(time.monotonic() * 1000))


def _run(target: str, seed: int, number: int, folder: Path) -> tuple[str, str, int]:
    """What was wrong with one input, in a word and in full, and the bytes of memory that it justifies."""
    random = random_of(target, seed, number)
    files = CASES[target].made(random)
    folder.mkdir(exist_ok=True)
    for left in folder.iterdir():
        if left.is_file() and left.name not in files:
            left.unlink()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    justified = _ANYWAY + 2 * _INFLATED * sum(map(len, files.values()))
    try:
        CASES[target].asked(folder / next(iter(files)), random)
    except Broken as broken:
        return "promise", str(broken), justified
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        return type(error).__name__, f"{error} ({Path(where.filename).name}:{where.lineno})", justified
    return "", "", justified


def _tell(target: str, seed: str, number: int, kind: str, detail: str) -> None:
    finding = {"target": target, "seed": int(seed), "number": number, "kind": kind, "detail": detail[:500]}
    sys.stdout.write(json.dumps(finding) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
