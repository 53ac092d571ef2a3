"""Swept boxes against swept boxes: what meets when, and which pieces of it (sections 5.4 to 5.6).

Everything that moves together is looked at together, as one batch of boxes over the same frames, whose boxes belong to
*lanes* (a way in which one patch may fold). A patch is cut into N_s pieces along its hinge direction; whether a piece
meets something does not depend on the other pieces, so one sweep of the whole patch answers for all windows.

Broad phase on bounds over time, then on bounds frame by frame, then the exact separating-axis test. Boxes of parallel
hinge directions are prisms along the same line, so that which of their pieces meet follows from intervals alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.boxes import Boxes, bounds, near_pairs, overlaps

PARALLEL = 1.0 - 1e-9
"""Cosine above which two hinge directions are the same line."""
SQUARE = 1e-9
"""Cosine below which two hinge directions are square to each other."""
INSET = 1e-6
"""Pieces end this much short of their cuts, mm, so that neighbours do not count as meeting."""
_LEVEL = 1e-300
"""What is divided by instead of the slope of a level side."""
SAMPLE = 8
"""One in this many meetings is looked at first."""
CHUNK = 20_000
"""Pairs of boxes that are looked at in one go, for the sake of memory."""

Excluded = Bools | Callable[[], Bools] | None
"""(lanes of a, lanes of b) which are never compared, or how to find out where any come near each other."""


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Boxes over time; the second axis of every box runs along its hinge direction."""

    boxes: Boxes
    """(frames, n); one frame for what stands still."""
    lane: Indices
    """(n,) what each box belongs to."""
    low: Array
    """(frames, n, 3) lower corners of the bounds."""
    high: Array
    """(frames, n, 3) upper corners."""
    least: Array
    """(n, 3) lower corners over all frames."""
    most: Array
    """(n, 3) upper corners over all frames."""

    def __len__(self) -> int:
        return len(self.lane)


def batch(boxes: Boxes, lane: Indices) -> Batch:
    """A batch of boxes (frames, n) with their bounds."""
    low, high = bounds(boxes)
    return Batch(boxes, lane, low, high, low.min(0), high.max(0))


def joined(parts: list[tuple[Boxes, int]], margin: float) -> Batch:
    """One batch of several movers (frames, n_i) with their lanes, every face moved outward by `margin` mm."""
    center = np.concatenate([boxes.center for boxes, _ in parts], axis=1)
    axes = np.concatenate([boxes.axes for boxes, _ in parts], axis=1)
    half = np.maximum(np.concatenate([boxes.half for boxes, _ in parts], axis=1) + margin, 0.0)
    lane = np.repeat([number for _, number in parts], [boxes.center.shape[1] for boxes, _ in parts])
    return batch(Boxes(center, axes, half), lane)


def carried(boxes: Boxes, shift: Array, lane: Indices) -> Batch:
    """A batch of rigid boxes (n,) that are translated by `shift` (frames, n, 3)."""
    low, high = bounds(boxes)
    shape = shift.shape[:2]
    spread = Boxes(
        boxes.center + shift, np.broadcast_to(boxes.axes, (*shape, 3, 3)), np.broadcast_to(boxes.half, (*shape, 3))
    )
    return Batch(spread, lane, low + shift, high + shift, low + shift.min(0), high + shift.max(0))


def still(boxes: Boxes, frames: int) -> Boxes:
    """Boxes (n,) repeated over frames."""
    shape = (frames, len(boxes))
    return Boxes(
        np.broadcast_to(boxes.center, (*shape, 3)), np.broadcast_to(boxes.axes, (*shape, 3, 3)),
        np.broadcast_to(boxes.half, (*shape, 3)),
    )  # fmt: skip


