"""What styles with a pin of its own share: bored knuckles."""

from __future__ import annotations

from foldfab.fabrication.hinges import Mark
from foldfab.fabrication.solids import Solid, rod
from foldfab.folding.model import Thickness

OUT = 0.2
"""How far a bore reaches out of the face that it opens, mm, so that no skin is left."""
FREE_WAY = 500.0
"""How far the follower is bored beyond the hinge, mm, so that the pin can go in where its panel reaches further."""


def plain(marks: tuple[Mark, ...], thickness: Thickness, x: float, z: float) -> list[Solid]:
    """Knuckles without anything."""
    return [rod(thickness.panel / 2, a, b, x, z) for a, b in marks]


def bore(radius: float, start: float, end: float, x: float, z: float) -> Solid:
    """A round hole around (x, z) between two places along y, in either order."""
    return rod(radius, min(start, end), max(start, end), x, z, is_hole=True)
