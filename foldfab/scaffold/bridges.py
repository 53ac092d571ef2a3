"""What a base gains where a sheet is to touch one of its parts and stands beside it: a strip from the one to the other.

Section 5.1 stretches patches until they meet. A sheet reaches its base's height by itself; sideways the base comes
to it.
"""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.scaffold.model import Outline

Span = tuple[float, float]


def bridge(strip: Outline, part: Outline) -> Outline | None:
    """The outline that joins a sheet's strip and a part of its base, seen from above; None where they overlap.

    Along the sheet it is as wide as both, across it reaches from one into the other; from corner to corner it is as
    wide as the sheet is thick.
    """
    along = strip.along
    axes = np.array([along, [-along[1], along[0]]])
    turned = np.abs(axes @ np.array([part.along, [-part.along[1], part.along[0]]]).T) @ part.half
    middle = axes @ (part.center - strip.center)
    spans = [_span(strip.half[k], middle[k] - turned[k], middle[k] + turned[k]) for k in range(2)]
    if not any(is_gap for _, is_gap in spans):
        return None
    rim = float(strip.half.min())
    reach = np.array([(low - rim, high + rim) if is_gap else (low, high) for (low, high), is_gap in spans])
    center: Array = strip.center + reach.mean(1) @ axes
    return Outline(strip.part, center, along, np.maximum(np.ptp(reach, axis=1) / 2, rim))


def _span(half: float, low: float, high: float) -> tuple[Span, bool]:
    """What [-half, half] and [low, high] share, or what lies between them, and whether it is that."""
    inner = (max(-half, low), min(half, high))
    return ((inner[1], inner[0]), True) if inner[0] > inner[1] else (inner, False)
