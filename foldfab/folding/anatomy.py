"""What a thick chain is made of, as boxes: panel slabs, knuckles, and the feet, plinths and pockets on its bases.

Every clash test of the solver works on these (section 5.6): slabs are K thick, an inserted hinge's knuckle is a bar
K × K around its axis, and a base hinge's foot reaches from the base face to K/2 beyond its axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from foldfab.folding.mechanism import REMEMBERED, directions, joined, open_and_folded, start, tilts
from foldfab.folding.model import Chain, Shape, Thickness
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.boxes import Boxes, stacked
from foldfab.scaffold.model import BasePatch

RIM = 0.4
"""How far plates reach beyond the feet on them, mm."""
OPEN_AND_FOLDED = np.array([0.0, 1.0])
"""Fold progress of what does not fold now."""
_MIRRORED_PLACE = np.array([-1.0, 1.0, 1.0])
"""What turns places of a chain that folds to the right into those of one that folds to the left."""
_MIRRORED_AXES = np.array([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]])
"""The same for the axes of its boxes, which tilt the other way."""


Spans = tuple[tuple[float, float], ...]
"""Extents along the hinge direction of the panels, then of each inserted hinge, stretch by stretch, mm."""


class Foot(NamedTuple):
    """What a base hinge turns on, as it lies about the hinge's axis."""

    middle: float
    """Along the axis from the middle of the chain, mm."""
    height: float
    """How far it stands off the axis, away from the base, mm."""
    half: tuple[float, float, float]
    """Half lengths across and along the axis, and away from the base, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class Ride:
    """A chain as it folds while its bases carry it."""

    chain: Chain
    progress: Array
    """(k,) fold progress."""
    near: Array
    """(k, 3) translation of its anchor, mm."""
    far: Array | None
    """(k, 3) translation of its far base, mm; None for a T-scaffold."""


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """The two faces of a base plate, heights in mm."""

    bottom: float
    top: float


def faces(base: BasePatch, thickness: Thickness) -> Face:
    """The faces of a base's plate, K/2 beyond its lowest and highest member."""
    half = thickness.of(base.thickness).panel / 2
    return Face(base.bottom - half, base.top + half)


def base_boxes(base: BasePatch, thickness: Thickness) -> Boxes:
    """The plate of a base (n,), one box for each of its outlines, at least K wide."""
    face = faces(base, thickness)
    n = len(base.outlines)
    center = np.array([[*o.center, (face.bottom + face.top) / 2] for o in base.outlines])
    axes = np.zeros((n, 3, 3))
    axes[:, 0, :2] = [o.along for o in base.outlines]
    axes[:, 1, :2] = [(-o.along[1], o.along[0]) for o in base.outlines]
    axes[:, 2, 2] = 1.0
    least = thickness.of(base.thickness).panel / 2
    half = np.array([[*np.maximum(o.half, least), (face.top - face.bottom) / 2] for o in base.outlines])
    return Boxes(center, axes, half)


def moving_boxes(chain: Chain, thickness: Thickness, progress: Array) -> Boxes:
    """Slabs and knuckles (k, m + s (m - 1)) of a chain at each progress (k,), relative to the anchor's open position.

    Its inserted hinges have knuckles in s stretches each.
    """
    when = np.asarray(progress, dtype=np.float64).tobytes()
    made = _moving(chain.to_the_right, chain.panel, _apart(chain, thickness), _spans(chain), when)
    return _placed(chain, made)


