"""Conflicts by folding regions, the paper's own test, and by sweeps.

A region is the plan of a folded patch, at whatever height; so the conflict graph of regions forbids what is at the same
place at the same time but never at the same height. Whatever the graph says, every choice is played through.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.conflict import compare
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.recipe.model import Part
from foldfab.validity.verify import violations

from .every import whole

Solve = Callable[..., FoldSolution]
Make = Callable[..., Problem]
NAMES = ("three_walls", "box_with_table", "shelf", "deep_box", "chair", "corner", "two_lean", "passage", "beside")


@pytest.fixture(scope="module")
def storeys(board_at: Callable[..., Part], box: Callable[..., Part]) -> tuple[Part, ...]:
    """Three short storeys and a tall wall that folds below the upper one, while that folds above it."""

    def upright(name: str, x: float, low: float, high: float, y: float) -> Part:
        return box(name, (x, y, (low + high) / 2), (4, 48, high - low - 4))

    return (
        board_at("low", 0, 127, 120, 38.5), board_at("first", 80, 19, 120, -15.5),
        board_at("second", 140, 19, 120, -15.5), board_at("high", 200, 127, 120, 38.5),
        upright("a", -15, 0, 80, 34), upright("b", -15, 80, 140, 34),
        upright("over", -15, 140, 200, -34), upright("beside", 92, 0, 200, -34),
    )  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("slanting", [True, False])
def test_regions_are_never_cheaper_where_all_that_meets_is_seen_by_both(
    solution: Solve, name: str, slanting: bool
) -> None:
    by_regions = solution(name, slanting=slanting, collisions="regions")
    assert by_regions.cost >= solution(name, slanting=slanting).cost - 1e-9
    assert violations(by_regions) == ()


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
def test_sweeps_allow_what_is_never_there_together(
    solution: Solve, storeys: tuple[Part, ...], assert_folds: Callable[[FoldSolution], None], ordering: str
) -> None:
    """The elbow of the tall wall reaches under the wall of the upper storey, which folds at the same time."""
    options = {"slanting": False, "max_hinges": 1, "ordering": ordering}
    swept, regions = (solution(storeys, collisions=how, **options) for how in ("swept", "regions"))
    assert swept.cost == pytest.approx(0.5) and all(m.window == (0.0, 1.0) for m in swept.modifications)
    assert regions.cost > swept.cost + 0.01
    assert {m.patch for m in regions.modifications if m.window != (0.0, 1.0)} == {"beside", "over"}
    for made in (swept, regions):
        assert_folds(made)
        assert violations(made) == ()


def test_pieces_in_conflict_are_those_whose_regions_overlap_while_both_fold(
    problem: Make, storeys: tuple[Part, ...]
) -> None:
    """`a` and `b` are one above the other and fold one after the other; `over` and `beside` fold together."""
    made = problem(storeys, slanting=False, max_hinges=1, collisions="regions")
    (unit,) = made.units
    own = whole(made, unit)
    compare(made, own, own.lanes)
    met = {frozenset((own.lanes[a].patch, own.lanes[b].patch)) for a, b in own.pieces}
    assert met == {frozenset(("beside", "over"))}
    for a, b in own.pieces:
        first, second = own.lanes[a].active, own.lanes[b].active
        assert max(first.start, second.start) < min(first.stop, second.stop)
