"""Figure 11: when the basic scaffolds of a unit fold, and which of their in-place folds are in each other's way."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import changes, interval, sheet, shrunk, way

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 300.0)
STAIR = (
    sheet("ground", (0, 600), DEPTH, 0), sheet("low", (0, 250), DEPTH, 150), sheet("high", (0, 600), DEPTH, 450),
    sheet("under", 20, DEPTH, (0, 150)), sheet("over", 20, DEPTH, (150, 450)), sheet("beside", 580, DEPTH, (0, 450)),
)  # fmt: skip


def passage(width: float) -> tuple[Part, ...]:
    """Two walls 200 mm high, so that each reaches 100 mm into the passage between them."""
    return (
        sheet("ground", (0, width), DEPTH, 0), sheet("ceiling", (0, width), DEPTH, 200),
        sheet("left", 0, DEPTH, (0, 200)), sheet("right", width, DEPTH, (0, 200)),
    )  # fmt: skip


def test_figure_11a_higher_bases_start_before_lower_ones(fold: Fold) -> None:
    made = fold(*STAIR, slanting=False)
    high, low = (-way(made, base, 601)[:, 2] for base in ("high", "low"))
    first_high, first_low = (int(np.argmax(down > 1)) for down in (high, low))
    assert first_high < first_low
    assert high[first_low] == pytest.approx(300, abs=10), "high has come down to low before low starts"


def test_figure_11a_the_bases_of_a_scaffold_say_when_it_folds(fold: Fold) -> None:
    """From the start of its upper base until its lower one takes over, or until the end where that never moves."""
    made = fold(*STAIR, slanting=False)
    (over_0, over_1), (under_0, under_1) = interval(made, "over"), interval(made, "under")
    assert interval(made, "beside") == pytest.approx((0.0, 1.0), abs=0.02)
    assert (over_0, under_1) == pytest.approx((0.0, 1.0), abs=0.02)
    assert over_1 == pytest.approx(under_0, abs=0.02)
    assert over_1 == pytest.approx(300 / 450, abs=0.1)


def test_figure_11b_the_same_region_at_different_times_is_no_conflict(fold: Fold) -> None:
    """`under` and `over` fold one over the other, and neither is shrunk or split more than once."""
    made = fold(*STAIR, slanting=False)
    assert shrunk(made) == set() and {m.hinges for m in made.modifications} == {1}


@pytest.mark.parametrize(("width", "collides"), [(150, True), (190, True), (210, False), (300, False)])
def test_figure_11b_at_the_same_time_the_regions_must_not_overlap(fold: Fold, width: float, collides: bool) -> None:
    made = fold(*passage(width), slanting=False, stay_in_box=True)
    assert interval(made, "left") == interval(made, "right")
    assert {changes(made)[wall].side for wall in ("left", "right")} == {"l", "r"}
    assert (made.cost > 0.5 / 3 + 1e-9) == collides


def test_figure_11b_regions_beside_each_other_are_no_conflict_however_close_the_walls(fold: Fold) -> None:
    """The bottom two of the figure: walls that would collide head on, each on its own half of the depth."""
    ground, ceiling, *_ = passage(150)
    walls = sheet("left", 0, (0, 145), (0, 200)), sheet("right", 150, (155, 300), (0, 200))
    made = fold(ground, ceiling, *walls, slanting=False, stay_in_box=True)
    assert made.cost == pytest.approx(0.5 / 3)


def test_figure_11b_regions_that_share_an_edge_are_no_conflict(fold: Fold) -> None:
    """Two walls that would collide head on fold side by side when each is cut to its own half (as in figure 18)."""
    made = fold(*passage(150), slanting=False, stay_in_box=True, max_hinges=1, shrink_steps=2)
    assert {m.window for m in made.modifications} == {(0.0, 0.5), (0.5, 1.0)}
