"""How much memory a job took, will take, and how much there is; and how many processors."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_STATUS = Path("/proc/self/status")
_CLEAR = Path("/proc/self/clear_refs")
_MEMINFO = Path("/proc/meminfo")
_CGROUP = Path("/sys/fs/cgroup")
#: The interpreter with numpy and the kernels.
_BASE_BYTES = 60 << 20
#: Samples, then the surface: of 8-bit noise it can take several times the samples.
_PER_CONTENT_BYTE = 4


def processors() -> int:
    """The processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_one_heap() -> None:
    """Let all threads take memory from one heap, so that what one of them frees is there for the others.

    For a process of our own: it holds for all libraries in it. Nothing where the C library has no such setting.
    """
    from isocore import _kernels  # late: most of what asks for free memory needs none of it

    _kernels.share_one_heap()


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


def estimated_bytes(content_bytes: int) -> int:
    """A generous guess at the peak of a job whose input is so long when it is unpacked."""
    return _BASE_BYTES + _PER_CONTENT_BYTE * content_bytes


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
