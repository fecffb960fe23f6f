"""Open a file in VTK's XML format: its tags read, and none of its numbers."""

from __future__ import annotations

from contextlib import suppress

from isocore.errors import InputError
from isocore.readers.vtu_arrays import ArrayReader
from isocore.readers.vtu_file import StoredFile
from isocore.readers.vtu_layout import UNSTRUCTURED, UnusualLayout, scan
from isocore.readers.vtu_plain import plain


def opened(path: str, kind: str = UNSTRUCTURED) -> ArrayReader:
    """What reads the file's arrays, and its layout. Raises InputError where its tags are not what they should be.

    Appended arrays stay on the disk until they are read. Where the tags are not all at the beginning the whole file is
    read; where the scan does not follow them they are written plainly first.
    """
    file = StoredFile(path)
    try:
        reader = _opened(path, file, kind)
    except BaseException:
        file.close()
        raise
    if reader.file is None:
        file.close()
    return reader


def _opened(path: str, file: StoredFile, kind: str) -> ArrayReader:
    head = bytes(file.read(0, 64))
    if not head:
        raise InputError(f"{path}: is empty; copy it again")
    if head.startswith(b"# vtk DataFile"):
        raise InputError(f"{path}: is a legacy VTK file under the suffix of an XML one; convert it to .vtu")
    data = file.tags()
    if len(data) < file.size:
        with suppress(UnusualLayout, InputError):  # what looked like the appended data was a text or a comment
            layout = scan(path, data, kind)
            if layout.appended is not None:
                return ArrayReader(path, data[: layout.appended[1]], layout, file)
        data = file.all()
    try:
        return ArrayReader(path, data, scan(path, data, kind))
    except UnusualLayout:
        data = plain(path, data)
    try:
        return ArrayReader(path, data, scan(path, data, kind))
    except UnusualLayout as unusual:  # tags among the numbers
        raise InputError(f"{path}: {unusual}; write it again") from unusual
