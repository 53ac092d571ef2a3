"""Hinges: interleaved cylindrical knuckles of radius K/2 (section 5.6), whatever pins them together.

The knuckles of the *carrier* (the base, or the earlier panel) stand at both ends, those of the *follower* between them.
Knuckles are a gap g apart along the axis. A base hinge's carrier stands on feet; an inserted hinge's knuckles are tied
to their panels by webs. What pins them is a style's affair (`foldfab.fabrication.styles`).

Everything is in the local frame of a panel or a foot: y along the axis, x across, z along the panel or upward.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from foldfab.fabrication.shapes import Shape, box, rod
from foldfab.fabrication.walls import LINE
from foldfab.folding.model import Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES

LONGEST_KNUCKLE = 14.0
"""Hinges get more knuckles rather than longer ones than this, mm."""
MOST_KNUCKLES = 9
"""But not more than this many."""

Mark = tuple[float, float]
"""From where to where along the axis, mm."""


@dataclass(frozen=True, slots=True)
class Knuckles:
    """Extents along the axis of the knuckles of one hinge, mm."""

    carrier: tuple[Mark, ...]
    follower: tuple[Mark, ...]
    pins: tuple[Mark, ...] = ()
    """From the outer face of the first knuckle, where each pin goes in, to that of the last one."""
    free: tuple[Mark, ...] = ()
    """Stretches between them that the hinge leaves free."""

    @property
    def mirrored(self) -> Knuckles:
        """The same, seen in a frame whose y points the other way."""
        marks = (self.carrier, self.follower, self.free)
        carrier, follower, free = (tuple((-b, -a) for a, b in reversed(m)) for m in marks)
        return Knuckles(carrier, follower, tuple((-a, -b) for a, b in reversed(self.pins)), free)


def knuckles(span: Array, thickness: Thickness, breaks: tuple[Mark, ...] = ()) -> Knuckles:
    """An odd number of knuckles over a span (2,), the carrier's at both ends; two such groups where pins are too short.

    A span of the least width gets three; the ends are no narrower than a socket needs. Beside each of the `breaks`
    there is a group; where it would be narrower than that, the hinge ends.
    """
    ends = [float(span[0]), *(float(np.clip(end, *span)) for mark in breaks for end in mark), float(span[1])]
    stretches = [mark for mark in zip(ends[::2], ends[1::2], strict=True) if mark[1] - mark[0] >= thickness.hinge_width]
    if not breaks or not stretches:
        return _row(float(span[0]), float(span[1]), thickness)
    rows = [_row(low, high, thickness) for low, high in stretches]
    free = tuple((a, b) for (_, a), (b, _) in pairwise([(ends[0], ends[0]), *stretches, (ends[-1], ends[-1])]) if b > a)
    pins = tuple(pin for row in rows for pin in row.pins)
    style = STYLES[thickness.hinge]
    if style.has_loose_pin and style.longest is None:
        # One pin goes through all groups, as it does through all knuckles.
        pins = ((pins[0][0], pins[-1][1]),)
    carrier = tuple(mark for row in rows for mark in row.carrier)
    return Knuckles(carrier, tuple(mark for row in rows for mark in row.follower), pins, free)


def _row(low: float, high: float, thickness: Thickness) -> Knuckles:
    longest = STYLES[thickness.hinge].longest
    if longest is None or high - low <= longest:
        return _group(low, high, thickness)
    first = _group(low, low + min(longest, high - low), thickness)
    if high - low < longest + thickness.gap + thickness.hinge_width:
        return first
    size = min(longest, (high - low - thickness.gap) / 2)
    first, last = _group(low, low + size, thickness), _group(-high, size - high, thickness).mirrored
    return Knuckles(first.carrier + last.carrier, first.follower + last.follower, first.pins + last.pins)


def _group(low: float, high: float, thickness: Thickness) -> Knuckles:
    style = STYLES[thickness.hinge]
    low, width = low + style.head, high - low - style.head - style.tip
    count = 3
    while count < MOST_KNUCKLES and width / count > LONGEST_KNUCKLE:
        count += 2
    free = width - (count - 1) * thickness.gap
    inner = 2 * thickness.socket_radius + thickness.socket_width
    carriers, followers = (count + 1) // 2, (count - 1) // 2
    share = free / count
    middle = max(share, inner) if carriers > 2 else 0.0
    pin = max(min(share, free - 2 * thickness.socket_width), style.pin_knuckle)
    end = (free - (carriers - 2) * middle - followers * pin) / 2
    marks, at = [], low
    for i in range(count):
        size = pin if i % 2 else end if i in (0, count - 1) else middle
        size += style.tip if i == count - 1 else 0.0
        marks.append((at, at + size))
        at += size + thickness.gap
    return Knuckles(tuple(marks[::2]), tuple(marks[1::2]), ((marks[0][0], marks[-1][1]),))


def room(marks: tuple[Mark, ...], radius: float, thickness: Thickness, x: float, z: float, span: Mark) -> list[Shape]:
    """What the other part, which reaches over a span, must leave free around knuckles at `marks`."""
    return [rod(radius, a, b, x, z, is_hole=True) for a, b in stretches(marks, thickness.gap, span)]


def stretches(marks: tuple[Mark, ...], gap: float, span: Mark) -> list[Mark]:
    """Knuckles with the gaps beside them, and with what would be left of a span beyond them thinner than a line."""
    low, high = span
    ends = [(a - gap, b + gap) for a, b in marks]
    return [(a - LINE if low < a < low + LINE else a, b + LINE if high - LINE < b < high else b) for a, b in ends]


def webs(marks: tuple[Mark, ...], thickness: Thickness, x: float, z: float, toward: float) -> list[Shape]:
    """Ties between the knuckles of an inserted hinge and their panel, which lies on the `toward` (±1) side in z."""
    near, far = z + toward * thickness.gap / 2, z + toward * thickness.panel / 2
    return [box((min(0.0, x), a, min(near, far)), (max(0.0, x), b, max(near, far))) for a, b in marks]


def feet(hinge: Knuckles, thickness: Thickness, depth: float) -> list[Shape]:
    """Feet of the carrier's knuckles around the axis at the origin, down to `depth` below it."""
    half = thickness.panel / 2
    return [box((-half, a, -depth), (half, b, 0.0)) for a, b in hinge.carrier]
