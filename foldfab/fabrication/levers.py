"""What stops a base hinge: pieces of its panel and its base that meet when it is turned on, in the frame of its mount.

Printed open, faces are a clearance g apart, and a stop has to be some 20 g away from the axis to meet within 3°:

- *tongue*: a knuckle of the panel reaches down through a slot in its base and meets the slot's wall. Folded, it lies in
  the layer of its own panel, so that the stack stays as low as it is. Where the base is too thin it leans back until it
  is long enough, and stands up out of that layer once it is folded; where the base ends too early, it gets a lip.
- *arm*: the same, flat on the base behind the panel, where no slot may be.
- *post*: the base's own, beside a knuckle and up behind the panel, where the base is too narrow for either.

Printed otherwise they may be closer: a *heel* is a squared knuckle. At the folded end, where the base ends too early, a
*rest* reaches out below the panel.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from foldfab.fabrication.hinges import Mark
from foldfab.fabrication.latches import END, SEAT, Tongue, lock
from foldfab.fabrication.mounts import NARROWEST, WALL, WIDEST, Mount, Stop, leant, spots, within
from foldfab.fabrication.relief import STEEP
from foldfab.fabrication.shapes import Shape, box, cut, placed, prism, union
from foldfab.fabrication.walls import LINE
from foldfab.geometry.arrays import Array

CLOSE = 0.95
"""The gap at a stop as a share of the clearance: what the inspection lets pass, for a shorter lever."""
AIM = np.radians(2.4)
"""The angle that levers are made for, so that there is material at 3° and not only a touch."""
LEAST = np.radians(2.75)
"""The angle that they are made for at least, where their place lets them."""
NEAR = np.radians(1.5)
"""The angle at which faces meet that are not printed beside each other."""
LIFT = 0.2
"""How far a tongue ends above the far face of its base, mm: it must not stick to the bed."""
OPEN = 0.1
"""How far a slot is cut beyond the far face of its base, mm; another panel may fold there."""
SKIN = 0.8
"""Less than this below a slot is not left standing, mm."""
FAR = 1000.0
"""Beyond everything, mm."""
EDGE = 2 * LINE
"""A wall thinner than this between a slot and an edge of its base may be cut away, mm."""
POST = 2.0
"""Thickness of a post, mm: what turns the panel on bends it across its layers."""
PAST_AXIS = 0.1
"""How far an arm reaches past the axis, where pointed knuckles have their edge, mm: what only touches is no body."""
ROOTED = 0.2
"""How far a post reaches into a foot, mm: less than there is beside a socket."""

_LYING = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a prism, drawn along y, so that it is drawn along -z and its outline lies in x and y."""


def levers(mount: Mount, *, is_latched: bool) -> Iterator[Stop]:
    """What stops it open with faces that are a clearance apart, best first; `is_latched` if it is to be held there."""
    is_long = _room_below(mount, mount.lean) >= _lever(mount)
    if is_long:
        yield from _tongues(mount, mount.lean, is_latched=is_latched)
    lean = _long(mount)
    if lean is not None:
        yield from _tongues(mount, lean, is_latched=is_latched)
        yield from _tongues(mount, lean, is_latched=is_latched, has_lip=True)
    yield from _arms(mount)
    if not is_long:
        yield from _tongues(mount, mount.lean, is_latched=is_latched)
    yield from _posts(mount)


def bolts(mount: Mount) -> Iterator[Stop]:
    """Tongues along the panel that a pin can hold, whether or not they stop it in time."""
    yield from (stop for stop in _tongues(mount, mount.lean, is_latched=True) if stop.lock is not None)


def heels(mount: Mount) -> Iterator[Stop]:
    """What stops it open with faces that may be closer."""
    half, height = mount.thickness.panel / 2, mount.thickness.axis_height
    # Below a panel that leans over it the heel is shorter, so that it stays within the panel's layer.
    lever = min(half, (half - height * float(np.sin(-mount.lean))) / float(np.cos(mount.lean)))
    lift = lever * float(np.sin(NEAR))
    beyond = leant(box((-FAR, -FAR, -FAR), (-half, FAR, FAR)), mount.lean)
    for low, high in mount.marks.follower if lever > 0 else ():
        heel = cut(box((-half, low, lift - height), (min(half / 2 - lever, 0.0), high, 0.0)), [beyond])
        yield Stop(mount.joint, "heel", False, mount.panel, heel, mount.base)


def rests(mount: Mount, up: Array | None = None) -> Iterator[Stop]:
    """What stops it folded; `up` (3,) is the hinge direction that points up in print, where it stands on edge.

    There a rest has a ramp below it.
    """
    top = -mount.thickness.axis_height
    reach = mount.thickness.gap / np.sin(AIM)
    thick = min(mount.thickness.panel, mount.depth + top)
    way = 0.0 if up is None else float(np.sign(mount.frame[1] @ up))
    ramp = abs(way) * STEEP * max(reach - mount.thickness.panel / 2, 0.0)
    for low, high in spots(mount.span, WIDEST, mount.marks.free, ramp):
        tab = _tab(mount.thickness.panel / 2, reach, (low, high), way * ramp)
        flat = placed(prism(tab, -top, thick - top), np.zeros(3), _LYING)
        yield Stop(mount.joint, "rest", True, mount.base, flat, mount.panel)


