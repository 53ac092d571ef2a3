"""Written meshes as solids of the kernel, for checking."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from foldfab.geometry.arrays import Array, Indices

if TYPE_CHECKING:
    from manifold3d import Manifold


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One closed mesh."""

    name: str
    vertices: Array
    """(n, 3) mm, those that its faces use."""
    faces: Indices
    """(m, 3)"""
    low: Array
    """(3,) least corner of its box, mm."""
    high: Array
    """(3,) greatest corner of its box, mm."""
    manifold: Manifold


def solid(name: str, vertices: Array, faces: Indices) -> Solid:
    """The solid of (n, 3) vertices and (m, 3) faces.

    Raises:
        ValueError: the mesh is not closed, or encloses nothing.
    """
    from manifold3d import Manifold, Mesh

    if len(faces) == 0 or faces.min() < 0 or faces.max() >= len(vertices) or not np.isfinite(vertices).all():
        raise ValueError(f"{name}: the mesh is empty or refers to vertices that it does not have")
    manifold = Manifold(Mesh(vertices.astype(np.float32), faces.astype(np.uint32)))
    if manifold.status().name != "NoError":
        raise ValueError(f"{name}: the mesh is not watertight ({manifold.status().name})")
    if manifold.volume() <= 0:
        raise ValueError(f"{name}: the mesh encloses nothing, or is inside out")
    used, renamed = np.unique(faces, return_inverse=True)
    points = vertices[used]
    return Solid(name, points, renamed.reshape(-1, 3), points.min(axis=0), points.max(axis=0), manifold)


def close_pairs(points: list[Array], distance: float) -> Iterator[tuple[int, int]]:
    """Which of the bodies, given by (n, 3) points each, have boxes nearer than `distance` mm to each other."""
    low = np.array([p.min(axis=0) for p in points]) - distance
    high = np.array([p.max(axis=0) for p in points])
    for i in range(len(points)):
        is_near = np.all((low[i] <= high[i + 1 :]) & (low[i + 1 :] <= high[i]), axis=1)
        for j in np.flatnonzero(is_near).tolist():
            yield i, i + 1 + j
