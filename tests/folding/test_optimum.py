"""The optimum in one shot: never dearer than greedy, equal to brute force where that can be had."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.improve import weight
from foldfab.folding.model import FoldSolution
from foldfab.folding.ordering import floors, greedy
from foldfab.folding.problem import Problem
from foldfab.folding.scene import open_scene
from foldfab.folding.solve import _ordered
from foldfab.recipe.model import Part
from foldfab.validity.verify import violations

from .brute import NO_MORE, cheaper

Make = Callable[..., Problem]
BOTH = ("box_with_table", "shelf", "three_walls", "tower", "deep_box", "chair", "table", "passage", "two_ways")


@pytest.mark.parametrize("name", BOTH)
@pytest.mark.parametrize("slanting", [True, False])
def test_it_is_never_dearer_than_greedy(solution: Callable[..., FoldSolution], name: str, slanting: bool) -> None:
    best, first = (solution(name, slanting=slanting, ordering=how) for how in ("optimal", "greedy"))
    assert best.cost <= first.cost + 1e-9
    assert best.lower_bound <= best.cost + 1e-9 and first.lower_bound <= best.cost + 1e-9
    assert not [v for v in violations(best) if v.model != "without thickness"]


@pytest.mark.parametrize("name", ["box_with_table", "h_scaffold", "two_ways", "deep_box", "table"])
@pytest.mark.parametrize("slanting", [True, False])
def test_it_equals_brute_force(problem: Make, name: str, slanting: bool) -> None:
    made = problem(name, slanting=slanting, shrink_steps=2, max_hinges=1, ordering="optimal", time_limit=60.0)
    found, bound = _ordered(made)
    assert bound == pytest.approx(weight(found), abs=NO_MORE), "not proven"
    assert cheaper(made, weight(found) - 2 * NO_MORE)[0] is None
    least, _ = cheaper(made, weight(found) + 2 * NO_MORE)
    assert least == pytest.approx(weight(found), abs=NO_MORE)


def test_it_finds_what_greedy_misses(problem: Make, crowded: tuple[Part, ...]) -> None:
    first, best = (problem(crowded, ordering=how, time_limit=30.0) for how in ("greedy", "optimal"))
    greedily = weight(greedy(first, open_scene(first), floors(first)))
    found, bound = _ordered(best)
    assert bound <= weight(found) + NO_MORE
    assert weight(found) <= greedily + NO_MORE


def test_a_little_work_gives_a_fold_with_its_bound(solution: Callable[..., FoldSolution]) -> None:
    made = solution("box_with_table", slanting=False, ordering="optimal", time_limit=1e-6)
    assert made.lower_bound <= made.cost
    assert not [v for v in violations(made) if v.model != "without thickness"]


def test_the_same_furniture_gets_the_same_answer(problem: Make, crowded: tuple[Part, ...]) -> None:
    told = []
    for _ in range(2):
        found, bound = _ordered(problem(crowded, ordering="optimal", time_limit=0.2))
        told.append(([(f.unit.name, f.chosen) for f in found.folds], bound))
    assert told[0] == told[1]


def test_it_keeps_to_the_bounding_box(problem: Make, crowded: tuple[Part, ...]) -> None:
    made = problem(crowded, ordering="optimal", stay_in_box=True, time_limit=5.0)
    low, high = made.outline
    skin = made.thickness.panel
    found, _ = _ordered(made)
    for fold in found.folds:
        for chain in fold.chains:
            if chain.far is None:
                tip = chain.root + np.sign(chain.turn) * chain.lengths[0] * chain.across
                assert (tip > low - skin).all() and (tip < high + skin).all()


@pytest.fixture
def crowded(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """A floor with two flaps that may fall either way, and a box around them."""
    return (
        board_at("ground", 0, 300), wall_at("left", -140, 0, 100), wall_at("right", 140, 0, 100),
        board_at("ceiling", 100, 300), wall_at("flap-a", -40, 0, 60), wall_at("flap-b", 40, 0, 60),
    )  # fmt: skip
