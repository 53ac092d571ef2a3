"""Seams: the line along which a part is cut that is longer than the bed, and the tongues that hold its pieces together.

Tongues lie in the plane of the plate and go through all of it, so that pieces print flat without overhangs and are
pressed into each other from above; pulled along the part they hold.

- *dovetail*: its flanks widen by 1 in 2 on either side; as many as there is width for.
- *splice*: where a plate is too narrow for that, two halves side by side that hook into each other (a hooked scarf).

Frame of a seam: x along the line, y through the plate, z across the line; lengths in mm. Between the pieces there is
the same gap everywhere, half the clearance of hinges: FDM parts with 0.1 to 0.2 mm are pressed together and stay.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.solids import Outline
from foldfab.geometry.arrays import Array

FIT_SHARE, LEAST_FIT = 0.5, 0.1
"""The gap of a seam as a share of the clearance, and the least that printers leave, mm."""
SLOPE = 0.5
"""By how much each flank of a dovetail goes out over its depth."""
LEAST_HEAD, MOST_HEAD = 4.8, 16.0
"""Width of a dovetail at its far end, mm: the least leaves a neck of 2.4 mm, six lines of a 0.4 mm nozzle."""
HEAD_SHARE = 0.4
"""The same as a share of the width that a tongue has for itself."""
SPACING = 45.0
"""A tongue for so much of the width, mm."""
WALL = 1.2
"""Least wall beside a socket, three lines, mm."""
LEAST_SPLICE = 4.0
"""Least width of a part that is spliced, mm: two halves of four lines each."""
HOOK_SHARE = 0.2
"""How far the halves of a splice hook into each other, as a share of its width."""
SPLICE_LENGTH, MOST_REACH = 2.0, 10.0
"""Length of a splice: so many widths, at most so many mm, which is more than any tongue reaches."""
SUNK = 1.0
"""How far tongues begin inside of their piece, mm: bodies that should be one overlap."""
BEYOND = 10.0
"""How far lines go on beyond a part, mm."""

Kind = Literal["dovetail", "splice"]
Line = tuple[tuple[float, float], ...]
"""Corners (x, z), mm."""


@dataclass(frozen=True, slots=True)
class Tongue:
    """What one piece reaches across the seam with."""

    kind: Kind
    outline: Line
    span: tuple[float, float]
    """The width that has to be plain plate: the tongue, and the walls beside its socket."""
    middle: float
    """x that lies within the tongue at its far end, mm."""
    reach: float
    """How far it reaches across the line, mm."""


def fit_of(clearance: float) -> float:
    """The gap between the pieces of a part, mm, where hinges are printed with `clearance`."""
    return max(LEAST_FIT, FIT_SHARE * clearance)


def tongues(low: float, high: float, at: float, fit: float) -> tuple[Tongue, ...]:
    """The tongues on a line at z = `at` across a plate between two x; none where it is too narrow for any."""
    width = high - low
    if width >= LEAST_HEAD + 2 * (WALL + fit):
        count = max(1, int(width // SPACING))
        share = width / count
        return tuple(_dovetail(low + (i + 0.5) * share, share, at, fit) for i in range(count))
    return (_splice(low, high, at, fit),) if width >= LEAST_SPLICE else ()


def parted(own: tuple[Tongue, ...], at: float, fit: float, bounds: tuple[Array, Array]) -> tuple[Line, Line]:
    """What the piece with the tongues, below the line, has cut away, and what the other one has.

    `bounds` are the lower and upper corner (2,), x and z, of the part.
    """
    low, high = bounds[0] - BEYOND, bounds[1] + BEYOND
    under = _rectangle(low, np.array([high[0], at]))
    for tongue in own:
        under = under + solids.covered(np.array([tongue.outline]))
    over = _rectangle(low, high) - under
    return _line(over), _line(solids.grown(under, fit))


def _dovetail(middle: float, share: float, at: float, fit: float) -> Tongue:
    head = float(np.clip(HEAD_SHARE * share, LEAST_HEAD, MOST_HEAD))
    depth = head / 2
    neck = head - 2 * SLOPE * depth
    right = ((neck / 2, at - SUNK), (neck / 2, at), (head / 2, at + depth))
    outline = tuple((middle + x, z) for x, z in right) + tuple((middle - x, z) for x, z in reversed(right))
    reach = head / 2 + fit + WALL
    return Tongue("dovetail", outline, (middle - reach, middle + reach), middle, depth)


def _splice(low: float, high: float, at: float, fit: float) -> Tongue:
    """The half at lower x belongs to the piece below the line, and hooks into the other one at its end."""
    width, middle = high - low, (low + high - fit) / 2
    hook, length = HOOK_SHARE * width / 2, min(SPLICE_LENGTH * width, MOST_REACH)
    out = low - fit - LEAST_FIT
    right = ((middle - hook, at - SUNK), (middle - hook, at + length / 2), (middle + hook, at + length / 2))
    outline = (*right, (middle + hook, at + length), (out, at + length), (out, at - SUNK))
    return Tongue("splice", outline, (low, high), (low + middle) / 2, length)


def _rectangle(low: Array, high: Array) -> Outline:
    return solids.rectangle((low + high) / 2, high - low)


def _line(outline: Outline) -> Line:
    (ring,) = outline.to_polygons()
    return tuple((float(x), float(z)) for x, z in ring)
