"""Figure 10: a patch cut into four pieces can be shrunk in ten ways, or be deleted where nothing is left loose."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.errors import FoldingError
from foldfab.folding.basic import cost, windows
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import FoldOptions

from .builder import changes, sheet

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 200.0)
GROUND, SIDE = sheet("ground", (0, 300), DEPTH, 0), sheet("side", 0, DEPTH, (0, 200))
BOX = (
    sheet("ground", (0, 600), (0, 400), 0), sheet("ceiling", (0, 600), (0, 400), 300),
    sheet("left", 0, (0, 400), (0, 300)), sheet("right", 600, (0, 400), (0, 300)),
    sheet("back", (0, 600), 400, (0, 300)),
)  # fmt: skip


def test_figure_10_four_pieces_make_ten_windows() -> None:
    found = windows(4)
    assert sorted(found) == [(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)]
    assert len(found) == 4 * (1 + 4) // 2


def test_figure_10_the_less_is_kept_the_more_it_costs_and_deletion_costs_most() -> None:
    options = FoldOptions(alpha=0.5)
    costs = [cost(0, (b - a) / 4, options) for a, b in sorted(windows(4), key=lambda w: w[0] - w[1])]
    assert costs == sorted(costs) and set(costs) == {0.0, 0.5 / 16, 0.5 / 4, 0.5 * 9 / 16}
    assert cost(0, 0.0, options) == 0.5 > max(costs)


def test_figure_10_what_is_shrunk_keeps_one_of_the_ten_windows(fold: Fold) -> None:
    """The walls of a box make room for one another; a shrunk patch keeps its mechanism."""
    made = fold(*BOX, slanting=False, stay_in_box=True, shrink_steps=4)
    kept = {m.window for m in made.modifications}
    assert kept <= {(a / 4, b / 4) for a, b in windows(4)} and kept != {(0.0, 1.0)}
    assert {m.mechanism for m in made.modifications} == {"in-place"}


def test_figure_10_a_patch_that_cannot_fold_is_deleted_where_that_leaves_the_rest_in_one_piece(fold: Fold) -> None:
    """A flap too high to swing down within the box, that must not be split."""
    flap = sheet("flap", 150, DEPTH, (0, 200), hingeable=False)
    made = fold(GROUND, SIDE, flap, stay_in_box=True)
    deleted = changes(made)["flap"]
    assert deleted.is_deleted and deleted.window == (0.0, 0.0)
    assert deleted.cost == pytest.approx(0.5 * deleted.importance)
    assert not changes(made)["side"].is_deleted


def test_figure_10_a_patch_that_holds_a_base_is_never_deleted(fold: Fold) -> None:
    wall = sheet("wall", 150, DEPTH, (0, 200), hingeable=False)
    with pytest.raises(FoldingError):
        fold(GROUND, wall, sheet("ceiling", (0, 300), DEPTH, 200), stay_in_box=True)
