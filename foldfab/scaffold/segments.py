"""Each part as an oriented box in the canonical frame, and what it can be: a base patch or a foldable patch.

Section 5.1: a part whose medial sheet is perpendicular to d is a base candidate, and so is a rod whose axis is;
every other part folds. Of a rod's two planes the one is taken whose hinge direction is perpendicular to d.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes
from foldfab.geometry.rotation import upright
from foldfab.recipe.model import Part, Recipe

ROD_RATIO = 3.0
"""A part is a rod where its longest side is this many times the middle one, and the middle one not a sheet's."""
PLATE_TILT = np.radians(26.0)
"""A plate this close to perpendicular to d still counts as perpendicular (slightly tilted seats)."""
ROD_TILT = np.radians(8.0)
"""The same for a rod's axis."""
UPRIGHT = 1e-6
"""Sine of the tilt below which a rod stands upright."""


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """One part in the canonical frame at print scale."""

    name: str
    center: Array
    """(3,) mm."""
    axes: Array
    """(3, 3) orthonormal rows."""
    half: Array
    """(3,) half lengths, mm."""
    hingeable: bool
    is_base: bool
    """Whether it is perpendicular to d."""

    @property
    def thickness(self) -> float:
        """Its smallest side, mm."""
        return 2 * float(self.half.min())


def segments(recipe: Recipe, direction: Array, scale: float) -> tuple[Segment, ...]:
    """All parts of the recipe, turned so that d = -Z and scaled to print millimetres, sorted by name."""
    turn = upright(direction)
    made = [_segment(part, turn, scale) for part in recipe.parts]
    return tuple(sorted(made, key=lambda s: s.name))


def as_boxes(many: tuple[Segment, ...]) -> Boxes:
    """The solid boxes of the segments (n,)."""
    return Boxes(np.array([s.center for s in many]), np.array([s.axes for s in many]), np.array([s.half for s in many]))


def sheet(segment: Segment) -> tuple[Array, Array, float, float, float]:
    """The medial sheet of a segment that folds, as a rectangle with horizontal hinge direction.

    Returns:
        along (3,), up (3,), and the full width, length and thickness in mm: the tight rectangle around the
        part in the plane that contains `along` (perpendicular to d) and rises most steeply.
    """
    along = _hinge_direction(segment)
    up = _rising(segment, along)
    normal = np.cross(along, up)
    extent = 2 * np.abs(segment.axes @ np.stack([along, up, normal]).T).T @ segment.half
    return along, up, float(extent[0]), float(extent[1]), float(extent[2])


def _segment(part: Part, turn: Array, scale: float) -> Segment:
    axes, half = part.axes @ turn.T, scale * part.size / 2
    return Segment(part.name, scale * turn @ part.center, axes, half, part.hingeable, _is_perpendicular(axes, half))


def _is_perpendicular(axes: Array, half: Array) -> bool:
    thin, _, long = np.argsort(half, kind="stable")
    if _is_rod(half):
        return bool(abs(axes[long, 2]) < np.sin(ROD_TILT))
    return bool(abs(axes[thin, 2]) > np.cos(PLATE_TILT))


def _is_rod(half: Array) -> bool:
    thin, middle, long = np.sort(half)
    return bool(long > ROD_RATIO * middle and middle < ROD_RATIO * thin)


def _hinge_direction(segment: Segment) -> Array:
    """(3,) horizontal: along the sheet of a plate; across the axis of a rod, of which it spans the sheet with it."""
    thin, _, long = np.argsort(segment.half, kind="stable")
    guide = segment.axes[long] if _is_rod(segment.half) else segment.axes[thin]
    along = np.cross([0.0, 0.0, 1.0], guide)
    if np.linalg.norm(along) < UPRIGHT:
        # An upright rod folds about its wider side.
        along = np.cross([0.0, 0.0, 1.0], segment.axes[thin])
    unit: Array = along / np.linalg.norm(along)
    return unit


def _rising(segment: Segment, along: Array) -> Array:
    """(3,) the direction in the sheet, perpendicular to `along`, that goes up."""
    thin, _, long = np.argsort(segment.half, kind="stable")
    up = segment.axes[long] if _is_rod(segment.half) else np.cross(segment.axes[thin], along)
    up = up - (up @ along) * along
    unit: Array = up / np.linalg.norm(up) * np.sign(up[2])
    return unit
