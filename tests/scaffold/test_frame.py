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
from foldfab.scaffold.frame import canonical, straight

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


def about_z(degrees: float) -> Array:
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("name", NAMES)
def test_what_stands_straight_in_its_file_stays_so_on_the_bed(name: str) -> None:
    assert np.array_equal(straight(foldfab.load(name)), np.eye(3))


@pytest.mark.parametrize(("askew", "back"), [(20.0, -20.0), (-30.0, 30.0), (70.0, 20.0), (0.01, 0.0)])
def test_what_stands_askew_is_turned_straight_the_short_way(askew: float, back: float) -> None:
    found = straight(turned(foldfab.load("bench"), about_z(askew)))
    assert found == pytest.approx(about_z(back), abs=1e-9)


def test_of_the_lines_that_sides_face_that_of_the_smallest_outline_is_taken(box: Box, recipe: Make) -> None:
    """Large legs that cross below a top, at 45 degrees to it, do not turn the top askew."""
    top = box("top", (0, 0, 700), (600, 600, 18))
    legs = tuple(box(f"leg{k}", (0, 0, 340), (18, 600, 680), about_z(45 + 90 * k).T) for k in range(2))
    assert np.array_equal(straight(recipe((top, *legs))), np.eye(3))
    assert straight(turned(recipe((top, *legs)), about_z(20))) == pytest.approx(about_z(-20), abs=1e-9)


@pytest.mark.parametrize("line", [0.0, 22.5, 45.0, 90.0, 137.0])
def test_sides_within_half_a_degree_of_a_line_face_it_together(line: float, box: Box, recipe: Make) -> None:
    """Two walls a little to either side of a line outvote a larger one that faces elsewhere."""
    walls = [box(f"near{k}", (0, 0, 100 * k), (18, 400, 400), about_z(line + 0.4 * k - 0.2).T) for k in range(2)]
    other = box("other", (0, 0, 300), (18, 400, 600), about_z(line + 30).T)
    found = canonical(recipe((*walls, other)), DOWN) @ about_z(line)[:, 0]
    assert np.abs(found).max() > np.cos(np.radians(0.3))
