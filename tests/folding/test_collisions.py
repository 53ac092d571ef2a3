"""Solutions meet nothing on their way, by a check that shares no code with the solver's; and that check can fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from foldfab.folding.anatomy import moving_boxes
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import grown, overlaps

Make = Callable[..., FoldSolution]
Collisions = Callable[..., set[tuple[str, str]]]
NAMES = (
    "t_scaffold", "h_scaffold", "slanted_t", "slanted_h", "same_way", "two_ways", "two_lean", "corner", "beside",
    "roof", "passage", "three_walls", "box_with_table", "shelf", "table", "tower", "deep_box", "plain_chair", "chair",
)  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_a_solution_folds_flat_without_a_collision(
    solution: Make, assert_folds: Callable[[FoldSolution], None], name: str
) -> None:
    assert_folds(solution(name))


@pytest.mark.parametrize("name", NAMES)
def test_so_it_does_without_slanting(solution: Make, assert_folds: Callable[[FoldSolution], None], name: str) -> None:
    assert_folds(solution(name, slanting=False))


def test_the_check_notices_a_table_that_folds_too_late(solution: Make, collisions: Collisions) -> None:
    made = solution("box_with_table")
    first, second = made.steps
    late = replace(first, start=1 - first.end, end=1.0), replace(second, start=0.0, end=1 - first.end)
    assert collisions(replace(made, steps=late)) & {("base ceiling", "leg-left"), ("base top", "base ceiling")}


def test_the_check_notices_panels_that_fold_into_each_other(solution: Make, collisions: Collisions) -> None:
    """The back of the three walls, as wide as it was before it had to shrink."""
    made = solution("three_walls")
    chains = tuple(
        replace(c, span=np.array([-100.0, 100.0]), hinge_spans=np.tile([-100.0, 100.0], (len(c.lengths) + 1, 1)))
        if c.patch == "back"
        else c
        for c in made.chains
    )
    met = collisions(replace(made, chains=chains))
    assert met and all("back" in f"{a} {b}".split() for a, b in met)


def test_the_check_notices_a_base_that_comes_down_too_far(solution: Make, collisions: Collisions) -> None:
    made = solution("h_scaffold")
    (step,) = made.steps
    sunk = replace(step, travel={b: way * 1.2 for b, way in step.travel.items()})
    assert ("base ground", "base ceiling") in collisions(replace(made, steps=(sunk,)))


@pytest.mark.parametrize("name", ["slanted_h", "deep_box", "two_ways", "chair", "slanted_t"])
def test_panels_of_one_chain_never_pass_through_one_another(solution: Make, name: str) -> None:
    made = solution(name, slanting=False, alpha=0.0, max_hinges=5)
    for chain in made.chains:
        slabs = grown(moving_boxes(chain, made.thickness, np.linspace(0, 1, 60)), -0.01)
        for i, j in combinations(range(len(chain.lengths)), 2):
            assert not overlaps(slabs[:, i], slabs[:, j]).any()


@pytest.mark.parametrize(
    "name",
    [
        *("h_scaffold", "slanted_h", "deep_box", "two_ways", "three_walls", "table", "box_with_table"),
    ],
)
def test_staying_in_the_box_is_kept_to(
    solution: Make, extent: Callable[[FoldSolution, float], tuple[Array, Array]], name: str
) -> None:
    made = solution(name, stay_in_box=True)
    low, high = extent(made, 0.0)
    slack = made.thickness.panel / 2 + made.thickness.gap + 0.01
    for t in np.linspace(0, 1, 30):
        now = extent(made, float(t))
        assert (now[0] > low - slack).all() and (now[1] < high + slack).all()