def meetings(a: Batch, b: Batch, excluded: Excluded = None) -> Iterator[tuple[Indices, Indices, Indices]]:
    """Frame, box of `a` and box of `b` (k,) of all overlaps, in chunks.

    `excluded` says which lanes are never compared.
    """
    if not len(a) or not len(b):
        return
    i, j = near_pairs((a.least, a.most), (b.least, b.most))
    if excluded is not None and len(i):
        never = excluded() if callable(excluded) else excluded
        keep = ~never[a.lane[i], b.lane[j]]
        i, j = i[keep], j[keep]
    for start in range(0, len(i), CHUNK):
        p, q = i[start : start + CHUNK], j[start : start + CHUNK]
        frame, pair = np.nonzero(_near(a, b, p, q))
        if not len(frame):
            continue
        p, q = p[pair], q[pair]
        hit = overlaps(_at(a, frame, p), _at(b, frame, q))
        if hit.any():
            yield frame[hit], p[hit], q[hit]


def _near(a: Batch, b: Batch, p: Indices, q: Indices) -> Bools:
    """(frames, k) when the bounds of each box `p` of `a` overlap those of the box `q` of `b`."""
    # Axis by axis: that takes a third of the time of a reduction over rows of three.
    found = np.ones((max(len(a.low), len(b.low)), len(p)), dtype=bool)
    for axis in range(3):
        found &= np.take(a.low[..., axis], p, axis=1) <= np.take(b.high[..., axis], q, axis=1)
        found &= np.take(b.low[..., axis], q, axis=1) <= np.take(a.high[..., axis], p, axis=1)
    return found


def blocked(a: Batch, cuts: Array, b: Batch, excluded: Excluded = None) -> tuple[Bools, Indices, Indices]:
    """Which pieces of each lane of `a` meet `b`.

    Args:
        a: the lanes.
        cuts: (lanes, N_s + 1) cutting points of each lane along its hinge direction, absolute coordinates, mm.
        b: what stands around them.
        excluded: which lanes of a and b are never compared.

    Returns:
        (lanes, N_s), and the lane and box of `b` of each meeting (k,), (k,), each once.
    """
    found = np.zeros((len(cuts), cuts.shape[1] - 1), dtype=bool)
    met: set[int] = set()
    for frame, p, q in meetings(a, b, excluded):
        frame, p, q = _once(a, b, frame, p, q)
        lane = a.lane[p]
        row, piece = np.nonzero(_blocked(_at(a, frame, p), cuts[lane], _at(b, frame, q)))
        found[lane[row], piece] = True
        met.update((lane[row] * len(b) + q[row]).tolist())
    lanes, others = np.divmod(np.array(sorted(met), dtype=np.int64), max(len(b), 1))
    return found, lanes, others


def _blocked(a: Boxes, cuts: Array, b: Boxes) -> Bools:
    """(k, N_s) which pieces of boxes (k,) meet the boxes that they overlap."""
    one = _intervals(a, cuts)
    real: Bools = one[1] > one[0]
    square = np.abs(np.einsum("kj,kj->k", a.axes[:, 1], b.axes[:, 1])) < SQUARE
    found = np.zeros(real.shape, dtype=bool)
    k = np.nonzero(square)[0]
    if len(k):
        first, second, own = a[k], b[k], (one[0][k], one[1][k])
        found[k] = _share(_heights(second, first.axes[:, 1], own), _heights(first, second.axes[:, 1], _whole(second)))[
            ..., 0
        ]
    k = np.nonzero(~square)[0]
    if len(k):
        pieces, other = _pieces(a[k], cuts[k]), b[k]
        wide = Boxes(other.center[:, None], other.axes[:, None], other.half[:, None])
        found[k] = overlaps(pieces, _shaped(wide, pieces.half.shape[:-1]))
    return found & real


def conflicts(a: Batch, b: Batch, cuts: Array, excluded: Bools) -> dict[tuple[int, int], Bools]:
    """By lane of `a` and lane of `b` that meet, which of their pieces do (N_s, N_s)."""
    steps = cuts.shape[1] - 1
    found: dict[tuple[int, int], Bools] = {}
    for frame, p, q in meetings(a, b, excluded):
        frame, p, q = _once(a, b, frame, p, q)
        pairs, place = np.unique(a.lane[p] * len(cuts) + b.lane[q], return_inverse=True)
        table = np.zeros((len(pairs), steps, steps), dtype=bool)
        _fill(table, place, _at(a, frame, p), cuts[a.lane[p]], _at(b, frame, q), cuts[b.lane[q]])
        for pair, own in zip(pairs.tolist(), table, strict=True):
            key = divmod(pair, len(cuts))
            found[key] = found[key] | own if key in found else own
    return {key: own for key, own in found.items() if own.any()}


