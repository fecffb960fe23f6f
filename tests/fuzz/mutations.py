"""Damage by structure: to bytes, to the fields of a binary header, to lines of text, tags, JSON trees, packed content.

A mutator is a function (random, content) -> content. Each format chains those that know its structure, so that damage
gets past the first check and meets the ones behind it.
"""

from __future__ import annotations

import base64
import bz2
import gzip
import json
import re
import struct
import zlib
from collections.abc import Callable, Sequence
from functools import cache
from random import Random
from typing import Any

Mutator = Callable[[Random, bytes], bytes]

WHOLE = (
    0, 1, -1, 2, 3, 4, 5, 7, 8, 10, 12, 14, 16, 17, 42, 71, 72, 127, 128, 255, 256, 348, 540, 32767, 32768, 65535,
    65536, 100_000, 2**24 + 1, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**40, 2**53 + 1, 2**63 - 1, 2**63, 2**64, 10**20,
)  # fmt: skip
REAL = (
    0.0, -0.0, 1.0, -1.0, 0.5, 1e-45, 1e-310, 1e30, -3.4e38, 1e39, 1e154, 1e308, -1.8e308, 1e400, -1e400, float("nan"),
)  # fmt: skip
WORDS = (
    "", " ", "-", "nan", "inf", "-inf", "none", "1e999", "9" * 30, "9" * 5000, "0x10", "1_000", "\u0661", "1.5", "+3",
    "1d5",
    "1.#QNAN", "(1,0,0)", "(nan,nan,nan)", "()", "((", "[", "{", "%d", "%s%n", "LIST", "raw", "gzip", "bzip2", "ascii",
    "hex", "big", "little", "uint8", "float64", "block", "x" * 400, "a\tb", "a\x1b[31mb", "\x00", "\x85", "\u202e",
    "\u00b5m", "\ud800", "../../etc", "/dev/zero", "=1+1", "]]>", "&amp;", "<", ">", '"', "'", "\\", ":=", "#",
)  # fmt: skip
_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_]\w*")
_ATTRIBUTE = re.compile(rb"(\w+)=(\"[^\"]*\"|'[^']*')")
_TAG = re.compile(rb"<[^<>]{1,300}>")
_BASE64 = re.compile(rb">\s*([A-Za-z0-9+/]{8,}={0,2}(?:[A-Za-z0-9+/]+={0,2})?)\s*<")
_BOMB_BYTES = 1 << 24


def number_text(random: Random) -> bytes:
    """A number as text, likely one that nobody expected."""
    if random.random() < 0.6:
        return str(random.choice(WHOLE)).encode()
    return repr(random.choice(REAL)).encode() if random.random() < 0.7 else word(random)


def word(random: Random) -> bytes:
    """A word as text."""
    return random.choice(WORDS).encode("utf-8", "surrogatepass")


def damaged_bytes(random: Random, content: bytes) -> bytes:
    """One change that knows nothing of the format."""
    at = random.randrange(len(content) + 1)
    size = random.choice((1, 1, 2, 4, 8, 16, 64, 300))
    match random.randrange(9):
        case 0 | 1:
            if at == len(content):
                return content + bytes([random.randrange(256)])
            return content[:at] + bytes([content[at] ^ 1 << random.randrange(8)]) + content[at + 1 :]
        case 2:
            filling = random.choice((b"\0", b"\xff", b"\x7f", b"\x80", b" ", b"\n")) * size
            return content[:at] + filling + content[at + size :]
        case 3:
            return content[:at] + content[at + size :]
        case 4:
            return content[:at] + random.randbytes(size) + content[at:]
        case 5:
            return content[:at]
        case 6:
            other = random.randrange(len(content) + 1)
            return content[:at] + content[other : other + size] + content[at:]
        case 7:
            return content + random.choice((bytes(size), random.randbytes(size), content, b"\r\n"))
        case _:
            kind = random.choice("bBhHiIqQ") if random.random() < 0.7 else random.choice("fd")
            packed = packed_number(random, random.choice("<>"), kind)
            return content[:at] + packed + content[at + len(packed) :]


