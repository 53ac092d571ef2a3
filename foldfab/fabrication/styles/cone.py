"""Pinned by 45° cones: prints in place without bridges (section 6, Fabrication).

The follower has a cone on each side of its knuckles, the carrier the sockets; a cone is g away from its socket
everywhere.
"""

from __future__ import annotations

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.shapes import Shape, cone, rod
from foldfab.folding.model import Thickness


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Knuckles with sockets towards their neighbours."""
    solid = [rod(thickness.panel / 2, a, b, x, z) for a, b in hinge.carrier]
    holes = []
    size, out = thickness.socket_radius, thickness.panel / 20
    near = 2 * thickness.gap
    for a, b in hinge.carrier:
        # The mouth starts outside its knuckle: coplanar faces would leave a skin without thickness.
        is_after = any(abs(a - end) < near for _, end in hinge.follower)
        is_before = any(abs(start - b) < near for start, _ in hinge.follower)
        holes += [cone(size + out, a - out, a + size, x, z, is_hole=True)] if is_after else []
        holes += [cone(size + out, b + out, b - size, x, z, is_hole=True)] if is_before else []
    return solid, holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Knuckles with a cone on either side."""
    size, sunk = thickness.pin_radius, thickness.panel / 20
    solid = []
    for a, b in hinge.follower:
        solid.append(rod(thickness.panel / 2, a, b, x, z))
        # The cone starts inside its knuckle: bodies that should be one overlap.
        solid += [cone(size + sunk, a + sunk, a - size, x, z), cone(size + sunk, b - sunk, b + size, x, z)]
    return solid, []
