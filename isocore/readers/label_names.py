"""Names and colours of labels that a label map holds in itself.

NIfTI: the label table of an extension, as Connectome Workbench and TotalSegmentator write it. NRRD: the segments of
Slicer's `.seg.nrrd`, which may lie in several layers.
"""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from isocore.errors import IsocoreError
from isocore.readers.label_tables import Colour, LabelName
from isocore.readers.nifti import extension_texts
from isocore.readers.nrrd_header import remarks

_SEGMENT = re.compile(r"Segment(\d{1,9})_(Name|LabelValue|Color|Layer|ID)")


def names_inside(path: Path, suffix: str, layer: int | None = None) -> dict[int, LabelName]:
    """What the file calls its labels, by their numbers; nothing where it does not say, or cannot be read.

    layer: which volume of several, for segments that lie in layers.
    """
    try:
        if suffix in (".nii", ".nii.gz"):
            return _of_tables(extension_texts(path))
        if suffix in (".nrrd", ".nhdr"):
            return _of_segments(remarks(path), layer)
    except (IsocoreError, OSError, ValueError, OverflowError):
        return {}
    return {}


def _of_tables(texts: list[bytes]) -> dict[int, LabelName]:
    found: dict[int, LabelName] = {}
    for text in texts:
        # A label table declares no entity; whatever does is none.
        if b"<Label" not in text or b"<!DOCTYPE" in text or b"<!ENTITY" in text:
            continue
        try:
            root = ElementTree.fromstring(text.strip(b"\0 \r\n\t"))
        except ElementTree.ParseError:
            continue
        for label in root.iter("Label"):
            key, name = label.get("Key", ""), " ".join((label.text or "").split())
            if re.fullmatch(r"-?\d{1,15}", key) and name:
                colour = _fractions([label.get(part, "") for part in ("Red", "Green", "Blue")])
                found[int(key)] = LabelName(name, colour)
    return found


def _of_segments(remarks: dict[str, str], layer: int | None) -> dict[int, LabelName]:
    segments: dict[str, dict[str, str]] = {}
    for key, value in remarks.items():
        if match := _SEGMENT.fullmatch(key):
            segments.setdefault(match[1], {})[match[2]] = value
    found: dict[int, LabelName] = {}
    for number, segment in segments.items():
        # Before there were layers, segments were numbered from 1 in their order.
        value, name = segment.get("LabelValue", str(int(number) + 1)), segment.get("Name", segment.get("ID", ""))
        own_layer = segment.get("Layer", "0")
        if re.fullmatch(r"-?\d{1,15}", value) and name and (layer is None or own_layer == str(layer)):
            found[int(value)] = LabelName(name, _fractions(segment.get("Color", "").split()))
    return found


def _fractions(texts: list[str]) -> Colour | None:
    """Red, green and blue from 0 to 1."""
    try:
        numbers = [float(text) for text in texts]
    except ValueError:
        return None
    if len(numbers) != 3 or not all(0 <= number <= 1 for number in numbers):
        return None
    red, green, blue = (round(255 * number) for number in numbers)
    return red, green, blue
