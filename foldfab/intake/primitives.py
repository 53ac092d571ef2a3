"""Boxes, cylinders, capsules and ellipsoids as triangles around the origin, as robot descriptions name them.

Round ones are inscribed, with vertices at every quarter turn, so that their boxes are exact.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Mesh

SIDES = 32
"""Of a circle; a multiple of four."""
RINGS = 8
"""From the equator of a sphere to its pole."""

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def box(half: Array) -> Mesh:
    """A box by its half lengths (3,)."""
    return Mesh(_CORNERS * half, np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]]))


def cylinder(radius: float, half: float) -> Mesh:
    """An upright cylinder."""
    return _turned(np.array([[0.0, -half], [radius, -half], [radius, half], [0.0, half]]))


def capsule(radius: float, half: float) -> Mesh:
    """An upright cylinder between two half spheres."""
    low, high = _arc(-1.0, 0.0), _arc(0.0, 1.0)
    return _turned(np.concatenate([radius * low - [0.0, half], radius * high + [0.0, half]]))


def ellipsoid(half: Array) -> Mesh:
    """An ellipsoid by its half axes (3,)."""
    sphere = _turned(np.concatenate([_arc(-1.0, 0.0), _arc(0.0, 1.0)[1:]]))
    return Mesh(sphere.vertices * half, sphere.faces)


def _arc(low: float, high: float) -> Array:
    """(RINGS + 1, 2) radius and height of a unit circle between two angles in quarter turns."""
    angles = np.linspace(low, high, RINGS + 1) * np.pi / 2
    return np.round(np.stack([np.cos(angles), np.sin(angles)], axis=1), 15)


def _turned(profile: Array) -> Mesh:
    """The body of revolution of a profile (n, 2) of radius and height, from the lower pole to the upper one."""
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.round(np.stack([np.cos(angles), np.sin(angles)], axis=1), 15)
    rings = [np.column_stack([radius * circle, np.full(SIDES, height)]) for radius, height in profile]
    around, after = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
    faces = []
    for low in SIDES * np.arange(len(profile) - 1):
        high = low + SIDES
        faces += [np.stack([around + low, after + low, after + high], axis=1)]
        faces += [np.stack([around + low, after + high, around + high], axis=1)]
    return Mesh(np.concatenate(rings), np.concatenate(faces))
