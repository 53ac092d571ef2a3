"""Figure 21: in-place folding of shelves that are neither orthogonal nor simple."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import NEARLY, changes, leaning, sheet, way

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 250.0)
SIDE = 300.0
HALF, RISE = SIDE / 2, SIDE * np.sqrt(0.75)


def cell(name: str, x: float, z: float) -> tuple[Part, ...]:
    """A hexagon with its left lower corner at (x, z), without its floor and roof."""
    left, right = x - HALF, x + SIDE + HALF
    return (
        leaning(f"{name}-low-left", (x, z), (left, z + RISE), DEPTH),
        leaning(f"{name}-low-right", (x + SIDE, z), (right, z + RISE), DEPTH),
        leaning(f"{name}-high-left", (left, z + RISE), (x, z + 2 * RISE), DEPTH),
        leaning(f"{name}-high-right", (right, z + RISE), (x + SIDE, z + 2 * RISE), DEPTH),
    )


def hexagons() -> tuple[Part, ...]:
    """Two cells, one upon the other, with ledges at their waists."""
    waists = [
        sheet(f"ledge-{i}{side}", reach, DEPTH, (2 * i + 1) * RISE)
        for i in (0, 1)
        for side, reach in (("l", (-HALF - 60, -HALF)), ("r", (SIDE + HALF, SIDE + HALF + 60)))
    ]
    floors = [sheet(f"floor-{i}", (0, SIDE), DEPTH, 2 * i * RISE) for i in (0, 1, 2)]
    return (*floors, *waists, *cell("low", 0, 0), *cell("high", 0, 2 * RISE))


def assert_in_place(solution: FoldSolution) -> None:
    assert {m.mechanism for m in solution.modifications} == {"in-place"}
    for base in solution.scaffold.bases:
        assert np.abs(way(solution, base.name)[:, :2]).max() == 0.0


def shares(solution: FoldSolution) -> list[float]:
    """Where the hinge of each patch with one hinge is, as a share of its length from the nearer end."""
    return [float(min(c.lengths) / c.lengths.sum()) for c in solution.chains if len(c.lengths) == 2]


def test_figure_21_the_hinges_of_hexagonal_cells_are_at_a_quarter(fold: Fold) -> None:
    """Sides of length L lean by 30°: panels of (L - L/2)/2 and (L + L/2)/2 come straight down."""
    made = fold(*hexagons(), slanting=False)
    assert len(made.modifications) == 8 and {m.hinges for m in made.modifications} == {1}
    assert_in_place(made)
    assert shares(made) == pytest.approx([0.25] * 8, abs=NEARLY / SIDE)


@pytest.mark.parametrize("name", ["hexagon-shelf", "shelf-slanted"])
def test_figure_21_nor_are_the_hinges_of_shipped_shelves_that_lean_in_the_middle(
    shipped: Callable[..., FoldSolution], name: str
) -> None:
    made = shipped(name, slanting=False)
    assert_in_place(made)
    assert max(shares(made)) < 0.4


def test_figure_21_those_of_an_orthogonal_shelf_are(shipped: Callable[..., FoldSolution]) -> None:
    made = shipped("bookshelf", slanting=False)
    assert_in_place(made)
    assert shares(made) == pytest.approx([0.5] * len(made.chains))


def test_figure_21_upright_and_leaning_boards_of_one_shelf_fold_together(fold: Fold) -> None:
    """A crooked shelf: what stands upright is split in the middle, what leans is not."""
    low, high = sheet("low", (0, 900), DEPTH, 0), sheet("high", (0, 900), DEPTH, 300)
    boards = leaning("leaning", (100, 0), (250, 300), DEPTH), sheet("upright", 600, DEPTH, (0, 300))
    made = fold(low, high, *boards, slanting=False)
    assert_in_place(made)
    assert {m.hinges for m in changes(made).values()} == {1}
    leans, stands = (made.chain(name).lengths for name in ("leaning", "upright"))
    assert stands[0] == pytest.approx(stands[1]) and abs(leans[0] - leans[1]) == pytest.approx(150, abs=NEARLY)
