"""How far a box is from what it stands for."""

from __future__ import annotations

from itertools import product

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.triangles import to_points
from foldfab.recipe.model import Mesh

_AT_ONCE = 1 << 18
"""Pairs of points and triangles that are compared at once."""
_LOOKED_AT = 1 << 17
"""Triangles that are looked at at once, so that large meshes take little memory."""
_ROUNDING = 1e-9
"""Share of a distance that rounding may have made it too small."""
_GRID = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))


def off_box(mesh: Mesh, center: Array, axes: Array, size: Array) -> float:
    """The greatest distance from the box to the part's surface, mm, over corners and the middles of edges and faces.

    Where a part fills its box it is 0; what is round, bent, open or an L-profile is far from some of them.
    """
    points = center + (_GRID * size / 2) @ axes
    return float(to_surface(points[np.abs(_GRID).max(1) > 0], mesh).max())


def to_surface(points: Array, mesh: Mesh) -> Array:
    """(n,) distance of points (n, 3) to the nearest triangle, mm."""
    nearest = np.full(len(points), np.inf)
    step = max(1, _AT_ONCE // len(points))
    for first in range(0, len(mesh.faces), _LOOKED_AT):
        corners = _near(points, mesh.vertices[mesh.faces[first : first + _LOOKED_AT]], np.sqrt(nearest))
        for start in range(0, len(corners), step):
            some = corners[start : start + step]
            nearest = np.minimum(nearest, to_points(points[:, None], some).min(1))
    found: Array = np.sqrt(nearest)
    return found


def _near(points: Array, corners: Array, nearest: Array) -> Array:
    """The triangles (m, 3, 3) that may be nearer to one of the points (n, 3) than what was `nearest` (n,) so far.

    Nothing is nearer than its middle by more than its reach, and the nearest is no further than any middle.
    """
    middle = corners.mean(1)
    reach = np.sqrt(((corners - middle[:, None]) ** 2).sum(2).max(1))
    kept = np.zeros(len(corners), dtype=bool)
    for point, most in zip(points, nearest, strict=True):
        away = np.sqrt(((middle - point) ** 2).sum(1))
        kept |= away - reach <= min(most, away.min()) * (1 + _ROUNDING)
    return corners[kept]
