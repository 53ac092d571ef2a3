"""Hinges that print in place: interleaved cylindrical knuckles of radius K/2, held by 45° cones (section 5.6).

The knuckles of the *carrier* (the base, or the earlier panel) stand at both ends and have sockets; those of the
*follower* have a cone on each side. Knuckles are a gap g apart along the axis, and a cone is g away from its socket
everywhere. A base hinge's carrier stands on feet; an inserted hinge's knuckles are tied to their panels by webs.

Everything is in the local frame of a panel or a foot: y along the axis, x across, z along the panel or upward.
"""

from __future__ import annotations

from dataclasses import dataclass

from foldfab.fabrication.shapes import Shape, box, cone, rod
from foldfab.folding.model import PIN_KNUCKLE, Thickness
from foldfab.geometry.arrays import Array

LONGEST_KNUCKLE = 14.0
"""Hinges get more knuckles rather than longer ones than this, mm."""
MOST_KNUCKLES = 9
"""But not more than this many."""


@dataclass(frozen=True, slots=True)
class Knuckles:
    """Extents along the axis of the knuckles of one hinge, mm."""

    carrier: tuple[tuple[float, float], ...]
    follower: tuple[tuple[float, float], ...]


def knuckles(span: Array, thickness: Thickness) -> Knuckles:
    """An odd number of knuckles over a span (2,), the carrier's at both ends.

    A span of the least width gets three; the ends are no narrower than a socket needs.
    """
    low, high = float(span[0]), float(span[1])
    width = high - low
    count = 3
    while count < MOST_KNUCKLES and width / count > LONGEST_KNUCKLE:
        count += 2
    free = width - (count - 1) * thickness.gap
    inner = 2 * thickness.socket_radius + thickness.socket_width
    carriers, followers = (count + 1) // 2, (count - 1) // 2
    share = free / count
    middle = max(share, inner) if carriers > 2 else 0.0
    pin = max(min(share, free - 2 * thickness.socket_width), PIN_KNUCKLE)
    end = (free - (carriers - 2) * middle - followers * pin) / 2
    marks, at = [], low
    for i in range(count):
        size = pin if i % 2 else end if i in (0, count - 1) else middle
        marks.append((at, at + size))
        at += size + thickness.gap
    return Knuckles(tuple(marks[::2]), tuple(marks[1::2]))


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Material and holes of the carrier's knuckles around the axis (x, z)."""
    solid = [rod(thickness.panel / 2, a, b, x, z) for a, b in hinge.carrier]
    holes = []
    size, out = thickness.socket_radius, thickness.panel / 20
    for i, (a, b) in enumerate(hinge.carrier):
        # The mouth starts outside its knuckle: coplanar faces would leave a skin without thickness.
        holes += [cone(size + out, a - out, a + size, x, z, is_hole=True)] if i > 0 else []
        holes += [cone(size + out, b + out, b - size, x, z, is_hole=True)] if i < len(hinge.carrier) - 1 else []
    return solid, holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> list[Shape]:
    """Material of the follower's knuckles around the axis (x, z), with their cones."""
    size, sunk = thickness.pin_radius, thickness.panel / 20
    solid = []
    for a, b in hinge.follower:
        solid.append(rod(thickness.panel / 2, a, b, x, z))
        # The cone starts inside its knuckle: bodies that should be one overlap.
        solid += [cone(size + sunk, a + sunk, a - size, x, z), cone(size + sunk, b - sunk, b + size, x, z)]
    return solid


def room(
    marks: tuple[tuple[float, float], ...], radius: float, thickness: Thickness, x: float, z: float
) -> list[Shape]:
    """What the other part must leave free around knuckles at `marks`."""
    return [rod(radius, a - thickness.gap, b + thickness.gap, x, z, is_hole=True) for a, b in marks]


def webs(
    marks: tuple[tuple[float, float], ...], thickness: Thickness, x: float, z: float, toward: float
) -> list[Shape]:
    """Ties between the knuckles of an inserted hinge and their panel, which lies on the `toward` (±1) side in z."""
    near, far = z + toward * thickness.gap / 2, z + toward * thickness.panel / 2
    return [box((min(0.0, x), a, min(near, far)), (max(0.0, x), b, max(near, far))) for a, b in marks]


def feet(hinge: Knuckles, thickness: Thickness, depth: float) -> list[Shape]:
    """Feet of the carrier's knuckles around the axis at the origin, down to `depth` below it."""
    half = thickness.panel / 2
    return [box((-half, a, -depth), (half, b, 0.0)) for a, b in hinge.carrier]
