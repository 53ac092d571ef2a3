"""Parts that mirror each other, treated alike."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.symmetry import is_less, mirrored
from foldfab.recipe.model import Part


@pytest.fixture
def crossing(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """Two walls so near that their panels would meet: one has to shrink, or both."""
    return (
        board_at("ground", 0, 200),
        board_at("ceiling", 100, 200),
        wall_at("left", -30, 0, 100),
        wall_at("right", 30, 0, 100),
    )


def test_no_twins_unless_asked_for(problem: Callable[..., Problem], crossing: tuple[Part, ...]) -> None:
    assert problem(crossing).twins == {}


def test_twins_mirror_each_other(problem: Callable[..., Problem], crossing: tuple[Part, ...]) -> None:
    found = problem(crossing, symmetry=True).twins
    assert {p: t.patch for p, t in found.items()} == {"left": "right", "right": "left"}


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
@pytest.mark.parametrize("slanting", [True, False])
def test_twins_are_treated_alike(
    solution: Callable[..., FoldSolution], crossing: tuple[Part, ...], ordering: str, slanting: bool
) -> None:
    free = solution(crossing, slanting=slanting, ordering=ordering)
    made = solution(crossing, slanting=slanting, ordering=ordering, symmetry=True)
    left, right = made.modification("left"), made.modification("right")
    assert (left.mechanism, left.hinges) == (right.mechanism, right.hinges)
    kept = {round(m.window[1] - m.window[0], 9) for m in (left, right)}
    assert len(kept) == 1
    assert made.cost >= free.cost - 1e-9


def test_a_window_is_mirrored() -> None:
    assert mirrored(("in-place", 1, (0, 2)), 5, is_reversed=True) == ("in-place", 1, (3, 5))
    assert mirrored(("in-place", 1, (0, 2)), 5, is_reversed=False) == ("in-place", 1, (0, 2))
    assert mirrored(("deleted", 0, (0, 0)), 5, is_reversed=True) == ("deleted", 0, (0, 0))


def test_less_of_the_same() -> None:
    assert is_less(("in-place", 1, (1, 3)), ("in-place", 1, (0, 5)))
    assert is_less(("deleted", 0, (0, 0)), ("in-place", 1, (0, 5)))
    assert not is_less(("in-place", 3, (1, 3)), ("in-place", 1, (0, 5)))
    assert not is_less(("in-place", 1, (0, 4)), ("in-place", 1, (1, 5)))
