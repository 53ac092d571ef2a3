"""Figure 17: what the parameters α and N_s do."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import ACROSS, changes, kept, sheet, shrunk

Fold = Callable[..., FoldSolution]
CHAIR = (
    sheet("left", 0, (0, 300), (0, 730)), sheet("right", 400, (0, 300), (0, 730)),
    sheet("seat", (0, 400), (0, 280), 300), sheet("back", (0, 400), 300, (330, 730)),
    sheet("apron", (0, 400), (0, 300), 260),
)  # fmt: skip
"""As in figure 1, top row: the apron keeps the seat from folding down, so that it folds up to where the back is."""


def box(width: float, depth: float) -> tuple[Part, ...]:
    """The walls of a box, 300 mm high, which have to make room for one another."""
    x, y, z = (0, width), (0, depth), (0, 300)
    return (
        sheet("ground", x, y, 0), sheet("ceiling", x, y, 300),
        sheet("left", 0, y, z), sheet("right", width, y, z), sheet("back", x, depth, z),
    )  # fmt: skip


def price(solution: FoldSolution, alpha: float) -> float:
    """What the modifications of a solution cost by equations 1 and 3 at another α."""
    terms = [(m.importance, m.hinges / 3, (1 - kept(m)) ** 2) for m in solution.modifications]
    return sum(share * (alpha * split + (1 - alpha) * lost) for share, split, lost in terms)


def test_figure_17a_where_splits_are_penalised_less_there_are_more_and_the_back_shrinks_less(fold: Fold) -> None:
    """An H-scaffold folds in place with one hinge or three, so that the seat takes two more at once."""
    mild, strict = (fold(*CHAIR, along=ACROSS, alpha=alpha) for alpha in (0.25, 0.75))
    assert sum(m.hinges for m in mild.modifications) > sum(m.hinges for m in strict.modifications)
    assert kept(changes(strict)["back"]) < kept(changes(mild)["back"]) < 1
    assert shrunk(mild) == shrunk(strict) == {"back"}


def test_figure_17a_each_chair_is_the_cheaper_one_at_its_own_preference(fold: Fold) -> None:
    mild, strict = (fold(*CHAIR, along=ACROSS, alpha=alpha) for alpha in (0.25, 0.75))
    assert mild.cost == pytest.approx(price(mild, 0.25)) and mild.cost < price(strict, 0.25) - 0.01
    assert strict.cost == pytest.approx(price(strict, 0.75)) and strict.cost < price(mild, 0.75) - 0.01


@pytest.mark.parametrize("size", [(500, 400), (600, 400), (700, 400)])
def test_figure_17b_finer_pieces_allow_a_cheaper_solution(fold: Fold, size: tuple[float, float]) -> None:
    coarse, fine = (fold(*box(*size), slanting=False, shrink_steps=steps) for steps in (3, 5))
    assert fine.cost < coarse.cost - 0.01
    lost = [sum(m.importance * (1 - kept(m)) for m in made.modifications) for made in (fine, coarse)]
    assert lost[0] < lost[1], "and less of the furniture is cut away"
