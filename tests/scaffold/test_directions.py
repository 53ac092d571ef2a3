"""Which directions are tried."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.directions import AXES, MOST_OBLIQUE, is_across, is_same, lines, main_frame, title

Make = Callable[..., Recipe]


def turned(degrees: float) -> Array:
    """Axes (3, 3) that are turned about y."""
    angle = np.radians(degrees)
    return np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])


def told(recipe: Recipe) -> list[str]:
    return [title(line.direction) for line in lines(recipe)]


def test_level_furniture_has_its_axes(recipe: Make, box: Callable[..., Part]) -> None:
    assert told(recipe("h_scaffold")) == ["-z", "-x", "-y"]
    shares = [line.share for line in lines(recipe((box("cube", (0, 0, 0), (9, 9, 9)),)))]
    assert shares == pytest.approx([1 / 3] * 3)


def test_what_leans_is_tried_and_named_after_the_part(recipe: Make, box: Callable[..., Part]) -> None:
    parts = (box("floor", (0, 0, 0), (90, 90, 4)), box("back", (0, 0, 30), (4, 90, 60), turned(30)))
    found = lines(recipe(parts))
    assert [(title(line.direction), line.part) for line in found[3:]] == [("[0.866, 0, -0.5]", "back")]
    assert is_same(found[3].direction, turned(30)[0])


def test_close_directions_are_one(recipe: Make, box: Callable[..., Part]) -> None:
    boards = [box(f"b{i}", (i, 0, 0), (4, 90, 60), turned(30 + 0.5 * i)) for i in range(3)]
    assert len(lines(recipe(tuple(boards)))) == 5, "the axes, the boards' faces and their tops"
    assert told(recipe((box("a", (0, 0, 0), (9, 9, 9), turned(1)),))) == ["-z", "-x", "-y"]


def test_there_are_never_too_many(recipe: Make, box: Callable[..., Part]) -> None:
    fan = tuple(box(f"b{i}", (i, 0, 0), (4, 90, 60), turned(7 * i)) for i in range(1, 12))
    found = lines(recipe(fan))
    assert len(found) == 3 + MOST_OBLIQUE
    assert [line.part for line in found] == [line.part for line in lines(recipe(fan[::-1]))]


def test_small_parts_do_not_vote(recipe: Make, box: Callable[..., Part]) -> None:
    parts = (box("floor", (0, 0, 0), (900, 900, 4)), box("wedge", (0, 0, 5), (4, 9, 9), turned(30)))
    assert told(recipe(parts)) == ["-z", "-x", "-y"]


def test_the_recipes_own_direction_is_tried_too(recipe: Make) -> None:
    own = np.array([0.6, 0.0, 0.8])
    found = lines(recipe("h_scaffold", direction=own))
    assert len(found) == 4 and is_same(found[3].direction, own)


def test_the_main_frame_follows_turned_furniture(recipe: Make, box: Callable[..., Part]) -> None:
    axes = turned(20)
    parts = (box("seat", (0, 0, 0), (90, 60, 4), axes), box("side", 20 * axes[2], (4, 60, 40), axes))
    frame = main_frame(lines(recipe(parts)))
    assert all(is_same(row, axis) for row, axis in zip(frame, axes[[2, 0, 1]], strict=True))
    assert np.linalg.det(frame) == pytest.approx(1.0)


def test_words_and_angles() -> None:
    assert title(np.array([0.0, -0.6, 0.8])) == "[0, -0.6, 0.8]"
    assert [title(np.array(axis, dtype=float)) for axis in AXES.values()] == ["-z", "-x", "-y", "z", "x", "y"]
    assert is_across(np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    assert is_same(np.array([1.0, 0, 0]), np.array([-1.0, 0, 0]))