@lru_cache(REMEMBERED)
def _moving(shape: Shape, panel: float, apart: float, spans: Spans, progress: bytes) -> Boxes:
    """The same in the frame of the chain to the right (across, along, rise), from its root.

    Panels end `apart` / 2 from inserted hinges.
    """
    normal, length = directions(tilts(shape, np.frombuffer(progress)))
    hinges = joined(shape, normal, length)
    frames, count = normal.shape[:2]
    every, rows = count + len(spans) - 1, (len(spans) - 1) // max(count - 1, 1)
    axes = np.zeros((frames, every, 3, 3))
    axes[:, :count, 0, ::2], axes[:, :count, 2, ::2] = normal, length
    axes[:, :, 1, 1] = 1.0
    low = [0.0, *[apart / 2] * (count - 1)]
    high = [*(whole - apart / 2 for whole in shape.lengths[:-1]), shape.lengths[-1]]
    center = np.zeros((frames, every, 3))
    center[:, :count, ::2] = hinges[:, :-1] - np.array(shape.offsets[:-1])[:, None] * normal
    center[:, :count, ::2] += length * np.array([(a + b) / 2 for a, b in zip(low, high, strict=True)])[:, None]
    for row in range(rows):
        own = slice(count + row * (count - 1), count + (row + 1) * (count - 1))
        axes[:, own], center[:, own, ::2] = axes[:, : count - 1], hinges[:, 1:-1]
    center[:, :, 1] = [*[(spans[0][0] + spans[0][1]) / 2] * count, *((a + b) / 2 for a, b in spans[1:])]
    width = (spans[0][1] - spans[0][0]) / 2
    slabs = [(panel / 2, width, (b - a) / 2) for a, b in zip(low, high, strict=True)]
    half = np.empty((frames, every, 3))
    half[:] = [*slabs, *((panel / 2, (b - a) / 2, panel / 2) for a, b in spans[1:])]
    return Boxes(center, axes, half)


def _apart(chain: Chain, thickness: Thickness) -> float:
    """How far panels end from each other; without thickness they are longer by what makes up for knuckles and gap."""
    return -chain.panel if chain.breaks else thickness.gap


def _spans(chain: Chain) -> Spans:
    first, last = chain.span.tolist()
    if not chain.breaks:
        return ((first, last), *((low, high) for low, high in chain.hinge_spans[1:-1].tolist()))
    hinges = [chain.stretches(i) for i in range(1, len(chain.lengths))]
    return ((first, last), *(one for row in zip(*hinges, strict=True) for one in row))


def resting_boxes(chain: Chain, thickness: Thickness, progress: float) -> Boxes:
    """Slabs, knuckles and anchor foot (n,) of a chain that stands still at some fold progress."""
    # What stands open in one scene lies folded in another.
    is_end = progress in (0.0, 1.0)
    when, frame = (OPEN_AND_FOLDED, int(progress)) if is_end else (np.array([progress]), 0)
    return stacked([moving_boxes(chain, thickness, when)[frame], anchor_feet(chain, thickness)])


def swept_boxes(rides: Sequence[Ride], thickness: Thickness) -> tuple[Boxes, Indices]:
    """Panels, knuckles and feet (k, n) of all chains that ride at once, and of which of them each is (n,).

    Those of a chain follow one another: slabs, knuckles, the feet on its anchor and last those on its far base.
    """
    made = [_carried(ride, thickness) for ride in rides]
    found = Boxes(*(np.concatenate([getattr(m, f) for m in made], axis=1) for f in ("center", "axes", "half")))
    return found, np.repeat(np.arange(len(made)), [boxes.center.shape[1] for boxes in made])


def _carried(ride: Ride, thickness: Thickness) -> Boxes:
    chain, near = ride.chain, _feet(ride.chain, thickness, 0)
    far = _feet(chain, thickness, -1) if ride.far is not None else ()
    apart, when = _apart(chain, thickness), ride.progress.tobytes()
    made = _placed(chain, _standing(chain.to_the_right, chain.panel, apart, _spans(chain), near, far, when))
    on_near = made.center.shape[1] - len(far)
    made.center[:, :on_near] += ride.near[:, None]
    if ride.far is not None:
        made.center[:, on_near:] += ride.far[:, None]
    return made


def _placed(chain: Chain, made: Boxes) -> Boxes:
    """Boxes of the chain to the right, in its frame, where the chain has them."""
    center, axes = made.center, made.axes
    if chain.turn < 0:
        center, axes = center * _MIRRORED_PLACE, axes * _MIRRORED_AXES
    # As one flat product: numpy would make one of every few rows.
    flat = (center.reshape(-1, 3) @ chain.basis).reshape(center.shape)
    return Boxes(chain.root + flat, (axes.reshape(-1, 3) @ chain.basis).reshape(axes.shape), made.half)


