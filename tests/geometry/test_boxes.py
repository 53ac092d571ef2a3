"""The separating-axis test agrees with brute force: convex bodies meet where an edge of one cuts the other."""

from __future__ import annotations

import itertools
from unittest import mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry import boxes as module
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, bounds, close_pairs, gaps, grown, moved, near_pairs, overlaps, stacked

MARGIN = 1e-6
SIGNS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
EDGES = [(i, j) for i, j in itertools.combinations(range(8), 2) if (SIGNS[i] != SIGNS[j]).sum() == 1]
seeds = st.integers(0, 2**32 - 1)
steady = settings(deadline=None, derandomize=True, max_examples=60)


def one(center: tuple[float, ...], half: tuple[float, ...], axes: Array | None = None) -> Boxes:
    return Boxes(np.array([center]), np.array([np.eye(3) if axes is None else axes]), np.array([half]))


def some(seed: int, count: int) -> Boxes:
    """Boxes of all proportions, about as far apart as they are long; every third is turned by quarters only."""
    rng = np.random.default_rng(seed)
    turns = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    turns[::3] = np.eye(3)[rng.permutation(3)]
    return Boxes(rng.uniform(-2, 2, (count, 3)), turns, 10.0 ** rng.uniform(-1.5, 0.3, (count, 3)))


def rotation(seed: int) -> Array:
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    proper: Array = turn * np.sign(np.linalg.det(turn))
    return proper


def corners(box: Boxes) -> Array:
    found: Array = box.center + (SIGNS * box.half) @ box.axes
    return found


def edge_cuts(a: Boxes, b: Boxes) -> bool:
    """Whether an edge of box `a` meets box `b`: each edge clipped by the three slabs of `b`."""
    local = (corners(a) - b.center) @ b.axes.T
    for i, j in EDGES:
        start, way = local[i], local[j] - local[i]
        still = np.abs(way) < 1e-12
        near = (-b.half - start) / np.where(still, 1.0, way)
        far = (b.half - start) / np.where(still, 1.0, way)
        low = np.where(still, -np.inf, np.minimum(near, far)).max()
        high = np.where(still, np.inf, np.maximum(near, far)).min()
        if (np.abs(start[still]) <= b.half[still]).all() and max(low, 0.0) <= min(high, 1.0):
            return True
    return False


def meet(a: Boxes, b: Boxes) -> bool:
    """Brute force on two single boxes."""
    return edge_cuts(a, b) or edge_cuts(b, a)


@given(seeds)
@steady
def test_overlap_agrees_with_brute_force(seed: int) -> None:
    a, b = some(seed, 12), some(seed + 1, 12)
    for i, hit in enumerate(overlaps(a, b)):
        if hit:
            assert meet(grown(a[i], MARGIN), grown(b[i], MARGIN))
        else:
            assert not meet(grown(a[i], -MARGIN), grown(b[i], -MARGIN))


@given(seeds)
@steady
def test_overlap_is_symmetric(seed: int) -> None:
    a, b = some(seed, 40), some(seed + 1, 40)
    assert (overlaps(a, b) == overlaps(b, a)).all()


@given(seeds)
@steady
def test_a_rigid_motion_changes_no_overlap(seed: int) -> None:
    a, b, turn = some(seed, 40), some(seed + 1, 40), rotation(seed)
    shift = np.array([10.0, -20.0, 30.0])
    there = [Boxes(x.center @ turn.T + shift, x.axes @ turn.T, x.half) for x in (a, b)]
    after = overlaps(*there)
    assert not (overlaps(grown(a, -MARGIN), grown(b, -MARGIN)) & ~after).any()
    assert not (after & ~overlaps(grown(a, MARGIN), grown(b, MARGIN))).any()


def test_boxes_that_touch_overlap_and_boxes_a_hair_apart_do_not() -> None:
    unit = one((0, 0, 0), (1, 1, 1))
    for corner in SIGNS:
        assert overlaps(unit, moved(unit, 2 * corner)).all()
        assert not overlaps(unit, moved(unit, (2 + 1e-6) * corner)).any()


def test_crossed_edges_are_told_apart_by_their_common_normal() -> None:
    half = np.sqrt(0.5)
    about_x = np.array([[1, 0, 0], [0, half, half], [0, -half, half]])
    about_y = np.array([[half, 0, half], [0, 1, 0], [-half, 0, half]])
    below, edge = one((0, 0, 0), (3, 1, 1), about_x), 2 * np.sqrt(2.0)
    assert overlaps(below, one((0, 0, edge - 1e-6), (1, 3, 1), about_y)).all()
    assert not overlaps(below, one((0, 0, edge + 1e-6), (1, 3, 1), about_y)).any()


def test_a_box_within_a_box_overlaps() -> None:
    assert overlaps(one((0, 0, 0), (5, 5, 5)), one((1, 2, 3), (0.1, 0.1, 0.1), rotation(3))).all()


@given(seeds)
@steady
def test_close_pairs_are_all_pairs_that_overlap(seed: int) -> None:
    a, b = some(seed, 9), some(seed + 1, 7)
    found = set(zip(*(index.tolist() for index in close_pairs(a, b)), strict=True))
    expected = {(i, j) for i in range(9) for j in range(7) if overlaps(a[[i]], b[[j]])[0]}
    assert found == expected


