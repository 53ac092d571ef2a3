"""How the knuckles of a hinge are pinned together, and the least sizes that each way needs (mm of print).

The table of what there is; what a style adds and cuts is made in `foldfab.fabrication.styles`, a module a style.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

HingeKind = Literal["cone", "filament", "screw-m2", "screw-m3", "clip"]

IN_PLACE_POSTURES = ("open", "folded", "edge")
"""Postures in which everything is printed together, so that hinges must hold without anything put in later."""


@dataclass(frozen=True, slots=True)
class HingeStyle:
    """The least sizes of one way to pin a hinge."""

    kind: HingeKind
    least_thickness: float
    """Least K, with walls of two lines around what is bored, mm."""
    knuckle: float
    """Least length of a knuckle of the carrier, mm; that of a cone follows from its socket instead."""
    pin_knuckle: float
    """Least length of a knuckle of the follower, mm."""
    head: float = 0.0
    """Room along the axis before the first knuckle, mm."""
    tip: float = 0.0
    """What the last knuckle is longer than the others, mm: a blind end, or thread."""
    has_loose_pin: bool = False
    """Whether the pin is a thing of its own that is put in after printing."""
    longest: float | None = None
    """Most width that one pin spans, mm; a wider hinge gets two, from both ends."""


STYLES = MappingProxyType(
    {
        style.kind: style
        for style in (
            HingeStyle("cone", 2.0, 0.0, 1.6),
            HingeStyle("filament", 4.0, 2.0, 2.0, tip=0.8, has_loose_pin=True),
            HingeStyle("screw-m2", 4.0, 2.0, 2.0, head=1.9, tip=2.0, has_loose_pin=True, longest=20.0),
            HingeStyle("screw-m3", 6.0, 2.4, 2.4, head=2.7, tip=3.6, has_loose_pin=True, longest=30.0),
            HingeStyle("clip", 4.0, 2.4, 2.0),
        )
    }
)
"""By kind."""


def hinge_problem(kind: HingeKind, thickness: float | None, posture: str | None) -> str | None:
    """Why hinges of a kind cannot be made in plates of a thickness (mm), printed in a posture, and what would do."""
    style = STYLES[kind]
    if thickness is not None and thickness < style.least_thickness:
        # Parts that are printed apart cannot have cones, those that are printed in place no loose pins.
        fits = {k: s for k, s in STYLES.items() if s.least_thickness <= thickness}
        able = [k for k, s in fits.items() if (k != "cone" if posture == "plate" else not s.has_loose_pin)]
        other = f"the hinge {' or '.join(able)}" if able else "another posture"
        return (
            f"{kind} needs plates of at least {style.least_thickness:g} mm, these are {thickness:g} mm; "
            f"give a thickness of {style.least_thickness:g} or more, or {other}"
        )
    if style.has_loose_pin and posture in IN_PLACE_POSTURES:
        return (
            f"{kind} is put in after printing, so what is printed {posture} would fall apart; "
            "give the posture plate, or the hinge cone or clip, which hold by themselves"
        )
    return None
