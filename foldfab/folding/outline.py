"""Whether a fold keeps to the furniture's outline (section 5.3), or to its bounding box where asked for (section 3).

In-place folding incurs no horizontal expansion: a chain may stick out of the open furniture, seen along its own normal,
only by what a leaning patch adds. The bounding box, `stay_in_box`, holds for everything that a fold carries along.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.folding.model import Chain, Thickness
from foldfab.folding.space import Sweep
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds

EXPANSION = 0.1
"""In-place folding may stick out of the furniture's outline by this share of its size in that direction."""


def sticks_out(furniture: Boxes, chain: Chain, swept: Sweep, thickness: Thickness) -> bool:
    """Whether a chain that folds in place leaves the outline of the open furniture (n,) along its own normal."""
    low, high = _extent(furniture, chain.across)
    near, far = _extent(swept.boxes, chain.across)
    slack = max(_skin(thickness), EXPANSION * (high - low))
    return near < low - slack or far > high + slack


def leaves_box(
    furniture: Boxes, swept: Sweep, clusters: Mapping[str, tuple[Array, Array]], shift: Mapping[str, Array],
    offset: Array, root: str, thickness: Thickness,
) -> bool:  # fmt: skip
    """Whether a chain, or anything that moves with the unit's bases, leaves the bounding box of the open furniture.

    Args:
        furniture: the open furniture (n,).
        swept: the chain over time, in the frame of the unit's lowest base.
        clusters: by base of the unit, lower and upper corner (3,) of what moves with it.
        shift: by base of the unit, (frames, 3) its translation in that frame.
        offset: (3,) how far the unit has been carried since the open posture.
        root: the base of the unit that moves with the furniture's lowest base, which stays where it is.
        thickness: K and g.
    """
    low, high = (c.min(0) if i == 0 else c.max(0) for i, c in enumerate(bounds(furniture)))
    slack = _skin(thickness)
    carried = offset - shift[root]
    if ((swept.low + carried[:, None]).min((0, 1)) < low - slack).any():
        return True
    if ((swept.high + carried[:, None]).max((0, 1)) > high + slack).any():
        return True
    for base, (near, far) in clusters.items():
        way = shift[base] + carried
        if (near + way.min(0) < low - slack).any() or (far + way.max(0) > high + slack).any():
            return True
    return False


def _skin(thickness: Thickness) -> float:
    """Knuckles stand this far out of the plates and panels that make up the open furniture."""
    return thickness.panel / 2 + thickness.gap


def _extent(boxes: Boxes, direction: Array) -> tuple[float, float]:
    """Least and greatest coordinate of the boxes along a unit direction (3,)."""
    middle = boxes.center @ direction
    reach = (boxes.half * np.abs(boxes.axes @ direction)).sum(-1)
    return float((middle - reach).min()), float((middle + reach).max())
