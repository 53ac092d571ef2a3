"""One sweep of many whole patches answers for all of their windows: compared with the exact test, piece by piece."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding import space
from foldfab.folding.space import Batch, batch, blocked, carried, conflicts, joined, meetings, still
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, bounds, moved, overlaps

STEPS = 3
FRAMES = 4
LANES = 2
WIDE = 3.0
CUTS = np.tile(np.linspace(-WIDE, WIDE, STEPS + 1), (2 * LANES, 1))
SHORT = 1e-6
"""Pieces end this much before their cuts."""
seeds = st.integers(0, 2**32 - 1)
directions = st.sampled_from([(1, 1, 0.0), (0, 1, 0.0), (0, -1, 0.0), (1, -1, 0.0), (1, 1, 1.0)])
"""The axis of a second hinge direction, its sign, and by which angle (radians) it is turned, beside a first one along
+y: alike, square, opposite, and at another angle."""
steady = settings(deadline=None, derandomize=True, max_examples=60)


def about(axis: int, sign: int, angles: Array) -> Array:
    """(…, 3, 3) axes whose second row is ± the unit vector of `axis`."""
    sin, cos, rows = np.sin(angles), np.cos(angles), np.zeros((*angles.shape, 3, 3))
    u, v = (axis + 1) % 3, (axis + 2) % 3
    rows[..., 1, axis] = sign
    rows[..., 0, u], rows[..., 0, v] = cos, sin
    rows[..., 2, u], rows[..., 2, v] = -sign * sin, sign * cos
    return rows


def panels(
    seed: int, axis: int = 1, sign: int = 1, angle: float = 0.0, *, first: int = 0, per_lane: int = 2
) -> Batch:  # fmt: skip
    """Two lanes of panels that turn about axes along one direction; some are narrower, as knuckles are."""
    rng = np.random.default_rng(seed)
    count = LANES * per_lane
    half = np.broadcast_to(np.array([0.3, WIDE, 2.0]), (count, 3)).copy()
    half[:, 1] = rng.choice([WIDE, 1.2], count)
    center = rng.uniform(-3, 3, (FRAMES, count, 3))
    # Panels keep to their place along their hinges.
    center[..., axis] = np.where(half[:, 1] < WIDE, rng.uniform(-1.5, 1.5, count), 0.0)
    axes = about(axis, sign, rng.uniform(-2, 2, (FRAMES, count)))
    turn = np.array([[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    boxes = Boxes(center @ turn, axes @ turn, np.broadcast_to(half, (FRAMES, count, 3)))
    return batch(boxes, first + np.repeat(np.arange(LANES), per_lane))


def pieces(many: Batch, cuts: Array) -> Iterator[tuple[int, int, int, Boxes]]:
    """Box, lane and piece, and the boxes (frames,) of each piece that is not empty."""
    for i, lane in enumerate(many.lane.tolist()):
        box = many.boxes[:, i]
        along = box.axes[0, 1]
        middle, reach = float(box.center[0] @ along), float(box.half[0, 1])
        for k in range(cuts.shape[1] - 1):
            low, high = max(middle - reach, cuts[lane, k] + SHORT), min(middle + reach, cuts[lane, k + 1] - SHORT)
            if low < high:
                center = box.center + along * ((low + high) / 2 - middle)
                half = box.half.copy()
                half[:, 1] = (high - low) / 2
                yield i, lane, k, Boxes(center, box.axes, half)


def not_at_all(shape: tuple[int, int]) -> Bools:
    return np.zeros(shape, dtype=bool)


@given(seeds, directions, st.sampled_from([3, 20_000]))
@steady
def test_pieces_of_lanes_conflict_exactly_where_the_exact_test_says(
    seed: int, direction: tuple[int, int, float], chunk: int
) -> None:
    """However few boxes are looked at in one go."""
    a, b = panels(seed), panels(seed + 1, *direction, first=LANES)
    expected = {
        (one, other): np.zeros((STEPS, STEPS), dtype=bool) for one in range(LANES) for other in range(LANES, 2 * LANES)
    }
    for (_, one, s, p), (_, other, t, q) in itertools.product(pieces(a, CUTS), pieces(b, CUTS)):
        expected[one, other][s, t] |= bool(overlaps(p, q).any())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(space, "CHUNK", chunk)
        found = conflicts(a, b, CUTS, not_at_all((2 * LANES, 2 * LANES)))
    assert {k: v.tolist() for k, v in found.items()} == {k: v.tolist() for k, v in expected.items() if v.any()}


@given(seeds, directions)
@steady
def test_pieces_of_lanes_are_blocked_exactly_where_they_meet_an_obstacle(
    seed: int, direction: tuple[int, int, float]
) -> None:
    a, b = panels(seed), panels(seed + 1, *direction)
    expected, met = np.zeros((LANES, STEPS), dtype=bool), set[tuple[int, int]]()
    for _, lane, k, p in pieces(a, CUTS):
        for j in range(len(b)):
            if overlaps(p, b.boxes[:, j]).any():
                expected[lane, k] = True
                met.add((lane, j))
    found, lanes, others = blocked(a, CUTS[:LANES], b)
    assert found.tolist() == expected.tolist()
    assert list(zip(lanes.tolist(), others.tolist(), strict=True)) == sorted(met)


@given(seeds, directions, st.integers(1, 40))
@steady
def test_meetings_are_all_overlaps_however_few_are_looked_at_at_once(
    seed: int, direction: tuple[int, int, float], chunk: int
) -> None:
    a, b = panels(seed), panels(seed + 1, *direction)
    expected = {
        (frame, i, j)
        for frame in range(FRAMES)
        for i in range(len(a))
        for j in range(len(b))
        if overlaps(a.boxes[frame, i], b.boxes[frame, j])
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(space, "CHUNK", chunk)
        found = [tuple(map(int, m)) for many in meetings(a, b) for m in zip(*many, strict=True)]
    assert len(found) == len(set(found)) and set(found) == expected


@given(seeds)
@steady
def test_lanes_that_are_never_compared_do_not_meet(seed: int) -> None:
    a, b = panels(seed), panels(seed + 1, 0, first=LANES)
    apart = not_at_all((2 * LANES, 2 * LANES))
    whole = conflicts(a, b, CUTS, apart)
    apart[1, 2] = True
    kept = conflicts(a, b, CUTS, apart)
    assert {k: v.tolist() for k, v in kept.items()} == {k: v.tolist() for k, v in whole.items() if k != (1, 2)}
    obstacles = panels(seed + 1, 0)
    without = np.zeros((LANES, LANES), dtype=bool)
    without[0] = True
    found, lanes, _ = blocked(a, CUTS[:LANES], obstacles, without)
    assert not found[0].any() and 0 not in lanes
    assert found[1].tolist() == blocked(a, CUTS[:LANES], obstacles)[0][1].tolist()


def test_panels_far_apart_block_and_conflict_with_nothing() -> None:
    a, b = panels(1), panels(2, 0, first=LANES)
    far = batch(moved(b.boxes, np.array([100.0, 0.0, 0.0])), b.lane)
    assert conflicts(a, far, CUTS, not_at_all((2 * LANES, 2 * LANES))) == {}
    found, lanes, others = blocked(a, CUTS[:LANES], far)
    assert not found.any() and not len(lanes) and not len(others)


def test_nothing_meets_nothing() -> None:
    a = panels(1)
    none = batch(a.boxes[:, :0], a.lane[:0])
    assert not list(meetings(a, none)) and not list(meetings(none, a))


def test_an_obstacle_of_one_frame_stands_still() -> None:
    a, b = panels(3), panels(5, 0)
    once = batch(b.boxes[:1], b.lane)
    always = batch(still(b.boxes[0], FRAMES), b.lane)
    found = blocked(a, CUTS[:LANES], once)
    assert found[0].any()
    for one, other in zip(found, blocked(a, CUTS[:LANES], always), strict=True):
        assert one.tolist() == other.tolist()


def face_to_face(first: tuple[float, float], second: tuple[float, float]) -> tuple[Batch, Batch]:
    """Two parallel panels in one place, that cover intervals of their hinge direction."""
    made = []
    for lane, (low, high) in enumerate((first, second)):
        center = np.array([[[0.0, (low + high) / 2, 0.0]]])
        half = np.array([[[1.0, (high - low) / 2, 1.0]]])
        made.append(batch(Boxes(center, np.eye(3)[None, None], half), np.array([lane])))
    return made[0], made[1]


def test_pieces_that_meet_at_a_cut_do_not_conflict() -> None:
    """Windows on either side of a cut leave room for each other."""
    cuts = np.array([[0.0, 10.0, 20.0, 30.0]] * 2)
    whole = conflicts(*face_to_face((0, 30), (0, 30)), cuts, not_at_all((2, 2)))
    assert whole[0, 1].tolist() == np.eye(3, dtype=bool).tolist()


def test_pieces_that_overlap_by_more_than_a_touch_conflict() -> None:
    cuts = np.array([[0.0, 10.0, 20.0, 30.0], [0.1, 10.1, 20.1, 30.1]])
    met = conflicts(*face_to_face((0, 30), (0.1, 30.1)), cuts, not_at_all((2, 2)))[0, 1]
    assert met.tolist() == [[True, False, False], [True, True, False], [False, True, True]]


@given(seeds)
@steady
def test_carried_boxes_are_where_they_would_be_frame_by_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes, shift = panels(seed).boxes[0], rng.uniform(-5, 5, (FRAMES, LANES * 2, 3))
    found = carried(boxes, shift, np.arange(LANES * 2))
    center = np.stack([boxes.center + shift[k] for k in range(FRAMES)])
    expected = batch(Boxes(center, still(boxes, FRAMES).axes, still(boxes, FRAMES).half), found.lane)
    for name in ("low", "high", "least", "most"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name))
    assert found.boxes.center == pytest.approx(center)
    assert (found.boxes.axes == expected.boxes.axes).all() and (found.boxes.half == expected.boxes.half).all()


def test_movers_are_joined_with_their_lanes_and_grow_on_every_side() -> None:
    one, other = panels(1).boxes, panels(2).boxes[:, :3]
    found = joined([(one, 7), (other, 4)], 0.25)
    assert found.lane.tolist() == [7] * 4 + [4] * 3 and len(found) == 7
    assert found.boxes.half[:, :4] == pytest.approx(one.half + 0.25)
    assert (found.boxes.center[:, 4:] == other.center).all()
    assert (found.least <= bounds(found.boxes)[0]).all() and (found.most >= bounds(found.boxes)[1]).all()


def test_movers_that_shrink_away_have_no_size_below_nothing() -> None:
    assert (joined([(panels(1).boxes, 0)], -1.0).boxes.half >= 0).all()
