"""The noun of this room: an Assembly, printed bodies that are held together by hinges, and their motion."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from foldfab.fabrication.shapes import Point, Shape
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array, Indices, frozen, frozen_indices
from foldfab.recipe.model import Posture


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """One rigid printed part: a closed mesh in the canonical frame (d = -Z), open posture, print millimetres."""

    name: str
    kind: Literal["base", "panel"]
    vertices: Array
    """(n, 3) mm."""
    faces: Indices
    """(m, 3) counter-clockwise seen from outside."""
    normal: Array
    """(3,) unit normal of its plate, open posture, canonical frame."""
    volume: float
    """mm³."""
    hinge_faces: Indices
    """(k,) faces that belong to hinges that were added (for pictures)."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, -1, 3))
        object.__setattr__(self, "faces", frozen_indices(self.faces, -1, 3))
        object.__setattr__(self, "normal", frozen(self.normal, 3))
        object.__setattr__(self, "hinge_faces", frozen_indices(self.hinge_faces, -1))


@dataclass(frozen=True, slots=True)
class Latch:
    """What holds a hinge in its open place: a pin of filament in a groove of its base."""

    base: str
    """The body that has the groove."""
    pin: tuple[Point, Point]
    """The ends of the pin's axis, open posture, canonical frame, mm."""
    into: Point
    """Unit vector in which it is pressed into its groove."""
    holds_at: float
    """How far the hinge turns towards folded before the pin holds it, degrees."""
    moment: float
    """Up to which it holds, N·mm: a force times its arm from the axis."""

    @property
    def length(self) -> float:
        """Of the pin, mm."""
        return math.dist(*self.pin)


@dataclass(frozen=True, slots=True)
class Seam:
    """What holds two pieces of one part together, that was cut because it is longer than the bed."""

    kind: Literal["dovetail", "splice"]
    keys: int
    """How many tongues of the one piece lie in sockets of the other."""
    fit: float
    """The gap around them, mm."""
    pull: Point
    """Unit vector along which the second piece cannot be pulled off the first, open posture, canonical frame."""


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """One hinge between two bodies, or the seam between two pieces of a part."""

    name: str
    parts: tuple[str, str]
    axis: Array
    """(2, 3) the ends of the axis, open posture, canonical frame, mm."""
    radius: float
    """mm."""
    range_deg: tuple[float, float]
    """How far it may turn from the open posture."""
    is_inserted: bool
    """True where it splits a patch, False where it joins a patch to a base."""
    stop_deg: tuple[float | None, float | None] = (None, None)
    """How far past its open and its folded end it turns before its halves meet; None where they never do."""
    stops: tuple[str, ...] = ()
    """What was added to stop it: `tongue`, `arm`, `post`, `lap`, `heel`, `butt`, `rest`."""
    latch: Latch | None = None
    """What holds it open, where that was asked for."""
    seam: Seam | None = None
    """What it is where it does not turn; its axis is then the line that was cut, its radius half the plate."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "axis", frozen(self.axis, 2, 3))


@dataclass(frozen=True, slots=True)
class Finding:
    """Something worth knowing about the result that does not stop it from working, or that does."""

    code: str
    """Short and stable, such as `widened` or `clash`."""
    text: str
    """One sentence: which part, which number, what to change."""
    is_fatal: bool = False
    """True where the print would not work."""


AS_READ = "as-read"
"""The code of findings that the recipe brings with it."""
LEVEL = "level"
"""The code of a finding about knuckles that have no ramps on edge."""


@dataclass(frozen=True, slots=True, eq=False)
class Assembly:
    """All bodies, joints and poses of one print."""

    solution: FoldSolution
    """What it was made from; `solution.scaffold.recipe` is the furniture."""
    bodies: tuple[Body, ...]
    """Sorted by name."""
    joints: tuple[Joint, ...]
    """Sorted by name."""
    times: Array
    """(k,) key times t in [0, 1], strictly increasing from 0 to 1."""
    poses: dict[str, Array]
    """By body, (k, 4, 4) rigid motions from the open posture, canonical frame, mm."""
    posture: Posture
    """How the print file is laid out."""
    findings: tuple[Finding, ...]
    shapes: dict[str, Shape] = field(default_factory=dict)
    """By body, what it is made of, open posture, canonical frame, mm."""
    up: Array | None = None
    """(3,) the hinge direction that points up where it stands on edge, canonical frame; None in other postures."""

    propped: tuple[Body, ...] = ()
    """The bodies that are printed with a prop to be broken off, with it; sorted by name."""
    spared: frozenset[str] = frozenset()
    """The parts that keep their edges on the bed, because a hinge needs them to stop."""
    pieces: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """By part that was cut because it is longer than the bed, the bodies that it became."""

    @property
    def hinges(self) -> tuple[Joint, ...]:
        """The joints that turn."""
        return tuple(joint for joint in self.joints if joint.seam is None)

    def __post_init__(self) -> None:
        object.__setattr__(self, "times", frozen(self.times, -1))
        if self.up is not None:
            object.__setattr__(self, "up", frozen(self.up, 3))
        poses = {name: frozen(pose, -1, 4, 4) for name, pose in self.poses.items()}
        object.__setattr__(self, "poses", poses)
