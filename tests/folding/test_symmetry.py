"""Parts that mirror each other, treated alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.symmetry import is_less, mirrored
from foldfab.recipe.model import Part, Pattern
from foldfab.validity.verify import violations


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


def turned(parts: tuple[Part, ...], degrees: float) -> tuple[Part, ...]:
    """Furniture turned about the vertical, and moved away."""
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    away = np.array([130.0, -70.0, 20.0])
    return tuple(replace(p, center=turn @ p.center + away, axes=p.axes @ turn.T) for p in parts)


@pytest.mark.parametrize("degrees", [0.0, 90.0, 17.3])
def test_twins_are_found_however_the_furniture_stands(
    problem: Callable[..., Problem], furniture: dict[str, tuple[Part, ...]], degrees: float
) -> None:
    found = problem(turned(furniture["three_walls"], degrees), symmetry=True).twins
    assert {p: t.patch for p, t in found.items()} == {"left": "right", "right": "left"}
    found = problem(turned(furniture["box_with_table"], degrees), symmetry=True).twins
    pairs = {("left", "right"), ("leg-left", "leg-right")}
    assert {(p, t.patch) for p, t in found.items()} == pairs | {(b, a) for a, b in pairs}


def test_what_is_off_its_mirror_image_has_no_twin(
    problem: Callable[..., Problem], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """By its place, its width or its lean; a patch is never its own twin."""
    boards = board_at("ground", 0, 200), board_at("ceiling", 100, 200)
    left, middle = wall_at("left", -30, 0, 100), wall_at("middle", 0, 0, 100)
    assert problem((*boards, left, middle), symmetry=True).twins == {}
    for other in (wall_at("right", 31, 0, 100), wall_at("right", 30, 0, 100, 58), wall_at("right", 30, 0, 100, 60, 1)):
        assert problem((*boards, left, other), symmetry=True).twins == {}


def test_the_width_of_a_twin_is_counted_from_the_end_that_mirrors(
    problem: Callable[..., Problem], furniture: dict[str, tuple[Part, ...]], crossing: tuple[Part, ...]
) -> None:
    """Mirrored in x, the front of the left wall is the front of the right one, whichever way each is counted."""
    across = tuple(
        replace(p, size=p.size[[1, 0, 2]], center=p.center * [1.5, 1, 1]) if p.name in ("left", "right") else p
        for p in crossing
    )
    told = set()
    for parts in (crossing, furniture["three_walls"], across):
        made = problem(parts, symmetry=True)
        twin, sites = made.twins["left"], made.sites
        along = sites["left"].along * [-1, 1, 1]
        assert twin.is_reversed == bool(sites["right"].along @ along < 0)
        told.add((bool(sites["right"].along @ sites["left"].along < 0), twin.is_reversed))
    assert any(a != b for a, b in told), "as if nothing were mirrored"


@pytest.fixture
def two_tables(board_at: Callable[..., Part], wall_at: Callable[..., Part]) -> tuple[Part, ...]:
    """Two units that mirror each other, and a flap beside one of them that makes it fold another way."""
    parts = [board_at("ground", 0, 300)]
    for name, x in (("a", -70), ("b", 70)):
        parts += [board_at(f"{name}-top", 64, 30, 60, x), wall_at(f"{name}-leg", x, 0, 64)]
    return (*parts, wall_at("flap", 96, 0, 44), wall_at("post", 48, 0, 44))


def world(made: FoldSolution, patch: str) -> tuple[float, float]:
    """The window of a patch along y in the world, from the middle, in shares of its width."""
    (chain,) = (c for c in made.chains if c.patch == patch)
    low, high = np.sort(chain.root[1] + chain.along[1] * chain.span)
    return round(float(low), 6), round(float(high), 6)


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
@pytest.mark.parametrize("slanting", [True, False])
def test_twins_in_two_units_are_treated_alike(
    solution: Callable[..., FoldSolution], two_tables: tuple[Part, ...], ordering: str, slanting: bool
) -> None:
    free = solution(two_tables, slanting=slanting, ordering=ordering)
    made = solution(two_tables, slanting=slanting, ordering=ordering, symmetry=True)
    first, second = made.modification("a-leg"), made.modification("b-leg")
    assert (first.mechanism, first.hinges) == (second.mechanism, second.hinges)
    assert world(made, "a-leg") == world(made, "b-leg")
    assert ordering == "greedy" or made.cost >= free.cost - 1e-9
    assert made.lower_bound <= made.cost
    assert violations(made) == ()


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
def test_mirrored_windows_keep_what_mirrors_each_other(
    solution: Callable[..., FoldSolution], furniture: dict[str, tuple[Part, ...]], ordering: str
) -> None:
    """Without symmetry only one of the side walls is cut; with it both are, at the same end, and that costs more."""
    free = solution("three_walls", ordering=ordering)
    assert world(free, "left") != world(free, "right")
    made = solution("three_walls", ordering=ordering, symmetry=True)
    assert world(made, "left") == world(made, "right")
    assert made.cost >= free.cost - 1e-9


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
def test_what_is_asked_of_one_twin_the_other_does_as_well_in_a_unit_of_its_own(
    solution: Callable[..., FoldSolution], two_tables: tuple[Part, ...], ordering: str
) -> None:
    """`b-leg` is pinned to three hinges; `a-leg`, whose unit would fold first, gets them too."""
    parts = tuple(replace(p, pin=Pattern(hinges=3)) if p.name == "b-leg" else p for p in two_tables)
    free = solution(parts, slanting=False, ordering=ordering)
    made = solution(parts, slanting=False, ordering=ordering, symmetry=True)
    assert free.modification("a-leg").hinges == 1
    assert made.modification("a-leg").hinges == made.modification("b-leg").hinges == 3
    assert made.cost > free.cost and made.lower_bound <= made.cost
