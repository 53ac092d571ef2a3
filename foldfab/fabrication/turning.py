"""How far a hinge turns on past the ends of its range before its two halves meet, tried on the solids.

Both halves are taken alone, as if they were all there is: what stops them is part of them. Angles in degrees.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.model import Joint
from foldfab.fabrication.solids import Solid
from foldfab.geometry.arrays import Array

MEETS = 0.01
"""Halves that share this volume have met, mm³: above rounding, a fortieth of a grain of sand."""
PAST = 3.0
"""How far a hinge may turn on."""
FINE = 0.25
"""The angle of a stop within `PAST` is told to this."""
COARSE = (3.5, 4.0, 5.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 45.0, 60.0, 90.0)
"""Angles that are tried where nothing stops it within `PAST`."""


@dataclass(frozen=True, slots=True, eq=False)
class Turn:
    """The ends of a hinge's range, as poses (4, 4) of its second part in the frame of its first."""

    opened: Array
    folded: Array
    axis: Array
    """(2, 3) mm, in the frame of the first part; a positive turn about it folds."""

    def past(self, degrees: float, *, is_folded: bool) -> Array:
        """(4, 4) the second part turned on past its open or its folded end."""
        turn = rotation(self.axis, np.radians(degrees if is_folded else -degrees))
        pose: Array = turn @ (self.folded if is_folded else self.opened)
        return pose


def turn(joint: Joint, first: Array, second: Array) -> Turn:
    """The range of a hinge from the poses (k, 4, 4) of its two parts over a whole fold."""
    relative = np.linalg.inv(first) @ second
    angles, axis = _angles(relative, joint.axis), joint.axis
    if turn_sign(relative, axis) < 0:
        angles, axis = -angles, axis[::-1]
    return Turn(relative[int(angles.argmin())], relative[int(angles.argmax())], axis)


def turns(joints: Iterable[Joint], poses: Mapping[str, Array]) -> dict[str, Turn]:
    """The ranges of hinges, by name, from the poses (k, 4, 4) of all bodies over a whole fold."""
    return {joint.name: turn(joint, *(poses[part] for part in joint.parts)) for joint in joints}


def turn_sign(relative: Array, axis: Array) -> float:
    """1 where poses (k, 4, 4) that begin open turn positively about an axis (2, 3) at their widest, else -1."""
    angles = _angles(relative, axis)
    return -1.0 if angles[np.abs(angles).argmax()] < 0 else 1.0


def _angles(relative: Array, axis: Array) -> Array:
    """(k,) radians by which poses (k, 4, 4) are turned about an axis (2, 3)."""
    along = (axis[1] - axis[0]) / np.linalg.norm(axis[1] - axis[0])
    r = relative[:, :3, :3]
    skew = np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], axis=1)
    angles: Array = np.unwrap(np.arctan2(skew @ along / 2, (np.trace(r, axis1=1, axis2=2) - 1) / 2))
    return angles


def rotation(axis: Array, angle: float) -> Array:
    """(4, 4) the rotation by an angle (radians) around the line through two points (2, 3)."""
    x, y, z = (axis[1] - axis[0]) / np.linalg.norm(axis[1] - axis[0])
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    pose = np.eye(4)
    pose[:3, :3] += np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    pose[:3, 3] = axis[0] - pose[:3, :3] @ axis[0]
    return pose


def meets(range_: Turn, first: Solid, second: Solid, degrees: float, *, is_folded: bool) -> bool:
    """Whether the halves of a hinge meet when it is turned on past its open or its folded end by so much."""
    pose = range_.past(degrees, is_folded=is_folded)
    return solids.overlap(first, solids.moved(second, pose)) > MEETS


def stops_at(range_: Turn, first: Solid, second: Solid, *, is_folded: bool) -> float | None:
    """The angle past its open or folded end at which the halves meet, rounded up to `FINE`; None if they never do."""
    if not meets(range_, first, second, PAST, is_folded=is_folded):
        return next((angle for angle in COARSE if meets(range_, first, second, angle, is_folded=is_folded)), None)
    low, high = 0, round(PAST / FINE)
    while high - low > 1:
        middle = (low + high) // 2
        has_met = meets(range_, first, second, middle * FINE, is_folded=is_folded)
        low, high = (low, middle) if has_met else (middle, high)
    return high * FINE
