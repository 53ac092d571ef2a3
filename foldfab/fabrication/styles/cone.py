"""Pinned by 45° cones: prints in place without bridges (section 6, Fabrication).

The follower has a cone on each side of its knuckles, the carrier the sockets; a cone is g away from its socket
everywhere.
"""

from __future__ import annotations

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.solids import Solid, cone, rod
from foldfab.folding.model import Thickness


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Solid], list[Solid]]:
    """Knuckles with sockets towards their neighbours."""
    solid = [rod(thickness.panel / 2, a, b, x, z) for a, b in hinge.carrier]
    holes = []
    size, out = thickness.socket_radius, thickness.panel / 20
    for i, (a, b) in enumerate(hinge.carrier):
        # The mouth starts outside its knuckle: coplanar faces would leave a skin without thickness.
        holes += [cone(size + out, a - out, a + size, x, z, is_hole=True)] if i > 0 else []
        holes += [cone(size + out, b + out, b - size, x, z, is_hole=True)] if i < len(hinge.carrier) - 1 else []
    return solid, holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Solid], list[Solid]]:
    """Knuckles with a cone on either side."""
    size, sunk = thickness.pin_radius, thickness.panel / 20
    solid = []
    for a, b in hinge.follower:
        solid.append(rod(thickness.panel / 2, a, b, x, z))
        # The cone starts inside its knuckle: bodies that should be one overlap.
        solid += [cone(size + sunk, a + sunk, a - size, x, z), cone(size + sunk, b - sunk, b + size, x, z)]
    return solid, []
