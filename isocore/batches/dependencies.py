"""The files that an input consists of: a detached header and its data, a raw file and its sidecar."""

from __future__ import annotations

from pathlib import Path

from isocore.readers import suffix_of

_HEADER_BYTES = 65536


def files_of(source: Path) -> tuple[Path, ...]:
    """The source first, then what lies beside it and belongs to it."""
    suffix = suffix_of(source)
    if suffix == ".nhdr":
        return (source, *_named_by(source))
    if suffix in (".hdr", ".hdr.gz", ".img", ".img.gz"):
        assert suffix is not None
        stem = source.name[: -len(suffix)]
        others = (".img", ".img.gz") if suffix.startswith(".hdr") else (".hdr", ".hdr.gz")
        return (source, *(path for other in others if (path := source.with_name(stem + other)).exists()))
    if suffix in (".raw", ".raw.gz"):
        names = (source.name + ".json", source.name.removesuffix(".gz") + ".json")
        sidecars = dict.fromkeys(source.with_name(name) for name in names)
        return (source, *(path for path in sidecars if path.exists()))
    return (source,)


def _named_by(header: Path) -> tuple[Path, ...]:
    """The data files that an NRRD header names; those of a numbered pattern are found by its shape."""
    try:
        with header.open("rb") as stream:
            lines = stream.read(_HEADER_BYTES).decode("latin-1").splitlines()
    except OSError:
        return ()
    for number, line in enumerate(lines):
        key, _, value = line.partition(":")
        if key.strip().lower() not in ("data file", "datafile"):
            continue
        value = value.strip()
        if value.upper().startswith("LIST"):
            names = [item.strip() for item in lines[number + 1 :] if item.strip()]
        elif "%" in value:
            return tuple(sorted(header.parent.glob(value.split()[0].split("%")[0] + "*")))
        else:
            names = [value]
        return tuple(path for name in names if (path := header.parent / name).exists())
    return ()
