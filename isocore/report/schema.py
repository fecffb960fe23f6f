"""What JSON must be to become a record: the types of the records' own fields, so that nothing is listed twice.

Every value is checked here, once, where a report or a stamp is loaded; whoever works with a record may trust its types.
What a record does not know is None: a number that JSON cannot say (NaN, an infinity) was written as null, and a key
that another version of the program did not write is missing.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from isocore.errors import InputError, one_line

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Section = TypeVar("Section", bound="DataclassInstance")

#: Counts are of 64 bits.
_LARGEST = 2**63
#: What nobody lists key by key (facts, tool, host) may be nested so deep.
_DEEPEST = 8
_SHOWN = 40


def parsed(text: str | bytes) -> Any:
    """JSON, strictly. Raises InputError, without a path, for anything else, such as NaN."""
    try:
        return json.loads(text, parse_constant=_refused)
    except RecursionError as error:
        raise InputError("is nested too deeply") from error
    except ValueError as error:
        raise InputError(f"is not JSON ({one_line(error)})") from error


def built(
    kind: type[Section],
    record: Any,
    place: str,
    *,
    given: dict[str, Any] | None = None,
    needed: Collection[str] = (),
    complete: bool = False,
) -> Section:
    """A section out of the keys of its fields; other keys are left out.

    place: of `record` in its file, for messages; "" for all of it. given: values of fields that are no keys of it.
    needed: keys that no version may lack; complete: this version wrote it, so it may lack none.
    Raises InputError, without a path, for a key that is lacking or has a value of another type.
    """
    if not isinstance(record, dict):
        raise _misfit(place, record, "an object")
    values = dict(given or {})
    hints = _hints(kind)
    for item in fields(kind):
        if item.name in values:
            continue
        name, hint = f"{place}.{item.name}".lstrip("."), hints[item.name]
        value = record.get(item.name)
        if value is not None:
            values[item.name] = _fitted(hint, value, name, complete)
        elif item.name in needed or (complete and not _may_be_null(hint, item.name in record)):
            raise InputError(f"lacks {name}")
        elif not _has_default(item):
            values[item.name] = None
    return kind(**values)


def _fitted(hint: Any, value: Any, place: str, complete: bool) -> Any:
    """The value as this type has it."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        (other,) = (part for part in inner if part is not NoneType)
        empty = value is None or (value == {} and is_dataclass(other))  # an empty object stands for no section
        return None if empty else _fitted(other, value, place, complete)
    if origin is Literal:
        if value not in inner:
            raise _misfit(place, value, f"one of {', '.join(map(str, inner))}")
        return value
    if origin is tuple:
        return _tuple(inner, value, place, complete)
    if is_dataclass(hint) and isinstance(hint, type):
        return built(hint, value, place, complete=complete)
    if origin is dict:
        return _free(value, place, dict, 0)
    return _SCALARS[hint](value, place)


def _tuple(inner: tuple[Any, ...], value: Any, place: str, complete: bool) -> tuple[Any, ...]:
    open_end = len(inner) == 2 and inner[1] is ...
    if not isinstance(value, (list, tuple)) or not (open_end or len(value) == len(inner)):
        raise _misfit(place, value, "a list" if open_end else f"a list of {len(inner)}")
    hints = (inner[0],) * len(value) if open_end else inner
    items = enumerate(zip(hints, value, strict=True))
    return tuple(_fitted(hint, item, f"{place}[{n}]", complete) for n, (hint, item) in items)


def _free(value: Any, place: str, kind: type | None, depth: int) -> Any:
    """JSON as it is, if it is finite and not too deep. kind: what it must be."""
    if depth > _DEEPEST:
        raise InputError(f"{place} is nested too deeply")
    if kind is not None and not isinstance(value, kind):
        raise _misfit(place, value, "an object")
    if isinstance(value, dict):
        return {key: _free(item, f"{place}.{_shown(key)}", None, depth + 1) for key, item in value.items()}
    if isinstance(value, list):
        return [_free(item, f"{place}[{n}]", None, depth + 1) for n, item in enumerate(value)]
    if isinstance(value, int) and not isinstance(value, bool):
        return _whole(value, place)
    return _real(value, place) if isinstance(value, float) else value


def _whole(value: Any, place: str) -> int:
    """Also 3.0, as programs write a count that know one kind of number only."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not -_LARGEST <= value < _LARGEST:
        raise _misfit(place, value, "a whole number of at most 64 bits")
    return value


def _real(value: Any, place: str) -> float | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise _misfit(place, value, "a number")
    try:
        real = float(value)
    except OverflowError:
        real = math.inf
    if not math.isfinite(real):
        raise _misfit(place, value, "a finite number")
    return real


def _truth(value: Any, place: str) -> bool:
    if not isinstance(value, bool):
        raise _misfit(place, value, "true or false")
    return value


def _text(value: Any, place: str) -> str:
    if not isinstance(value, str):
        raise _misfit(place, value, "a text")
    return value


_SCALARS: dict[Any, Callable[[Any, str], Any]] = {int: _whole, float: _real, bool: _truth, str: _text}


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _has_default(item: Field[Any]) -> bool:
    return item.default is not MISSING or item.default_factory is not MISSING


def _may_be_null(hint: Any, present: bool) -> bool:
    """Whether a complete record may have no value there."""
    return (hint is float and present) or NoneType in get_args(hint)


def _misfit(place: str, value: Any, wanted: str) -> InputError:
    shown = "null" if value is None else _shown(value)
    return InputError(f"{place or 'the whole'} is {shown}, which is not {wanted}")


def _shown(value: Any) -> str:
    """The start of a value, printable."""
    try:
        text = json.dumps(value)
    except (ValueError, RecursionError):
        text = type(value).__name__
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def _refused(constant: str) -> Any:
    raise ValueError(f"{constant} is no number of JSON")

