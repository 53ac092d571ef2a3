"""Units fold one after another, in an order that leaves each of them room (section 5.5)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
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
