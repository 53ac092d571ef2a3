"""Figure 12: slanted folds of one unit must drag its upper base the same way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import changes, leaning, sheet, way

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 200.0)
BASES = sheet("ground", (0, 900), DEPTH, 0), sheet("ceiling", (0, 900), DEPTH, 200)


def walls(lean_1: float, lean_2: float) -> tuple[Part, ...]:
    """Two H-scaffolds far apart, whose tops stand further along the bases by their leans, mm."""
    return (
        *BASES,
        leaning("one", (100, 0), (100 + lean_1, 200), DEPTH), leaning("two", (700, 0), (700 + lean_2, 200), DEPTH),
    )  # fmt: skip


@pytest.mark.parametrize("lean", [0, 60, -60])
def test_figure_12c_walls_that_drag_the_upper_base_alike_both_slant(fold: Fold, lean: float) -> None:
    made = fold(*walls(lean, lean))
    one, two = changes(made).values()
    assert made.cost == 0.0 and {one.mechanism, two.mechanism} == {"slanted"}
    assert one.side == two.side


@pytest.mark.parametrize("leans", [(60, -60), (-60, 60), (60, 0), (60, 120)])
def test_figure_12b_walls_that_drag_the_upper_base_differently_do_not(fold: Fold, leans: tuple[float, float]) -> None:
    """To the same side or not: their tops end at different places over the base."""
    made = fold(*walls(*leans))
    assert {m.mechanism for m in made.modifications} == {"in-place"}
    assert np.abs(way(made, "ceiling")[:, :2]).max() == 0.0


def test_figure_12b_nor_do_walls_across_each_other(fold: Fold) -> None:
    made = fold(*BASES, sheet("one", 50, (0, 180), (0, 200)), sheet("two", (500, 800), 199, (0, 200)))
    assert {m.mechanism for m in made.modifications} == {"in-place"}


def test_figure_12b_two_that_must_slant_and_conflict_are_not_both_kept_as_they_are(fold: Fold) -> None:
    """Un-hingeable, so that only slanting is left: one of them has to let go of the upper base."""
    made = fold(*(replace(part, hingeable=False) for part in walls(60, -60)))
    held = [c for c in made.chains if c.far is not None]
    assert len(held) == 1 and {m.hinges for m in made.modifications} == {0}
