"""What a thick chain is made of, as boxes: panel slabs, knuckles, and the feet and plinths on its bases.

Every clash test of the solver works on these (section 5.6): slabs are K thick, an inserted hinge's knuckle is a bar
K × K around its axis, and a base hinge's foot reaches from the base face to K/2 beyond its axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.folding.mechanism import frames, joints, tilts
from foldfab.folding.model import Chain, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, stacked
from foldfab.scaffold.model import BasePatch


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """The two faces of a base plate, heights in mm."""

    bottom: float
    top: float


def faces(base: BasePatch, thickness: Thickness) -> Face:
    """The faces of a base's plate, K/2 beyond its lowest and highest member."""
    return Face(base.bottom - thickness.panel / 2, base.top + thickness.panel / 2)


def base_boxes(base: BasePatch, thickness: Thickness) -> Boxes:
    """The plate of a base (n,), one box for each of its outlines, at least K wide."""
    face = faces(base, thickness)
    n = len(base.outlines)
    center = np.array([[*o.center, (face.bottom + face.top) / 2] for o in base.outlines])
    axes = np.zeros((n, 3, 3))
    axes[:, 0, :2] = [o.along for o in base.outlines]
    axes[:, 1, :2] = [(-o.along[1], o.along[0]) for o in base.outlines]
    axes[:, 2, 2] = 1.0
    half = np.array([[*np.maximum(o.half, thickness.panel / 2), (face.top - face.bottom) / 2] for o in base.outlines])
    return Boxes(center, axes, half)


def moving_boxes(chain: Chain, thickness: Thickness, progress: Array) -> Boxes:
    """Slabs and knuckles (k, 2 m - 1) of a chain at each progress (k,), relative to the anchor's open position."""
    origins, axes = frames(chain, progress)
    count, half_k = len(chain.lengths), chain.panel / 2
    low = np.where(np.arange(count) == 0, 0.0, thickness.gap / 2)
    is_last_free = np.arange(count) == count - 1
    high = chain.lengths - np.where(is_last_free, 0.0, thickness.gap / 2)
    middle, half_span = float(chain.span.mean()), float(np.ptp(chain.span)) / 2
    center = origins + axes[:, :, 2] * ((low + high) / 2)[:, None] + axes[:, :, 1] * middle
    half = np.stack([np.full(count, half_k), np.full(count, half_span), (high - low) / 2], axis=1)
    slabs = Boxes(center, axes, np.broadcast_to(half, center.shape))
    if count == 1:
        return slabs
    bars = _knuckles(chain, half_k, progress, axes)
    return Boxes(*(np.concatenate([getattr(slabs, f), getattr(bars, f)], axis=1) for f in ("center", "axes", "half")))


def resting_boxes(chain: Chain, thickness: Thickness, progress: float) -> Boxes:
    """Slabs, knuckles and anchor foot (n,) of a chain at rest, at fold progress 0 or 1."""
    return stacked([moving_boxes(chain, thickness, np.array([progress]))[0], anchor_feet(chain, thickness)])


def swept_boxes(chain: Chain, thickness: Thickness, progress: Array, near: Array, far: Array | None) -> Boxes:
    """Panels, knuckles and feet (k, n) of a chain while its anchor and its far base are translated by `near` and `far`
    (k, 3)."""
    panels = moving_boxes(chain, thickness, progress)
    feet = [(anchor_feet(chain, thickness), near)]
    if far is not None:
        feet.append((far_feet(chain, thickness), far))
    center = [panels.center + near[:, None], *(boxes.center + shift[:, None] for boxes, shift in feet)]
    shape = (len(progress), 1)
    axes = [panels.axes, *(np.broadcast_to(boxes.axes, (*shape, 3, 3)) for boxes, _ in feet)]
    half = [panels.half, *(np.broadcast_to(boxes.half, (*shape, 3)) for boxes, _ in feet)]
    return Boxes(*(np.concatenate(parts, axis=1) for parts in (center, axes, half)))


def anchor_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The foot or plinth (1,) of the chain on its anchor, open position."""
    return _foot(chain, thickness, chain.root, chain.rise, chain.pads[0], chain.hinge_spans[0])


def far_feet(chain: Chain, thickness: Thickness) -> Boxes:
    """The foot or plinth of the chain on its far base (1,), or none (0,) for a T-scaffold, open position."""
    if chain.far is None:
        return Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)))
    end = joints(chain, tilts(chain, np.zeros(1)))[0, -1]
    place = chain.root + end @ np.stack([chain.across, chain.rise])
    return _foot(chain, thickness, place, -chain.rise, chain.pads[1], chain.hinge_spans[-1])


def _knuckles(chain: Chain, half_k: float, progress: Array, axes: Array) -> Boxes:
    flat = joints(chain, tilts(chain, progress))[:, 1:-1]
    spans = chain.hinge_spans[1:-1]
    center = chain.root + flat @ np.stack([chain.across, chain.rise]) + chain.along * spans.mean(axis=1)[:, None]
    half = np.stack([np.full(len(spans), half_k), np.ptp(spans, axis=1) / 2, np.full(len(spans), half_k)], axis=1)
    return Boxes(center, axes[:, :-1], np.broadcast_to(half, center.shape))


def _foot(chain: Chain, thickness: Thickness, axis: Array, outward: Array, pad: float, hinge: Array) -> Boxes:
    """From the base face, which lies below the axis seen along `outward`, to the far side of the knuckle."""
    thickness, span = thickness.of(chain.panel), chain.span if pad > 0 else hinge
    low, high = -thickness.axis_height - pad, thickness.panel / 2
    center = axis + outward * (low + high) / 2 + chain.along * float(span.mean())
    half = np.array([[thickness.panel / 2, float(np.ptp(span)) / 2, (high - low) / 2]])
    return Boxes(center[None], np.stack([chain.across, chain.along, chain.rise])[None], half)
