"""Pockets: room in a body that a stop of two others would meet while it folds.

A stop that reaches further from its axis than the stack is high enters the base that folds down on it. What it takes
there at the instants of the fold, with a gap all around, is cut from that base as a box. Where little would be left
beside the box, it goes too: a pocket that almost passes through a plate passes through it. No pocket is cut where a
hinge is.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.shapes import Shape, box
from foldfab.fabrication.solids import Solid
from foldfab.geometry.arrays import Array

SKIN = 0.8
"""A wall thinner than this beside a pocket is not left standing, mm."""
BEYOND = 0.1
"""How far a pocket is cut beyond a face that it opens, mm."""
ROUNDING = 1e-3
"""A wall is as thick as it should be to this, mm."""

Corners = tuple[Array, Array]
"""Lower and upper corner (3,), mm."""


def pocket(body: Solid, taken: Corners, gap: float, hinges: Iterable[Corners]) -> Shape | None:
    """What is cut from a body for what is `taken` from it by another one; None where a hinge is in its way.

    All in the frame of the body.
    """
    low, high = taken[0] - gap, taken[1] + gap
    opened = [_is_thin(body, low, high, axis, way) for axis in range(3) for way in (-1, 1)]
    low = low - np.where(opened[0::2], SKIN + BEYOND, 0.0)
    high = high + np.where(opened[1::2], SKIN + BEYOND, 0.0)
    if any(bool((low < end).all() and (start < high).all()) for start, end in hinges):
        return None
    return box(low, high)


def _is_thin(body: Solid, low: Array, high: Array, axis: int, way: int) -> bool:
    """Whether the wall beside a box, on one side of it, is thinner than `SKIN`."""
    start, end = low.copy(), high.copy()
    if way > 0:
        start[axis], end[axis] = high[axis], high[axis] + SKIN
    else:
        start[axis], end[axis] = low[axis] - SKIN, low[axis]
    wall = solids.within(body, start, end)
    if wall.is_empty():
        return False
    reach = solids.bounds(wall)
    return bool(reach[1][axis] < end[axis] - ROUNDING if way > 0 else reach[0][axis] > start[axis] + ROUNDING)
