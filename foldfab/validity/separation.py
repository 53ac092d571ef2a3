"""How far two oriented boxes or rectangles are apart, or how deep they share space, with the axis that says so.

All fifteen axes of the separating-axis test are measured, not only asked. Where boxes overlap, the result is minus the
least way that would part them, exactly; where they are apart, it is at most their distance. Rectangles and segments
are boxes with half lengths of 0: resting on each other or sharing an edge they are 0 apart.
"""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes

SKEW = 1e-5
"""Edges whose cross product is shorter than this are parallel and make no axis of their own."""


def separation(a: Boxes, b: Boxes) -> tuple[Array, Array]:
    """Distance (n,) of two flat collections pair by pair, negative where they overlap, mm, and the axis (n, 3) to it.

    The axis points from a to b.
    """
    crossed = np.cross(a.axes[:, :, None], b.axes[:, None]).reshape(-1, 9, 3)
    size = np.linalg.norm(crossed, axis=-1)
    axes = np.concatenate([a.axes, b.axes, crossed / np.maximum(size, SKEW)[..., None]], axis=1)
    offset = np.einsum("nij,nj->ni", axes, b.center - a.center)
    apart = np.abs(offset) - reach(a, axes) - reach(b, axes)
    apart[:, 6:][size < SKEW] = -np.inf
    best = np.argmax(apart, axis=1)
    pick = np.arange(len(best)), best
    return apart[pick], axes[pick] * np.where(offset[pick] < 0, -1.0, 1.0)[:, None]


def along(a: Boxes, b: Boxes, axes: Array) -> Array:
    """How far (n,) b begins beyond the end of a along unit axes (n, 3), mm."""
    one = axes[:, None]
    found: Array = np.einsum("nj,nj->n", axes, b.center - a.center) - (reach(a, one) + reach(b, one))[:, 0]
    return found


def reach(boxes: Boxes, axes: Array) -> Array:
    """Half extents (n, m) of boxes (n,) along axes (n, m, 3)."""
    found: Array = np.einsum("nmk,nk->nm", np.abs(np.einsum("nmj,nkj->nmk", axes, boxes.axes)), boxes.half)
    return found


def cut_back(boxes: Boxes, point: Array, direction: Array, room: float) -> Boxes:
    """What remains of boxes (n,) beyond a square of half width `room` around an axis that runs along one of their own.

    Boxes without an edge along `direction` stay whole.
    """
    kept: list[tuple[Array, Array, Array]] = []
    for center, axes, half in zip(boxes.center, boxes.axes, boxes.half, strict=True):
        own = int(np.argmax(np.abs(axes @ direction)))
        if abs(axes[own] @ direction) < 1 - 1e-9:
            kept.append((center, axes, half))
            continue
        u, v = (k for k in range(3) if k != own)
        hole = axes @ (point - center)
        for low, high in _around(half, hole, room, u, v):
            kept.append((center + (low + high) / 2 @ axes, axes, (high - low) / 2))
    parts = [np.array([k[i] for k in kept]) for i in range(3)]
    return Boxes(parts[0].reshape(-1, 3), parts[1].reshape(-1, 3, 3), parts[2].reshape(-1, 3))


def _around(half: Array, hole: Array, room: float, u: int, v: int) -> list[tuple[Array, Array]]:
    """Lower and upper corners of up to four boxes around the square, in the frame of their box."""
    found = []
    middle_low, middle_high = max(-half[u], hole[u] - room), min(half[u], hole[u] + room)
    for axis, side in ((u, -1), (u, 1), (v, -1), (v, 1)):
        low, high = -half, half.copy()
        if axis == v:
            low[u], high[u] = middle_low, middle_high
        if side < 0:
            high[axis] = min(high[axis], hole[axis] - room)
        else:
            low[axis] = max(low[axis], hole[axis] + room)
        if (high - low >= 0).all() and (high - low)[[u, v]].max() > 0:
            found.append((low, high))
    return found
