"""Oriented boxes in bulk: bounds, and the exact separating-axis test for many pairs at once.

The test follows Gottschalk, Lin and Manocha, "OBBTree" (1996): two boxes are apart exactly where one of
fifteen axes separates them. Cost: a few hundred flops a pair, after a broad phase on axis-aligned bounds that halves
space until few boxes are left: O(n log n) for furniture, whose boxes overlap only their neighbours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from foldfab.geometry.arrays import Array, Bools, Indices

PARALLEL = 1e-9
"""Added to projected radii so that nearly parallel edges make no false separating axis."""

DENSE = 2**14
"""Up to this many pairs all bounds are compared at once; halving space would only cost time."""
SMALL = 2**8
"""Up to this many pairs the number of calls counts and not that of comparisons."""
FEW = 2**12
"""Space is not halved further where this many pairs are left."""
GAP_STEPS = 40
"""Halvings of a gap: down to rounding."""
WORTHWHILE = 0.8
"""Space is halved only where fewer than this share of the pairs is left to compare."""

_NEXT = np.array([1, 2, 0])
_LAST = np.array([2, 0, 1])


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Oriented boxes with any leading shape."""

    center: Array
    """(…, 3) mm."""
    axes: Array
    """(…, 3, 3) orthonormal rows."""
    half: Array
    """(…, 3) half lengths along the rows of `axes`, mm."""

    def __getitem__(self, index: Any) -> Boxes:
        return Boxes(self.center[index], self.axes[index], self.half[index])

    def __len__(self) -> int:
        return len(self.center)


def stacked(parts: list[Boxes]) -> Boxes:
    """One flat collection (n,) of several flat collections."""
    if not parts:
        return Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)))
    return Boxes(
        np.concatenate([p.center for p in parts]),
        np.concatenate([p.axes for p in parts]),
        np.concatenate([p.half for p in parts]),
    )


def moved(boxes: Boxes, offset: Array) -> Boxes:
    """The boxes translated by `offset`, anything that broadcasts against (…, 3)."""
    return Boxes(boxes.center + offset, boxes.axes, boxes.half)


def grown(boxes: Boxes, margin: float) -> Boxes:
    """The boxes with every face moved outward by `margin` mm (inward where negative)."""
    return Boxes(boxes.center, boxes.axes, np.maximum(boxes.half + margin, 0.0))


def bounds(boxes: Boxes) -> tuple[Array, Array]:
    """Lower and upper corners (…, 3) of the axis-aligned bounds."""
    reach = np.einsum("...k,...kj->...j", boxes.half, np.abs(boxes.axes))
    return boxes.center - reach, boxes.center + reach


def close_pairs(a: Boxes, b: Boxes) -> tuple[Indices, Indices]:
    """Indices (k,), (k,) into two flat collections of the pairs that overlap, sorted."""
    i, j = near_pairs(bounds(a), bounds(b))
    hit = overlaps(a[i], b[j])
    return i[hit], j[hit]


def gaps(a: Boxes, b: Boxes) -> Array:
    """(n,) how far the boxes of two equally shaped flat collections are apart, mm, pair by pair; 0 where they overlap.

    By how much both have to grow together to overlap, halved step by step: boxes that grow keep their corners, so
    it is less than the distance where these are nearest.
    """
    low = np.zeros(len(a))
    high = np.linalg.norm(a.center - b.center, axis=1) + PARALLEL
    for _ in range(GAP_STEPS):
        middle = (low + high) / 2
        half = (middle / 2)[:, None]
        hit = overlaps(Boxes(a.center, a.axes, a.half + half), Boxes(b.center, b.axes, b.half + half))
        low, high = np.where(hit, low, middle), np.where(hit, middle, high)
    return np.where(overlaps(a, b), 0.0, high)


