"""Which pieces of a patch have room to move (sections 5.4 to 5.6): swept boxes against swept boxes.

A patch is cut into N_s pieces along its hinge direction; whether a piece meets an obstacle does not depend on the
other pieces, so one sweep of the whole patch answers for all windows. Broad phase on bounds, then the exact test.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.boxes import Boxes, bounds, overlaps


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """Boxes of one mover over time; the second axis of every box runs along the hinge direction."""

    boxes: Boxes
    """(frames, n)."""
    cuts: Array
    """(N_s + 1,) cutting points along the hinge direction in absolute coordinates, mm."""
    low: Array
    """(frames, n, 3) lower corners of the bounds."""
    high: Array
    """(frames, n, 3) upper corners."""


def sweep(boxes: Boxes, cuts: Array) -> Sweep:
    """A sweep of boxes (frames, n) with their bounds."""
    low, high = bounds(boxes)
    return Sweep(boxes, cuts, low, high)


def hits(a: Sweep, b: Sweep) -> tuple[Indices, Indices, Indices]:
    """Frame, box of `a` and box of `b` (k,) of all overlaps; a sweep of one frame stands still."""
    none = np.zeros(0, dtype=np.int64)
    if (a.low.min((0, 1)) > b.high.max((0, 1))).any() or (b.low.min((0, 1)) > a.high.max((0, 1))).any():
        return none, none, none
    i = np.nonzero(_may_meet(a, b))[0]
    j = np.nonzero(_may_meet(b, a))[0]
    if not len(i) or not len(j):
        return none, none, none
    near = (a.low[:, i, None, :] <= b.high[:, None, j, :]).all(-1) & (
        b.low[:, None, j, :] <= a.high[:, i, None, :]
    ).all(-1)
    frame, p, q = np.nonzero(near)
    p, q = i[p], j[q]
    hit = overlaps(a.boxes[_at(a, frame), p], b.boxes[_at(b, frame), q])
    return frame[hit], p[hit], q[hit]


def blocked(a: Sweep, b: Sweep) -> tuple[Bools, Indices]:
    """Which pieces (N_s,) of `a` meet `b`, and the boxes of `b` that are met."""
    frame, p, q = hits(a, b)
    if not len(frame):
        return np.zeros(len(a.cuts) - 1, dtype=bool), np.zeros(0, dtype=np.int64)
    pieces = _pieces(a.boxes[_at(a, frame), p], a.cuts)
    others = b.boxes[_at(b, frame), q]
    wide = Boxes(others.center[:, None], others.axes[:, None], others.half[:, None])
    met = overlaps(pieces, _shaped(wide, pieces.half.shape[:-1])) & (pieces.half[..., 1] > 0)
    found: Bools = np.logical_or.reduce(met, axis=0)
    return found, np.unique(q[np.logical_or.reduce(met, axis=1)])


def conflicts(a: Sweep, b: Sweep) -> Bools:
    """Which pieces of `a` meet which pieces of `b`, (N_s, N_s)."""
    frame, p, q = hits(a, b)
    count = len(a.cuts) - 1
    if not len(frame):
        return np.zeros((count, count), dtype=bool)
    first = _pieces(a.boxes[_at(a, frame), p], a.cuts)
    second = _pieces(b.boxes[_at(b, frame), q], b.cuts)
    left = Boxes(first.center[:, :, None], first.axes[:, :, None], first.half[:, :, None])
    right = Boxes(second.center[:, None], second.axes[:, None], second.half[:, None])
    shape = (len(frame), count, count)
    left, right = _shaped(left, shape), _shaped(right, shape)
    met = overlaps(left, right) & (left.half[..., 1] > 0) & (right.half[..., 1] > 0)
    found: Bools = np.logical_or.reduce(met, axis=0)
    return found


def window_blocked(pieces: Bools, window: tuple[int, int]) -> bool:
    """Whether a window holds a blocked piece."""
    return bool(pieces[window[0] : window[1]].any())


def window_conflicts(pieces: Bools, windows: tuple[tuple[int, int], ...]) -> Bools:
    """Which windows of one patch conflict with which of the other, (w, w), from its pieces (N_s, N_s)."""
    total = np.zeros((pieces.shape[0] + 1, pieces.shape[1] + 1), dtype=np.int64)
    total[1:, 1:] = pieces.cumsum(0).cumsum(1)
    a, b = np.array(windows).T
    inside = total[b][:, b] - total[a][:, b] - total[b][:, a] + total[a][:, a]
    found: Bools = inside > 0
    return found


def _at(s: Sweep, frame: Indices) -> Indices:
    return frame if len(s.low) > 1 else np.zeros_like(frame)


def _may_meet(a: Sweep, b: Sweep) -> Bools:
    low, high = b.low.min((0, 1)), b.high.max((0, 1))
    found: Bools = ((a.low.min(0) <= high) & (a.high.max(0) >= low)).all(-1)
    return found


def _pieces(boxes: Boxes, cuts: Array) -> Boxes:
    """Each box (k,) cut into pieces (k, N_s); where a piece is empty its half length is 0."""
    along = boxes.axes[:, 1]
    middle = np.einsum("kj,kj->k", boxes.center, along)
    low = np.maximum((middle - boxes.half[:, 1])[:, None], cuts[:-1])
    high = np.minimum((middle + boxes.half[:, 1])[:, None], cuts[1:])
    center = boxes.center[:, None] + along[:, None] * ((low + high) / 2 - middle[:, None])[..., None]
    half = np.repeat(boxes.half[:, None], len(cuts) - 1, axis=1)
    half[..., 1] = np.maximum((high - low) / 2, 0.0)
    return Boxes(center, np.broadcast_to(boxes.axes[:, None], (*half.shape, 3)), half)


def _shaped(boxes: Boxes, shape: tuple[int, ...]) -> Boxes:
    return Boxes(
        np.broadcast_to(boxes.center, (*shape, 3)),
        np.broadcast_to(boxes.axes, (*shape, 3, 3)),
        np.broadcast_to(boxes.half, (*shape, 3)),
    )
