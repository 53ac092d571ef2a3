"""What the hinges of a print do when each is turned on, with its two halves as they are or would be.

A hinge stops in time within `PAST` of either end of its range; a latch holds it where its pin is seated, has room, and
the panel meets it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from foldfab.fabrication.latches import Lock, held_at, is_free, is_seated
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.mounts import Stop
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import PAST, Turn, meets, stops_at, turns
from foldfab.geometry.arrays import Array

Made = Mapping[str, Solid]
"""Bodies as they are or would be, by name."""


@dataclass(frozen=True, slots=True, eq=False)
class Hinges:
    """The hinges of a print, by name."""

    turns: Mapping[str, Turn]
    """Their ranges."""
    parts: Mapping[str, tuple[str, str]]
    """Their two bodies."""
    bases: frozenset[str]
    """The bodies that are bases."""


def hinges_of(assembly: Assembly, poses: Mapping[str, Array]) -> Hinges:
    """The hinges of a print whose bodies take poses (k, 4, 4) over its fold."""
    bases = frozenset(base.name for base in assembly.solution.scaffold.bases)
    return Hinges(turns(assembly.joints, poses), {j.name: j.parts for j in assembly.joints}, bases)


def is_prompt(hinges: Hinges, joint: str, made: Made, *, is_folded: bool) -> bool:
    """Whether a hinge stops within `PAST` of an end of its range."""
    return meets(hinges.turns[joint], *_halves(hinges, joint, made), PAST, is_folded=is_folded)


def angle_of(hinges: Hinges, stop: Stop, made: Made) -> float | None:
    """How far a hinge turns past the end of its range that a stop is for, degrees; None where nothing stops it."""
    return stops_at(hinges.turns[stop.joint], *_halves(hinges, stop.joint, made), is_folded=stop.is_folded)


def unstopped(hinges: Hinges, made: Made, name: str, solid: Solid) -> str:
    """That a hinge which stops in time would do so no more with another solid for a body, or nothing."""
    then = {**made, name: solid}
    for joint, parts in hinges.parts.items():
        for is_folded in (False, True) if name in parts else ():
            was = is_prompt(hinges, joint, made, is_folded=is_folded)
            if was and not is_prompt(hinges, joint, then, is_folded=is_folded):
                return f"leaves {joint} without a stop"
    return ""


def unlatched(hinges: Hinges, locks: Mapping[str, Lock], made: Made, changed: Made) -> str:
    """That one of the latches, by joint, would not hold any more with some bodies changed, or nothing."""
    then = {**made, **changed}
    for joint, held in locks.items():
        is_held = is_free(changed.values(), held)
        if is_held and {*hinges.parts[joint]} & {*changed}:
            base, _ = _leaf(hinges, joint)
            is_held = is_seated(then[base], held) and play(hinges, joint, held, then) is not None
        if not is_held:
            return f"leaves {joint} without a latch"
    return ""


def play(hinges: Hinges, joint: str, held: Lock, made: Made) -> float | None:
    """How far a hinge turns from open before its pin holds it, degrees; None where it does not, or has no room."""
    if not is_free(made.values(), held):
        return None
    base, panel = _leaf(hinges, joint)
    return held_at(hinges.turns[joint], made[panel], held, is_base_first=hinges.parts[joint][0] == base)


def _leaf(hinges: Hinges, joint: str) -> tuple[str, str]:
    """The base of a base hinge, and the panel that it holds."""
    first, second = hinges.parts[joint]
    return (first, second) if first in hinges.bases else (second, first)


def _halves(hinges: Hinges, joint: str, made: Made) -> tuple[Solid, Solid]:
    first, second = hinges.parts[joint]
    return made[first], made[second]
