"""One sweep of a whole patch answers for all of its windows."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding.basic import windows
from foldfab.folding.space import Sweep, blocked, conflicts, sweep, window_blocked, window_conflicts
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, overlaps

STEPS = 3
seeds = st.integers(0, 2**32 - 1)
steady = settings(deadline=None, derandomize=True, max_examples=40)


def about(axis: int, angles: Array) -> Array:
    """(…, 3, 3) axes whose second row is the unit vector of `axis`."""
    sin, cos, rows = np.sin(angles), np.cos(angles), np.zeros((*angles.shape, 3, 3))
    along, u, v = axis, (axis + 1) % 3, (axis + 2) % 3
    rows[..., 1, along] = 1.0
    rows[..., 0, u], rows[..., 0, v] = cos, sin
    rows[..., 2, u], rows[..., 2, v] = -sin, cos
    return rows


def panels(seed: int, axis: int, frames: int = 4, count: int = 2) -> Sweep:
    """Panels that turn about axes along one direction; their middles wander."""
    rng = np.random.default_rng(seed)
    axes = about(axis, rng.uniform(-2, 2, (frames, count)))
    half = np.broadcast_to(np.array([0.3, 3.0, 2.0]), (frames, count, 3))
    center = rng.uniform(-3, 3, (frames, count, 3))
    center[..., axis] = 0.0
    return sweep(Boxes(center, axes, half), np.linspace(-3, 3, STEPS + 1))


def piece(boxes: Boxes, cuts: Array, axis: int, index: int) -> Boxes:
    """The panels cut down to the strip between two cutting points."""
    center, half = boxes.center.copy(), boxes.half.copy()
    center[..., axis] = (cuts[index] + cuts[index + 1]) / 2
    half[..., 1] = (cuts[index + 1] - cuts[index]) / 2
    return Boxes(center, boxes.axes, half)


def meet(a: Boxes, b: Boxes) -> bool:
    """Whether any panels of two sweeps meet in any frame."""
    pairs = itertools.product(range(a.half.shape[1]), range(b.half.shape[1]))
    return any(bool(overlaps(a[:, i], b[:, j]).any()) for i, j in pairs)


@given(seeds)
@steady
def test_pieces_conflict_exactly_where_strips_of_the_panels_meet(seed: int) -> None:
    a, b = panels(seed, 1), panels(seed + 1, 0)
    expected = [
        [meet(piece(a.boxes, a.cuts, 1, i), piece(b.boxes, b.cuts, 0, j)) for j in range(STEPS)] for i in range(STEPS)
    ]
    assert conflicts(a, b).tolist() == expected


@given(seeds)
@steady
def test_pieces_are_blocked_exactly_where_strips_meet_an_obstacle(seed: int) -> None:
    a, b = panels(seed, 1), panels(seed + 1, 0)
    pieces, met = blocked(a, b)
    assert pieces.tolist() == [meet(piece(a.boxes, a.cuts, 1, i), b.boxes) for i in range(STEPS)]
    assert met.tolist() == [j for j in range(2) if meet(a.boxes, b.boxes[:, [j]])]


def test_panels_far_apart_block_and_conflict_with_nothing() -> None:
    a, far = panels(1, 1), panels(2, 0)
    far = sweep(Boxes(far.boxes.center + 100, far.boxes.axes, far.boxes.half), far.cuts + 100)
    assert not conflicts(a, far).any()
    assert not blocked(a, far)[0].any() and not len(blocked(a, far)[1])


def test_an_obstacle_of_one_frame_stands_still() -> None:
    a, b = panels(3, 1), panels(4, 0, frames=1, count=1)
    always = sweep(Boxes(*(np.repeat(getattr(b.boxes, f), 4, axis=0) for f in ("center", "axes", "half"))), b.cuts)
    assert blocked(a, b)[0].tolist() == blocked(a, always)[0].tolist()


@given(seeds, st.integers(1, 6))
@steady
def test_windows_conflict_exactly_where_they_hold_pieces_that_do(seed: int, steps: int) -> None:
    pieces: Bools = np.random.default_rng(seed).random((steps, steps)) < 0.2
    whole = windows(steps)
    expected = [[bool(pieces[a:b, c:d].any()) for c, d in whole] for a, b in whole]
    assert window_conflicts(pieces, whole).tolist() == expected


@pytest.mark.parametrize(("window", "expected"), [((0, 2), False), ((0, 3), True), ((2, 3), True), ((3, 5), False)])
def test_a_window_is_blocked_where_it_holds_a_blocked_piece(window: tuple[int, int], expected: bool) -> None:
    assert window_blocked(np.array([False, False, True, False, False]), window) is expected