def _fill(table: Bools, place: Indices, a: Boxes, cuts_a: Array, b: Boxes, cuts_b: Array) -> None:
    """Marks in `table` (pairs, N_s, N_s) which pieces of overlapping boxes (k,) meet; `place` (k,) is their pair."""
    one, other = _intervals(a, cuts_a), _intervals(b, cuts_b)
    real: Bools = (one[1] > one[0])[:, :, None] & (other[1] > other[0])[:, None]
    cosine = np.einsum("kj,kj->k", a.axes[:, 1], b.axes[:, 1])
    same, square = np.abs(cosine) > PARALLEL, np.abs(cosine) < SQUARE
    met = real & _share((one[0], one[1]), _on_line(other, cosine)) & same[:, None, None]
    if square.any():
        met |= real & _share(_heights(b, a.axes[:, 1], one), _heights(a, b.axes[:, 1], other)) & square[:, None, None]
    row, s, t = np.nonzero(met)
    table[place[row], s, t] = True
    rest = np.nonzero(~same & ~square)[0]
    if len(rest):
        first, second = _pieces(a[rest], cuts_a[rest]), _pieces(b[rest], cuts_b[rest])
        near: Bools = real[rest] & _bounds_meet(bounds(first), bounds(second))
        # Most pieces that meet do so in many frames: a few of these tell for most pairs, the others need not be asked.
        for part in (slice(0, None, SAMPLE), slice(None)):
            row, s, t = np.nonzero(near[part] & ~table[place[rest[part]]])
            row = np.arange(len(rest))[part][row]
            hit = overlaps(first[row, s], second[row, t])
            table[place[rest[row[hit]]], s[hit], t[hit]] = True


def _on_line(intervals: tuple[Array, Array], cosine: Array) -> tuple[Array, Array]:
    """Intervals (k, n) along hinge directions, on lines that may run the other way."""
    low, high = (end * np.sign(cosine)[:, None] for end in intervals)
    return np.minimum(low, high), np.maximum(low, high)


def _share(a: tuple[Array, Array], b: tuple[Array, Array]) -> Bools:
    """Which intervals (k, n) and (k, m) have more than an end in common, (k, n, m)."""
    found: Bools = (a[0][:, :, None] < b[1][:, None]) & (b[0][:, None] < a[1][:, :, None])
    return found


def _heights(boxes: Boxes, along: Array, intervals: tuple[Array, Array]) -> tuple[Array, Array]:
    """Between which heights boxes (k,) reach into intervals (k, n) of horizontal lines square to their hinges.

    Boxes whose hinges are square to each other meet in those pieces in which they reach the same height: where one of
    them is along its own hinge does not matter to what the other one needs.
    """
    middle = np.einsum("kj,kj->k", boxes.center, along)[:, None]
    low, high = intervals[0] - middle, intervals[1] - middle
    sides, rises, half = np.einsum("kij,kj->ki", boxes.axes[:, ::2], along), boxes.axes[:, ::2, 2], boxes.half[:, ::2]
    # A box is the same seen from its other end: how far it reaches down is how far it reaches up there.
    both = _highest(sides, rises, half, np.concatenate([low, -high], axis=1), np.concatenate([high, -low], axis=1))
    count, height = low.shape[1], boxes.center[:, 2:]
    return height - both[:, count:], height + both[:, :count]


