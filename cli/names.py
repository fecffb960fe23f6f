"""Names of files on stdout and stderr, also those that are not UTF-8 and those that the locale cannot spell.

The system's names are bytes; Python keeps those that it cannot decode as lone surrogates (PEP 383), which print
refuses. stdout gets the bytes back, so that whoever reads it finds the file; stderr shows them:
`M\\xfcller.nii`.
"""

from __future__ import annotations

import codecs
import io
import sys

_FIRST_BYTE = 0xDC00
_STRAY_BYTES = range(0xDC80, 0xDD00)


def speak_any_name() -> None:
    """Let both streams of this process take any text."""
    codecs.register_error("isocore.bytes", _as_bytes)
    codecs.register_error("isocore.shown", _as_shown)
    for stream, errors in ((sys.stdout, "isocore.bytes"), (sys.stderr, "isocore.shown")):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=errors)


def _as_bytes(error: UnicodeError) -> tuple[str | bytes, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    code = ord(error.object[error.start])
    if code in _STRAY_BYTES:
        return bytes([code - _FIRST_BYTE]), error.start + 1
    return _as_shown(error)


def _as_shown(error: UnicodeError) -> tuple[str | bytes, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    code = ord(error.object[error.start])
    text = chr(code).encode("ascii", "backslashreplace").decode()
    return f"\\x{code - _FIRST_BYTE:02x}" if code in _STRAY_BYTES else text, error.start + 1
