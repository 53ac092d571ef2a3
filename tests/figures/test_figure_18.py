"""Figure 18: the bench, the tower and the desk with a shelf on top."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.kinematics import configuration, size_at
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

from .builder import ACROSS, changes, kept, sheet, shrunk

Fold = Callable[..., FoldSolution]
DEPTH = (0.0, 300.0)
POSTS = tuple(f"post-{i}" for i in range(4))
SPREAD, FACING = (0.0, 100.0, 200.0, 300.0), (0.0, 50.0, 400.0, 450.0)
"""Where the posts stand: one after another, or two and two that can only fold towards each other."""
BENCH = (
    sheet("left", 0, (0, 300), (0, 730)), sheet("right", 400, (0, 300), (0, 730)),
    sheet("seat", (0, 400), (0, 280), 300), sheet("back", (0, 400), 300, (330, 730)),
)  # fmt: skip
BARS = sheet("bars", (0, 400), (0, 300), 260)


def tower(places: tuple[float, ...] = SPREAD, ground: float = 600) -> tuple[Part, ...]:
    """A shelf on two legs, with room beside it, and a top shelf on four panels that are 300 mm high.

    Folded, 150 mm, a panel reaches over its neighbour's place, even where it has three hinges.
    """
    legs = (sheet("leg-1", 20, DEPTH, (0, 150)), sheet("leg-2", 430, DEPTH, (0, 150)))
    boards = (
        sheet("ground", (0, ground), DEPTH, 0), sheet("shelf", (0, 450), DEPTH, 150), sheet("top", (0, 450), DEPTH, 450)
    )  # fmt: skip
    return (*boards, *legs, *(sheet(n, x, DEPTH, (150, 450)) for n, x in zip(POSTS, places, strict=True)))


def sideways(solution: FoldSolution) -> float:
    """How much further than the open furniture the fold reaches in any horizontal direction, mm."""
    sizes = np.array([size_at(solution, t, np.eye(3)) for t in np.linspace(0, 1, 41)])
    return float((sizes - sizes[0])[:, :2].max())


def footprint(solution: FoldSolution) -> float:
    """Area under the folded furniture, mm²."""
    return float(np.prod(size_at(solution, 1.0, np.eye(3))[:2]))


def mechanisms(solution: FoldSolution, *names: str) -> set[str]:
    return {changes(solution)[name].mechanism for name in names}


def fall(solution: FoldSolution, patch: str) -> float:
    """How far the middle of a patch, where it is split, goes down as the furniture stands, as a share of its length."""
    chain, scaffold = solution.chain(patch), solution.scaffold
    middle = np.append(scaffold.patch(patch).center, 1.0)
    moved = [configuration(solution, np.array([1.0]))[b][0] for b in (chain.panels[0], chain.anchor)]
    off = scaffold.rotation.T @ ((moved[0] - moved[1]) @ middle)[:3]
    return float(-off[2] / scaffold.patch(patch).length)


def test_figure_18_the_bench_folds_its_seat_downward_and_nothing_is_shrunk(fold: Fold) -> None:
    made = fold(*BENCH, along=ACROSS)
    assert shrunk(made) == set() and {m.hinges for m in made.modifications} == {1}
    assert fall(made, "seat") == pytest.approx(0.5, abs=0.05)


def test_figure_18_with_bars_below_the_seat_folds_upward_and_the_back_is_shrunk(fold: Fold) -> None:
    """The chair of figure 1, to which the figure compares the bench."""
    made = fold(*BENCH, BARS, along=ACROSS)
    assert shrunk(made) == {"back"}
    assert fall(made, "seat") == pytest.approx(-0.5, abs=0.05)


def test_figure_18_so_does_the_bench_that_is_shipped(shipped: Callable[..., FoldSolution]) -> None:
    made = shipped("bench-down")
    assert shrunk(made) == set()
    assert 0.3 < fall(made, "seat") < 0.6


def test_figure_18_in_its_bounding_box_the_tower_slants_below_and_folds_in_place_above(fold: Fold) -> None:
    made = fold(*tower(), stay_in_box=True)
    assert mechanisms(made, *POSTS) == {"in-place"}
    assert mechanisms(made, "leg-1", "leg-2") == {"slanted"}
    # Knuckles stand a little out of the plates.
    assert sideways(made) < 2


def test_figure_18_without_slanting_the_top_panels_of_the_tower_shrink_to_about_half(fold: Fold) -> None:
    """Two and two share the depth of the shelf."""
    assert_halved(fold(*tower(FACING, ground=450), slanting=False))


def test_figure_18_without_slanting_panels_in_a_row_are_halved_and_fold_left_to_right(fold: Fold) -> None:
    assert_halved(fold(*tower(SPREAD), slanting=False))


def assert_halved(solution: FoldSolution) -> None:
    """All four top panels keep about half of their width and have one hinge."""
    made = [changes(solution)[post] for post in POSTS]
    assert {m.hinges for m in made} == {1}
    assert all(0.4 <= kept(m) <= 0.6 for m in made)


def test_figure_18_slanting_the_shelves_of_the_desk_leaves_the_outline_of_the_input(
    shipped: Callable[..., FoldSolution],
) -> None:
    slanted, in_place = shipped("desk-shelf"), shipped("desk-shelf", slanting=False)
    uprights = [m.patch for m in slanted.modifications if m.patch.startswith("upright")]
    assert mechanisms(slanted, *uprights) == {"slanted"} and slanted.cost == 0.0
    assert sideways(slanted) > 10
    assert mechanisms(in_place, *uprights) == {"in-place"} and sideways(in_place) < 5
    # Of the footprint alone: with thickness a stack of two panels is higher than one of one.
    assert footprint(in_place) < footprint(slanted)


def test_figure_18_the_bottom_of_the_desk_slants_even_without_slanting(shipped: Callable[..., FoldSolution]) -> None:
    """Its legs are T-scaffolds."""
    made = shipped("desk-shelf", slanting=False)
    assert mechanisms(made, "leg-left", "leg-right") == {"slanted"}
    assert {c.far for c in made.chains if c.patch.startswith("leg")} == {None}