def _highest(sides: Array, rises: Array, half: Array, low: Array, high: Array) -> Array:
    """(k, n) how far rectangles reach above their middle where they are between `low` and `high` (k, n) beside it.

    `sides` and `rises` (k, 2) are the components of their unit sides, `half` (k, 2) their half lengths; -inf where they
    do not reach there.
    """
    leans = sides * np.sign(rises)
    corner = (leans * half).sum(1)[:, None]
    at = np.minimum(np.maximum(corner, low), high)
    # A level side bounds no height.
    slopes = np.maximum(np.abs(rises), _LEVEL)[:, :, None]
    found = ((half[:, :, None] - leans[:, :, None] * at[:, None]) / slopes).min(1)
    return np.where(np.abs(at) <= (np.abs(sides) * half).sum(1)[:, None], found, -np.inf)


def _bounds_meet(a: tuple[Array, Array], b: tuple[Array, Array]) -> Bools:
    """Which pieces (k, n) and (k, m) have bounds that overlap, (k, n, m)."""
    (low_a, high_a), (low_b, high_b) = a, b
    found = np.ones((len(low_a), low_a.shape[1], low_b.shape[1]), dtype=bool)
    for axis in range(3):
        found &= low_a[:, :, None, axis] <= high_b[:, None, :, axis]
        found &= low_b[:, None, :, axis] <= high_a[:, :, None, axis]
    return found


def _once(a: Batch, b: Batch, frame: Indices, p: Indices, q: Indices) -> tuple[Indices, Indices, Indices]:
    """Every pair of parallel boxes once: which of their pieces meet is the same at all times."""
    first, second = (s.boxes.axes[_frame(s, frame), box, 1] for s, box in ((a, p), (b, q)))
    same = np.abs(np.einsum("kj,kj->k", first, second)) > PARALLEL
    code = p * len(b) + q
    keep = ~same
    _, index = np.unique(code[same], return_index=True)
    keep[np.nonzero(same)[0][index]] = True
    return frame[keep], p[keep], q[keep]


def _at(s: Batch, frame: Indices, box: Indices) -> Boxes:
    return s.boxes[_frame(s, frame), box]


def _frame(s: Batch, frame: Indices) -> Indices:
    """The frame of a batch at each frame, which is the only one for what stands still."""
    return frame if len(s.low) > 1 else np.zeros_like(frame)


def _intervals(boxes: Boxes, cuts: Array) -> tuple[Array, Array]:
    """Where the pieces of boxes (k,) begin and end (k, N_s) along the boxes' hinge direction; empty ones in reverse."""
    middle = np.einsum("kj,kj->k", boxes.center, boxes.axes[:, 1])
    low = np.maximum((middle - boxes.half[:, 1])[:, None], cuts[:, :-1] + INSET)
    high = np.minimum((middle + boxes.half[:, 1])[:, None], cuts[:, 1:] - INSET)
    return low, high


def _whole(boxes: Boxes) -> tuple[Array, Array]:
    """Where boxes (k,) begin and end (k, 1) along their hinge direction."""
    middle = np.einsum("kj,kj->k", boxes.center, boxes.axes[:, 1])
    return (middle - boxes.half[:, 1])[:, None], (middle + boxes.half[:, 1])[:, None]


def _pieces(boxes: Boxes, cuts: Array) -> Boxes:
    """Each box (k,) cut into pieces (k, N_s); where a piece is empty its half length is 0."""
    along = boxes.axes[:, 1]
    middle = np.einsum("kj,kj->k", boxes.center, along)
    low, high = _intervals(boxes, cuts)
    center = boxes.center[:, None] + along[:, None] * ((low + high) / 2 - middle[:, None])[..., None]
    half = np.repeat(boxes.half[:, None], cuts.shape[1] - 1, axis=1)
    half[..., 1] = np.maximum((high - low) / 2, 0.0)
    return Boxes(center, np.broadcast_to(boxes.axes[:, None], (*half.shape, 3)), half)


def _shaped(boxes: Boxes, shape: tuple[int, ...]) -> Boxes:
    return Boxes(
        np.broadcast_to(boxes.center, (*shape, 3)),
        np.broadcast_to(boxes.axes, (*shape, 3, 3)),
        np.broadcast_to(boxes.half, (*shape, 3)),
    )
