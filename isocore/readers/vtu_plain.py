"""Write XML plainly where the tag scan does not follow it: UTF-16, CDATA, entities, comments among the numbers."""

from __future__ import annotations

from io import BytesIO
from mmap import mmap
from xml.parsers import expat
from xml.sax.saxutils import escape, quoteattr

from isocore.errors import InputError


def plain(path: str, data: mmap | bytes) -> bytes:
    """The same tags and texts in UTF-8, without comments. Raises InputError where it is no XML."""
    out = BytesIO()
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: dict[str, str]) -> None:
        given = "".join(f" {name}={quoteattr(value)}" for name, value in attributes.items())
        out.write(f"<{tag}{given}>".encode())

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: out.write(f"</{tag}>".encode())
    parser.CharacterDataHandler = lambda text: out.write(escape(text).encode())
    try:
        parser.Parse(data[:], True)
    except expat.ExpatError as error:
        raise InputError(
            f"{path}: its XML is broken near line {error.lineno:,} ({expat.ErrorString(error.code)}); copy it again"
        ) from error
    return out.getvalue()
