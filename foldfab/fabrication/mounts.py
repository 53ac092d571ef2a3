"""A base hinge as its stops see it: in a frame of its own, with what it stands on and how its panel leans.

The frame has x to where the panel folds, y along the axis and z away from the base; the axis is its origin.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from foldfab.fabrication.hinges import Knuckles, Mark, knuckles
from foldfab.fabrication.latches import Lock
from foldfab.fabrication.plates import axis_of
from foldfab.fabrication.shapes import Shape, placed
from foldfab.folding.anatomy import faces
from foldfab.folding.mechanism import tilts
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array

WIDEST, NARROWEST = 8.0, 1.2
"""Width of a tongue, a lap or a rest along the axis, mm; three lines of a nozzle at least."""
SHARED = 2.0
"""A knuckle has two tongues where each may be at least this wide, mm."""
WALL = 1.2
"""What is left between the slots of two tongues, mm."""
INSET = 0.2
"""How far a tongue stays within its knuckle at either side, mm, so that slots end short of the feet's faces."""


@dataclass(frozen=True, slots=True, eq=False)
class Stop:
    """One way to stop one hinge: material and holes for the two bodies, open posture, canonical frame."""

    joint: str
    kind: str
    is_folded: bool
    """Whether it works at the folded end."""
    body: str
    """To which the material belongs."""
    added: Shape
    other: str
    """The body that it meets."""
    lip: Shape | None = None
    """What the other body is given first, where it ends too early."""
    cut: Shape | None = None
    """What is taken from the other body."""
    lock: Lock | None = None
    """What could hold it open besides."""


@dataclass(frozen=True, slots=True, eq=False)
class Mount:
    """A base hinge in its own frame."""

    joint: str
    base: str
    panel: str
    """The two bodies that it holds together."""
    origin: Array
    frame: Array
    """(3, 3) rows x, y, z."""
    lean: float
    """Tilt of the open panel from z towards x, radians."""
    marks: Knuckles
    span: Mark
    """Of the hinge."""
    depth: float
    """From the axis to the far face of the base, mm."""
    plate: float
    """Thickness of the base below the hinge, mm."""
    thickness: Thickness

    def placed(self, stop: Stop) -> Stop:
        """A stop in this frame, in the frame of the print."""
        added, lip, cut = (s and placed(s, self.origin, self.frame) for s in (stop.added, stop.lip, stop.cut))
        assert added is not None
        return replace(stop, added=added, lip=lip, cut=cut, lock=stop.lock and stop.lock.at(self.origin, self.frame))


def names(chain: Chain, hinge: int) -> tuple[str, str, str]:
    """The name of a hinge of a chain, by its number, and those of its two bodies."""
    first, second = chain.bodies[hinge : hinge + 2]
    return f"{first}~{second}", first, second


def mount(solution: FoldSolution, chain: Chain, hinge: int) -> Mount:
    """The mount of a base hinge, by its number in its chain."""
    thickness = solution.thickness
    is_far = hinge > 0
    name, first, second = names(chain, hinge)
    parts = (second, first) if is_far else (first, second)
    base = solution.scaffold.base(chain.far or "" if is_far else chain.anchor)
    open_, folded = tilts(chain, np.array([0.0, 1.0]))[:, -1 if is_far else 0]
    out = -chain.rise if is_far else chain.rise
    side = float(np.sign(folded - open_)) * (-1.0 if is_far else 1.0)
    frame = np.stack([side * chain.across, np.cross(out, side * chain.across), out])
    way = float(frame[1] @ chain.along)
    marks = knuckles(chain.hinge_spans[hinge], thickness.of(chain.panel), chain.breaks)
    marks = marks if way > 0 else marks.mirrored
    low, high = sorted(way * float(end) for end in chain.hinge_spans[hinge])
    face, own = faces(base, thickness), thickness.of(chain.panel)
    pad, plate = chain.pads[1 if is_far else 0], face.top - face.bottom
    depth = own.axis_height + pad + plate
    lean = float(open_) * side * (-1.0 if is_far else 1.0)
    axis = axis_of(chain, 1 if is_far else 0)
    return Mount(name, *parts, axis, frame, lean, marks, (low, high), depth, plate + min(pad, 0.0), own)


def leant(solid: Shape, lean: float) -> Shape:
    """Turned around the axis of a mount, from upright to where its panel folds, radians."""
    return placed(solid, np.zeros(3), leaning(lean))


def leaning(lean: float) -> Array:
    """(3, 3) rows x, y, z of what leans so, in the frame of its mount."""
    sin, cos = np.sin(lean), np.cos(lean)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])


def within(marks: tuple[Mark, ...], gap: float, wall: float = WALL) -> Iterator[Mark]:
    """Places within knuckles, the widest first: at either end of each, for another chain may want one, then amid.

    Between the slots of two there is at least `wall`, mm.
    """
    middle = (marks[0][0] + marks[-1][1]) / 2
    for low, high in sorted(marks, key=lambda m: (-round(m[1] - m[0], 6), abs(sum(m) / 2 - middle), m)):
        room = high - low - 2 * INSET
        width = min((room - 2 * gap - wall) / 2, WIDEST)
        if width >= SHARED:
            yield low + INSET, low + INSET + width
            yield high - INSET - width, high - INSET
        if room >= NARROWEST:
            width = min(room, WIDEST)
            yield (low + high - width) / 2, (low + high + width) / 2


def spots(span: Mark, widest: float, breaks: tuple[Mark, ...], ramp: float = 0.0) -> Iterator[Mark]:
    """Places on a span: in its middle, then towards its ends, then narrow ones; each with room for a `ramp`, mm.

    None is in what is to be left free.
    """
    low, high = span
    for room in (min((high - low) / 2, widest), min((high - low) / 4, widest / 2)):
        width = room + ramp
        if room >= NARROWEST and width <= high - low:
            for share in (0.5, 0.1, 0.9):
                start = low + share * (high - low - width)
                if not any(a < start + width and start < b for a, b in breaks):
                    yield start, start + width
