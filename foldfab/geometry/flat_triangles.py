"""Triangles of a closed mesh whose corners lie on one line, taken out without opening it.

Such a triangle has its middle corner on its longest side. Flipping that side, so that the neighbour across it is split
at the middle corner, leaves two triangles that have an area and the same surface. O(flat triangles · their rounds).
"""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array, Indices

ROUNDS = 40
"""Flat triangles may lie side by side in a row; each round takes one of a row."""


def flipped(vertices: Array, faces: Indices, height: float) -> Indices:
    """Faces (m, 3) of the same closed surface, flat triangles (lower than `height`, mm) flipped away where that can be.

    Rows keep their places: a flat triangle and its neighbour become the two new ones.
    """
    made = np.array(faces)
    for _ in range(ROUNDS):
        flat = np.nonzero(heights(vertices[made]) < height)[0]
        if not len(flat) or not _flip(vertices, made, flat):
            break
    return made


def heights(corners: Array) -> Array:
    """(m,) least heights of triangles (m, 3, 3)."""
    sides = corners - np.roll(corners, 1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return np.asarray(np.divide(doubled, longest, out=np.zeros_like(doubled), where=longest > 0))


def _flip(vertices: Array, faces: Indices, flat: Indices) -> bool:
    """Flips what can be flipped, in place; whether anything was."""
    owner = {(int(f[i]), int(f[(i + 1) % 3])): k for k, f in enumerate(faces) for i in range(3)}
    done: set[int] = set()
    for k in flat.tolist():
        a, b, middle = _longest_first(vertices, faces[k])
        other = owner.get((b, a))
        if other is None or {k, other} & done:
            continue
        apex = next(int(v) for v in faces[other] if v not in (a, b))
        if apex == middle or (middle, apex) in owner or (apex, middle) in owner:
            continue
        faces[k], faces[other] = (a, apex, middle), (apex, b, middle)
        done |= {k, other}
    return bool(done)


def _longest_first(vertices: Array, face: Indices) -> tuple[int, int, int]:
    """The corners in the triangle's sense, its longest side first."""
    corners = vertices[face]
    side = int(np.argmax(np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)))
    a, b, c = (int(v) for v in np.roll(face, -side))
    return a, b, c