@lru_cache(REMEMBERED)
def _standing(
    shape: Shape, panel: float, apart: float, spans: Spans, near: tuple[Foot, ...], far: tuple[Foot, ...],
    progress: bytes,
) -> Boxes:  # fmt: skip
    moving = _moving(shape, panel, apart, spans, progress)
    frames, count = moving.center.shape[:2]
    size = (frames, count + len(near) + len(far))
    found = Boxes(np.zeros((*size, 3)), np.zeros((*size, 3, 3)), np.empty((*size, 3)))
    found.center[:, :count], found.axes[:, :count], found.half[:, :count] = moving.center, moving.axes, moving.half
    found.axes[:, count:] = np.eye(3)
    for i, foot in enumerate((*near, *far), count):
        found.center[:, i, 1], found.center[:, i, 2], found.half[:, i] = foot.middle, foot.height, foot.half
    across, rise = open_and_folded(shape)[0] if far else (0.0, 0.0)
    for i, foot in enumerate(far, count + len(near)):
        found.center[:, i] = across, foot.middle, rise - foot.height
    return found


def anchor_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The feet (n,) of the chain on its anchor, or its plinth (1,), open position."""
    return _feet_boxes(chain, _feet(chain, thickness, 0), chain.root, chain.rise)


def far_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The same (n,) on its far base, or none (0,) for a T-scaffold, open position."""
    if chain.far is None:
        return Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)))
    return _feet_boxes(chain, _feet(chain, thickness, -1), chain.root + start(chain), -chain.rise)


def pockets(chain: Chain, end: int, thickness: Thickness) -> Boxes:
    """What is cut from the base at an end of the chain, 0 for its anchor, so that it can sink in (n,), open position.

    The gap around all that its first panel from there sweeps below the face, with what may stop it behind its axis;
    nothing where the chain does not sink.
    """
    depth, place = -chain.pads[end], chain.root if end == 0 else chain.root + start(chain)
    if depth <= 0:
        return Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)))
    thickness, out = thickness.of(chain.panel), chain.rise if end == 0 else -chain.rise
    folded, side = tilts(chain, np.ones(1))[0], 1.0 if end == 0 else -1.0
    # Where the chain is one panel, a knuckle of its other base lies at its end.
    beyond = thickness.panel / 2 if len(chain.lengths) == 1 else 0.0
    reach = np.sign(side * folded[-end]) * (chain.lengths[-end] + beyond + 2 * thickness.gap)
    low, high = sorted((-np.sign(reach) * thickness.foot_room, reach))
    (first, last), floor = chain.span.tolist(), -thickness.axis_height
    center = place + chain.across * ((low + high) / 2) + chain.along * ((first + last) / 2) + out * (floor + depth / 2)
    half = np.array([[(high - low) / 2, (last - first) / 2 + thickness.gap, depth / 2]])
    return Boxes(center[None], chain.basis[None], half)


def _feet(chain: Chain, thickness: Thickness, end: int) -> tuple[Foot, ...]:
    """From the base face or the pocket's floor, below the axis seen from the base, to the far side of the knuckle."""
    thickness, pad = thickness.of(chain.panel), chain.pads[end]
    low, high = -thickness.axis_height - max(pad, 0.0), thickness.panel / 2
    if chain.breaks and pad <= 0:
        spans = chain.stretches(end)
    else:
        first, last = (chain.span if pad > 0 else chain.hinge_spans[end]).tolist()
        spans = ((first, last),)
    return tuple(
        Foot((first + last) / 2, (low + high) / 2, (thickness.panel / 2, (last - first) / 2, (high - low) / 2))
        for first, last in spans
    )


def _feet_boxes(chain: Chain, feet: tuple[Foot, ...], axis: Array, outward: Array) -> Boxes:
    center = [axis + outward * foot.height + chain.along * foot.middle for foot in feet]
    return Boxes(np.array(center), np.repeat(chain.basis[None], len(feet), axis=0), np.array([f.half for f in feet]))
