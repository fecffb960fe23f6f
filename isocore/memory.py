"""How much memory a job took, will take, and how much there is."""

from __future__ import annotations

import os
import struct
import sys
from collections.abc import Iterable
from pathlib import Path

_STATUS = Path("/proc/self/status")
_CLEAR = Path("/proc/self/clear_refs")
_MEMINFO = Path("/proc/meminfo")
_CGROUP = Path("/sys/fs/cgroup")
#: The interpreter with numpy and the kernels.
_BASE_BYTES = 60 << 20
#: Samples, then the surface: of 8-bit noise it can take several times the samples.
_PER_CONTENT_BYTE = 4
#: No deflate stream inflates to more than this many times its size, and a scan usually to this many.
_DEFLATE_LIMIT = 1032
_USUAL_RATIO = 4


def forget_peak() -> None:
    """Start the peak anew, so that each job of a process reports its own; does nothing where it cannot."""
    try:
        _CLEAR.write_text("5")
    except OSError:
        return


def peak_bytes() -> int | None:
    """Peak resident memory since forget_peak, or of the whole process where the system cannot forget."""
    try:
        for line in _STATUS.read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    if sys.platform == "win32":
        return None
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def estimated_bytes(files: Iterable[Path]) -> int:
    """A generous guess at the peak of a job that reads these files, by their sizes alone."""
    return _BASE_BYTES + _PER_CONTENT_BYTE * sum(_content_bytes(file) for file in files)


def _content_bytes(file: Path) -> int:
    """The size of a file, inflated where it is gzip: its last four bytes say so, modulo 2^32."""
    try:
        size = file.stat().st_size
        if not file.name.lower().endswith(".gz") or size < 18:
            return size
        with file.open("rb") as stream:
            stream.seek(-4, os.SEEK_END)
            (inflated,) = struct.unpack("<I", stream.read(4))
    except OSError:
        return 0
    return min(int(inflated), size * _DEFLATE_LIMIT) if inflated >= size else size * _USUAL_RATIO


def free_bytes() -> int | None:
    """Memory that can still be had, by the machine and by the control group; None where neither tells."""
    told = [amount for amount in (_machine_free(), _group_free()) if amount is not None]
    return min(told, default=None)


def _machine_free() -> int | None:
    try:
        for line in _MEMINFO.read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return None


def _group_free() -> int | None:
    try:
        limit = (_CGROUP / "memory.max").read_text().strip()
        used = int((_CGROUP / "memory.current").read_text())
    except (OSError, ValueError):
        return None
    return None if limit == "max" else max(0, int(limit) - used)
