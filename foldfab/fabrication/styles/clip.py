"""Snapped together after printing: the follower's pin goes through a mouth into open sockets of the carrier.

The mouth is narrower than the pin by `INTERFERENCE` on either side, which the arms have to give. Printed in place it
holds as well, and can be taken apart.
"""

from __future__ import annotations

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.shapes import Shape, box, rod
from foldfab.folding.model import Thickness

PIN_SHARE = 0.25
"""Radius of the pin as a share of K: with the gap it leaves arms of 0.7 mm around it at K = 4."""
INTERFERENCE = 0.2
"""By how much each arm has to give, mm: 0.2 mm over an arm of about 2 mm is what PLA takes again and again."""


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Sockets that open away from the base, or away from the panel's face."""
    half, pin = thickness.panel / 2, PIN_SHARE * thickness.panel
    holes = []
    for a, b in hinge.carrier:
        low, high = a - thickness.gap / 2, b + thickness.gap / 2
        holes.append(rod(pin + thickness.gap, low, high, x, z, is_hole=True))
        mouth = pin - INTERFERENCE
        if x == 0.0:
            holes.append(box((-mouth, low, z), (mouth, high, z + half + thickness.gap)))
        else:
            out = x + (half + thickness.gap) * (1.0 if x > 0 else -1.0)
            holes.append(box((min(x, out), low, z - mouth), (max(x, out), high, z + mouth)))
    return [rod(half, a, b, x, z) for a, b in hinge.carrier], holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Knuckles with a pin through all of a group, which ends a gap before what its panel meets beyond the sockets."""
    radius, short = PIN_SHARE * thickness.panel, thickness.gap / 2
    pins = [rod(radius, low + short, high - short, x, z) for low, high in hinge.pins]
    return [*(rod(thickness.panel / 2, a, b, x, z) for a, b in hinge.follower), *pins], []
