"""Rotations that are exact at quarter turns, so that what is axis-aligned stays so to the last bit."""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array

SNAP = 1e-12
"""Sines and cosines closer than this to -1, 0 or 1 are taken to be that value."""


def cosine(angle: Array) -> Array:
    """Cosine of angles in radians, exact at multiples of a quarter turn."""
    return _snapped(np.cos(angle))


def sine(angle: Array) -> Array:
    """Sine of angles in radians, exact at multiples of a quarter turn."""
    return _snapped(np.sin(angle))


def sine_and_cosine(angle: Array) -> Array:
    """(2, …) both of them."""
    return _snapped(np.array([np.sin(angle), np.cos(angle)]))


def cross(a: Array, b: Array) -> Array:
    """The cross product of two vectors (3,): `np.cross` to the last bit, without its overhead for many."""
    a0, a1, a2 = a.tolist()
    b0, b1, b2 = b.tolist()
    return np.array([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0])


def upright(direction: Array) -> Array:
    """The rotation (3, 3) that turns the unit vector `direction` (3,) into -Z; exact for axis directions.

    Directions along an axis give a permutation of the axes, and -Z the identity.
    """
    up = -np.asarray(direction, dtype=np.float64)
    side = np.zeros(3)
    side[int(np.argmin(np.abs(up)))] = 1.0
    side -= (side @ up) * up
    side /= np.linalg.norm(side)
    return np.stack([side, cross(up, side), up])


def _snapped(values: Array) -> Array:
    nearest = np.round(values)
    return np.where(np.abs(values - nearest) < SNAP, nearest, values)
