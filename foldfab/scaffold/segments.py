"""Each part as an oriented box in the canonical frame, and what it can be: a base patch or a foldable patch.

Section 5.1: a part whose medial sheet is perpendicular to d is a base candidate, and so is a rod whose axis is;
every other part folds. Of a rod's two planes the one is taken whose hinge direction is perpendicular to d.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes
from foldfab.geometry.rotation import cross
from foldfab.recipe.model import Recipe
from foldfab.scaffold.frame import canonical

ROD_RATIO = 3.0
"""A part is a rod where its longest side is this many times the middle one, and the middle one not a sheet's."""
PLATE_TILT = np.radians(26.0)
"""A plate this close to perpendicular to d still counts as perpendicular (slightly tilted seats)."""
ROD_TILT = np.radians(8.0)
"""The same for a rod's axis."""
SQUARE = 1e-3
"""A rod whose sides differ by less than this share is square: its sheet faces along y, and no noise decides."""
FILLING = 1.6
"""A board whose bounding rectangle is this many times its own face leans within its plane."""
ALL_BUT_ZERO = 1e-4
"""Components of axes below this are errors of the file: 0.1 mm over a metre."""
GRID_DIGITS = 3
"""Places and sizes stand on a grid of 1 µm in print: faces are flush, or far enough apart for the solid kernel."""
UPRIGHT = 1e-6
"""Sine of the tilt below which a rod stands upright."""

VERTICAL = np.array([0.0, 0.0, 1.0])
"""-d in the canonical frame."""


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
    """All parts of the recipe in the canonical frame, scaled to print millimetres, sorted by name."""
    parts = sorted(recipe.parts, key=lambda part: part.name)
    turn = canonical(recipe, direction)
    axes = _settled(np.array([part.axes for part in parts]) @ turn.T)
    half = _on_grid(scale * np.array([part.size for part in parts]) / 2)
    center = _on_grid(((scale * turn) @ np.array([part.center for part in parts])[:, :, None])[:, :, 0])
    level = _are_perpendicular(axes, half).tolist()
    found = zip(parts, center, axes, half, level, strict=True)
    return tuple(Segment(part.name, c, a, h, part.hingeable, is_base) for part, c, a, h, is_base in found)


def as_boxes(many: tuple[Segment, ...]) -> Boxes:
    """The solid boxes of the segments (n,)."""
    return Boxes(np.array([s.center for s in many]), np.array([s.axes for s in many]), np.array([s.half for s in many]))


def sheet(segment: Segment) -> tuple[Array, Array, float, float, float]:
    """The medial sheet of a segment that folds, as a rectangle with horizontal hinge direction.

    A board that leans within its own plane would fill far more of that plane than it is; like a rod it spans its sheet
    with the horizontal across its axis.

    Returns:
        along (3,), up (3,), and the full width, length and thickness in mm: the tight rectangle around the
        part in the plane that contains `along` (perpendicular to d) and rises most steeply.
    """
    thin, middle, long = np.argsort(segment.half, kind="stable")
    if is_rod(segment.half):
        if segment.half[middle] < (1 + SQUARE) * segment.half[thin]:
            thin = max(thin, middle, key=lambda side: abs(segment.axes[side, 1]))
        return _spanned(segment, segment.axes[long], segment.axes[thin])
    found = _spanned(segment, cross(segment.axes[thin], _level(segment.axes[thin])), segment.axes[thin])
    if found[2] * found[3] > FILLING * 4 * segment.half[middle] * segment.half[long]:
        return _spanned(segment, segment.axes[long], segment.axes[thin])
    return found


def slope(segment: Segment) -> float:
    """How much higher one end of its medial sheet is than the other, mm."""
    rise = np.abs(segment.axes[:, 2]) * segment.half
    _, middle, long = np.argsort(segment.half, kind="stable")
    return 2 * float(rise[long] if is_rod(segment.half) else rise[long] + rise[middle])


def is_rod(half: Array) -> bool:
    """Whether a part with these half lengths (3,) is a rod, and not a board."""
    thin, middle, long = sorted(half.tolist())
    return bool(long > ROD_RATIO * middle and middle < ROD_RATIO * thin)


def as_base(segment: Segment) -> Segment:
    """The segment taken as perpendicular to d."""
    return replace(segment, is_base=True)


def is_level(segment: Segment) -> bool:
    """Whether its longest side is perpendicular to d."""
    return bool(abs(segment.axes[int(np.argmax(segment.half)), 2]) < np.sin(ROD_TILT))


def _settled(axes: Array) -> Array:
    """The orthonormal rows (n, 3, 3) with what is all but zero made zero, so that nearly flush faces become flush."""
    small = np.abs(axes) < ALL_BUT_ZERO
    settled = axes.copy()
    for index in np.nonzero((small & (axes != 0)).any((1, 2)))[0]:
        left, _, right = np.linalg.svd(np.where(small[index], 0.0, axes[index]))
        rows = left @ right
        settled[index] = np.where(np.abs(rows) < 1e-12, 0.0, rows)
    return settled


def _on_grid(lengths: Array) -> Array:
    return np.round(lengths, GRID_DIGITS) + 0.0


def _are_perpendicular(axes: Array, half: Array) -> Bools:
    """Whether each part (n,), by its axes (n, 3, 3) and half lengths (n, 3), is perpendicular to d."""
    order = np.argsort(half, axis=1, kind="stable")
    every = np.arange(len(half))
    thin, middle, long = np.sort(half, axis=1).T
    is_rod = (long > ROD_RATIO * middle) & (middle < ROD_RATIO * thin)
    level_rod = np.abs(axes[every, order[:, 2], 2]) < np.sin(ROD_TILT)
    level_plate = np.abs(axes[every, order[:, 0], 2]) > np.cos(PLATE_TILT)
    level: Bools = np.where(is_rod, level_rod, level_plate)
    return level


def _spanned(segment: Segment, axis: Array, normal: Array) -> tuple[Array, Array, float, float, float]:
    """The sheet (as `sheet` returns it) that an axis spans with the horizontal across it; upright, with the one across
    `normal`.
    """
    along = _level(axis) if np.hypot(axis[0], axis[1]) > UPRIGHT else _level(normal)
    up = axis - (axis @ along) * along
    up = up / np.linalg.norm(up) * np.sign(up[2])
    extent = 2 * np.abs(segment.axes @ np.array([along, up, cross(along, up)]).T).T @ segment.half
    return along, up, float(extent[0]), float(extent[1]), float(extent[2])


def _level(direction: Array) -> Array:
    """(3,) the horizontal unit vector across a direction that is not upright, towards +x where it may, else +y."""
    across = cross(VERTICAL, direction)
    unit: Array = across / np.linalg.norm(across)
    lead = unit[0] if abs(unit[0]) > ALL_BUT_ZERO else unit[1]
    return unit if lead > 0 else -unit
