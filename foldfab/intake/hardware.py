"""What is too small to be a part of the furniture: screws, pins, glides; the same bodies, however the furniture stands.

A body is as long as it is far from one end to the other: from where it is furthest from its middle to where it is
furthest from there. For a box that is its diagonal. The furniture is as long as its longest side along its main axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake.model import Body
from foldfab.intake.outline import Outline, main_axes, outline

HARDWARE = 0.02
"""A body that is no longer than this share of the furniture's longest side is hardware."""


@dataclass(frozen=True, slots=True, eq=False)
class Sizes:
    """How long bodies are."""

    limit: float
    """mm; hardware is no longer than this."""
    small: frozenset[str]
    """The names of bodies that are no longer."""
    outlines: dict[str, Outline | None]
    """By name, those that had to be found to know."""


def sizes(bodies: list[Body], smallest: float | None) -> Sizes:
    """Which of some bodies are small; `smallest` is the limit in mm, None for a share of what they make together."""
    lengths = {body.name: _across([body.mesh.vertices]) for body in bodies}
    outlines: dict[str, Outline | None] = {}
    if smallest is None:
        longest = _across([body.mesh.vertices for body in bodies])
        # No side is longer than all is across, so what is longer than that share of it is no hardware for certain.
        outlines = {b.name: outline(b) for b in bodies if lengths[b.name] > HARDWARE * longest}
        found = [some for some in outlines.values() if some is not None]
        smallest = HARDWARE * (_side(found) if found else longest)
    return Sizes(smallest, frozenset(name for name, length in lengths.items() if length <= smallest), outlines)


def _side(outlines: list[Outline]) -> float:
    corners = np.concatenate([o.corners for o in outlines])
    return float(np.ptp(corners @ main_axes(outlines).T, axis=0).max())


def _across(many: list[Array]) -> float:
    """How far it is from one end of points (n, 3) to the other."""
    middle: Array = sum(points.sum(0) for points in many) / sum(len(points) for points in many)
    end, _ = _furthest(many, middle)
    return _furthest(many, end)[1]


def _furthest(many: list[Array], start: Array) -> tuple[Array, float]:
    """The point that is furthest from `start`, and how far it is."""
    ends = []
    for points in many:
        # Column by column, which takes less memory than the points.
        away = sum((points[:, k] - start[k]) ** 2 for k in range(3))
        index = int(np.argmax(away))
        ends.append((float(away[index]), points[index]))
    squared, end = max(ends, key=lambda found: found[0])
    return end, squared**0.5
