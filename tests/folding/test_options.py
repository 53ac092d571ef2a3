"""Options are priced by eq. 3, pruned by what has room, and restricted by what the recipe demands of a part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.errors import FoldingError
from foldfab.folding.basic import cost
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import FoldSolution
from foldfab.folding.options import DELETION, Alike, Options, options_of
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects, prospects, unhindered
from foldfab.folding.scene import open_scene
from foldfab.folding.solve import NO_MORE
from foldfab.folding.surroundings import look
from foldfab.recipe.model import Part, Pattern

from .every import whole

Make = Callable[..., Problem]
Parts = tuple[Part, ...]
HERE = np.zeros(3)


def room_of(made: Problem, patch: str) -> Prospects:
    return unhindered(made, whole(made, made.unit_of[patch]))


def of(made: Problem, patch: str) -> Options:
    return options_of(made, room_of(made, patch), HERE)[patch]


def possible(options: Options) -> list[int]:
    return [i for i in range(len(options.price)) if np.isfinite(options.weight[i])]


def demanding(parts: Parts, name: str, *, pin: Pattern | None = None, forbid: tuple[Pattern, ...] = ()) -> Parts:
    """The furniture with a demand on one of its parts."""
    return tuple(replace(p, pin=pin, forbid=forbid) if p.name == name else p for p in parts)


@pytest.mark.parametrize("alpha", [0.0, 0.25, 0.5, 1.0])
@pytest.mark.parametrize("name", ["h_scaffold", "t_scaffold", "three_walls"])
def test_prices_are_equation_3_weighted_by_importance(problem: Make, name: str, alpha: float) -> None:
    made = problem(name, alpha=alpha, shrink_steps=4, max_hinges=5)
    for patch in made.sites:
        options = of(made, patch)
        for i in range(len(options.price)):
            option = options[i]
            kept = (option.window[1] - option.window[0]) / 4
            hinges = option.variant.hinges if option.variant else 0
            expected = made.sites[patch].importance * cost(hinges, kept, made.options)
            assert options.price[i] == option.cost == pytest.approx(expected)


def test_every_lane_has_every_window_and_deletion_comes_last(problem: Make) -> None:
    made = problem("h_scaffold", shrink_steps=4)
    options = of(made, "leg")
    every = [options[i] for i in range(len(options.price))]
    variants = [x.variant for x in repertoire(made, made.units[0]).plain["leg"]]
    assert len(every) == 10 * len(variants) + 1 and len(set(every)) == len(every)
    assert [o.variant for o in every[::10]] == [*variants, None]
    assert every[-1].window == (0, 0)


def test_deletion_counts_many_times_its_price_in_the_search(problem: Make) -> None:
    made = problem("three_walls")
    options, share = of(made, "left"), made.sites["left"].importance
    assert options.price[-1] == pytest.approx(0.5 * share)
    assert options.weight[-1] == pytest.approx(DELETION + 0.5 * share)
    assert options.weight[-1] > options.weight[possible(options)[:-1]].max()


def test_preferences_never_outweigh_a_price(problem: Make) -> None:
    options = of(problem("h_scaffold"), "leg")
    extra = (options.weight - options.price)[possible(options)[:-1]]
    assert (extra >= 0).all() and 0 < extra.max() < NO_MORE


def test_options_of_one_price_are_told_apart_by_what_leaves_the_furniture(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """A ceiling that is dragged inwards is better than one that is dragged outwards."""
    parts = (board_at("ground", 0, 400), board_at("ceiling", 84, 60, x=-150), wall_at("leg", -150, 0, 84))
    made = problem(parts)
    options = of(made, "leg")
    (first, second) = (i for i in possible(options) if options.price[i] == 0.0)
    inward = [options.lanes[i // len(options.windows)].way[0] > 0 for i in (first, second)]
    weights = options.weight[[first, second]]
    assert sorted(inward) == [False, True] and inward[int(np.argmin(weights))]


def test_windows_that_hold_a_blocked_piece_are_out(problem: Make) -> None:
    made = problem("h_scaffold", slanting=False)
    room = room_of(made, "leg")
    first = room.lanes["leg"][0]
    blocked = {**room.blocked, first.number: np.array([True, False, False, False, True])}
    options = options_of(made, Prospects(room.lanes, blocked, {}, {}), HERE)["leg"]
    count = len(options.windows)
    allowed = {options.windows[i] for i in possible(options) if i < count}
    assert allowed == {(a, b) for a in range(1, 4) for b in range(a + 1, 5)}
    assert {options.windows[i - count] for i in possible(options) if count <= i < 2 * count} >= {(0, 5), (0, 4)}


def test_windows_too_narrow_for_a_hinge_are_out(problem: Make) -> None:
    made = problem("h_scaffold", shrink_steps=10)
    options = of(made, "leg")
    widths = {b - a for a, b in (options[i].window for i in possible(options)[:-1])}
    # 60 mm in ten pieces, half a gap lost at each cut.
    assert min(widths) == int(np.ceil((made.thickness.hinge_width + made.thickness.gap) / 6.0))


@pytest.mark.parametrize("alike", ["wider windows", "any window"])
def test_options_alike_are_of_one_lane_and_wider_or_of_any_window(problem: Make, alike: Alike) -> None:
    options = of(problem("h_scaffold", shrink_steps=3), "leg")
    for i in range(len(options.price) - 1):
        own = options[i]
        expected = [
            j
            for j in range(len(options.price) - 1)
            if (other := options[j]).variant == own.variant
            and (alike == "any window" or (other.window[0] <= own.window[0] and other.window[1] >= own.window[1]))
        ]
        assert options.like(i, alike) == expected
        assert options.like(i, "this") == [i]


def test_options_that_let_a_base_fall_alike_are_of_any_side_and_window(problem: Make) -> None:
    options = of(problem("h_scaffold", shrink_steps=2, max_hinges=3), "leg")
    last = len(options.price) - 1
    kinds = [(v.mechanism, v.hinges) for v in (options[i].variant for i in range(last)) if v is not None]
    by_hinges = {n: [i for i, kind in enumerate(kinds) if kind == ("in-place", n)] for n in (1, 3)}
    assert options.like(by_hinges[1][0], "any fall") == by_hinges[1]
    assert options.like(last, "any fall") == [last]
    # Folded, a chain of one hinge leaves 8.9 mm, and one of three 17.5 mm.
    assert options.like(by_hinges[1][0], "any fall", 80 - 8.9 - 0.1) == [*by_hinges[1], last]
    assert options.like(by_hinges[1][0], "any fall", 80 - 17.5 - 0.1) == sorted([*by_hinges[1], *by_hinges[3], last])
    # Before they fall they rise, the one with more hinges more.
    rises = {x.variant.hinges: x.snap for x in options.lanes if x.snap > 0}
    assert rises[1] < rises[3]
    assert options.like(by_hinges[3][0], "any fall", -rises[3]) == [*by_hinges[3], last]
    assert options.like(by_hinges[3][0], "any fall", -rises[1]) == sorted([*by_hinges[1], *by_hinges[3], last])


@pytest.mark.parametrize(
    ("pin", "expected"),
    [
        (Pattern(mechanism="slanted"), {("slanted", 0, "l"), ("slanted", 0, "r")}),
        (Pattern(hinges=3), {("in-place", 3, "l"), ("in-place", 3, "r")}),
        (Pattern(mechanism="in-place", hinges=1, side="l"), {("in-place", 1, "l")}),
        (Pattern(mechanism="deleted"), {None}),
    ],
)
def test_what_is_pinned_is_all_that_is_possible(
    problem: Make, furniture: dict[str, Parts], pin: Pattern, expected: set[object]
) -> None:
    options = of(problem(demanding(furniture["h_scaffold"], "leg", pin=pin)), "leg")
    found = (options[i].variant for i in possible(options))
    assert {v and (v.mechanism, v.hinges, v.side) for v in found} == expected


def test_a_pinned_window_is_kept_exactly(problem: Make, furniture: dict[str, Parts]) -> None:
    made = problem(demanding(furniture["h_scaffold"], "leg", pin=Pattern(window=(0.2, 0.8))))
    options = of(made, "leg")
    assert {options[i].window for i in possible(options)} == {(1, 4)}


def test_what_is_forbidden_is_not_possible_and_all_else_is(problem: Make, furniture: dict[str, Parts]) -> None:
    free = of(problem("h_scaffold"), "leg")
    forbid = (Pattern(mechanism="slanted"), Pattern(side="l", hinges=1), Pattern(mechanism="deleted"))
    made = of(problem(demanding(furniture["h_scaffold"], "leg", forbid=forbid)), "leg")
    gone = [made[i].variant for i in set(possible(free)) - set(possible(made))]
    assert {v and (v.mechanism, v.hinges, v.side) for v in gone} == {
        ("slanted", 0, "l"), ("slanted", 0, "r"), ("in-place", 1, "l"), None,
    }  # fmt: skip
    kept = [made[i].variant for i in possible(made)]
    assert {v and (v.mechanism, v.hinges, v.side) for v in kept} == {
        ("in-place", 1, "r"), ("in-place", 3, "l"), ("in-place", 3, "r"),
    }  # fmt: skip


def test_demands_on_one_patch_leave_the_others_alone(problem: Make, furniture: dict[str, Parts]) -> None:
    made = problem(demanding(furniture["three_walls"], "left", pin=Pattern(hinges=3)))
    free = problem("three_walls")
    for patch in ("right", "back"):
        assert possible(of(made, patch)) == possible(of(free, patch))
    assert len(possible(of(made, "left"))) < len(possible(of(free, "left")))


def test_a_solution_honours_what_is_pinned_and_what_is_forbidden(
    solution: Callable[..., FoldSolution], furniture: dict[str, Parts]
) -> None:
    parts = demanding(furniture["shelf"], "a", pin=Pattern(hinges=3))
    parts = demanding(parts, "c", forbid=(Pattern(mechanism="slanted"), Pattern(side="r")))
    made = solution(parts)
    assert made.modification("a").hinges == 3 and made.modification("b").mechanism == "in-place"
    above = made.modification("c")
    assert (above.mechanism, above.side) == ("in-place", "l")
    assert made.cost > solution("shelf").cost


def test_a_part_that_must_be_deleted_is(solution: Callable[..., FoldSolution], furniture: dict[str, Parts]) -> None:
    made = solution(demanding(furniture["three_walls"], "back", pin=Pattern(mechanism="deleted")))
    assert made.modification("back").is_deleted
    assert {c.patch for c in made.chains} == {"left", "right"}


def test_demands_that_leave_nothing_are_an_error(
    solution: Callable[..., FoldSolution], furniture: dict[str, Parts]
) -> None:
    forbid = (Pattern(mechanism="slanted"), Pattern(mechanism="in-place"), Pattern(mechanism="deleted"))
    with pytest.raises(FoldingError, match="leg"):
        solution(demanding(furniture["h_scaffold"], "leg", forbid=forbid))


def test_where_things_stand_in_the_way_options_are_fewer(problem: Make) -> None:
    made = problem("beside")
    own = repertoire(made, made.unit_of["wall"])
    room = prospects(made, own, look(made, open_scene(made), own), in_place=False)
    assert len(possible(options_of(made, room, HERE)["wall"])) < len(possible(of(made, "wall")))
