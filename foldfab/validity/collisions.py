"""No two bodies share space at any moment (condition iii of section 5.2), the moments between samples included.

Two boxes cannot meet in an interval if one direction separates them at its ends and its middle, and nothing bends away
from a straight way by more than they are apart. Intervals without such a direction are bisected. Sheets without
thickness could pass through each other while parallel and never cross: a change of sides is looked for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array, Bools, Indices
from foldfab.geometry.boxes import Boxes, bounds, stacked
from foldfab.validity.configuration import Poses, Tree, arranged
from foldfab.validity.model import Folding
from foldfab.validity.separation import along, cut_back, separation

TOUCH = 0.05
"""Bodies may share this much, mm: a layer of a print, and far less than the clearance of a hinge."""
DEPTH = 7
"""How often an interval is bisected; 3 mm of motion are then 0.02 mm."""
PASSING = 20
"""How often the moment is bisected in which parallel sheets change sides."""
CHUNK = 24
"""Intervals that are looked at together."""
PARALLEL = 0.9998
"""Cosine of the angle up to which two sheets count as parallel: 1.1°."""
ON_PLANE = 1e-6
"""Sheets closer than this lie in one plane, mm: they rest on each other and have no side."""


@dataclass(frozen=True, slots=True)
class Meeting:
    """Two bodies that share space."""

    time: float
    """The first moment."""
    first: str
    second: str
    depth: float
    """The least way that would part them when they share most, mm."""


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """All pieces of all bodies in the open posture; those cut back for one other body come last."""

    boxes: Boxes
    body: Indices
    """(n,) index of the body it belongs to."""
    tested: Bools
    """(n, n) which pairs may not meet; each is True once."""


@dataclass(frozen=True, slots=True, eq=False)
class _Spans:
    """Intervals of time (n,), each with a pair of pieces that may meet in it."""

    start: Array
    end: Array
    first: Indices
    second: Indices

    def __getitem__(self, pick: Bools) -> _Spans:
        return _Spans(self.start[pick], self.end[pick], self.first[pick], self.second[pick])


def meetings(folding: Folding, tree: Tree) -> list[Meeting]:
    """Pairs of bodies that meet, each with the first moment and the most that they share, sorted by time."""
    pieces, times = _pieces(folding), folding.moments
    all_met = list(_at_start(folding, tree, pieces))
    for i in range(0, len(times) - 1, CHUNK):
        all_met += _within(folding, tree, pieces, times[i : i + CHUNK + 1])
    found: dict[tuple[str, str], Meeting] = {}
    for met in all_met:
        pair = (met.first, met.second)
        known = found.get(pair, met)
        found[pair] = Meeting(min(met.time, known.time), *pair, max(met.depth, known.depth))
    return sorted(found.values(), key=lambda m: (m.time, m.first, m.second))


def _pieces(folding: Folding) -> _Pieces:
    bodies, hinges = folding.linkage.bodies, folding.linkage.hinges
    index = {body.name: i for i, body in enumerate(bodies)}
    boxes = [body.pieces for body in bodies]
    owner = [i for i, body in enumerate(bodies) for _ in range(len(body.pieces))]
    cuts = []
    for hinge in hinges:
        if hinge.room > 0:
            rest = cut_back(bodies[index[hinge.second]].pieces, hinge.point, hinge.direction, hinge.room)
            boxes.append(rest)
            cuts += [(index[hinge.first], len(owner) + i) for i in range(len(rest))]
            owner += [index[hinge.second]] * len(rest)
    body = np.array(owner, dtype=np.int64)
    whole = len(owner) - len(cuts)
    tested = np.zeros((len(owner), len(owner)), dtype=bool)
    tested[:whole, :whole] = body[:whole, None] < body[None, :whole]
    for hinge in hinges:
        if hinge.room > 0:
            one, other = body[:whole] == index[hinge.first], body[:whole] == index[hinge.second]
            tested[:whole, :whole] &= ~(one[:, None] & other | other[:, None] & one)
    for first, piece in cuts:
        tested[:whole, piece] = body[:whole] == first
    return _Pieces(stacked(boxes), body, tested)


def _at_start(folding: Folding, tree: Tree, pieces: _Pieces) -> Iterator[Meeting]:
    """What meets at the first moment; later only what moves against each other can begin to."""
    start = folding.moments[:1]
    poses = _poses(folding, tree, start)
    low, high = bounds(_posed(pieces, poses)[0])
    first, second = np.nonzero(pieces.tested & _near(low, high))
    spans = _Spans(np.full(len(first), start[0]), np.full(len(first), start[0]), first, second)
    at = np.zeros(len(first), dtype=np.int64)
    depth = separation(pieces.boxes[first], _relative(pieces, spans, poses, at))[0]
    yield from _met(folding, pieces, spans, depth, spans.start)


def _within(folding: Folding, tree: Tree, pieces: _Pieces, times: Array) -> Iterator[Meeting]:
    """What meets between some moments (k,)."""
    spans = _close(folding, tree, pieces, times)
    for _ in range(DEPTH + 1):
        if not len(spans.start):
            return
        middle = (spans.start + spans.end) / 2
        moments, where = np.unique(np.concatenate([spans.start, middle, spans.end]), return_inverse=True)
        poses = _poses(folding, tree, moments)
        posed = [_relative(pieces, spans, poses, at) for at in np.split(where, 3)]
        own = pieces.boxes[spans.first]
        measured = [separation(own, other) for other in posed]
        for (apart, _), time in zip(measured, (spans.start, middle, spans.end), strict=True):
            yield from _met(folding, pieces, spans, apart, time)
        passed = _passed(folding, tree, pieces, spans, posed[0], posed[2])
        yield from _met(folding, pieces, spans, passed, middle)
        deep = np.min([apart for apart, _ in measured], axis=0) < -TOUCH
        again = ~(_is_safe(own, posed, [axis for _, axis in measured]) | (passed < -TOUCH) | deep)
        rest, half = spans[again], middle[again]
        spans = _Spans(
            np.concatenate([rest.start, half]), np.concatenate([half, rest.end]),
            np.tile(rest.first, 2), np.tile(rest.second, 2),
        )  # fmt: skip


def _close(folding: Folding, tree: Tree, pieces: _Pieces, times: Array) -> _Spans:
    """The pairs of pieces that move against each other and come near, by interval."""
    moments = np.concatenate([times, (times[1:] + times[:-1]) / 2])
    poses = _poses(folding, tree, moments)
    posed = _posed(pieces, poses)
    k = len(times) - 1
    ends = [posed[:k], posed[k + 1 :], posed[1 : k + 1]]
    edges = [bounds(boxes) for boxes in ends]
    bend = _bend(*ends)[..., None]
    low = np.min([edge[0] for edge in edges], axis=0) - bend
    high = np.max([edge[1] for edge in edges], axis=0) + bend
    group = _moving_alike(poses)[pieces.body]
    tested = pieces.tested & (group[:, None] != group[None])
    first, second = np.nonzero(tested & _near(low.min(0), high.max(0)))
    near = np.all(low[:, first] <= high[:, second], axis=-1) & np.all(low[:, second] <= high[:, first], axis=-1)
    at, pair = np.nonzero(near)
    return _Spans(times[at], times[at + 1], first[pair], second[pair])


def _moving_alike(poses: Poses) -> Indices:
    """(n,) a number for each body, the same where bodies do not move against each other."""
    turn = np.einsum("tnij,nkj->tnik", poses.turn, poses.turn[0])
    place = poses.place - np.einsum("tnij,nj->tni", turn, poses.place[0])
    flat = np.concatenate([turn.reshape(*turn.shape[:2], 9), place], axis=-1).round(9) + 0.0
    kinds: dict[bytes, int] = {}
    return np.array([kinds.setdefault(flat[:, i].tobytes(), len(kinds)) for i in range(flat.shape[1])])


def _near(low: Array, high: Array) -> Bools:
    """(n, n) whether bounds (n, 3) overlap."""
    below = np.all(low[:, None] <= high[None], axis=-1)
    return np.asarray(below & below.T)


def _is_safe(own: Boxes, posed: list[Boxes], axes: list[Array]) -> Bools:
    """Whether one of three directions (n, 3) separates the pairs at start, middle and end, bends allowed for."""
    least = [np.min([along(own, boxes, axis) for boxes in posed], axis=0) for axis in axes]
    return np.asarray(np.max(least, axis=0) - 1.5 * _bend(*posed) >= -TOUCH)


def _bend(start: Boxes, middle: Boxes, end: Boxes) -> Array:
    """How far (…,) any point of some boxes is at most from the middle of its way, mm: 0 where the way is straight."""
    off = np.linalg.norm(middle.center - (start.center + end.center) / 2, axis=-1)
    turned = np.linalg.norm(middle.axes - (start.axes + end.axes) / 2, axis=-1)
    bend: Array = off + (turned * start.half).sum(-1)
    return bend


def _passed(folding: Folding, tree: Tree, pieces: _Pieces, spans: _Spans, before: Boxes, after: Boxes) -> Array:
    """(n,) minus how much of each other sheets cover that change sides while parallel, mm; 0 where they do not."""
    own, found = pieces.boxes[spans.first], np.zeros(len(spans.start))
    sides = _side(own, before), _side(own, after)
    change = _is_parallel(own, before) & _is_parallel(own, after) & (sides[0] * sides[1] < 0)
    change &= (np.minimum(*np.abs(sides)) > ON_PLANE) & (np.abs(sides[0] - sides[1]) > TOUCH)
    if change.any():
        own, other = own[change], _in_passing(folding, tree, pieces, spans[change], sides[0][change])
        # In their plane only: they are as good as in it.
        thick = [np.where(b.half == 0, 1e3, b.half) for b in (own, other)]
        level = separation(Boxes(own.center, own.axes, thick[0]), Boxes(other.center, other.axes, thick[1]))[0]
        found[change] = np.minimum(level, 0.0)
    return found


def _in_passing(folding: Folding, tree: Tree, pieces: _Pieces, spans: _Spans, side: Array) -> Boxes:
    """Where the second sheets of spans are when they go through the planes of the first ones; `side` (n,) at first.

    That moment is bisected: on the way from one sample to the other sheets move aside as well.
    """
    own, start, end = pieces.boxes[spans.first], spans.start, spans.end
    for _ in range(PASSING):
        middle = (start + end) / 2
        moments, at = np.unique(middle, return_inverse=True)
        other = _relative(pieces, spans, _poses(folding, tree, moments), at)
        is_before = _side(own, other) * side > 0
        start, end = np.where(is_before, middle, start), np.where(is_before, end, middle)
    return other


def _side(own: Boxes, other: Boxes) -> Array:
    """(n,) how far sheets are off the planes of others, mm."""
    found: Array = np.einsum("nj,nj->n", _normal(own), other.center - own.center)
    return found


def _is_parallel(own: Boxes, other: Boxes) -> Bools:
    """(n,) which are sheets that lie in almost parallel planes."""
    is_thin = (own.half.min(1) == 0) & (other.half.min(1) == 0)
    return np.asarray(is_thin & (np.abs(np.einsum("nj,nj->n", _normal(own), _normal(other))) > PARALLEL))


def _normal(boxes: Boxes) -> Array:
    """(n, 3) the direction in which each is thinnest."""
    found: Array = boxes.axes[np.arange(len(boxes)), np.argmin(boxes.half, axis=1)]
    return found


def _poses(folding: Folding, tree: Tree, times: Array) -> Poses:
    return arranged(folding.linkage, tree, folding.angles(times), folding.slips(times))


def _posed(pieces: _Pieces, poses: Poses) -> Boxes:
    """All pieces (k, n) where the poses put them."""
    turn = poses.turn[:, pieces.body]
    center = np.einsum("tnij,nj->tni", turn, pieces.boxes.center) + poses.place[:, pieces.body]
    axes = np.einsum("tnij,nkj->tnki", turn, pieces.boxes.axes)
    return Boxes(center, axes, np.broadcast_to(pieces.boxes.half, center.shape))


def _relative(pieces: _Pieces, spans: _Spans, poses: Poses, at: Indices) -> Boxes:
    """The second piece of each span (n,) at its moment `at`, as seen from the body of the first one."""
    a, b = pieces.body[spans.first], pieces.body[spans.second]
    boxes = pieces.boxes[spans.second]
    turn = np.einsum("nji,njk->nik", poses.turn[at, a], poses.turn[at, b])
    place = np.einsum("nji,nj->ni", poses.turn[at, a], poses.place[at, b] - poses.place[at, a])
    center = np.einsum("nij,nj->ni", turn, boxes.center) + place
    return Boxes(center, np.einsum("nij,nkj->nki", turn, boxes.axes), boxes.half)


def _met(folding: Folding, pieces: _Pieces, spans: _Spans, apart: Array, time: Array) -> Iterator[Meeting]:
    """The pairs that share more than a touch."""
    names = [body.name for body in folding.linkage.bodies]
    for i in np.nonzero(apart < -TOUCH)[0]:
        pair = sorted((int(pieces.body[spans.first[i]]), int(pieces.body[spans.second[i]])))
        yield Meeting(float(time[i]), names[pair[0]], names[pair[1]], float(-apart[i]))
