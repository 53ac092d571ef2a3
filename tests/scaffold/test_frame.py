"""The canonical frame is the furniture's own, however it stands in its file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import foldfab
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.frame import canonical

DOWN = np.array([0.0, 0.0, -1.0])
WAYS = {"-z": DOWN, "+z": -DOWN, "-x": np.array([-1.0, 0, 0]), "+y": np.array([0, 1.0, 0])}
Box = Callable[..., Part]
Make = Callable[..., Recipe]

NAMES = ("bench", "box-table", "chair-across", "desk-shelf", "hexagon-shelf", "room")


def turned(recipe: Recipe, rotation: Array, factor: float = 1.0) -> Recipe:
    """The furniture as it stands in another frame, its parts' axes told in another order and the other way."""
    parts = tuple(
        Part(p.name, factor * (rotation @ p.center), factor * p.size[::-1], -(p.axes @ rotation.T)[::-1])
        for p in recipe.parts
    )
    return replace(recipe, parts=parts)


def places(recipe: Recipe, direction: Array) -> Array:
    """(n, 3) where the parts are in the canonical frame, about their mean."""
    found = (
        np.array([part.center for part in sorted(recipe.parts, key=lambda p: p.name)]) @ canonical(recipe, direction).T
    )
    return found - found.mean(0)


def some_rotation(seed: int) -> Array:
    matrix = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    return matrix * np.sign(np.linalg.det(matrix))


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", NAMES)
def test_it_is_a_right_handed_quarter_turn_with_d_down(name: str, way: str) -> None:
    found = canonical(foldfab.load(name), WAYS[way])
    assert np.array_equal(np.abs(found).sum(0), np.ones(3)) and np.array_equal(np.abs(found).max(1), np.ones(3))
    assert np.linalg.det(found) == 1.0
    assert np.array_equal(found @ WAYS[way], DOWN)


@given(name=st.sampled_from(NAMES), way=st.sampled_from(sorted(WAYS)), seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_a_copy_that_stands_otherwise_stands_the_same_in_it(name: str, way: str, seed: int) -> None:
    recipe, rotation = foldfab.load(name), some_rotation(seed)
    still, askew = places(recipe, WAYS[way]), places(turned(recipe, rotation, 2.54), rotation @ WAYS[way]) / 2.54
    assert np.abs(still - askew).max() < 1e-6


def test_furniture_is_longest_along_x(box: Box, recipe: Make) -> None:
    board, wall = box("board", (0, 0, 0), (300, 900, 18)), box("wall", (140, 0, 100), (18, 900, 200))
    made = recipe((board, wall))
    assert np.abs(canonical(made, DOWN) @ [0, 1, 0]) == pytest.approx([1, 0, 0])


def test_the_first_part_off_the_middle_is_at_the_back(box: Box, recipe: Make) -> None:
    seat = box("seat", (0, 0, 0), (900, 300, 18))
    for side in (1, -1):
        made = recipe((seat, box("back", (0, 141 * side, 109), (900, 18, 200))))
        assert (canonical(made, DOWN) @ [0, 141 * side, 109])[1] == pytest.approx(141)


def test_parts_that_all_lie_askew_to_each_other_have_a_frame(box: Box, recipe: Make) -> None:
    """Nothing faces sideways, so there is no line to go by."""
    tilt = np.array([[1, -1, 0], [1, 1, -2], [1, 1, 1]]) / np.sqrt(np.array([[2.0], [6], [3]]))
    turn = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    found = canonical(recipe((box("a", (0, 0, 0), (50, 60, 700), turn @ tilt @ turn),)), DOWN)
    assert found @ found.T == pytest.approx(np.eye(3))
