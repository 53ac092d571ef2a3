"""What each part can be along a direction: a base, or a sheet with a horizontal hinge direction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.frame import canonical
from foldfab.scaffold.segments import Segment, segments, sheet

DOWN = (0.0, 0.0, -1.0)
DIAGONAL = np.array([[1.0, -1, 0], [1, 1, -2], [1, 1, 1]]) / np.sqrt(np.array([[2.0], [6], [3]]))
"""Axes of a rod along (1, 1, 1)."""

Box = Callable[..., Part]
Make = Callable[..., Recipe]


def about_y(angle: float) -> Array:
    sin, cos = np.sin(angle), np.cos(angle)
    return np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])


def segment(recipe: Make, part: Part, direction: tuple[float, ...] = DOWN, scale: float = 1.0) -> Segment:
    return segments(recipe((part,)), np.array(direction), scale)[0]


@pytest.mark.parametrize(
    ("direction", "is_base"), [((0, 0, -1), True), ((0, 0, 1), True), ((1, 0, 0), False), ((0, -1, 0), False)]
)
def test_a_board_is_a_base_exactly_where_it_is_perpendicular_to_the_direction(
    box: Box, recipe: Make, direction: tuple[float, ...], is_base: bool
) -> None:
    assert segment(recipe, box("board", (0, 0, 0), (100, 60, 4)), direction).is_base is is_base


@pytest.mark.parametrize(("degrees", "is_base"), [(0, True), (10, True), (20, True), (40, False), (90, False)])
def test_a_slightly_tilted_seat_counts_as_a_base(box: Box, recipe: Make, degrees: float, is_base: bool) -> None:
    seat = box("seat", (0, 0, 0), (100, 60, 4), about_y(np.radians(degrees)))
    assert segment(recipe, seat).is_base is is_base


@pytest.mark.parametrize(("direction", "is_base"), [((0, 0, -1), True), ((0, -1, 0), True), ((-1, 0, 0), False)])
def test_a_rod_is_a_base_where_its_axis_is_perpendicular_to_the_direction(
    box: Box, recipe: Make, direction: tuple[float, ...], is_base: bool
) -> None:
    assert segment(recipe, box("bar", (0, 0, 0), (100, 6, 5)), direction).is_base is is_base


@pytest.mark.parametrize("size", [(5, 6, 80), (6, 5, 80), (5, 5, 80)])
def test_a_leaning_rod_folds_in_the_plane_in_which_it_leans(box: Box, recipe: Make, size: tuple[float, ...]) -> None:
    along, up, width, length, thickness = sheet(segment(recipe, box("leg", (0, 0, 0), size, about_y(0.3))))
    assert np.abs(along) == pytest.approx([0, 1, 0])
    assert up == pytest.approx([np.sin(0.3), 0, np.cos(0.3)])
    assert (width, length, thickness) == pytest.approx((size[1], 80, size[0]))


@pytest.mark.parametrize("size", [(5, 6, 120), (6, 5, 120)])
def test_the_plane_of_a_rod_depends_on_the_direction_and_not_on_its_thinner_side(
    box: Box, recipe: Make, size: tuple[float, ...]
) -> None:
    rod = box("rod", (0, 0, 0), size, DIAGONAL)
    downward = sheet(segment(recipe, rod))
    along = downward[0] @ canonical(recipe((rod,)), np.array(DOWN))
    assert np.abs(along) == pytest.approx(np.abs(DIAGONAL[0]))
    assert downward[2] == pytest.approx(size[0])
    along_x = segments(recipe((rod,)), np.array([-1.0, 0, 0]), 1.0)[0]
    assert sheet(along_x)[0][2] == 0.0


def test_a_rod_that_splays_diagonally_stays_about_as_narrow_as_it_is(box: Box, recipe: Make) -> None:
    tilt, half = 0.25, np.sqrt(0.5)
    axis, sin, cos = np.array([half, -half, 0.0]), np.sin(tilt), np.cos(tilt)
    cross = np.cross(np.eye(3), axis)
    splayed = cos * np.eye(3) + sin * cross + (1 - cos) * np.outer(axis, axis)
    assert sheet(segment(recipe, box("leg", (0, 0, 0), (5, 5, 100), splayed)))[2] < 10.0


angle = st.floats(-0.9, 0.9)


@given(angle, angle, angle, st.sampled_from([(4, 60, 80), (80, 4, 60), (5, 6, 90), (30, 40, 3)]))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_sheet_is_orthonormal_rises_and_has_room_for_its_part(
    box: Box, recipe: Make, a: float, b: float, c: float, size: tuple[float, ...]
) -> None:
    turn = about_y(a) @ about_y(b)[[1, 2, 0]][:, [1, 2, 0]] @ about_y(c)[[2, 0, 1]][:, [2, 0, 1]]
    part = segment(recipe, box("part", (0, 0, 0), size, turn))
    if part.is_base:
        return
    along, up, width, length, thickness = sheet(part)
    assert abs(along[2]) < 1e-12 and up[2] > 0
    assert np.array([along, up]) @ np.array([along, up]).T == pytest.approx(np.eye(2))
    assert width * length * thickness >= np.prod(size) * (1 - 1e-9)


def test_segments_are_sorted_scaled_and_turned_so_that_the_direction_points_down(box: Box, recipe: Make) -> None:
    made = recipe((box("b", (10, 0, 0), (4, 60, 80)), box("a", (0, 20, 30), (100, 60, 4))))
    first, second = segments(made, np.array([1.0, 0, 0]), 0.5)
    assert (first.name, second.name) == ("a", "b")
    assert second.center[2] == -5.0 and first.center[2] == 0.0
    assert first.half == pytest.approx([25, 15, 1])
    assert second.is_base and not first.is_base