def packed_number(random: Random, order: str, kind: str) -> bytes:
    """A number of a struct's kind, cut to what it can hold."""
    size = struct.calcsize(f"={kind}")
    if kind in "fd":
        number = random.choice(REAL + WHOLE)
        try:
            return struct.pack(order + kind, float(number))
        except OverflowError:
            return struct.pack(order + kind, float("inf"))
    return (random.choice(WHOLE) % (1 << 8 * size)).to_bytes(size, "little" if order == "<" else "big")


def of_fields(fields: Sequence[tuple[int, str]], order: str) -> Mutator:
    """Damage to one field of a header. fields: offset and struct's kind of each number, in bytes."""

    def mutate(random: Random, content: bytes) -> bytes:
        at, kind = random.choice(fields)
        packed = packed_number(random, order, kind)
        return content[:at] + packed + content[at + len(packed) :]

    return mutate


def _one(random: Random, pattern: re.Pattern[bytes], content: bytes) -> re.Match[bytes] | None:
    """One of the matches, or None."""
    start = random.randrange(len(content)) if content else 0
    return pattern.search(content, start) or pattern.search(content)


def damaged_text(random: Random, content: bytes) -> bytes:
    """One change to lines, numbers and words; `content` may go on in binary."""
    kind = random.randrange(8)
    if kind < 4:
        found = _one(random, _NUMBER if kind < 3 else _WORD, content)
        if found:
            return content[: found.start()] + (number_text if kind < 3 else word)(random) + content[found.end() :]
    lines = content.split(b"\n")
    at, other = random.randrange(len(lines)), random.randrange(len(lines))
    if kind == 4:
        del lines[at]
    elif kind == 5:
        lines.insert(at, lines[other])
    elif kind == 6:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        name, colon, value = lines[at].partition(b":")
        lines[at] = name + colon + random.choice((b" ", b"")) + random.choice((word, number_text))(random) + value[:20]
    return b"\n".join(lines)


def damaged_numbers(random: Random, content: bytes) -> bytes:
    """One number of a text exchanged."""
    found = _one(random, _NUMBER, content)
    return content[: found.start()] + number_text(random) + content[found.end() :] if found else content


def damaged_xml(random: Random, content: bytes) -> bytes:
    """One change to an attribute or a tag."""
    kind = random.choice((0, 0, 1, 1, 2, 2, 3, 4, 5, 6))
    found = _one(random, _ATTRIBUTE if kind < 4 else _TAG, content)
    if found is None:
        return damaged_text(random, content)
    if kind < 4:
        other = _one(random, _ATTRIBUTE, content) or found
        value = (number_text(random), word(random), other[2][1:-1], found[2][1:-1] + b"0")[kind]
        new = found[1] + b'="' + value.replace(b'"', b"") + b'"' if random.random() < 0.9 else b""
        return content[: found.start()] + new + content[found.end() :]
    other = _one(random, _TAG, content) or found
    new = (b"", found[0] * 2, other[0])[kind - 4]
    return content[: found.start()] + new + content[found.end() :]


def damaged_base64(random: Random, content: bytes) -> bytes:
    """One change to the bytes behind a run of base64 letters."""
    found = _one(random, _BASE64, content)
    if found is None:
        return damaged_bytes(random, content)
    try:
        inner = base64.b64decode(found[1])
    except ValueError:
        return damaged_bytes(random, content)
    new = base64.b64encode(damaged_bytes(random, inner))
    return content[: found.start(1)] + new + content[found.end(1) :]


