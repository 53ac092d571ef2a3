"""Pinned by a pan-head screw (ISO 7045) that cuts its thread in the last knuckle.

All knuckles but the last have a clearance hole; the last one a core hole over its whole length. The head lies in front
of the first knuckle, where both parts leave room for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.styles.bore import FREE_WAY, OUT, bore, plain
from foldfab.folding.model import Thickness
from foldfab.recipe.hinges import STYLES, HingeKind


@dataclass(frozen=True, slots=True)
class Screw:
    """Radii, mm."""

    clearance: float
    """Of the hole it turns in."""
    core: float
    """Of the hole it cuts its thread in."""
    head: float


SCREWS: Mapping[HingeKind, Screw] = MappingProxyType(
    {"screw-m2": Screw(1.1, 0.85, 2.0), "screw-m3": Screw(1.6, 1.25, 2.8)}
)
"""By kind of hinge."""


def carrier(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Knuckles with clearance holes, and a core hole in the last one of each screw."""
    screw, holes = SCREWS[thickness.hinge], []
    for start, end in hinge.pins:
        way = math.copysign(1.0, end - start)
        low, high = next(m for m in hinge.carrier if end in m)
        thread = low if end == high else high
        holes.append(bore(screw.clearance, start - way * OUT, thread - way * thickness.gap / 2, x, z))
        holes.append(bore(screw.core, thread - way * thickness.gap, end + way * OUT, x, z))
        holes.append(_head(start, way, thickness, x, z))
    return plain(hinge.carrier, thickness, x, z), holes


def follower(hinge: Knuckles, thickness: Thickness, x: float, z: float) -> tuple[list[Shape], list[Shape]]:
    """Knuckles with clearance holes; a way in for the driver."""
    screw, holes = SCREWS[thickness.hinge], []
    for start, end in hinge.pins:
        way = math.copysign(1.0, end - start)
        holes.append(bore(screw.clearance, start - way * FREE_WAY, end + way * OUT, x, z))
        holes.append(_head(start, way, thickness, x, z))
    return plain(hinge.follower, thickness, x, z), holes


def _head(start: float, way: float, thickness: Thickness, x: float, z: float) -> Shape:
    # Flush with the face of the first knuckle, where the knuckle itself is bored anyway.
    radius = SCREWS[thickness.hinge].head + thickness.gap
    return bore(radius, start, start - way * (STYLES[thickness.hinge].head + OUT), x, z)
