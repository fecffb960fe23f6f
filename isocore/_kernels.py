"""The compiled kernels, in the widest instruction set that is installed and that this processor runs.

All builds come from the same sources without fused multiply-add, so they give the same bytes. ISOCORE_KERNELS=base or
v3 asks for one by name. `BUILD` says which it is; ISOCORE_ISA chose, when isocore was built, which there are.
"""

# ruff: noqa: F403
import os
from importlib.util import find_spec

if not find_spec("isocore._processor"):  # where Python looks first into the folder that it was started in
    todo = "start Python elsewhere, or as `python -P`, once isocore is installed"
    raise ImportError(f"{__file__}: here are isocore's sources, without compiled kernels; {todo}", name=__name__)

from isocore import _processor

#: The builds there may be, best first.
_BUILDS = ("v3", "base")


def _choose(installed: list[str], runs_v3: bool, asked: str) -> str:
    """The build to load, of those installed. ImportError if none will do, with the way out."""
    usable = [build for build in installed if build != "v3" or runs_v3]
    if asked and asked not in usable:
        reason = "this processor lacks AVX2" if asked in installed else "it was not built"
        raise ImportError(f"ISOCORE_KERNELS={asked}: {reason}; there is: {', '.join(usable) or 'none'}", name=__name__)
    if not usable:
        why = "for processors with AVX2 alone, which this one lacks" if installed else "without kernels"
        raise ImportError(f"isocore was built {why}; install it again, with ISOCORE_ISA=all", name=__name__)
    return asked or usable[0]


BUILD = _choose(
    [build for build in _BUILDS if find_spec(f"isocore._kernels_{build}")],
    _processor.supports_v3(),
    os.environ.get("ISOCORE_KERNELS", ""),
)
if BUILD == "v3":
    from isocore._kernels_v3 import *
else:
    from isocore._kernels_base import *