def _json_value(random: Random, value: Any) -> Any:
    """Something else in its place."""
    match random.randrange(8):
        case 0:
            return random.choice(WHOLE)
        case 1:
            return random.choice(REAL)
        case 2 | 3:
            return random.choice(WORDS)
        case 4:
            return random.choice((None, True, False, [], {}, [[]], {"": {}}))
        case 5:
            return [value, value]
        case 6:
            return {"source": value}
        case _:
            return str(value)


def _containers(tree: Any) -> list[Any]:
    """Every object and list of a JSON tree that is not empty; objects twice, since lists are long and alike."""
    if not isinstance(tree, (dict, list)) or not tree:
        return []
    found = [tree, tree] if isinstance(tree, dict) else [tree]
    for value in list(tree.values() if isinstance(tree, dict) else tree):
        found += _containers(value)
    return found


def _spot(random: Random, containers: list[Any]) -> tuple[Any, Any]:
    """A place in one of them: the container and the key."""
    container = random.choice([one for one in containers if one] or [[0]])
    return container, random.choice(list(container) if isinstance(container, dict) else range(len(container)))


def damaged_json(random: Random, content: bytes) -> bytes:
    """One change to the tree of a JSON text, or to its bytes."""
    if random.random() < 0.2:
        return random.choice((damaged_bytes, damaged_text))(random, content)
    try:
        tree = json.loads(content)
        containers = _containers(tree)
    except (ValueError, RecursionError):
        return damaged_bytes(random, content)
    if not containers:
        return json.dumps(_json_value(random, tree)).encode()
    container, key = _spot(random, containers)
    match random.randrange(10):
        case 0:
            del container[key]
        case 1 if isinstance(container, dict):
            container[random.choice(WORDS)] = container[key]
        case 2 if isinstance(container, list):
            container.insert(key, container[key])
        case 3:
            other, its_key = _spot(random, containers)
            container[key] = other[its_key]
        case 4 if random.random() < 0.05:
            return b"[" * 100_000 + content
        case _:
            container[key] = _json_value(random, container[key])
    try:
        return json.dumps(tree).encode()
    except (ValueError, RecursionError):  # it holds itself now
        return damaged_bytes(random, content)


def gzipped(content: bytes) -> bytes:
    """Quickly, and without a time."""
    return gzip.compress(content, 1, mtime=0)


def bzipped(content: bytes) -> bytes:
    """Quickly."""
    return bz2.compress(content, 1)


@cache
def _bomb(pack: Callable[[bytes], bytes]) -> bytes:
    return pack(bytes(_BOMB_BYTES))


def within(packing: str, inner: Mutator) -> Mutator:
    """Damage behind the packing, in front of it, or to it: checksums then hold or do not; or too much content."""
    pack = {"gzip": gzipped, "bzip2": bzipped}[packing]
    unpack = {"gzip": gzip.decompress, "bzip2": bz2.decompress}[packing]

    bomb = _bomb(pack)

    def mutate(random: Random, content: bytes) -> bytes:
        kind = random.randrange(12)
        if content.endswith(bomb):  # once is enough
            return content
        if kind < 4:
            return damaged_bytes(random, content)
        try:
            plain = unpack(content)
        except (OSError, EOFError, ValueError, zlib.error):
            return damaged_bytes(random, content)
        if kind < 9:
            return pack(inner(random, plain))
        at = random.randrange(len(plain) + 1)
        if kind == 9:
            return pack(plain[:at]) + random.choice((b"", bytes(random.randrange(20)))) + pack(plain[at:])
        if kind == 10:
            return content + random.choice((bytes(700), random.randbytes(9), pack(b""), pack(plain)[:-3], b"\x1f\x8b"))
        return content + bomb if random.random() < 0.02 else content

    return mutate


def some(*mutators: Mutator) -> Mutator:
    """One of them, or a chain of a few."""

    def mutate(random: Random, content: bytes) -> bytes:
        for _ in range(1 + min(3, int(random.expovariate(1.2)))):
            content = random.choice(mutators)(random, content)
        return content

    return mutate
