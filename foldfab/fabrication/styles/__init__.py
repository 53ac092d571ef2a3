"""What pins the knuckles of a hinge together: a module a style, each with a `carrier` and a `follower`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from foldfab.fabrication.hinges import Knuckles
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.styles import clip, cone, filament, screw
from foldfab.folding.model import Thickness
from foldfab.recipe.hinges import HingeKind

Half = Callable[[Knuckles, Thickness, float, float], tuple[list[Solid], list[Solid]]]
"""Material and holes of one half of a hinge around the axis (x, z) of the local frame; holes are cut last."""


@dataclass(frozen=True, slots=True)
class Style:
    """How the two halves of a hinge are made."""

    carrier: Half
    follower: Half


def style(kind: HingeKind) -> Style:
    """The style of that kind."""
    made: dict[HingeKind, Style] = {
        "cone": Style(cone.carrier, cone.follower),
        "filament": Style(filament.carrier, filament.follower),
        "screw-m2": Style(screw.carrier, screw.follower),
        "screw-m3": Style(screw.carrier, screw.follower),
        "clip": Style(clip.carrier, clip.follower),
    }
    return made[kind]
