"""Figure 8: a room with a table in it. The table folds first, as a unit of its own, and the walls need fewer hinges."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.model import FoldSolution
from foldfab.folding.units import Unit, decompose, merged
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

from .builder import changes, sheet

Fold = Callable[..., FoldSolution]


def room(width: float = 600) -> tuple[Part, ...]:
    """Half of a wall, 200 mm, reaches over the table, a quarter of it does not."""
    depth, middle = (0, 300), width / 2
    return (
        sheet("ground", (0, width), depth, 0), sheet("ceiling", (0, width), depth, 400),
        sheet("left", 0, depth, (0, 400)), sheet("right", width, depth, (0, 400)),
        sheet("top", (middle - 120, middle + 120), (50, 250), 150),
        sheet("leg-left", middle - 100, (50, 250), (0, 150)), sheet("leg-right", middle + 100, (50, 250), (0, 150)),
    )  # fmt: skip


PROP = sheet("prop", 300, (140, 160), (150, 400))
"""A stick from the table to the ceiling closes a cycle through both, so that the room is one unit."""


def wall_hinges(solution: FoldSolution) -> int:
    return sum(changes(solution)[wall].hinges for wall in ("left", "right"))


def test_figure_08b_the_table_folds_first_and_the_walls_need_one_hinge_each(fold: Fold) -> None:
    made = fold(*room(), slanting=False)
    assert [step.patches for step in made.steps] == [("leg-left", "leg-right"), ("left", "right")]
    assert wall_hinges(made) == 2


def test_figure_08a_in_one_unit_with_the_table_the_walls_need_more_hinges(fold: Fold) -> None:
    """The ceiling comes down on the table before the table moves."""
    made = fold(*room(), PROP, slanting=False)
    assert len(made.steps) == 1
    assert wall_hinges(made) > wall_hinges(fold(*room(), slanting=False))


def test_figure_08a_but_not_where_the_table_is_out_of_their_way(fold: Fold) -> None:
    wide = (*room(660), sheet("prop", 330, (140, 160), (150, 400)))
    assert wall_hinges(fold(*wide, slanting=False)) == 2


def test_figure_08a_all_units_merged_fold_with_more_hinges(fold: Fold, monkeypatch: pytest.MonkeyPatch) -> None:
    """The fallback of section 5.5, that a folding solution of one merged unit always exists."""

    def in_one(scaffold: Scaffold) -> tuple[Unit, ...]:
        return (merged(scaffold, decompose(scaffold)),)

    apart = fold(*room(), slanting=False)
    monkeypatch.setattr("foldfab.folding.solve.decompose", in_one)
    made = fold(*room(), slanting=False)
    assert len(made.steps) == 1 and wall_hinges(made) > wall_hinges(apart) and made.cost > apart.cost


@pytest.mark.parametrize(
    "width",
    [
        600,
        500,
    ],
)
def test_figure_08_leave_to_slant_never_makes_the_room_dearer(fold: Fold, width: float) -> None:
    """Whatever folds in place still does where slanting is allowed (section 5.3: an option)."""
    assert fold(*room(width)).cost <= fold(*room(width), slanting=False).cost + 1e-9


def test_figure_08_nor_the_box_with_a_table_that_is_shipped(shipped: Callable[..., FoldSolution]) -> None:
    assert shipped("box-table").cost <= shipped("box-table", slanting=False).cost + 1e-9
