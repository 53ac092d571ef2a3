"""Units fold one after another, in an order that leaves each of them room (section 5.5)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from foldfab.folding import ordering, unit_fold
from foldfab.folding.model import FoldSolution
from foldfab.folding.ordering import after, floors, greedy, travel
from foldfab.folding.problem import Problem
from foldfab.folding.repertoire import Repertoire
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.solve import NO_MORE
from foldfab.folding.unit_fold import Choice, Refusal, UnitFold, fold_alone, fold_unit
from foldfab.folding.units import Unit
from foldfab.folding.work import PLAYING
from foldfab.recipe.model import Part

Make = Callable[..., FoldSolution]
Box = Callable[..., Part]


def order(solution: FoldSolution) -> list[tuple[str, ...]]:
    return [step.patches for step in solution.steps]


@pytest.mark.parametrize("slanting", [True, False])
def test_the_table_folds_before_the_walls_of_its_box(solution: Make, slanting: bool) -> None:
    """Figure 8 b."""
    assert order(solution("box_with_table", slanting=slanting)) == [("leg-left", "leg-right"), ("left", "right")]


def test_the_table_folds_first_whatever_the_parts_are_called(
    solution: Make, furniture: dict[str, tuple[Part, ...]], box: Box
) -> None:
    names = {"leg-left": "z-left", "leg-right": "z-right"}
    parts = tuple(box(names.get(p.name, p.name), p.center, p.size) for p in furniture["box_with_table"])
    assert order(solution(parts)) == [("z-left", "z-right"), ("left", "right")]


def test_the_table_lets_the_walls_fold_with_one_hinge_each(solution: Make) -> None:
    """Figure 8: treated as one unit they would need more."""
    made = solution("box_with_table", slanting=False)
    assert {m.hinges for m in made.modifications} == {1}
    assert all(m.window == (0.0, 1.0) for m in made.modifications)


def test_a_box_in_a_box_in_a_box_folds_from_the_inside(solution: Make, board_at: Box, wall_at: Box) -> None:
    parts = [board_at("ground", 0, 480, 120)]
    for name, width, height in (("a-outer", 440, 144), ("b-middle", 240, 104), ("c-inner", 80, 64)):
        x = width / 2 - 10
        parts += [
            board_at(name, height, width),
            wall_at(f"{name}-l", -x, 0, height),
            wall_at(f"{name}-r", x, 0, height),
        ]
    steps = order(solution(tuple(parts), slanting=False))
    assert steps == [("c-inner-l", "c-inner-r"), ("b-middle-l", "b-middle-r"), ("a-outer-l", "a-outer-r")]


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "tower", "table", "passage"])
def test_every_unit_folds_once_and_together_they_fill_the_time(solution: Make, name: str) -> None:
    made = solution(name)
    folded = sorted(patch for step in made.steps for patch in step.patches)
    assert folded == [patch.name for patch in made.scaffold.patches]
    assert sum(step.end - step.start for step in made.steps) == pytest.approx(1.0)
    assert all(step.end > step.start for step in made.steps)


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "tower"])
def test_only_bases_that_move_travel_and_the_lowest_one_never_does(solution: Make, name: str) -> None:
    made = solution(name)
    assert all(way.any() for step in made.steps for way in step.travel.values())
    assert made.scaffold.bases[0].name not in {base for step in made.steps for base in step.travel}


@pytest.mark.parametrize(
    ("name", "unit", "moving"),
    [
        ("box_with_table", "leg-left", {"top"}),
        ("box_with_table", "left", {"ceiling"}),
        ("shelf", "a", {"middle", "high"}),
        ("shelf", "c", {"high"}),
        ("tower", "a", {"middle", "high"}),
    ],
)
def test_what_another_unit_carries_moves_along_with_it(solution: Make, name: str, unit: str, moving: set[str]) -> None:
    (step,) = [step for step in solution(name).steps if step.unit == unit]
    assert set(step.travel) == moving
    first, *others = step.travel.values()
    assert all((way == first).all() for way in others)


def test_the_upper_shelf_comes_down_with_the_lower_one(solution: Make) -> None:
    made = solution("tower", slanting=False)
    (lower,) = [step for step in made.steps if step.patches == ("a",)]
    assert lower.travel["high"] == pytest.approx(lower.travel["middle"])
    assert np.abs(lower.travel["middle"][-1, 2]) > 40


def test_a_unit_that_looks_the_same_is_not_folded_twice(
    problem: Callable[..., Problem], board_at: Box, wall_at: Box, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three tables far apart: each is solved once, and no look-ahead asks for more."""
    parts = [board_at("ground", 0, 900, 120)]
    for name, x in (("a", -300.0), ("b", 0.0), ("c", 300.0)):
        parts += [
            board_at(f"{name}-top", 64, 80, 80, x=x),
            wall_at(f"{name}-l", x - 30, 0, 64),
            wall_at(f"{name}-r", x + 30, 0, 64),
        ]
    made = problem(tuple(parts))
    solved: list[str] = []
    inner = unit_fold._fold

    def count(problem: Problem, scene: Scene, own: Repertoire, *rest: Any, **options: Any) -> UnitFold | Refusal:
        solved.append(own.unit.name)
        return inner(problem, scene, own, *rest, **options)

    monkeypatch.setattr(unit_fold, "_fold", count)
    found = greedy(made, open_scene(made), floors(made))
    assert len(found.folds) == 3 and sorted(solved) == ["a-l", "b-l", "c-l"]


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "three_walls", "chair", "tower", "deep_box"])
@pytest.mark.parametrize("slanting", [True, False])
def test_no_unit_counts_less_than_its_floors(problem: Callable[..., Problem], name: str, slanting: bool) -> None:
    made = problem(name, slanting=slanting)
    scene = open_scene(made)
    low = floors(made)
    found = greedy(made, scene, low)
    assert set(low) == {fold.unit.name for fold in found.folds}
    for fold in found.folds:
        alone = fold_alone(made, scene, fold.unit)
        assert isinstance(alone, UnitFold)
        assert 0 <= low[fold.unit.name].weight <= min(alone.weight, fold.weight) + NO_MORE


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "chair", "tower"])
def test_floors_only_save_time(problem: Callable[..., Problem], name: str) -> None:
    """Without them every unit is looked at ahead, and the same order comes out."""
    orders = []
    for bound in (floors, lambda made: {u.name: Choice(-1.0, {}) for u in made.units}):
        made = problem(name, slanting=False)
        found = greedy(made, open_scene(made), bound(made))
        orders.append([(fold.unit.name, fold.chosen) for fold in found.folds])
    assert orders[0] == orders[1]


