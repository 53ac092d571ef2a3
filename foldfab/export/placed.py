"""Where the parts of a print folder lie in its print file: the rigid motion that takes a part's STL there."""

from __future__ import annotations

from collections import Counter

import numpy as np

from foldfab.export.solid import solid
from foldfab.geometry.arrays import Array, Indices

OFF_MM = 2e-3
"""How far a corner may land from where the print file has it: both files are rounded to 0.01 µm and 32 bits."""
OUTSIDE_MM3 = 0.1
"""How much of a part may seem to stick out of what it is printed in: faces that lie on each other, rounded twice."""
LENGTH_DIGITS = 3
"""Triangles are told apart by the lengths of their sides to that many digits, where some are missing on one side."""


def placement(part: tuple[Array, Indices], printed: tuple[Array, Indices]) -> Array | None:
    """(4, 4) motion that takes a mesh, (n, 3) mm and (m, 3), to its copy in the print; None where it is no copy of it.

    Both list their triangles in the same order, save such as collapsed in one of the two by rounding.
    """
    a, b = (vertices[faces] for vertices, faces in (part, printed))
    if len(a) != len(b):
        a, b = _common(a, b)
    if len(a) == 0:
        return None
    motion = _fitted(a.reshape(-1, 3), b.reshape(-1, 3))
    off = np.abs(a.reshape(-1, 3) @ motion[:3, :3].T + motion[:3, 3] - b.reshape(-1, 3)).max()
    return motion if off <= OFF_MM else None


def is_within(part: tuple[Array, Indices], printed: tuple[Array, Indices], motion: Array) -> bool:
    """Whether a mesh, moved, lies within a body of the print: a part that is printed with a prop."""
    vertices, faces = part
    inner = solid("part", vertices @ motion[:3, :3].T + motion[:3, 3], faces).manifold
    return bool((inner - solid("body", *printed).manifold).volume() <= OUTSIDE_MM3)


def _common(a: Array, b: Array) -> tuple[Array, Array]:
    """Those of (m, 3, 3) triangles whose shape occurs once on either side, paired."""
    shapes = [[tuple(row) for row in np.round(_sides(triangles), LENGTH_DIGITS).tolist()] for triangles in (a, b)]
    counts = [Counter(rows) for rows in shapes]
    second = {shape: index for index, shape in enumerate(shapes[1])}
    pairs = [
        (index, second[shape])
        for index, shape in enumerate(shapes[0])
        if counts[0][shape] == 1 and counts[1][shape] == 1
    ]
    indices = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return a[indices[:, 0]], b[indices[:, 1]]


def _sides(triangles: Array) -> Array:
    return np.asarray(np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2))


def _fitted(points: Array, images: Array) -> Array:
    """The rigid motion with the least squared error (Kabsch)."""
    middle, other = points.mean(axis=0), images.mean(axis=0)
    u, _, vt = np.linalg.svd((points - middle).T @ (images - other))
    mirror = np.diag([1.0, 1.0, np.linalg.det(vt.T @ u.T)])
    motion = np.eye(4)
    motion[:3, :3] = vt.T @ mirror @ u.T
    motion[:3, 3] = other - motion[:3, :3] @ middle
    return motion
