"""Numbers as text: enough digits to tell them apart, and to read them back as what they are.

The command line's help reads this file, so it imports nothing.
"""

from __future__ import annotations

#: Digits of a number that people only look at.
USUAL_DIGITS = 6
#: So many tell any two doubles apart.
_MOST_DIGITS = 17


def exact(value: float) -> str:
    """The shortest text that reads back as this very number: 300, 0.1, 101325.00005."""
    return repr(float(value) + 0.0).removesuffix(".0")  # -0 is written as 0, which it equals


def counted(*values: float) -> tuple[str, ...]:
    """Whole numbers in full, with separators; others as legible has them."""
    if all(float(value).is_integer() and abs(value) < 2**53 for value in values):
        return tuple(f"{int(value):,}" for value in values)
    return legible(*values)


def legible(*values: float, digits: int = USUAL_DIGITS) -> tuple[str, ...]:
    """Texts of so many digits, or of as many more as different numbers need to look different."""
    different = len(set(values))
    for count in range(digits, _MOST_DIGITS):
        texts = tuple(f"{value + 0.0:.{count}g}" for value in values)
        if len(set(texts)) == different:
            return texts
    return tuple(exact(value) for value in values)