def spread(seed: int, count: int) -> tuple[Array, Array]:
    """Bounds on a coarse lattice, so that many touch; some as large as all together, some flat, some the same."""
    rng = np.random.default_rng(seed)
    low = rng.integers(-12, 12, (count, 3)).astype(float)
    size = rng.integers(0, 4, (count, 3)) * rng.choice([1.0, 1.0, 1.0, 12.0], (count, 3))
    return low, low + size


def all_pairs(a: tuple[Array, Array], b: tuple[Array, Array]) -> list[list[int]]:
    """Brute force."""
    near = (a[0][:, None] <= b[1][None]).all(-1) & (b[0][None] <= a[1][:, None]).all(-1)
    return [index.tolist() for index in np.nonzero(near)]


@given(seeds, st.integers(0, 80), st.integers(0, 80))
@steady
def test_halving_space_finds_exactly_all_pairs_in_order(seed: int, n: int, m: int) -> None:
    a, b = spread(seed, n), spread(seed + 1, m)
    expected = all_pairs(a, b)
    assert [index.tolist() for index in near_pairs(a, b)] == expected
    with mock.patch.multiple(module, DENSE=-1 if n * m else 0, FEW=9):
        assert [index.tolist() for index in near_pairs(a, b)] == expected


@given(seeds)
@settings(deadline=None, derandomize=True, max_examples=8)
def test_many_boxes_have_the_close_pairs_of_brute_force(seed: int) -> None:
    many = some(seed, 700)
    scattered = moved(many, np.random.default_rng(seed).uniform(-30, 30, (700, 3)))
    i, j = (index.reshape(-1) for index in np.meshgrid(range(700), range(700), indexing="ij"))
    hit = overlaps(scattered[i], scattered[j])
    found = close_pairs(scattered, scattered)
    assert (found[0] == i[hit]).all() and (found[1] == j[hit]).all()


def test_pairs_that_are_compared_grow_as_the_boxes_do() -> None:
    compared = []
    for side in (32, 64, 128):
        low = np.array([(x, y, 0.0) for x in range(side) for y in range(side)])
        with mock.patch.object(module, "_meeting", wraps=module._meeting) as meeting:
            i, _ = near_pairs((low, low + 1.2), (low, low + 1.2))
        assert len(i) == (3 * side - 2) ** 2
        compared.append(sum(len(call.args[0][0]) * len(call.args[1][0]) for call in meeting.call_args_list))
    assert compared[2] < 4.4 * compared[1] < 4.4 * 4.4 * compared[0]


def test_nothing_has_no_close_pairs() -> None:
    nothing = stacked([])
    assert len(nothing) == 0
    assert [len(index) for index in close_pairs(nothing, some(1, 3))] == [0, 0]


@given(seeds)
@steady
def test_bounds_are_those_of_the_corners(seed: int) -> None:
    boxes = some(seed, 10)
    low, high = bounds(boxes)
    for i in range(10):
        assert np.allclose(low[i], corners(boxes[i]).min(0))
        assert np.allclose(high[i], corners(boxes[i]).max(0))


def test_overlaps_and_bounds_keep_any_leading_shape() -> None:
    flat = some(5, 12)
    grid = Boxes(flat.center.reshape(3, 4, 3), flat.axes.reshape(3, 4, 3, 3), flat.half.reshape(3, 4, 3))
    assert (overlaps(grid[:2], grid[1:]).ravel() == overlaps(flat[:8], flat[4:])).all()
    assert bounds(grid)[0].shape == (3, 4, 3)


def test_growing_moves_every_face_and_never_turns_a_box_inside_out() -> None:
    box = one((1, 2, 3), (0.5, 2, 4))
    assert grown(box, 0.25).half.tolist() == [[0.75, 2.25, 4.25]]
    assert grown(box, -1.0).half.tolist() == [[0.0, 1.0, 3.0]]


def test_moving_keeps_axes_and_size() -> None:
    box = some(2, 4)
    shifted = moved(box, np.array([1.0, 2.0, 3.0]))
    assert shifted.center == pytest.approx(box.center + np.array([1.0, 2.0, 3.0]))
    assert (shifted.axes == box.axes).all() and (shifted.half == box.half).all()


def test_gaps_are_what_boxes_grow_by_to_meet() -> None:
    turned = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1.0]])
    a = stacked([one((0, 0, 0), (1, 1, 1))] * 3)
    b = stacked([one((5, 0, 0), (1, 2, 3)), one((1, 1, 1), (1, 1, 1)), one((4, 0, 0), (2**0.5, 1, 1), turned)])
    found = gaps(a, b)
    assert found[:2] == pytest.approx([3, 0])
    assert overlaps(grown(a, found[2] / 2 + MARGIN), grown(b, found[2] / 2 + MARGIN))[2]
    assert not overlaps(grown(a, found[2] / 2 - MARGIN), grown(b, found[2] / 2 - MARGIN))[2]
