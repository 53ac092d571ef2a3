"""What a scaffold makes of the furniture that it is not: parts that lie in a base, level, though they stand or slope.

A rail that touches no base is made one (`abstract`), whatever stands upright of it; a board taken for a rail is printed
on its side. Each part counts by the area of its sheet, and by the sine of the angle that it is turned by.
"""

from __future__ import annotations

import numpy as np

from foldfab.scaffold.model import Scaffold
from foldfab.scaffold.segments import Segment, is_rod, segments

BARELY = float(np.sin(np.radians(10.0)))
"""What is turned by less, a tilted seat, is the same to a maker."""


def turned(scaffold: Scaffold) -> dict[str, float]:
    """By part that is laid level, its share of the area of all parts' sheets, as far as it is turned."""
    recipe = scaffold.recipe
    found = segments(recipe, scaffold.direction, scaffold.scale)
    folds = {name for patch in scaffold.patches for name in patch.parts}
    total = sum(map(_area, found))
    angles = {s.name: _sine(s) for s in found if s.name not in folds}
    return {s.name: _area(s) * angles[s.name] / total for s in found if angles.get(s.name, 0.0) > BARELY}


def _area(segment: Segment) -> float:
    _, middle, long = np.sort(segment.half)
    return float(middle * long)


def _sine(segment: Segment) -> float:
    """Of the angle between its sheet, or its axis where it is a rod, and the plane across d."""
    order = np.argsort(segment.half, kind="stable")
    if is_rod(segment.half):
        return float(abs(segment.axes[order[2], 2]))
    return float(np.sqrt(max(0.0, 1.0 - segment.axes[order[0], 2] ** 2)))
