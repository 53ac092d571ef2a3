"""How thick walls are: from every facet straight in, to where a facet looks the other way."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.solids import Solid, mesh
from foldfab.geometry.arrays import Array, Indices

LINE = 0.45
"""Width of a line of a 0.4 mm nozzle: what is thinner is not printed, mm."""

OPPOSITE = 0.9
"""Cosine: facets that look within 26° of opposite ways are the sides of a wall, and not those of an edge or a tip."""
INSIDE_MM = 1e-3
"""Where a ray starts, below the surface."""
SMALL_MM = 2.0
"""A facet no larger than this is looked at in its middle alone."""
SHARES = np.array([[1 / 3, 1 / 3, 1 / 3], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]])
"""Where in a facet, in shares of its corners, the wall is measured."""


def thin_sides(body: Solid, near: tuple[Array, Array] | None = None) -> int:
    """How many facets of a body are sides of walls that are thinner than a line; of those that reach into a box alone.

    `near` is the box, two corners (3,), mm.
    """
    vertices, faces = mesh(body)
    if near is not None:
        corners = vertices[faces]
        low, high = corners.min(axis=1), corners.max(axis=1)
        faces = faces[np.all((low <= near[1]) & (near[0] <= high), axis=1)]
    return thinnest(vertices, faces, body, LINE)[1]


def thinnest(vertices: Array, faces: Indices, body: Solid, limit: float) -> tuple[float, int]:
    """Thickness of the thinnest wall, mm, or `limit` where none is thinner; how many facets are sides of thinner ones.

    Of a body with its mesh, (n, 3) and (m, 3). O(facets · log facets).
    """
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    is_flat = lengths > 0
    corners, inward = corners[is_flat], -normals[is_flat] / lengths[is_flat, None]
    thickness = np.full(len(corners), limit)
    is_large = np.ptp(corners, axis=1).max(axis=1) > SMALL_MM
    for number, shares in enumerate(SHARES):
        is_seen = is_large | (number == 0)
        points = np.einsum("j,ijk->ik", shares, corners[is_seen])
        thickness[is_seen] = np.minimum(thickness[is_seen], _thickness(body, points, inward[is_seen], limit))
    return float(thickness.min(initial=limit)), int(np.sum(thickness < limit))


def _thickness(body: Solid, points: Array, inward: Array, limit: float) -> Array:
    """(n,) from (n, 3) points along (n, 3) directions."""
    starts, ends = (points + INSIDE_MM * inward).tolist(), (points + limit * inward).tolist()
    found = np.full(len(points), limit)
    for index, (start, end) in enumerate(zip(starts, ends, strict=True)):
        hits = body.ray_cast(start, end)
        if hits and float(np.dot(hits[0].normal, inward[index])) > OPPOSITE:
            found[index] = np.dot(hits[0].position - points[index], inward[index])
    return found
