"""Numbers as strokes of boxes, to be read on a print: no fonts."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from foldfab.fabrication.shapes import Shape, box, placed
from foldfab.geometry.arrays import Array

STROKE = 0.9
"""Width of a stroke, two lines of a 0.4 mm nozzle, mm."""
WIDTH, HEIGHT = 3.2, 6.0
"""Of a digit, mm."""
SPACE = 0.9
"""Between digits, mm."""

_STROKES = MappingProxyType(
    {
        "a": ((0.0, HEIGHT - STROKE), (WIDTH, HEIGHT)),
        "b": ((WIDTH - STROKE, HEIGHT / 2), (WIDTH, HEIGHT)),
        "c": ((WIDTH - STROKE, 0.0), (WIDTH, HEIGHT / 2)),
        "d": ((0.0, 0.0), (WIDTH, STROKE)),
        "e": ((0.0, 0.0), (STROKE, HEIGHT / 2)),
        "f": ((0.0, HEIGHT / 2), (STROKE, HEIGHT)),
        "g": ((0.0, (HEIGHT - STROKE) / 2), (WIDTH, (HEIGHT + STROKE) / 2)),
    }
)
"""The strokes of a seven-segment digit: lower left and upper right corner, mm."""
_LIT = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgedc", "abc", "abcdefg", "abcdfg")
_DIGITS = MappingProxyType(dict(zip("0123456789", _LIT, strict=True)))


def text_width(text: str) -> float:
    """How wide a number is, mm."""
    return sum(STROKE if letter == "." else WIDTH for letter in text) + SPACE * (len(text) - 1)


def strokes(text: str, low: float, high: float, origin: Array, axes: Array) -> list[Shape]:
    """A number such as `0.25` between two heights, from its lower left corner (3,); rows of `axes`: right, up, out."""
    made, at = [], 0.0
    for letter in text:
        for a, b in _boxes(letter):
            made.append(box((a[0] + at, a[1], low), (b[0] + at, b[1], high)))
        at += (STROKE if letter == "." else WIDTH) + SPACE
    return [placed(stroke, np.asarray(origin), np.asarray(axes)) for stroke in made]


def _boxes(letter: str) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    if letter == ".":
        return [((0.0, 0.0), (STROKE, STROKE))]
    return [_STROKES[name] for name in _DIGITS[letter]]
