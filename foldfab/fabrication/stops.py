"""Stops: what keeps a base hinge from turning past upright, and an inserted one past straight.

Two faces that are a clearance g apart as printed meet within an angle φ only if they are r ≥ g/sin φ from the axis:
5.7 mm for 0.3 mm and 3°, where a knuckle's radius is K/2 = 2 mm. So printed `open`:

- *tongue*: a follower's knuckle reaches down through a slot in its base and meets the slot's wall. Folded, it lies in
  the layer of its own panel, so that the stack stays as low as it is; a post beside the panel would not.
- *lap*: at an inserted hinge the half of one panel away from the axis laps into a recess of the other one.

Printed in another posture these faces are far apart on the bed, and may be closer than g where they meet:

- *heel*: a follower's knuckle is squared on the side away from the fold and meets the base;
- *butt*: the ends of two panels are closer than g on the side away from the axis.

At the folded end a panel meets what it lies on; where its base ends too early, a *rest* reaches out below it.

A stop is tried on the solids (`trial`) before it is made: there may be no room for it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication.hinges import Knuckles, Mark, knuckles
from foldfab.fabrication.latches import Detent, detent
from foldfab.fabrication.plates import axis_of
from foldfab.fabrication.relief import STEEP
from foldfab.fabrication.shapes import Shape, box, cut, placed, prism
from foldfab.fabrication.walls import LINE
from foldfab.folding.anatomy import faces
from foldfab.folding.mechanism import frames, joints, tilts
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array

CLOSE = 0.95
"""The gap at a stop as a share of the clearance: what the inspection lets pass, for a shorter lever."""
AIM = np.radians(2.4)
"""The angle that levers are made for, so that there is material at 3° and not only a touch."""
LEAST = np.radians(2.75)
"""The angle that they are made for at least, if there is a place for it."""
NEAR = np.radians(1.5)
"""The angle at which faces meet that are not printed beside each other."""
WIDEST, NARROWEST = 8.0, 1.2
"""Width of a tongue, a lap or a rest along the axis, mm; three lines of a nozzle at least."""
SHARED = 2.0
"""A knuckle has two tongues where each may be at least this wide, mm."""
WALL = 1.2
"""What is left between the slots of two tongues, mm."""
INSET = 0.2
"""How far a tongue stays within its knuckle at either side, mm, so that slots end short of the feet's faces."""
LIFT = 0.2
"""How far a tongue ends above the far face of its base, mm: it must not stick to the bed."""
OPEN = 0.1
"""How far a slot is cut beyond the far face of its base, mm; another panel may fold there."""
SKIN = 0.8
"""Less than this below a slot is not left standing, mm."""
WEB = 1.5
"""How far a lap reaches into its own panel, mm."""
FAR = 100.0
"""Beyond everything that a stop is cut with, mm."""
EDGE = 2 * LINE
"""A wall thinner than this between a slot and an edge of its base may be cut away, mm."""

