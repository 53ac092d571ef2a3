"""Whether a fold keeps to the furniture's outline (section 5.3), or to its bounding box where asked for (section 3).

In-place folding incurs no horizontal expansion: a chain may stick out of the open furniture, seen along its own normal,
only by what a leaning patch adds. The bounding box, `stay_in_box`, holds for everything that a fold carries along.
"""

from __future__ import annotations

from collections.abc import Mapping

from foldfab.folding.model import Chain, Thickness
from foldfab.folding.problem import Problem
from foldfab.geometry.arrays import Array

EXPANSION = 0.1
"""In-place folding may stick out of the furniture's outline by this share of its size in that direction."""


def leaves_outline(problem: Problem, chain: Chain, beside: tuple[float, float]) -> bool:
    """Whether a chain that folds in place leaves the outline of the open furniture along its own normal.

    `beside` is between which coordinates along that normal it stays, mm.
    """
    if chain.mechanism != "in-place":
        return False
    low, high = problem.extent_along(chain.across)
    slack = max(_skin(problem.thickness.of(chain.panel)), EXPANSION * (high - low))
    return beside[0] < low - slack or beside[1] > high + slack


def leaves_box(
    problem: Problem, low: Array, high: Array, clusters: Mapping[str, tuple[Array, Array]], shift: Mapping[str, Array],
    carried: Array,
) -> bool:  # fmt: skip
    """Whether a chain, or anything that moves with the unit's bases, leaves the bounding box of the open furniture.

    Args:
        problem: the open furniture.
        low: (frames, 3) lower corner of the chain, in the frame of the unit's lowest base.
        high: (frames, 3) upper corner.
        clusters: by base of the unit, lower and upper corner (3,) of what moves with it.
        shift: by base of the unit, (frames, 3) its translation in that frame.
        carried: (frames, 3) how far that frame has been carried since the open posture.
    """
    least, most = problem.outline
    slack = _skin(problem.thickness.of(max(site.panel for site in problem.sites.values())))
    if (low + carried < least - slack).any() or (high + carried > most + slack).any():
        return True
    for base, (near, far) in clusters.items():
        way = shift[base] + carried
        if (near + way.min(0) < least - slack).any() or (far + way.max(0) > most + slack).any():
            return True
    return False


def _skin(thickness: Thickness) -> float:
    """Knuckles stand this far out of the plates and panels that make up the open furniture."""
    return thickness.panel / 2 + thickness.gap
