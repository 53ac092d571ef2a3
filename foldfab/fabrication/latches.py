"""A lock pin that holds a base hinge open: 1.75 mm filament, pressed into a groove across the slot of a tongue.

The groove runs along the hinge in the outer face of the base, behind the tongue, and on into the plate on either side
of its slot. With the pin in it the tongue cannot swing back, without it the hinge is free; nothing gives as it turns.
The mouth is narrower than the filament, which snaps in; it is pushed out again through the slot, from the inner face.

The hinge holds up to the least of four moments about its axis, with the tongue's w × t, the pin's arm r and diameter d:

- the pin is sheared at both walls of the slot, F = 2 σ/√3 · πd²/4 (von Mises), or
- bends between them under an even load, clamped at both: F = 12/L · σ πd³/32 over L = w + 2g (Roark, table 8.1), or
- is pressed into the plastic of its seats, F = 2 σ d · `SEAT`: each M = F r;
- the tongue breaks across its layers where it leaves its knuckle: M = τ w t²/6.

σ and τ are what a data sheet of FDM PLA tells: 45 N/mm² at yield along its lines, 26 at break across its layers.
It is tried on the solids: the pin meets nothing open, and the tongue meets it within a few degrees.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, box, placed, rod, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import MEETS, Turn
from foldfab.geometry.arrays import Array

FILAMENT = 1.75
"""Diameter of a pin, mm."""
SNAP = 0.15
"""How much narrower than the filament the mouth of a groove is, mm."""
LEAST_FIT = 0.1
"""What is between a pin and its tongue is half the clearance, and at least this, mm; half of it is around the pin."""
SUNK = 0.1
"""How far a groove ends below the face that it opens, without its mouth, mm."""
SEAT = 2.4
"""How much of a pin lies in the base at either end, mm."""
END = 0.8
"""What is left of the base beyond an end of a pin, mm."""
WALL = 1.6
"""What is left of it behind a pin, mm."""
SKIN = 0.8
"""What is left of it over a pin, mm: four layers."""
BITE = 0.3
"""A tongue reaches over so much of a pin that it would still be held by one thinner by twice this, mm."""
OUT = 10.0
"""How far the way of a pin into its groove has to be free, mm."""
LEAST_LEAN = np.radians(-10.0)
"""A tongue that leans further to the front would press its pin out of the mouth."""
ALONG, ACROSS = 45.0, 26.0
"""What printed PLA bears along its lines and across its layers, N/mm²."""
HOLDS_WITHIN = 8.0
"""A latch that lets a hinge turn further than this is none, degrees."""
STEP = 0.25
"""Degrees between the angles that are tried."""


@dataclass(frozen=True, slots=True, eq=False)
class Lock:
    """The pieces of one latch, in the frame of its mount or, once placed, of the print."""

    pin: Shape
    pushed: Shape
    """The pin against the far wall of its groove."""
    core: Shape
    """Its inner part there, which the tongue has to meet as well."""
    groove: Shape
    """Cut from the base."""
    seats: Shape
    """What has to be of the base, for the pin to lie in."""
    way: Shape
    """Outside of the base, where the pin comes from."""
    ends: Array
    """(2, 3) of the pin's axis, mm."""
    into: Array
    """(3,) the direction in which it is pressed."""
    moment: float
    """N·mm that it holds."""

    def at(self, origin: Array, axes: Array) -> Lock:
        """The same in another place."""
        pin, pushed, core, groove, seats, way = (
            placed(s, origin, axes) for s in (self.pin, self.pushed, self.core, self.groove, self.seats, self.way)
        )
        ends, into = self.ends @ axes + origin, self.into @ axes
        return Lock(pin, pushed, core, groove, seats, way, ends, into, self.moment)


@dataclass(frozen=True, slots=True)
class Tongue:
    """What a pin is to hold: mm in the frame of its mount, where the outer face of the base is at -depth."""

    lean: float
    """From upright to where its panel folds, radians."""
    back: float
    """From its middle to its back, behind which the pin lies."""
    thick: float
    reach: float
    """From the axis to its tip."""
    low: float
    high: float
    """Along the axis."""


