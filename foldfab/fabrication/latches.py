"""A detent that holds a base hinge open: ridges in the slot of a stop's tongue, behind which its two prongs snap.

A slit parts the tongue into two prongs that give by `FLEX` each while it passes. The moment that holds the hinge is
that of two cantilevers pressed in by `FLEX` over a flank of 45°: M = 2 F r with F = 3 E I FLEX/L³.
It is tried on the solids: it meets the ridges where it leaves its play, and with the prongs pressed in it passes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.model import Latch
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, placed, rod, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import MEETS, Turn

FLEX = 0.15
"""What each prong gives, mm: 1.5 % of strain at its root, within what PLA takes."""
PRONG = 1.2
"""Thickness of a prong, mm."""
SLIT = 0.5
"""Least width of the slit, mm."""
RIDGE = 0.7
"""Radius of a ridge, mm."""
TALL = 1.6
"""Height of a ridge, at the tip of the tongue, mm."""
ROOT_SHARE = 0.3
"""Where the slit ends, as a share of K below the axis."""
STIFFNESS = 2300.0
"""Young's modulus of printed PLA, N/mm²; the solid plastic has half as much again."""
SPARE = 0.03
"""How much further than `FLEX` a prong is pressed in to pass, mm: rounding."""
HOLDS_WITHIN = 12.0
"""A latch that lets a hinge turn further than this before it meets the ridges is none, degrees."""
PASSED = 40.0
"""Well past the ridges, degrees."""
STEP = 0.5
"""Degrees between the angles that are tried."""


@dataclass(frozen=True, slots=True, eq=False)
class Detent:
    """The pieces of one latch, in the frame of the open panel or, once placed, of the print."""

    ridges: Shape
    """Added to the base."""
    slit: Shape
    """Cut from the panel."""
    pressed: Shape
    """What of the panel gives way while it passes."""
    moment: float
    """N·mm that hold the hinge."""

    def at(self, origin: np.ndarray, axes: np.ndarray) -> Detent:
        """The same in another place."""
        ridges, slit, pressed = (placed(s, origin, axes) for s in (self.ridges, self.slit, self.pressed))
        return Detent(ridges, slit, pressed, self.moment)


def detent(half: float, front: float, reach: float, gap: float, low: float, high: float) -> Detent | None:
    """The latch of a tongue from -half to `front` across, `low` to `high` along the axis and down to -reach; mm.

    None where the tongue is too narrow for two prongs.
    """
    if high - low < 2 * PRONG + SLIT:
        return None
    root = 2 * half * ROOT_SHARE
    middle = -half - gap - RIDGE
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    ridges = [
        placed(rod(RIDGE, -reach, TALL - reach, 0.0, 0.0), np.array([middle, y, 0.0]), upright)
        for y in (low + FLEX - RIDGE, high - FLEX + RIDGE)
    ]
    slit = box((-2 * half, low + PRONG, -reach - 1.0), (2 * half, high - PRONG, -root))
    give = FLEX + SPARE
    skins = [
        box((-2 * half, a, -reach - 1.0), (2 * half, b, -root))
        for a, b in ((low - 1, low + give), (high - give, high + 1))
    ]
    arm, lever = reach - TALL / 2, reach - TALL / 2 - root
    stiff = (half + front) * PRONG**3 / 12
    force = 3 * STIFFNESS * stiff * FLEX / lever**3
    return Detent(union(ridges), slit, union(skins), 2 * force * arm)


def tried(range_: Turn, base: Solid, panel: Solid, made: Detent, *, is_base_first: bool) -> Latch | None:
    """What a latch does on the solids; None where it does not hold, or does not pass with its prongs pressed in."""
    pressed = solids.cut(panel, [printed(made.pressed)])
    angles = np.arange(STEP, PASSED + STEP, STEP)
    shared = [_shared(range_, base, panel, angle, is_base_first) for angle in angles]
    held = next((float(a) for a, s in zip(angles, shared, strict=True) if s > MEETS and a <= HOLDS_WITHIN), None)
    is_free = all(_shared(range_, base, pressed, angle, is_base_first) <= MEETS for angle in angles)
    return Latch(held, made.moment, FLEX, max(shared)) if held is not None and is_free else None


def _shared(range_: Turn, base: Solid, panel: Solid, angle: float, is_base_first: bool) -> float:
    """Shared volume when the hinge is turned by an angle from its open end towards its folded one, mm³."""
    first, second = (base, panel) if is_base_first else (panel, base)
    return solids.overlap(first, solids.moved(second, range_.past(-angle, is_folded=False)))