_LYING = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a prism, drawn along y, so that it is drawn along -z and its outline lies in x and y."""


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
    cut: Shape | None = None
    """What is taken from the other body."""
    detent: Detent | None = None
    """What could hold it open besides."""


@dataclass(frozen=True, slots=True, eq=False)
class _Mount:
    """A base hinge in its own frame: x to where the panel folds, y along the axis, z away from the base."""

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
    thickness: Thickness


def stops(solution: FoldSolution, chain: Chain, hinge: int, *, in_open: bool) -> Iterator[Stop]:
    """The ways to stop a hinge (its number in the chain) at its open end, best first.

    `in_open` says whether the print is laid out open.
    """
    name, first, second = _names(chain, hinge)
    if 0 < hinge < len(chain.lengths):
        make = _laps if in_open else _butts
        yield from make(chain, hinge, solution.thickness.of(chain.panel), name)
        return
    mount = _mount(solution, chain, hinge)
    base, panel = (first, second) if hinge == 0 else (second, first)
    is_tongue = in_open or solution.scaffold.recipe.print.latch
    for added in () if is_tongue else _heels(mount):
        yield Stop(name, "heel", False, panel, placed(added, mount.origin, mount.frame), base)
    for added, slot, holding in _tongues(mount):
        material = placed(added, mount.origin, mount.frame)
        hole = slot and placed(slot, mount.origin, mount.frame)
        latch = holding and holding.at(mount.origin, mount.frame)
        yield Stop(name, "tongue", False, panel, material, base, hole, latch)


def rests(solution: FoldSolution, chain: Chain, hinge: int, up: Array | None = None) -> Iterator[Stop]:
    """The ways to stop a base hinge at its folded end.

    `up` (3,) is the hinge direction that points up in print, where it stands on edge: there a rest has a ramp below it.
    """
    if 0 < hinge < len(chain.lengths):
        return
    name, first, second = _names(chain, hinge)
    base, panel = (first, second) if hinge == 0 else (second, first)
    mount = _mount(solution, chain, hinge)
    top = -mount.thickness.axis_height
    reach = mount.thickness.gap / np.sin(AIM)
    thick = min(mount.thickness.panel, mount.depth + top)
    way = 0.0 if up is None else float(np.sign(mount.frame[1] @ up))
    ramp = abs(way) * STEEP * max(reach - mount.thickness.panel / 2, 0.0)
    for low, high in _places(mount.span, WIDEST, mount.marks.free, ramp):
        tab = _tab(mount.thickness.panel / 2, reach, (low, high), way * ramp)
        flat = placed(prism(tab, -top, thick - top), np.zeros(3), _LYING)
        yield Stop(name, "rest", True, base, placed(flat, mount.origin, mount.frame), panel)


def _tab(root: float, reach: float, span: Mark, ramp: float) -> list[tuple[float, float]]:
    """The outline (x, y) of a rest, whose tip is `ramp` mm narrower than its root: below, or above where it is < 0."""
    low, high = span
    ends = (low + max(ramp, 0.0), high + min(ramp, 0.0))
    return [(0.0, low), (root, low), (reach, ends[0]), (reach, ends[1]), (root, high), (0.0, high)]


def _names(chain: Chain, hinge: int) -> tuple[str, str, str]:
    first, second = chain.bodies[hinge : hinge + 2]
    return f"{first}~{second}", first, second


def _mount(solution: FoldSolution, chain: Chain, hinge: int) -> _Mount:
    thickness = solution.thickness
    is_far = hinge > 0
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
    depth = own.axis_height + chain.pads[1 if is_far else 0] + face.top - face.bottom
    lean = float(open_) * side * (-1.0 if is_far else 1.0)
    return _Mount(axis_of(chain, 1 if is_far else 0), frame, lean, marks, (low, high), depth, own)


def _tongues(mount: _Mount) -> Iterator[tuple[Shape, Shape | None, Detent | None]]:
    """Along the panel where its base is thick enough; then leant until they are long enough; then as long as may be."""
    lever = CLOSE * mount.thickness.gap / np.sin(LEAST)
    is_long = _room_below(mount, mount.lean) >= lever
    if is_long:
        yield from _tongue(mount, mount.lean)
    back, front = mount.thickness.panel / 20, mount.depth - LIFT
    reach = float(np.hypot(lever, back))
    if front < reach:
        yield from _tongue(mount, float(np.arctan2(back, lever) + np.arccos(front / reach)))
    yield from _arms(mount, lever)
    if not is_long:
        yield from _tongue(mount, mount.lean)


def _room_below(mount: _Mount, lean: float) -> float:
    """How far a tongue that leans so may reach from its axis at its front, mm."""
    return (mount.depth - LIFT - mount.thickness.panel / 20 * float(np.sin(lean))) / float(np.cos(lean))


def _tongue(mount: _Mount, lean: float) -> Iterator[tuple[Shape, Shape, Detent | None]]:
    half, gap = mount.thickness.panel / 2, mount.thickness.gap
    close, front = CLOSE * gap, half / 10
    # Along its panel it may be as thick as that; else it is as thin as may be, for it stands out when it is folded.
    back = half if lean == mount.lean else NARROWEST - front
    reach = min(close / np.sin(AIM), _room_below(mount, lean))
    sweep = float(np.hypot(half, reach)) + gap
    is_through = mount.depth - (reach + gap) * np.cos(lean) < SKIN
    top = sweep * max(0.0, float(np.sin(-lean)))
    # Seen along a panel that leans, corners are not equally deep.
    deep, below = (box((-FAR * 10, -FAR * 10, -FAR * 10), (FAR * 10, FAR * 10, z - mount.depth)) for z in (LIFT, -OPEN))
    # A slot that ends close to an edge of its base is opened there, because the wall beyond it would be too thin.
    for spare, (low, high) in itertools.product((0.0, EDGE), _within(mount.marks.follower, gap)):
        bottom = -(mount.depth + FAR) if is_through else -(reach + gap)
        slot = _leant(box((-sweep - spare, low - gap, bottom), (front + close, high + gap, top)), lean)
        slot = cut(slot, [below]) if is_through else slot
        holding = detent(back, front, reach, gap, low, high)
        holding = holding and holding.at(np.zeros(3), _leaning(lean))
        yield cut(_leant(box((-back, low, -reach), (front, high, 0.0)), lean), [deep]), slot, holding


def _arms(mount: _Mount, reach: float) -> Iterator[tuple[Shape, None, None]]:
    """What lies on the base behind the panel, where no slot may be: it stands up when it is folded."""
    top = CLOSE * mount.thickness.gap - mount.thickness.axis_height
    for low, high in _within(mount.marks.follower, mount.thickness.gap):
        yield box((-reach, low, top), (0.0, high, top + NARROWEST)), None, None


def _heels(mount: _Mount) -> Iterator[Shape]:
    half, height = mount.thickness.panel / 2, mount.thickness.axis_height
    # Below a panel that leans over it the heel is shorter, so that it stays within the panel's layer.
    lever = min(half, (half - height * float(np.sin(-mount.lean))) / float(np.cos(mount.lean)))
    lift = lever * float(np.sin(NEAR))
    beyond = _leant(box((-FAR, -FAR * 10, -FAR), (-half, FAR * 10, FAR)), mount.lean)
    for low, high in mount.marks.follower if lever > 0 else ():
        yield cut(box((-half, low, lift - height), (-lever / 2, high, 0.0)), [beyond])


def _laps(chain: Chain, hinge: int, thickness: Thickness, name: str) -> Iterator[Stop]:
    half, gap = thickness.panel / 2, thickness.gap
    close, back = CLOSE * gap, -float(np.sign(chain.offsets[hinge]))
    origin, axes = _straight(chain, hinge)
    # The longer panel gets the recess; then the other one is tried.
    for above in sorted((True, False), key=lambda above: -_free(chain, hinge, above, thickness)):
        z = -1.0 if above else 1.0
        reach = min(close / np.sin(AIM), _free(chain, hinge, above, thickness))
        tongue = _spread(back * close / 2, back * half, -z * WEB, z * reach)
        recess = _spread(-back * close / 2, back * (half + 1.0), 0.0, z * (reach + gap))
        below, over = chain.panels[hinge - 1], chain.panels[hinge]
        body, other = (over, below) if above else (below, over)
        for low, high in _places((float(chain.span[0]), float(chain.span[1])), WIDEST, chain.breaks):
            added, hole = _slab(tongue, low, high), _slab(recess, low - gap, high + gap)
            yield Stop(name, "lap", False, body, placed(added, origin, axes), other, placed(hole, origin, axes))


def _butts(chain: Chain, hinge: int, thickness: Thickness, name: str) -> Iterator[Stop]:
    half, gap = thickness.panel / 2, thickness.gap
    back = -float(np.sign(chain.offsets[hinge]))
    origin, axes = _straight(chain, hinge)
    near = (thickness.axis_offset + half) * float(np.sin(NEAR)) - gap / 2
    low, high = (float(end) for end in chain.span)
    added = _slab(_spread(back * half / 2, back * half, near, WEB), low, high)
    below, over = chain.panels[hinge - 1], chain.panels[hinge]
    if near < gap / 2:
        yield Stop(name, "butt", False, over, placed(added, origin, axes), below)


def _free(chain: Chain, hinge: int, above: bool, thickness: Thickness) -> float:
    """How far a lap may reach into the panel below the hinge (where it comes from above), or above it, mm."""
    panel = hinge - 1 if above else hinge
    at_base = panel == 0 if above else panel == len(chain.lengths) - 1 and chain.far is not None
    at_tip = not above and panel == len(chain.lengths) - 1 and chain.far is None
    taken = 0.0 if at_tip else thickness.foot_room if at_base else thickness.knuckle_room
    return max(float(chain.lengths[panel]) - taken - thickness.gap - 1.0, 0.5)


def _straight(chain: Chain, hinge: int) -> tuple[Array, Array]:
    """The frame of the panels at an inserted hinge, open: its origin (3,) on the mid-plane, rows x, y, z."""
    axis = joints(chain, tilts(chain, np.zeros(1)))[0, hinge] @ np.stack([chain.across, chain.rise])
    axes = frames(chain, np.zeros(1))[1][0, hinge]
    return chain.root + axis - float(chain.offsets[hinge]) * axes[0], axes


def _spread(x0: float, x1: float, z0: float, z1: float) -> tuple[Mark, Mark]:
    return (min(x0, x1), max(x0, x1)), (min(z0, z1), max(z0, z1))


def _slab(plane: tuple[Mark, Mark], low: float, high: float) -> Shape:
    (x0, x1), (z0, z1) = plane
    return box((x0, low, z0), (x1, high, z1))


def _leant(solid: Shape, lean: float) -> Shape:
    """Turned by an angle from upright to where the panel folds."""
    return placed(solid, np.zeros(3), _leaning(lean))


def _leaning(lean: float) -> Array:
    """(3, 3) rows x, y, z of what leans so, in the frame of its mount."""
    sin, cos = np.sin(lean), np.cos(lean)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])


def _within(marks: tuple[Mark, ...], gap: float) -> Iterator[Mark]:
    """Places within knuckles, the widest first: at either end of each, for another chain may want one, then amid."""
    middle = (marks[0][0] + marks[-1][1]) / 2
    for low, high in sorted(marks, key=lambda m: (-round(m[1] - m[0], 6), abs(sum(m) / 2 - middle), m)):
        room = high - low - 2 * INSET
        width = min((room - 2 * gap - WALL) / 2, WIDEST)
        if width >= SHARED:
            yield low + INSET, low + INSET + width
            yield high - INSET - width, high - INSET
        if room >= NARROWEST:
            width = min(room, WIDEST)
            yield (low + high - width) / 2, (low + high + width) / 2


def _places(span: Mark, widest: float, breaks: tuple[Mark, ...], ramp: float = 0.0) -> Iterator[Mark]:
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
