"""Units folded from the lowest up, each at its least, where that is found at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.folding import bottom_up as room
from foldfab.folding.bottom_up import bottom_up
from foldfab.folding.improve import weight
from foldfab.folding.model import FoldSolution
from foldfab.folding.ordering import floors, greedy
from foldfab.folding.problem import Problem
from foldfab.folding.realise import Clash
from foldfab.folding.scene import open_scene
from foldfab.folding.unit_fold import Choice
from foldfab.recipe.model import Part, Pattern
from foldfab.validity.verify import violations

Make = Callable[..., Problem]
NAMES = ["box_with_table", "shelf", "table", "chair", "deep_box", "two_ways", "same_way"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("slanting", [True, False])
def test_it_is_as_cheap_as_any_order_can_be(problem: Make, name: str, slanting: bool) -> None:
    made = problem(name, slanting=slanting)
    least = floors(made)
    found = bottom_up(made, open_scene(made), least)
    bound = sum(choice.weight for choice in least.values())
    if found is None:
        assert weight(greedy(made, open_scene(made), least)) >= bound - 1e-5
        return
    assert sorted(f.unit.name for f in found.folds) == sorted(least)
    assert weight(found) == pytest.approx(bound, abs=1e-5)


def test_the_lowest_unit_folds_first_and_what_is_in_its_way_before_it(problem: Make) -> None:
    made = problem("box_with_table")
    found = bottom_up(made, open_scene(made), floors(made))
    assert found is not None
    assert [set(f.unit.patches) for f in found.folds][-1] == {"left", "right"}


def test_its_folds_are_valid_and_those_of_the_look_ahead_cost_no_less(
    solution: Callable[..., FoldSolution], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = [solution(name, ordering="greedy") for name in NAMES]
    monkeypatch.setattr("foldfab.folding.solve.bottom_up", lambda *_: None)
    for name, own in zip(NAMES, made, strict=True):
        assert not violations(own)
        assert own.cost <= solution(name, ordering="greedy").cost + 1e-5


def test_a_flap_that_has_no_room_to_one_side_falls_to_the_other(
    problem: Make, board_at: Callable[..., Part], box: Callable[..., Part], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without asking for more than that: both ways cost nothing."""
    monkeypatch.setattr(room, "estimated", lambda *_: pytest.fail("more was asked"))
    parts = [board_at("ground", 0, 160), box("flap", (0, 0, 24), (4, 36, 44))]
    for x in (-20, 20):
        made = problem((*parts, replace(box("post", (x, 0, 17), (4, 36, 30)), hingeable=False)))
        least = floors(made)
        found = bottom_up(made, open_scene(made), least)
        assert found is not None
        flap = next(f for f in found.folds if f.unit.patches == ("flap",))
        assert flap.cost == 0.0 and len(flap.chains) == 1


def test_a_side_that_the_recipe_forbids_is_not_taken(
    problem: Make, board_at: Callable[..., Part], box: Callable[..., Part], monkeypatch: pytest.MonkeyPatch
) -> None:
    flap = replace(box("flap", (0, 0, 24), (4, 36, 44)), forbid=(Pattern(mechanism="deleted"),))
    made = problem((board_at("ground", 0, 160), flap))
    least, asked = floors(made), list[str]()
    monkeypatch.setattr(room, "has_room", lambda *_: False)
    monkeypatch.setattr(room, "estimated", lambda *given: asked.append(given[2].unit.name) or 1e3)
    assert bottom_up(made, open_scene(made), least) is None and asked == [made.units[0].name]


def test_it_tells_nothing_where_a_unit_costs_more_than_at_least(problem: Make) -> None:
    made = problem("box_with_table")
    least = floors(made)
    name = max(least, key=lambda n: least[n].weight)
    assert bottom_up(made, open_scene(made), {**least, name: Choice(least[name].weight - 0.1, {})}) is None


def test_it_tells_nothing_where_a_fold_does_not_hold(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    made = problem("table")
    monkeypatch.setattr(room, "realised", lambda *_: Clash((("leg",),), "told"))
    assert bottom_up(made, open_scene(made), floors(made)) is None


def test_parts_that_are_treated_alike_are_left_to_the_look_ahead(problem: Make) -> None:
    made = problem("two_ways")
    least = floors(made)
    assert bottom_up(made, open_scene(made), least) is not None
    assert bottom_up(replace(made, twins={"any": None}), open_scene(made), least) is None  # type: ignore[dict-item]
