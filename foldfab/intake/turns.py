"""Turns as robot descriptions write them, as matrices (3, 3) that act on columns; by scipy."""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array


def by_quaternion(w: float, x: float, y: float, z: float) -> Array:
    """The turn of a quaternion of any length but zero."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())


def by_angles(sequence: str, angles: Array) -> Array:
    """The turn by three angles in radians about axes such as `xyz`; small letters turn with the body, capitals do not.

    It is the other way round in scipy.
    """
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_euler(sequence.swapcase(), angles).as_matrix())


def by_axis(axis: Array, angle: float) -> Array:
    """The turn about an axis (3,) of any length but zero, radians."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix())


def by_columns(x: Array, y: Array) -> Array:
    """The turn to axes whose first is along `x` (3,) and whose second is as near to `y` (3,) as can be."""
    first = x / np.linalg.norm(x)
    second = y - (y @ first) * first
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)], axis=1)


def upright_to(z: Array) -> Array:
    """The least turn that takes the z axis to `z` (3,) of any length but zero."""
    end = z / np.linalg.norm(z)
    axis = np.cross([0.0, 0.0, 1.0], end)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return np.eye(3) if end[2] > 0 else np.diag([1.0, -1.0, -1.0])
    return by_axis(axis, float(np.arctan2(sine, end[2])))


def rigid(turn: Array, place: Array) -> Array:
    """The matrix (4, 4) of a turn (3, 3) and then a way (3,)."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    matrix[:3, 3] = place
    return matrix
