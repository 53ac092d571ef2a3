"""Whatever boards and walls are stacked up: a valid fold or a FoldfabError, never anything else."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.errors import FoldfabError
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

Make = Callable[..., FoldSolution]
Box = Callable[..., Part]
Wall = tuple[str, int, int, int, int]
"""Kind, the gap between boards where it stands, its x and y on a grid of 20 mm, its depth."""

Stack = Callable[[list[int], list[Wall]], tuple[Part, ...]]

walls = st.tuples(
    st.sampled_from(["across", "along", "leaning", "flap", "hanging"]),
    st.integers(0, 2), st.integers(-4, 4), st.integers(-1, 1), st.sampled_from([20, 36, 60]),
)  # fmt: skip
gaps = st.lists(st.sampled_from([40, 56, 72, 96]), min_size=1, max_size=3)
steady = settings(deadline=None, derandomize=True, max_examples=25)


@pytest.fixture(scope="module")
def stack(board_at: Box, wall_at: Box, leaning_at: Box, box: Box) -> Stack:
    """Makes boards one over another, a wall in every gap, and more walls of all kinds between them."""

    def piece(name: str, wall: Wall, low: int, high: int) -> Part:
        kind, _, column, row, depth = wall
        x, y, clear = 20.0 * column, 20.0 * row, high - low - 4.0
        if kind == "leaning":
            return leaning_at(name, x, x + 16, low, high, depth)
        length = clear if kind in ("across", "along") else 0.6 * clear
        middle = high - 2 - length / 2 if kind == "hanging" else low + 2 + length / 2
        return box(name, (x, y, middle), (depth, 4, length) if kind == "along" else (4, depth, length))

    def make(gaps: list[int], walls: list[Wall]) -> tuple[Part, ...]:
        heights = [sum(gaps[:i]) for i in range(len(gaps) + 1)]
        boards = [board_at(f"board-{i}", height, 200, 120) for i, height in enumerate(heights)]
        held = [wall_at(f"held-{i}", -90, low, high) for i, (low, high) in enumerate(pairwise(heights))]
        floors = [wall[1] % len(gaps) for wall in walls]
        more = [piece(f"wall-{i}", w, *heights[f : f + 2]) for i, (w, f) in enumerate(zip(walls, floors, strict=True))]
        return (*boards, *held, *more)

    return make


def test_a_stack_with_a_wall_a_flap_and_a_hanging_board_folds(
    solution: Make, stack: Stack, assert_folds: Callable[[FoldSolution], None]
) -> None:
    """So that the properties below are not all about errors."""
    walls = [("across", 0, 2, 0, 36), ("flap", 1, 0, 0, 36), ("hanging", 0, -1, 1, 20)]
    assert_folds(solution(stack([72, 56], walls)))


@given(gaps, st.lists(walls, max_size=4), st.booleans(), st.booleans())
@steady
def test_a_stack_of_boards_and_walls_folds_or_says_why_not(
    solution: Make, stack: Stack, assert_folds: Callable[[FoldSolution], None], gaps: list[int], walls: list[Wall],
    slanting: bool, stay_in_box: bool,
) -> None:  # fmt: skip
    with suppress(FoldfabError):
        assert_folds(solution(stack(gaps, walls), slanting=slanting, stay_in_box=stay_in_box))


@given(gaps, st.lists(walls, max_size=3), st.sampled_from([0.0, 0.25, 0.75, 1.0]), st.integers(1, 6), st.integers(1, 5))
@steady
def test_no_option_of_the_fold_breaks_it(
    solution: Make, stack: Stack, assert_folds: Callable[[FoldSolution], None], gaps: list[int], walls: list[Wall],
    alpha: float, shrink_steps: int, max_hinges: int,
) -> None:  # fmt: skip
    with suppress(FoldfabError):
        assert_folds(solution(stack(gaps, walls), alpha=alpha, shrink_steps=shrink_steps, max_hinges=max_hinges))


@given(gaps, st.lists(walls, max_size=3), st.floats(2.0, 12.0), st.floats(0.15, 0.6))
@steady
def test_nor_does_any_thickness_or_clearance(
    solution: Make, stack: Stack, assert_folds: Callable[[FoldSolution], None], gaps: list[int], walls: list[Wall],
    thickness: float, clearance: float,
) -> None:  # fmt: skip
    with suppress(FoldfabError):
        assert_folds(solution(stack(gaps, walls), thickness=thickness, clearance=clearance))


@given(gaps, st.lists(walls, min_size=1, max_size=4))
@steady
def test_no_bound_is_above_what_the_mirrored_furniture_costs(
    solution: Make, stack: Stack, gaps: list[int], walls: list[Wall]
) -> None:
    parts = stack(gaps, walls)
    mirror = np.array([-1.0, 1.0, 1.0])
    with suppress(FoldfabError):
        one = solution(parts)
        other = solution(
            tuple(replace(p, center=p.center * mirror, axes=p.axes * mirror * [[-1], [1], [1]]) for p in parts)
        )
        assert max(one.lower_bound, other.lower_bound) <= min(one.cost, other.cost) + 1e-6
