"""Check of the lock pins, from the GLB and the sheet: each fits its groove, and its panel cannot turn past it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.export.check_solids import OVERLAP_MM3
from foldfab.export.report import Row, listed
from foldfab.export.solid import Solid
from foldfab.export.stated import Stated, StatedJoint, StatedLatch
from foldfab.fabrication import solids as kernel
from foldfab.fabrication.turning import rotation, turn_sign
from foldfab.geometry.arrays import Array

ON_DEG = 1.0
"""A panel has to meet its pin when it is turned by this more than the sheet says."""


def check_latches(solids: Mapping[str, Solid], poses: Mapping[str, Array], stated: Stated) -> Row:
    """Of parts in the open posture, and the poses (k, 4, 4) that they take."""
    held = [(joint, joint.latch) for joint in stated.joints if joint.latch is not None]
    problems = [text for joint, latch in held for text in _problems(solids, poses, stated, joint, latch)]
    most = max((latch.holds_at for _, latch in held), default=0.0)
    return Row("latches", not problems, listed(problems) or f"{len(held)} lock pins, each holds within {most:g}°")


def _problems(
    solids: Mapping[str, Solid], poses: Mapping[str, Array], stated: Stated, joint: StatedJoint, latch: StatedLatch
) -> list[str]:
    pin = _pin(latch, latch.width / 2)
    met = [name for name, solid in solids.items() if (solid.manifold ^ pin).volume() > OVERLAP_MM3]
    if met:
        return [f"the pin of {joint.name} meets {listed(met)}"]
    if (solids[latch.base].manifold ^ _pin(latch, latch.width / 2 + stated.clearance)).volume() <= OVERLAP_MM3:
        return [f"the pin of {joint.name} lies in no groove of {latch.base}"]
    (panel,) = (part for part in joint.parts if part != latch.base)
    way = np.linalg.inv(poses[latch.base]) @ poses[panel]
    turn = rotation(joint.axis, np.radians(turn_sign(way, joint.axis) * (latch.holds_at + ON_DEG)))
    if (solids[panel].manifold.transform(turn[:3]) ^ pin).volume() <= OVERLAP_MM3:
        return [f"{joint.name} turns past its pin"]
    return []


def _pin(latch: StatedLatch, radius: float) -> kernel.Solid:
    along = latch.ends[1] - latch.ends[0]
    length = float(np.linalg.norm(along))
    y = along / length
    x = np.cross(y, np.eye(3)[int(np.abs(y).argmin())])
    x /= np.linalg.norm(x)
    rod = kernel.rod(radius, 0.0, length, 0.0, 0.0)
    return kernel.placed(rod, latch.ends[0], np.stack([x, y, np.cross(x, y)]))