def lock(tongue: Tongue, depth: float, plate: float, gap: float) -> Lock | None:
    """The latch of a tongue in a base whose outer face is `depth` below the axis and whose plate is so thick; mm.

    None where the plate is too thin for the groove, or the tongue does not reach as far as the pin.
    """
    fit, radius = max(gap / 2, LEAST_FIT), FILAMENT / 2
    wide = radius + fit / 2
    sin, cos = float(np.sin(tongue.lean)), float(np.cos(tongue.lean))
    behind = tongue.back + fit + radius
    # As close to the face as may be, but where the tongue still reaches past the middle of the pin.
    z = max(wide + SUNK - depth, behind * sin - (tongue.reach - BITE) * cos)
    if tongue.lean < LEAST_LEAN or z + wide + SKIN > plate - depth:
        return None
    arm = (behind * sin - z) / cos
    x = -behind * cos - arm * sin
    low, high = tongue.low - gap - SEAT, tongue.high + gap + SEAT
    # The tongue pushes along its own normal.
    far_x, far_z = x - fit / 2 * cos, z + fit / 2 * sin
    mouth = radius - SNAP / 2
    groove = union(
        [rod(wide, low, high, x, z, is_hole=True), box((x - mouth, low, -depth - SUNK), (x + mouth, high, z))]
    )
    behind_it, top = x - wide - WALL, plate - depth
    seats = union(
        [
            box((behind_it, low - END, -depth), (0.0, low + SEAT, top)),
            box((behind_it, high - SEAT, -depth), (0.0, high + END, top)),
        ]
    )
    return Lock(
        pin=rod(radius, low, high, x, z, is_hole=True),
        pushed=rod(radius, low, high, far_x, far_z),
        core=rod(radius - BITE, low, high, far_x, far_z),
        groove=groove,
        seats=seats,
        way=box((x - radius, low, -depth - OUT), (x + radius, high, -depth - SUNK)),
        ends=np.array([[x, low, z], [x, high, z]]),
        into=np.array([0.0, 0.0, 1.0]),
        moment=moment(tongue.high - tongue.low, tongue.thick, arm, gap),
    )


def moment(width: float, thick: float, arm: float, gap: float) -> float:
    """What a pin holds at `arm` from the axis, behind a tongue `width` × `thick` in a slot a gap wider; N·mm."""
    shear = 2 * ALONG / np.sqrt(3) * np.pi * FILAMENT**2 / 4
    bend = 12 / (width + 2 * gap) * ALONG * np.pi * FILAMENT**3 / 32
    pressed = 2 * ALONG * FILAMENT * SEAT
    return float(min(min(shear, bend, pressed) * arm, ACROSS * width * thick**2 / 6))


def held_at(range_: Turn, panel: Solid, made: Lock, *, is_base_first: bool) -> float | None:
    """How far a hinge turns from open before its tongue meets the pin, degrees; None where it passes it."""
    pins = [printed(made.pushed), printed(made.core)]
    angles = np.arange(STEP, HOLDS_WITHIN + STEP, STEP)
    found = [next((float(a) for a in angles if _meets(range_, panel, p, a, is_base_first)), None) for p in pins]
    return None if None in found else found[0]


def is_free(bodies: Iterable[Solid], made: Lock) -> bool:
    """Whether bodies, the base with its groove among them, leave room for the pin and its way there, open."""
    pin, way = printed(made.pin), printed(made.way)
    return all(solids.overlap(solid, piece) <= MEETS for solid in bodies for piece in (pin, way))


def is_seated(base: Solid, made: Lock) -> bool:
    """Whether a base, its groove cut or not, has all that a pin is to lie in."""
    return float(solids.cut(printed(made.seats), [base, printed(made.groove)]).volume()) <= MEETS


def _meets(range_: Turn, panel: Solid, pin: Solid, angle: float, is_base_first: bool) -> bool:
    first, second = (pin, panel) if is_base_first else (panel, pin)
    return solids.overlap(first, solids.moved(second, range_.past(-angle, is_folded=False))) > MEETS
