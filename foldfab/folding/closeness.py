"""Which sheets share more than a touch at any moment while they move, the moments between two samples included.

How deep two of them are in each other changes by no more than they move. An interval in which that could let them
cross is looked at again in smaller steps; in most nothing is near enough. Cost: bounds of all pairs at all samples, and
fifteen axes for those that may matter.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, bounds

DEPTH = 0.05
"""How much sheets may share, mm: a layer of a print."""
SKEW = 1e-5
"""Edges whose cross product is shorter than this are parallel and make no axis of their own."""
Moving = Callable[[Array], Boxes]
"""Where some sheets (k, n) are at times (k,)."""
STEPS = 12
"""Into how many steps a quarter turn is parted at first."""
FINER = 8
"""Into how many steps an interval is parted that is looked at again."""
LEVELS = 3
"""How often that is done."""


def crossing(a: Moving, b: Moving, times: Array) -> Bools:
    """(n, m) which of some sheets cross which others; `times` (k,) are looked at in any case."""
    for _ in range(LEVELS + 1):
        one, other = a(times), b(times)
        moved = _moved(one)[:, :, None] + _moved(other)[:, None]
        deep = _deep(one, other, moved)
        crossed: Bools = deep.max(0) > DEPTH
        again = ((deep[1:] + deep[:-1] + moved) / 2 > DEPTH) & ~crossed
        chosen = np.nonzero(again.any((1, 2)))[0]
        if crossed.any() or not len(chosen):
            break
        steps = np.arange(FINER + 1) / FINER
        times = np.unique(times[chosen, None] + (times[chosen + 1] - times[chosen])[:, None] * steps)
    return crossed


def _moved(boxes: Boxes) -> Array:
    """(k - 1, n) how far any point of some sheets comes at most from one sample to the next, mm."""
    turned = np.linalg.norm(np.diff(boxes.axes, axis=0), axis=-1)
    moved: Array = np.linalg.norm(np.diff(boxes.center, axis=0), axis=-1) + (turned * boxes.half[1:]).sum(-1)
    return moved


def _deep(a: Boxes, b: Boxes, moved: Array) -> Array:
    """(k, n, m) how deep sheets are in each other, mm, or at least not less where they cannot cross."""
    (low_a, high_a), (low_b, high_b) = bounds(a), bounds(b)
    shared = np.minimum(high_a[:, :, None] - low_b[:, None], high_b[:, None] - low_a[:, :, None])
    deep: Array = shared.min(-1)
    most = np.concatenate([moved, moved[-1:]])
    most[1:] = np.maximum(most[1:], moved)
    frame, i, j = np.nonzero(deep + most > DEPTH)
    if len(frame):
        deep[frame, i, j] = depth(a[frame, i], b[frame, j])
    return deep


def depth(a: Boxes, b: Boxes) -> Array:
    """(n,) the least way that would part two collections pair by pair, mm; less than 0 where they are apart."""
    crossed = np.cross(a.axes[:, :, None], b.axes[:, None]).reshape(-1, 9, 3)
    size = np.linalg.norm(crossed, axis=-1)
    axes = np.concatenate([a.axes, b.axes, crossed / np.maximum(size, SKEW)[..., None]], axis=1)
    reach = sum(np.einsum("nmk,nk->nm", np.abs(np.einsum("nmj,nkj->nmk", axes, c.axes)), c.half) for c in (a, b))
    shared = reach - np.abs(np.einsum("nij,nj->ni", axes, b.center - a.center))
    shared[:, 6:][size < SKEW] = np.inf
    least: Array = shared.min(axis=1)
    return least
