"""The canonical frame: d = -Z, and x and y along the furniture's own axes, however it stands in its file.

So a copy that is turned, moved or of another size is the same furniture in it, and of solutions that cost the same the
same one is found. Axes are those that the parts' sides face, by area. Which of them is x, and which way, is settled by
the furniture's length and then part by part, in the order of their names, by what tells the quarter turns apart.
"""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.rotation import upright
from foldfab.recipe.model import Recipe

LEVEL = np.sin(np.radians(2.0))
"""A side whose normal rises by less than this sine faces sideways."""
ONE_LINE = np.radians(0.5)
"""Sides whose normals are closer than this face along one line."""
SAME = 1e-3
"""Lengths that differ by less than this share of the furniture's size tell nothing apart, nor do such angles."""
ROUNDING = 1e-9
"""Outlines that differ by less than this share are as large as each other."""
QUARTER = np.pi / 2
_TURNS = np.array([[[1, 0], [0, 1]], [[-1, 0], [0, -1]], [[0, 1], [-1, 0]], [[0, -1], [1, 0]]], dtype=np.float64)
"""Quarter turns of x and y, the identity first."""


def canonical(recipe: Recipe, direction: Array) -> Array:
    """The rotation (3, 3) from the recipe's frame into the canonical one, for a unit `direction` (3,).

    Exact quarter turns where direction and furniture are along the axes.
    """
    parts = sorted(recipe.parts, key=lambda part: part.name)
    turn = upright(direction)
    axes = np.array([part.axes for part in parts]) @ turn.T
    size = np.array([part.size for part in parts])
    yaw = _along(axes, size)
    axes = axes[:, :, :2] @ yaw.T
    center = np.array([part.center for part in parts]) @ turn.T[:, :2] @ yaw.T
    reach = (np.abs(axes) * size[:, :, None] / 2).sum(1)
    return np.vstack([_quarter(center, reach) @ yaw @ turn[:2], turn[2:]])


def straight(recipe: Recipe) -> Array:
    """The rotation (3, 3) about z by which the furniture, upright as in its file, has the smallest outline on the bed.

    Along one of the lines that its sides face, the identity where none makes the outline notably smaller.
    """
    axes, size = np.array([part.axes for part in recipe.parts]), np.array([part.size for part in recipe.parts])
    center = np.array([part.center for part in recipe.parts])[:, :2]
    best, least = np.eye(2), float(np.ptp(_corners(center, axes[..., :2], size), axis=0).prod()) * (1 - SAME)
    lines = axes[np.abs(axes[:, :, 2]) < LEVEL]
    angles = np.arctan2(lines[:, 1], lines[:, 0])
    angles -= QUARTER * np.round(angles / QUARTER)
    for angle in dict.fromkeys(angles[angles != 0].tolist()):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        area = float(np.ptp(_corners(center @ turn.T, axes[..., :2] @ turn.T, size), axis=0).prod())
        if area < least * (1 - ROUNDING):
            best, least = turn, area
    found = np.eye(3)
    found[:2, :2] = best
    return found


def _corners(center: Array, axes: Array, size: Array) -> Array:
    """(2 n, 2) lower and upper corners of the bounds of boxes, in the plane."""
    reach = (np.abs(axes) * size[:, :, None] / 2).sum(1)
    return np.concatenate([center - reach, center + reach])


def _along(axes: Array, size: Array) -> Array:
    """(2, 2) rows: the horizontal line that most area of level sides faces, with that across it, and the one across."""
    level = np.abs(axes[:, :, 2]) < LEVEL
    if not level.any():
        return np.eye(2)
    votes = _votes(axes[level][:, :2], (size.prod(1)[:, None] / size)[level])
    first = int(np.argmax(votes > votes.max() * (1 - SAME)))
    x, y = axes[level][first][:2]
    if min(abs(x), abs(y)) < SAME:
        return np.eye(2)
    x, y = np.array([x, y]) / np.hypot(x, y)
    return np.array([[x, y], [-y, x]])


def _votes(lines: Array, area: Array) -> Array:
    """(n,) of the area (n,) that faces lines (n, 2), what faces each or goes across it, both within `ONE_LINE`."""
    # Four times the angle is the same for both lines of a cross, either way along each.
    angle = 4 * np.arctan2(lines[:, 1], lines[:, 0]) % (2 * np.pi)
    order = np.argsort(angle)
    turns = np.concatenate([angle[order] + around for around in (-2 * np.pi, 0.0, 2 * np.pi)])
    below = np.concatenate([[0.0], np.cumsum(np.tile(area[order], 3))])
    near = (np.searchsorted(turns, angle + side * 4 * ONE_LINE) for side in (1, -1))
    upper, lower = (below[i] for i in near)
    votes: Array = upper - lower
    return votes


def _quarter(center: Array, reach: Array) -> Array:
    """(2, 2) the quarter turn by which the furniture is as long as can be along x, and part by part furthest back.

    Args:
        center: (n, 2) middles of the parts in the order of their names.
        reach: (n, 2) how far they go from there.
    """
    low, high = (center - reach).min(0), (center + reach).max(0)
    size = high - low
    place = (center - (low + high) / 2) @ _TURNS.transpose(0, 2, 1)
    long = reach @ np.abs(_TURNS).transpose(0, 2, 1)
    # (4, 1 + 4 n): the whole, then each part.
    told = np.concatenate([place[:, :, 1:], -place[:, :, :1], long], axis=2).reshape(4, -1)
    features = np.concatenate([(np.abs(_TURNS) @ size)[:, :1], told], axis=1) / size.max()
    left = np.arange(4)
    for column in features.T:
        left = left[column[left] > column[left].max() - SAME]
        if len(left) == 1:
            break
    chosen: Array = _TURNS[left[0]]
    return chosen
