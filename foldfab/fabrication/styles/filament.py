"""Pinned by a piece of 1.75 mm filament, pushed in from one end after printing.

The bore ends blind in the last knuckle; the filament is cut 1 mm long and its end melted flat with a warm iron, which
holds it. The bore leaves 0.1 mm around the filament.
"""

from __future__ import annotations

import math

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.styles.bore import FREE_WAY, OUT, bore, plain
from foldfab.folding.model import Thickness
from foldfab.recipe.hinges import STYLES

BORE_RADIUS = 0.975
"""1.95 mm for a filament of 1.75 mm."""


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Solid], list[Solid]]:
    """Bored knuckles, the last one blind."""
    holes = []
    for start, end in hinge.pins:
        way = math.copysign(1.0, end - start)
        holes.append(bore(BORE_RADIUS, start - way * OUT, end - way * STYLES["filament"].tip, x, z))
    return plain(hinge.carrier, thickness, x, z), holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Solid], list[Solid]]:
    """Bored knuckles."""
    holes = []
    for start, end in hinge.pins:
        way = math.copysign(1.0, end - start)
        holes.append(bore(BORE_RADIUS, start - way * FREE_WAY, end - way * STYLES["filament"].tip, x, z))
    return plain(hinge.follower, thickness, x, z), holes
