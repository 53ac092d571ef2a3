"""Each part flat on the bed for itself: its plate level, the side down that leaves least below it to support."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.model import Body
from foldfab.geometry.arrays import Array
from foldfab.geometry.rotation import upright

FLAT = 0.766
"""Faces that look down more steeply than this (sine of 50°) want support."""


def lying(body: Body) -> Array:
    """(n, 3) its vertices as it lies, with the lowest at z = 0, mm."""
    return _grounded(body.vertices @ stands(body).T)


def stands(body: Body) -> Array:
    """(3, 3) rows: the bed's x, y and z in the body's frame, as it lies."""
    level = laid(body)
    ways: list[Array] = [level, level * np.array([[1.0], [-1.0], [-1.0]])]
    supports = [round(to_support(_grounded(body.vertices @ turn.T), body), 1) for turn in ways]
    return ways[int(supports[1] < supports[0])]


def laid(body: Body) -> Array:
    """(3, 3) rows: the bed's x, y and z in the body's frame, where one side of its plate lies on the bed."""
    return upright(-body.normal)


def to_support(points: Array, body: Body) -> float:
    """About how much lies below what hangs over, mm³, with the vertices of a body at (n, 3) `points`."""
    corners = points[body.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    areas = np.linalg.norm(normals, axis=1)
    hangs = normals[:, 2] < -FLAT * areas
    return float(-(normals[hangs, 2] * corners[hangs][:, :, 2].mean(axis=1)).sum())


def _grounded(points: Array) -> Array:
    return np.asarray(points - [0.0, 0.0, float(points[:, 2].min())])
