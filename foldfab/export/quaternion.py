"""Rotations as unit quaternions (x, y, z, w), the order of glTF."""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array

NEARLY_EQUAL_RAD = 1e-6
"""Below this angle the spherical interpolation is a straight one, to rounding."""


def from_matrices(rotations: Array) -> Array:
    """(k, 4) quaternions of (k, 3, 3) rotations; neighbours agree in sign, to interpolate the short way."""
    r = np.moveaxis(np.asarray(rotations, dtype=np.float64), 0, -1)
    xy, xz, yz = r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[1, 2] + r[2, 1]
    wx, wy, wz = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    diagonal = (1 + r[0, 0] - r[1, 1] - r[2, 2], 1 - r[0, 0] + r[1, 1] - r[2, 2], 1 - r[0, 0] - r[1, 1] + r[2, 2])
    products = np.array(
        [
            [diagonal[0], xy, xz, wx],
            [xy, diagonal[1], yz, wy],
            [xz, yz, diagonal[2], wz],
            [wx, wy, wz, 1 + r[0, 0] + r[1, 1] + r[2, 2]],
        ]
    )
    # Each row is 4 q_i q; the row of the largest component divides by no small number.
    largest = np.argmax(products[range(4), range(4)], axis=0)
    rows = products[largest, :, np.arange(len(largest))]
    return _continuous(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def to_matrix(quaternion: Array) -> Array:
    """(3, 3) rotation of a (4,) quaternion of any length but zero."""
    x, y, z, w = np.asarray(quaternion, dtype=np.float64) / np.linalg.norm(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def slerp(first: Array, second: Array, share: float) -> Array:
    """(4,) quaternion at `share` of the short way between two (4,) quaternions."""
    cosine = float(first @ second)
    if cosine < 0:
        second, cosine = -second, -cosine
    angle = float(np.arccos(min(1.0, cosine)))
    if angle < NEARLY_EQUAL_RAD:
        return first + share * (second - first)
    blend: Array = (np.sin((1 - share) * angle) * first + np.sin(share * angle) * second) / np.sin(angle)
    return blend


def _continuous(quaternions: Array) -> Array:
    dots = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.concatenate([[1.0], np.where(dots < 0, -1.0, 1.0)]))
    return quaternions * signs[:, None]
