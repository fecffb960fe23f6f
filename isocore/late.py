"""Functions whose module is imported when one of them is first called.

A table of formats or methods has a row for each, and a run needs few of them: what it does not call costs it no time.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any


def late(module: str, function: str) -> Callable[..., Any]:
    """The function of that name in `isocore.<module>`, which is imported at the first call."""

    def call(*arguments: Any, **keywords: Any) -> Any:
        return getattr(import_module(f"isocore.{module}"), function)(*arguments, **keywords)

    return call