def test_where_the_work_is_spent_nothing_is_looked_at_ahead(
    problem: Callable[..., Problem], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[UnitFold] = []
    monkeypatch.setattr(ordering, "_change", lambda _, fold: (looked.append(fold), 0.0)[1])
    for is_spent in (False, True):
        looked.clear()
        made = problem("box_with_table", slanting=False)
        low = floors(made)
        if is_spent:
            made.work.charge(made.work.limit + 2 * PLAYING * len(made.sites))
        found = greedy(made, open_scene(made), low)
        assert {fold.unit.name for fold in found.folds} == {unit.name for unit in made.units}
        assert bool(looked) != is_spent


def test_after_a_fold_all_stand_where_it_took_them(problem: Callable[..., Problem]) -> None:
    made = problem("tower", slanting=False)
    scene = open_scene(made)
    lower = fold_unit(made, scene, made.unit_of["a"])
    assert isinstance(lower, UnitFold)
    now = after(made, scene, lower)
    down = lower.motion.shift["middle"][-1]
    assert not now.moved("low").any()
    assert now.moved("middle") == pytest.approx(down) and now.moved("high") == pytest.approx(down)
    ways = travel(made, lower)
    assert set(ways) == {"middle", "high"} and ways["high"] is ways["middle"]


def test_what_hangs_moves_the_other_way_round(problem: Callable[..., Problem], board_at: Box, wall_at: Box) -> None:
    """A low tray hangs from a middle board that the furniture's lowest base does not carry it by."""
    parts = (
        board_at("floor", -30, 60, 60, x=-120), wall_at("post", -120, -30, 64),
        board_at("tray", 0, 60, 60, x=60), wall_at("hanger", 60, 0, 64), board_at("middle", 64, 320),
    )  # fmt: skip
    made = problem(parts, slanting=False)
    tray = fold_unit(made, open_scene(made), made.unit_of["hanger"])
    assert isinstance(tray, UnitFold)
    # The unit's own lowest base is the tray; but it is the tray that moves, up to the middle board.
    assert tray.unit.bases[0] == "tray" and set(travel(made, tray)) == {"tray"}
    assert travel(made, tray)["tray"][-1, 2] > 40
    now = after(made, open_scene(made), tray)
    assert now.moved("tray")[2] > 40 and not now.moved("middle").any() and not now.moved("floor").any()


def test_units_that_block_each_other_fold_as_one(
    problem: Callable[..., Problem], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Section 5.5: where no unit can fold, the rest is merged and folds in place."""
    made = problem("shelf")
    inner, asked = ordering.fold_unit, list[tuple[tuple[str, ...], bool]]()

    def one_by_one(problem: Problem, scene: Scene, unit: Unit, *, in_place: bool = False) -> UnitFold | Refusal:
        asked.append((unit.patches, in_place))
        return inner(problem, scene, unit, in_place=True) if in_place else Refusal(unit, "blocked")

    monkeypatch.setattr(ordering, "fold_seen", lambda _, __, own, *___, **____: Refusal(own.unit, "blocked"))
    monkeypatch.setattr(ordering, "fold_unit", one_by_one)
    found = greedy(made, open_scene(made), floors(made))
    assert asked == [(("a", "b"), False), (("c", "d"), False), (("a", "b", "c", "d"), True)]
    (fold,) = found.folds
    assert not found.refusals and {c.mechanism for c in fold.chains} == {"in-place"}
    assert {c.patch for c in fold.chains} == {"a", "b", "c", "d"}


def test_a_single_unit_that_cannot_fold_is_not_merged_with_itself(
    problem: Callable[..., Problem], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("h_scaffold")
    refusal = Refusal(made.units[0], "blocked")
    monkeypatch.setattr(ordering, "fold_seen", lambda *_, **__: refusal)
    monkeypatch.setattr(ordering, "fold_unit", lambda *_, **__: refusal)
    found = greedy(made, open_scene(made), floors(made))
    assert found.folds == () and found.refusals == (refusal,)


def test_what_is_in_the_way_of_others_folds_first_although_it_gains_nothing_itself(
    solution: Make, board_at: Box, wall_at: Box, box: Box
) -> None:
    """Figure 14: flaps on either side of a wall, which could fold at once, but shrunk."""
    parts = (
        board_at("ground", 0, 300), board_at("ceiling", 84, 30), wall_at("a-wall", 0, 0, 84),
        box("z-left", (-26, 0, 22), (4, 16, 40)), box("z-right", (26, 0, 22), (4, 16, 40)),
    )  # fmt: skip
    made = solution(parts, slanting=False)
    assert order(made) == [("z-left",), ("z-right",), ("a-wall",)]
    assert made.modification("a-wall").window == (0.0, 1.0)


def test_of_units_that_count_the_same_the_lowest_folds_first(solution: Make, board_at: Box, wall_at: Box) -> None:
    parts = (
        board_at("ground", 0), board_at("middle", 64), board_at("top", 128),
        wall_at("a-upper", 0, 64, 128), wall_at("z-lower", 0, 0, 64),
    )  # fmt: skip
    assert order(solution(parts, ordering="greedy")) == [("z-lower",), ("a-upper",)]


def test_no_look_ahead_is_spent_on_preferences(
    problem: Callable[..., Problem], box: Box, board_at: Box, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four walls of a box, each of which would rather fold inwards before the others lie there."""
    walls = {"left": (-98, 0), "right": (98, 0), "front": (0, -98), "back": (0, 98)}
    parts = [board_at("ground", 0, 200, 200)]
    parts += [box(n, (x, y, 42), (4, 180, 80) if x else (180, 4, 80)) for n, (x, y) in walls.items()]
    made = problem(tuple(parts))
    looked: list[str] = []
    inner = ordering._change

    def count(state: Any, fold: UnitFold) -> float:
        looked.append(fold.unit.name)
        change: float = inner(state, fold)
        return change

    monkeypatch.setattr(ordering, "_change", count)
    found = greedy(made, open_scene(made), floors(made))
    hinted = [fold.weight for fold in found.folds]
    assert max(hinted) > 0 and sum(fold.cost for fold in found.folds) == 0.0
    assert looked == [fold.unit.name for fold in found.folds[:-1]]
