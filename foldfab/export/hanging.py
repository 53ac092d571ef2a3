"""What hangs in the air as it is printed: surfaces that slope too little, and regions that start on nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldfab.export.solid import Solid
from foldfab.geometry.arrays import Array, Indices

OVERHANG_DEG = 45.0
"""Surfaces flatter than this want support."""
FACET_DEG = 2.0
"""Less what facets take: a cone that is meant to slope by 45° does so on average only."""
BED_MM = 0.01
"""What is no higher stands on the bed."""
LEVEL_MM = 1e-4
"""Vertices of one level differ by less."""
ABOVE = 1000.0
"""Longer than any ray has to be, mm."""


@dataclass(frozen=True, slots=True)
class Region:
    """A region that starts above the bed, with nothing to stand on."""

    body: str
    z: float
    """Where it starts, mm."""
    drop: float
    """How far it is down to the next body, or to the bed, mm."""


def overhang_areas(bodies: Sequence[Solid], gap: float) -> tuple[float, float]:
    """Area, mm², of surfaces that overhang, and how much of it has a body less than `gap` mm below."""
    total = close = 0.0
    for body in bodies:
        corners = body.vertices[body.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas = np.linalg.norm(normals, axis=1) / 2
        slope = np.divide(normals[:, 2], 2 * areas, out=np.zeros_like(areas), where=areas > 0)
        is_over = (slope < -np.cos(np.radians(OVERHANG_DEG - FACET_DEG))) & (corners[:, :, 2].max(axis=1) > BED_MM)
        total += float(areas[is_over].sum())
        for point, area in zip(corners[is_over].mean(axis=1), areas[is_over].tolist(), strict=True):
            close += area if drop(bodies, point) <= gap else 0.0
    return total, close


def floating(bodies: Sequence[Solid], layer: float) -> list[Region]:
    """Regions that start in the air, highest drop first; what lies within a `layer`, mm, below them carries them."""
    found = []
    for body in bodies:
        for point in starts(body.vertices, body.faces):
            height = drop(bodies, point)
            if point[2] > BED_MM and height > layer:
                found.append(Region(body.name, float(point[2]), height))
    return sorted(found, key=lambda region: (-round(region.drop, 6), region.body, region.z))


def starts(vertices: Array, faces: Indices) -> Array:
    """(k, 3) a point of each level from which a mesh only rises, and on whose upper side it is solid."""
    edges = np.unique(np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, [2, 0]]]), axis=1), axis=0)
    z = vertices[:, 2]
    rise = z[edges[:, 1]] - z[edges[:, 0]]
    level = _levels(len(vertices), edges[np.abs(rise) <= LEVEL_MM])
    is_lowest = np.zeros(len(vertices), dtype=bool)
    is_lowest[level[faces.ravel()]] = True
    steep = edges[np.abs(rise) > LEVEL_MM]
    upper = np.where(z[steep[:, 1]] > z[steep[:, 0]], steep[:, 1], steep[:, 0])
    is_lowest[level[upper]] = False
    corners = vertices[faces]
    down = -np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    facing = np.zeros(len(vertices))
    # A facet counts once for each of its corners; at the bottom of a hole they look up.
    np.add.at(facing, level[faces].ravel(), np.repeat(down, 3))
    return vertices[np.flatnonzero(is_lowest & (facing > 0))]


def drop(bodies: Sequence[Solid], point: Array) -> float:
    """How far below a point, mm, the next body's upper side is, or the bed."""
    x, y, z = point.tolist()
    top = 0.0
    for body in bodies:
        if body.low[0] <= x <= body.high[0] and body.low[1] <= y <= body.high[1] and body.low[2] < z:
            hits = body.manifold.ray_cast((x, y, z - LEVEL_MM), (x, y, z - ABOVE))
            top = max([top, *(hit.position[2] for hit in hits if hit.normal[2] > 0)])
    return float(z - top)


def _levels(count: int, edges: Indices) -> Indices:
    """(count,) by vertex, the first vertex that can be reached along (m, 2) edges."""
    leader = np.arange(count)
    while True:
        least = leader.copy()
        np.minimum.at(least, edges[:, 0], leader[edges[:, 1]])
        np.minimum.at(least, edges[:, 1], leader[edges[:, 0]])
        least = least[least]
        if np.array_equal(least, leader):
            return leader
        leader = least
