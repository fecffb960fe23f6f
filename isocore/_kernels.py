"""The compiled kernels, in the widest instruction set this processor runs.

Both builds come from the same sources without fused multiply-add, so they give the same bytes.
ISOCORE_KERNELS=base asks for the portable one.
"""

# ruff: noqa: F403
import os

from isocore import _kernels_base

if os.environ.get("ISOCORE_KERNELS") != "base" and _kernels_base.supports_v3():
    from isocore._kernels_v3 import *
else:
    from isocore._kernels_base import *
