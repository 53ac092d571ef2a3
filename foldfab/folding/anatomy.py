"""What a thick chain is made of, as boxes: panel slabs, knuckles, and the feet, plinths and pockets on its bases.

Every clash test of the solver works on these (section 5.6): slabs are K thick, an inserted hinge's knuckle is a bar
K × K around its axis, and a base hinge's foot reaches from the base face to K/2 beyond its axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from foldfab.folding.mechanism import REMEMBERED, directions, joined, start, tilts
from foldfab.folding.model import Chain, Shape, Thickness
from foldfab.geometry.arrays import Array
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
    """Slabs and knuckles (k, 2 m - 1) of a chain at each progress (k,), relative to the anchor's open position."""
    count, span = len(chain.lengths), tuple(chain.span.tolist())
    when = np.asarray(progress, dtype=np.float64).tobytes()
    # A row of knuckles for each of the stretches in which the inserted hinges have any.
    rows = list(zip(*(chain.stretches(i) for i in range(1, count)), strict=True)) or [()]
    # Without thickness panels are longer by what knuckles and the gap make up for (section 5.6).
    apart = -chain.panel if chain.breaks else thickness.gap
    every = [_moving(chain.to_the_right, chain.panel, apart, (span, *row), when) for row in rows]
    made = every[0] if len(every) == 1 else _beside([every[0], *(more[:, count:] for more in every[1:])])
    if chain.turn < 0:
        made = Boxes(made.center * _MIRRORED_PLACE, made.axes * _MIRRORED_AXES, made.half)
    return Boxes(chain.root + made.center @ chain.basis, made.axes @ chain.basis, made.half)


def _beside(many: list[Boxes]) -> Boxes:
    """Boxes (k, n_i) as one batch (k, n)."""
    center, axes, half = ([getattr(boxes, name) for boxes in many] for name in ("center", "axes", "half"))
    return Boxes(np.concatenate(center, axis=1), np.concatenate(axes, axis=1), np.concatenate(half, axis=1))


@lru_cache(REMEMBERED)
def _moving(shape: Shape, panel: float, apart: float, spans: tuple[tuple[float, float], ...], progress: bytes) -> Boxes:
    """The same in the chain's own frame (across, along, rise), from its root.

    Panels end `apart` / 2 from inserted hinges.
    `spans` holds the extent of the panels and of each inserted hinge along the hinge direction.
    """
    angles = tilts(shape, np.frombuffer(progress))
    normal, length = directions(angles)
    axes_flat = joined(shape, normal, length)
    count = len(shape.lengths)
    axes = np.zeros((*angles.shape, 3, 3))
    axes[..., 0, ::2], axes[..., 2, ::2] = normal, length
    axes[..., 1, 1] = 1.0
    low, high = np.full(count, apart / 2), np.array(shape.lengths) - apart / 2
    low[0], high[-1] = 0.0, shape.lengths[-1]
    span = np.array(spans)
    middle, reach = span.mean(axis=1), (span[:, 1] - span[:, 0]) / 2
    center = np.zeros((*angles.shape, 3))
    center[..., 0::2] = axes_flat[:, :-1]
    center -= np.array(shape.offsets)[:-1, None] * axes[..., 0, :]
    center += axes[..., 2, :] * ((low + high) / 2)[:, None]
    center[..., 1] = middle[0]
    half = np.stack([np.full(count, panel / 2), np.full(count, reach[0]), (high - low) / 2], axis=1)
    knuckles = np.zeros((len(angles), count - 1, 3))
    knuckles[..., 0::2] = axes_flat[:, 1:-1]
    knuckles[..., 1] = middle[1:]
    bars = np.stack([np.full(count - 1, panel / 2), reach[1:], np.full(count - 1, panel / 2)], axis=1)
    halves = np.concatenate([half, bars])
    return Boxes(
        np.concatenate([center, knuckles], axis=1), np.concatenate([axes, axes[:, :-1]], axis=1),
        np.broadcast_to(halves, (len(angles), *halves.shape)),
    )  # fmt: skip


def resting_boxes(chain: Chain, thickness: Thickness, progress: float) -> Boxes:
    """Slabs, knuckles and anchor foot (n,) of a chain that stands still at some fold progress."""
    # What stands open in one scene lies folded in another.
    is_end = progress in (0.0, 1.0)
    when, frame = (OPEN_AND_FOLDED, int(progress)) if is_end else (np.array([progress]), 0)
    return stacked([moving_boxes(chain, thickness, when)[frame], anchor_feet(chain, thickness)])


def swept_boxes(chain: Chain, thickness: Thickness, progress: Array, near: Array, far: Array | None) -> Boxes:
    """Panels, knuckles and feet (k, n) of a chain while its anchor and its far base are translated by `near` and `far`
    (k, 3).
    """
    panels = moving_boxes(chain, thickness, progress)
    feet = [(foot, near) for foot in _each(anchor_feet(chain, thickness))]
    if far is not None:
        feet += [(foot, far) for foot in _each(far_feet(chain, thickness))]
    count = panels.center.shape[1]
    shape = (len(progress), count + len(feet))
    found = Boxes(np.empty((*shape, 3)), np.empty((*shape, 3, 3)), np.empty((*shape, 3)))
    found.center[:, :count] = panels.center + near[:, None]
    found.axes[:, :count], found.half[:, :count] = panels.axes, panels.half
    for i, (foot, shift) in enumerate(feet, count):
        found.center[:, i] = foot.center + shift
        found.axes[:, i], found.half[:, i] = foot.axes, foot.half
    return found


def anchor_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The feet (n,) of the chain on its anchor, or its plinth (1,), open position."""
    return _feet(chain, thickness, chain.root, chain.rise, 0)


def far_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The same (n,) on its far base, or none (0,) for a T-scaffold, open position."""
    if chain.far is None:
        return Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)))
    place = chain.root + start(chain)
    return _feet(chain, thickness, place, -chain.rise, 1)


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


def _each(boxes: Boxes) -> list[Boxes]:
    return [boxes[i : i + 1] for i in range(len(boxes))]


def _feet(chain: Chain, thickness: Thickness, axis: Array, outward: Array, end: int) -> Boxes:
    """From the base face or the pocket's floor, below the axis seen along `outward`, to the far side of the knuckle."""
    thickness, pad = thickness.of(chain.panel), chain.pads[end]
    low, high = -thickness.axis_height - max(pad, 0.0), thickness.panel / 2
    spans = np.array([chain.span] if pad > 0 else chain.stretches(-end))
    middle, reach = spans.mean(axis=1), (spans[:, 1] - spans[:, 0]) / 2
    center = axis + outward * ((low + high) / 2) + chain.along * middle[:, None]
    half = np.stack([np.full(len(spans), thickness.panel / 2), reach, np.full(len(spans), (high - low) / 2)], axis=1)
    return Boxes(center, np.repeat(chain.basis[None], len(spans), axis=0), half)
