"""The conflict graph: what meets, what drags a base another way, and what snaps too differently."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.basic import windows
from foldfab.folding.conflict import compare, drag_alike, meet_across, neighbours, snap_alike, table, windows_table
from foldfab.folding.lanes import Lane, upright
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import TOUCH, Repertoire
from foldfab.geometry.arrays import Bools
from foldfab.geometry.boxes import Boxes, grown, moved, overlaps
from foldfab.recipe.model import Part

from .every import whole

Make = Callable[..., Problem]
STEPS = 3
SHORT = 1e-6
"""Pieces end this much before their cuts."""


def only(made: Problem) -> Repertoire:
    (unit,) = made.units
    return whole(made, unit)


def compared(made: Problem) -> Repertoire:
    own = only(made)
    compare(made, own, own.lanes)
    return own


def lanes_of(own: Repertoire, patch: str, mechanism: str, hinges: int) -> list[Lane]:
    return [x for x in own.plain[patch] if (x.variant.mechanism, x.variant.hinges) == (mechanism, hinges)]


def at(own: Repertoire, x: Lane, section: int, frame: int) -> Boxes:
    """The boxes (n,) of a lane at a moment: folding, still open, or folded and carried by its anchor."""
    movers, down = own.movers[x.number], own.nominal.down[x.chain.anchor]
    if section in x.active:
        return movers[section][frame]
    last, end = (x.active.start, 0) if section < x.active.start else (x.active.stop - 1, -1)
    return moved(movers[last][end], upright(down[section, frame : frame + 1] - down[last, end])[0])


def piece(boxes: Boxes, x: Lane, k: int) -> Boxes:
    """What of the boxes (n,) lies in a piece of the lane."""
    along = x.chain.along
    middle = boxes.center @ along
    low = np.maximum(middle - boxes.half[:, 1], x.cuts[k] + SHORT)
    high = np.minimum(middle + boxes.half[:, 1], x.cuts[k + 1] - SHORT)
    center = boxes.center + along * ((low + high) / 2 - middle)[:, None]
    half = np.stack([boxes.half[:, 0], (high - low) / 2, boxes.half[:, 2]], axis=1)
    return Boxes(center, boxes.axes, half)[low < high]


def pairwise_overlap(a: Boxes, b: Boxes) -> bool:
    i, j = np.indices((len(a), len(b))).reshape(2, -1)
    return bool(overlaps(a[i], b[j]).any())


def by_brute_force(made: Problem, own: Repertoire, a: Lane, b: Lane) -> Bools:
    """Which pieces of two lanes meet, by the exact test at every frame of the sections in which either folds."""
    found = np.zeros((STEPS, STEPS), dtype=bool)
    wide = made.thickness.gap / 2 - TOUCH
    for section in range(own.nominal.sections):
        if section not in a.active and section not in b.active:
            continue
        for frame in range(own.nominal.down[a.chain.anchor].shape[1]):
            one, other = (grown(at(own, x, section, frame), wide) for x in (a, b))
            if not pairwise_overlap(one, other):
                continue
            for s, t in itertools.product(range(STEPS), range(STEPS)):
                found[s, t] |= pairwise_overlap(piece(one, a, s), piece(other, b, t))
    return found


def assert_as_by_brute_force(made: Problem, own: Repertoire) -> int:
    """Compares all pieces of lanes of different patches; returns how many pairs of lanes meet."""
    count = 0
    for a, b in itertools.combinations(own.lanes, 2):
        if a.patch == b.patch:
            assert (a.number, b.number) not in own.pieces
            continue
        expected = by_brute_force(made, own, a, b)
        if not drag_alike(a, b):
            # Those never go together; that they meet is a reason, and no conflict.
            assert (a.number, b.number) not in own.pieces
            assert meet_across(made, own, [a], [b]) == ({(a.number, b.number)} if expected.any() else set())
            continue
        assert not meet_across(made, own, [a], [b])
        found = own.pieces.get((a.number, b.number), np.zeros((STEPS, STEPS), dtype=bool))
        assert found.tolist() == expected.tolist(), f"{a.patch} {a.variant} and {b.patch} {b.variant}"
        count += bool(expected.any())
    return count


@pytest.fixture
def close(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """Two walls face to face, too close to fold towards each other."""
    return (
        board_at("ground", 0), board_at("ceiling", 84), wall_at("a", -12, 0, 84), wall_at("b", 12, 0, 84, 60),
    )  # fmt: skip


@pytest.mark.parametrize("name", ["corner", "deep_box"])
def test_pieces_conflict_exactly_where_the_exact_test_says(problem: Make, name: str) -> None:
    made = problem(name, shrink_steps=STEPS)
    assert assert_as_by_brute_force(made, compared(made))


def test_so_they_do_in_units_of_several_levels(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """Lanes that stand open or lie folded while others fold are in their way as well."""
    parts = (
        board_at("low", 0), board_at("middle", 64, 60, x=-50), board_at("high", 128),
        wall_at("lower", -40, 0, 64), wall_at("upper", -40, 64, 128), wall_at("side", 0, 0, 128),
    )  # fmt: skip
    made = problem(parts, shrink_steps=STEPS, max_hinges=1)
    own = compared(made)
    assert own.nominal.sections == 2
    assert assert_as_by_brute_force(made, own)
    met = {frozenset((own.lanes[a].patch, own.lanes[b].patch)) for a, b in own.pieces}
    assert {frozenset(("lower", "side")), frozenset(("side", "upper"))} <= met


def test_it_does_not_matter_in_which_order_lanes_are_compared(
    problem: Make, levels: tuple[Part, ...], close: tuple[Part, ...]
) -> None:
    for parts in (levels, close, "corner", "deep_box"):
        at_once = compared(problem(parts, shrink_steps=STEPS))
        made = problem(parts, shrink_steps=STEPS)
        own = only(made)
        for x in (*own.lanes[::3], *own.lanes[1::3], *own.lanes):
            compare(made, own, [x])
        assert at_once.pieces and own.pieces.keys() == at_once.pieces.keys()
        assert all((own.pieces[key] == pieces).all() for key, pieces in at_once.pieces.items())
        assert own.compared == {x.number for x in own.lanes}


def test_windows_that_meet_at_a_cut_do_not_conflict(problem: Make, close: tuple[Part, ...]) -> None:
    """Walls that fold into each other have room where each keeps another part of its depth."""
    made = problem(close, shrink_steps=5, slanting=False)
    own = compared(made)
    facing = [
        (a, b)
        for a, b in itertools.product(lanes_of(own, "a", "in-place", 1), lanes_of(own, "b", "in-place", 1))
        if (a.number, b.number) in own.pieces
    ]
    assert facing
    every = windows(5)
    for a, b in facing:
        made_table = table(made, own, (a,), (b,), windows_table(every, 5))
        assert made_table is not None and not made_table[-1].any() and not made_table[:, -1].any()
        for (i, one), (j, other) in itertools.product(enumerate(every), enumerate(every)):
            # Both walls have the same depth, and so the same cuts, but hinge directions may run against each other.
            along = float(a.chain.along @ b.chain.along)
            low, high = other if along > 0 else (5 - other[1], 5 - other[0])
            is_apart = one[1] <= low or high <= one[0]
            assert made_table[i, j] == (not is_apart)


def test_a_window_holds_its_pieces() -> None:
    assert windows_table(((0, 3), (1, 2)), 3).tolist() == [[1, 1, 1], [0, 1, 0]]


@pytest.mark.parametrize("name", ["corner", "deep_box"])
def test_options_conflict_where_their_windows_hold_pieces_that_meet_or_lanes_never_agree(
    problem: Make, name: str
) -> None:
    made = problem(name, shrink_steps=STEPS)
    own, every = compared(made), windows(STEPS)
    first, second = (own.plain[p] for p in sorted(made.sites))
    found = table(made, own, first, second, windows_table(every, STEPS))
    assert found is not None
    expected = np.zeros_like(found)
    for (i, a), (j, b) in itertools.product(enumerate(first), enumerate(second)):
        low, high = sorted((a, b), key=lambda x: x.number)
        pieces = own.pieces.get((low.number, high.number), np.zeros((STEPS, STEPS), dtype=bool))
        pieces = pieces if a.number < b.number else pieces.T
        for (v, one), (w, other) in itertools.product(enumerate(every), enumerate(every)):
            meets = bool(pieces[one[0] : one[1], other[0] : other[1]].any())
            agree = drag_alike(a, b) and snap_alike(made, own, a, b)
            expected[i * len(every) + v, j * len(every) + w] = meets or not agree
    assert found.tolist() == expected.tolist()
    # The other way round it is the same.
    back = table(made, own, second, first, windows_table(every, STEPS))
    assert back is not None and back.tolist() == found.T.tolist()


def test_patches_far_apart_have_no_conflicts_when_they_fold_in_place(problem: Make) -> None:
    made = problem("box_with_table", slanting=False, max_hinges=1)
    own = whole(made, made.unit_of["left"])
    compare(made, own, own.lanes)
    assert not own.pieces and neighbours(own, own.plain) == []
    inside = windows_table(windows(5), 5)
    assert table(made, own, own.plain["left"], own.plain["right"], inside) is None


@pytest.mark.parametrize(
    ("slanting", "max_hinges", "expected"),
    [(True, 1, [("left", "right")]), (False, 5, [("left", "right")]), (False, 1, [])],
)
def test_patches_are_neighbours_that_may_drag_their_base_or_snap_differently(
    problem: Make, slanting: bool, max_hinges: int, expected: list[tuple[str, str]]
) -> None:
    """Although none of their panels ever meet."""
    made = problem("box_with_table", slanting=slanting, max_hinges=max_hinges)
    own = whole(made, made.unit_of["left"])
    compare(made, own, own.lanes)
    assert not own.pieces and neighbours(own, own.plain) == expected


def test_neighbours_are_all_pairs_whose_tables_are_not_empty(problem: Make, levels: tuple[Part, ...]) -> None:
    for made in (problem("three_walls"), problem("deep_box", slanting=False), problem(levels), problem("two_lean")):
        own = compared(made)
        inside = windows_table(windows(5), 5)
        held = {
            (a, b)
            for a, b in itertools.combinations(sorted(made.sites), 2)
            if table(made, own, own.plain[a], own.plain[b], inside) is not None
        }
        assert held and held <= set(neighbours(own, own.plain))


def test_parallel_walls_drag_their_base_alike_to_one_side_only(problem: Make) -> None:
    own = only(problem("same_way"))
    near, far = lanes_of(own, "near", "slanted", 0), lanes_of(own, "far", "slanted", 0)
    same_side = [np.sign(a.way[0]) == np.sign(b.way[0]) for a in near for b in far]
    assert [drag_alike(a, b) for a in near for b in far] == same_side
    assert any(same_side) and not all(same_side)


def test_walls_that_lean_differently_never_drag_their_base_alike(problem: Make) -> None:
    """Figure 12 b."""
    for name in ("two_ways", "two_lean", "corner"):
        made = problem(name)
        own = only(made)
        a, b = (lanes_of(own, p, "slanted", 0) for p in sorted(made.sites))
        assert a and b and not any(drag_alike(x, y) for x in a for y in b)


def test_who_slants_never_folds_beside_who_comes_straight_down(problem: Make) -> None:
    own = only(problem("same_way"))
    slanted, straight = lanes_of(own, "near", "slanted", 0), lanes_of(own, "far", "in-place", 1)
    assert not any(drag_alike(a, b) or drag_alike(b, a) for a in slanted for b in straight)
    assert all(drag_alike(a, b) for a in lanes_of(own, "near", "in-place", 1) for b in straight)


def test_lanes_of_other_bases_drag_as_they_like(problem: Make) -> None:
    made = problem("shelf")
    (below,), (above,) = ([whole(made, made.unit_of[p]).plain[p][0]] for p in ("a", "c"))
    assert below.drag is not None and drag_alike(below, replace(above, drag=None))


def test_snaps_are_alike_within_the_play_of_both(problem: Make) -> None:
    made = problem("deep_box")
    own = only(made)
    a, b = lanes_of(own, "back", "in-place", 1)[0], lanes_of(own, "side", "in-place", 1)[0]
    assert a.snap > 0 and snap_alike(made, own, a, b)
    limit = a.snap + 0.99 * (a.give + b.give)
    assert snap_alike(made, own, a, replace(b, snap=limit)) and snap_alike(made, own, replace(b, snap=limit), a)


@pytest.mark.parametrize(("height", "one", "three", "agree"), [
    (104, None, None, True),  # as they are
    (60, 6.0, None, True),  # thicker: one and three snap by what three panels of 4 mm do
    (74, None, None, True),  # in pockets
    (70, None, None, False),
    (84, 2.5, 6.0, False),
])  # fmt: skip
def test_snaps_are_alike_that_can_be_balanced(
    problem: Make, pair: Callable[..., tuple[Part, ...]], height: float, one: float | None, three: float | None,
    agree: bool,
) -> None:  # fmt: skip
    made = problem(pair(height, one, three), slanting=False)
    own = whole(made, made.unit_of["one"])
    a, b = lanes_of(own, "one", "in-place", 1)[0], lanes_of(own, "three", "in-place", 3)[0]
    assert snap_alike(made, own, a, b) == snap_alike(made, own, b, a) == agree


def test_who_does_not_come_straight_down_has_no_snap_to_share(problem: Make, levels: tuple[Part, ...]) -> None:
    made = problem("deep_box")
    own = only(made)
    slanted = lanes_of(own, "back", "slanted", 0)[0]
    assert snap_alike(made, own, slanted, replace(lanes_of(own, "side", "in-place", 1)[0], snap=50.0))
    made = problem(levels)
    many = only(made)
    lower, side = many.plain["lower"][0], many.plain["side"][0]
    assert snap_alike(made, many, lower, replace(side, snap=50.0))
