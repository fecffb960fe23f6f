"""Texts for files that must be UTF-8, also where a file's name is not.

The system's names are bytes. Python keeps those that are no UTF-8 as lone surrogates (PEP 383), which no file of text
may hold: JSON gets them as escapes, which Python's own reader turns back into the very name; everything else shows them
as people write such bytes, `M\\xfcller.nii`.
"""

from __future__ import annotations

import json
import re
from typing import Any

_STRAY = re.compile("[\ud800-\udfff]")


def json_text(value: Any, *, indent: int | None = None) -> str:
    """Plain JSON types as JSON that is UTF-8, on one line unless indented. Raises ValueError for NaN."""
    return _STRAY.sub(lambda stray: f"\\u{ord(stray[0]):04x}", _dumped(value, indent))


def shown_json(value: Any) -> str:
    """As json_text, but with texts as `shown` gives them: for those who read and do not look files up."""
    return _STRAY.sub(lambda stray: "\\" + shown(stray[0]), _dumped(value))


def shown(text: str) -> str:
    """The text with its stray bytes as `\\xfc`, and with other lone surrogates as `\\ud800`."""
    return _STRAY.sub(_escape, text)


def _dumped(value: Any, indent: int | None = None) -> str:
    return json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)


def _escape(stray: re.Match[str]) -> str:
    code = ord(stray[0])
    return f"\\x{code - 0xDC00:02x}" if 0xDC80 <= code <= 0xDCFF else f"\\u{code:04x}"
