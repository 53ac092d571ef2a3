"""Pockets: room in a body that a stop of two others would meet while it folds.

A stop that reaches further from its axis than the stack is high enters what folds down on it. What it takes there at
the instants of the fold, with a gap all around, is cut out as a box along the body's plate. Where little would be left
beside the box, it goes too: a pocket that almost passes through a plate passes through it. No pocket is cut where a
hinge is.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.places import Plane
from foldfab.fabrication.shapes import Shape, box, placed
from foldfab.fabrication.solids import Solid
from foldfab.geometry.arrays import Array

SKIN = 0.8
"""A wall thinner than this beside a pocket is not left standing, mm."""
BEYOND = 0.1
"""How far a pocket is cut beyond a face that it opens, mm."""
ROUNDING = 1e-3
"""A wall is as thick as it should be to this, mm."""


def pocket(body: Solid, plane: Plane, taken: Iterable[Solid], gap: float, hinges: Iterable[Array]) -> Shape | None:
    """What is cut from a body with its plate in a plane for what others take from it; None where a hinge is in the way.

    `hinges` are the corners (n, 3) of each that the body has.
    """
    corners = [solids.bounds(plane.laid(piece)) for piece in taken]
    low = np.min([c[0] for c in corners], axis=0) - gap
    high = np.max([c[1] for c in corners], axis=0) + gap
    laid = plane.laid(body)
    opened = np.array([[_is_thin(laid, low, high, axis, way) for axis in range(3)] for way in (-1, 1)])
    low = low - np.where(opened[0], SKIN + BEYOND, 0.0)
    high = high + np.where(opened[1], SKIN + BEYOND, 0.0)
    for points in map(plane.local, hinges):
        if bool((low < points.max(axis=0)).all() and (points.min(axis=0) < high).all()):
            return None
    return placed(box(low, high), plane.origin, plane.across)


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
