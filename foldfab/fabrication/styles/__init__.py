"""What pins the knuckles of a hinge together: a module a style, each with a `carrier` and a `follower`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.styles import clip, cone, filament, screw
from foldfab.folding.model import Thickness
from foldfab.recipe.hinges import HingeKind

Half = Callable[[Knuckles, Thickness, float, float], tuple[list[Shape], list[Shape]]]
"""Material and holes of one half of a hinge around the axis (x, z) of the local frame; holes are cut last."""


@dataclass(frozen=True, slots=True)
class Style:
    """How the two halves of a hinge are made."""

    carrier: Half
    follower: Half
    bores: tuple[float, ...] = ()
    """Radii of the holes for a pin that is put in later, mm: of what it turns in, then of its thread."""


def style(kind: HingeKind) -> Style:
    """The style of that kind."""
    made: dict[HingeKind, Style] = {
        "cone": Style(cone.carrier, cone.follower),
        "filament": Style(filament.carrier, filament.follower, (filament.BORE_RADIUS,)),
        **{kind: Style(screw.carrier, screw.follower, (s.clearance, s.core)) for kind, s in screw.SCREWS.items()},
        "clip": Style(clip.carrier, clip.follower),
    }
    return made[kind]