def near_pairs(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[Indices, Indices]:
    """Indices (k,), (k,) of the pairs of axis-aligned bounds that overlap (touching counts), sorted.

    Args:
        a: lower and upper corners (n, 3), as `bounds` gives them.
        b: the same (m, 3).
    """
    if len(a[0]) * len(b[0]) <= DENSE:
        i, j = np.nonzero(_meeting(a, b))
        return i, j
    todo = [(np.arange(len(a[0])), np.arange(len(b[0])))]
    found = [np.zeros(0, dtype=np.int64)]
    while todo:
        some_a, some_b = todo.pop()
        part_a, part_b = (a[0][some_a], a[1][some_a]), (b[0][some_b], b[1][some_b])
        halves = _halves(part_a, part_b) if len(some_a) * len(some_b) > FEW else ()
        todo += [(some_a[in_a], some_b[in_b]) for in_a, in_b in halves]
        if not halves:
            i, j = np.nonzero(_meeting(part_a, part_b))
            found.append(some_a[i] * len(b[0]) + some_b[j])
    # Sorted, and not by np.unique, which hashes millions of numbers for more than twice the time.
    codes = np.sort(np.concatenate(found))
    i, j = np.divmod(codes[np.diff(codes, prepend=-1) > 0], len(b[0]))
    return i, j


def _meeting(a: tuple[Array, Array], b: tuple[Array, Array]) -> Bools:
    """Whether each of the bounds (n) overlaps each of the others (m): (n, m)."""
    if len(a[0]) * len(b[0]) <= SMALL:
        inside: Bools = np.logical_and.reduce((a[0][:, None] <= b[1]) & (a[1][:, None] >= b[0]), axis=-1)
        return inside
    # Row by row of one axis: numbers that lie side by side compare in half the time.
    low_a, high_a, low_b, high_b = (np.ascontiguousarray(corner.T) for corner in (*a, *b))
    near: Bools = low_a[0][:, None] <= high_b[0]
    near &= high_a[0][:, None] >= low_b[0]
    for k in (1, 2):
        near &= low_a[k][:, None] <= high_b[k]
        near &= high_a[k][:, None] >= low_b[k]
    return near


def _halves(a: tuple[Array, Array], b: tuple[Array, Array]) -> tuple[tuple[Bools, Bools], ...]:
    """Which bounds reach into either half of space, cut where fewest pairs are left; none where that spares too little.

    Two bounds that overlap do so in one half or the other: where they begin to overlap lies below the cut, so both
    begin there, or above it, so both end there. The comparisons are exact; pairs across the cut are in both.
    """
    fewest, best = WORTHWHILE * len(a[0]) * len(b[0]), None
    for k in range(3):
        cut = float(np.median(np.concatenate([a[0][:, k] + a[1][:, k], b[0][:, k] + b[1][:, k]]))) / 2
        halves = (a[0][:, k] <= cut, b[0][:, k] <= cut), (a[1][:, k] > cut, b[1][:, k] > cut)
        pairs = sum(int(np.count_nonzero(in_a)) * int(np.count_nonzero(in_b)) for in_a, in_b in halves)
        if pairs < fewest:
            fewest, best = pairs, halves
    return best or ()


def overlaps(a: Boxes, b: Boxes) -> Bools:
    """Whether the boxes of two equally shaped collections overlap, pair by pair (touching counts)."""
    turn = a.axes @ b.axes.swapaxes(-1, -2)
    reach = np.abs(turn) + PARALLEL
    offset = np.einsum("...ik,...k->...i", a.axes, b.center - a.center)
    apart = (np.abs(offset) > a.half + np.einsum("...ij,...j->...i", reach, b.half)).any(-1)
    along_b = np.abs(np.einsum("...i,...ij->...j", offset, turn))
    apart |= (along_b > b.half + np.einsum("...i,...ij->...j", a.half, reach)).any(-1)
    found: Bools = ~apart.reshape(-1)
    # Boxes with an axis in common are apart along a face normal, or not at all.
    skew = np.nonzero(found & (reach < 1).all((-1, -2)).reshape(-1))[0]
    if len(skew):
        found[skew] = ~_edges_apart(
            a.half.reshape(-1, 3)[skew], b.half.reshape(-1, 3)[skew], offset.reshape(-1, 3)[skew],
            turn.reshape(-1, 3, 3)[skew], reach.reshape(-1, 3, 3)[skew],
        )  # fmt: skip
    return found.reshape(apart.shape)


def _edges_apart(half_a: Array, half_b: Array, offset: Array, turn: Array, reach: Array) -> Bools:
    """Whether one of the nine cross products of edges separates each pair (n,)."""
    distance = np.abs(offset[:, _LAST, None] * turn[:, _NEXT, :] - offset[:, _NEXT, None] * turn[:, _LAST, :])
    from_a = half_a[:, _NEXT, None] * reach[:, _LAST, :] + half_a[:, _LAST, None] * reach[:, _NEXT, :]
    from_b = half_b[:, None, _NEXT] * reach[:, :, _LAST] + half_b[:, None, _LAST] * reach[:, :, _NEXT]
    apart: Bools = np.logical_or.reduce(distance > from_a + from_b, axis=(-1, -2))
    return apart