def _tab(root: float, reach: float, span: Mark, ramp: float) -> list[tuple[float, float]]:
    """The outline (x, y) of a rest, whose tip is `ramp` mm narrower than its root: below, or above where it is < 0."""
    low, high = span
    ends = (low + max(ramp, 0.0), high + min(ramp, 0.0))
    return [(0.0, low), (root, low), (reach, ends[0]), (reach, ends[1]), (root, high), (0.0, high)]


def _lever(mount: Mount) -> float:
    """How far from its axis a stop has to be at least, mm."""
    return CLOSE * mount.thickness.gap / float(np.sin(LEAST))


def _sides(mount: Mount, lean: float) -> tuple[float, float]:
    """How far a tongue reaches from its middle to its back and to its front, where its panel folds, mm.

    Along its panel it is as thick as that. Else it leaves its panel's layer, is as thin as may be, and keeps its back
    away from a hinge that folds down on it.
    """
    half = mount.thickness.panel / 2
    if lean != mount.lean:
        return NARROWEST / 3, NARROWEST * 2 / 3
    return (half if lean >= 0 else NARROWEST - half / 10), half / 10


def _room_below(mount: Mount, lean: float) -> float:
    """How far a tongue that leans so may reach from the axis, mm: it comes out below its base at no time."""
    deepest, (back, front) = mount.depth - LIFT, _sides(mount, lean)
    if lean < 0:
        return float(np.sqrt(deepest**2 - back**2))
    return (deepest - front * float(np.sin(lean))) / float(np.cos(lean))


def _long(mount: Mount) -> float | None:
    """The lean at which a tongue is just long enough; None where it is so upright."""
    front, deepest = NARROWEST * 2 / 3, mount.depth - LIFT
    reach = float(np.hypot(_lever(mount), front))
    return float(np.arctan2(front, _lever(mount)) + np.arccos(deepest / reach)) if deepest < reach else None


def _tongues(mount: Mount, lean: float, *, is_latched: bool, has_lip: bool = False) -> Iterator[Stop]:
    gap, (back, front) = mount.thickness.gap, _sides(mount, lean)
    close = CLOSE * gap
    # What a pin is to hold has to reach to the outer face of its base.
    reach = _room_below(mount, lean) if is_latched else min(close / np.sin(AIM), _room_below(mount, lean))
    sweep = float(np.hypot(mount.thickness.panel / 2, reach)) + gap
    is_through = mount.depth - (reach + gap) * np.cos(lean) < SKIN
    bottom = -FAR if is_through else -(reach + gap)
    top = sweep * max(0.0, float(np.sin(-lean)))
    # A slot that ends close to an edge of its base is opened there, because the wall beyond it would be too thin.
    wall = SEAT + END if is_latched else WALL
    for spare, (low, high) in itertools.product((0.0, EDGE), within(mount.marks.follower, gap, wall)):
        # Seen along what leans, corners are not equally deep.
        slot = leant(box((-sweep - spare, low - gap, bottom), (front + close, high + gap, top)), lean)
        slot = cut(slot, [_below(mount.depth + OPEN)]) if is_through else slot
        added = cut(leant(box((-back, low, -reach), (front, high, 0.0)), lean), [_below(mount.depth - LIFT)])
        tongue = Tongue(lean, back, back + front, reach, low, high)
        held = lock(tongue, mount.depth, mount.plate, gap) if is_latched else None
        end = _lip(mount, reach * float(np.sin(lean)), (low, high)) if has_lip else None
        yield Stop(mount.joint, "tongue", False, mount.panel, added, mount.base, end, slot, held)


def _lip(mount: Mount, reach: float, span: Mark) -> Shape:
    """What a base is given to reach as far as a tongue, mm."""
    return box((-reach, span[0], -mount.depth), (0.0, span[1], -mount.thickness.axis_height))


def _arms(mount: Mount) -> Iterator[Stop]:
    under = CLOSE * mount.thickness.gap - mount.thickness.axis_height
    for low, high in within(mount.marks.follower, mount.thickness.gap):
        arm = box((-_lever(mount), low, under), (PAST_AXIS, high, under + NARROWEST))
        yield Stop(mount.joint, "arm", False, mount.panel, arm, mount.base)


def _posts(mount: Mount) -> Iterator[Stop]:
    half, behind = mount.thickness.panel / 2, CLOSE * mount.thickness.gap + mount.thickness.panel / 2
    for low, high in sorted(mount.marks.carrier, key=lambda mark: (round(mark[0] - mark[1], 6), mark)):
        width = min(high - low, WIDEST)
        # At the outer end of its knuckle, where it is furthest from those of the panel.
        a = low if low == mount.marks.carrier[0][0] else high - width
        post = leant(box((-behind - POST, a, -half), (-behind, a + width, _lever(mount))), mount.lean)
        root = box((-behind - POST, a, -mount.thickness.axis_height), (ROOTED - half, a + width, 0.0))
        yield Stop(mount.joint, "post", False, mount.base, union([post, root]), mount.panel)


def _below(depth: float) -> Shape:
    """All that is further than that below the axis, mm."""
    return box((-2 * FAR, -2 * FAR, -2 * FAR), (2 * FAR, 2 * FAR, -depth))
