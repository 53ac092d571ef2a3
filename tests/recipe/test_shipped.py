"""The recipes that foldfab ships stand on the floor and say what they are after."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.recipe.find import shipped
from foldfab.recipe.model import Part, Recipe
from foldfab.recipe.read import read

REACH = 1.0
"""mm between parts that touch."""


def corners(part: Part) -> Array:
    """(8, 3) corners of a part's box."""
    signs = np.array(list(product((-0.5, 0.5), repeat=3)))
    return np.asarray(part.center + (signs * part.size) @ part.axes)


def touches(one: Part, other: Part) -> bool:
    """Whether two boxes are within `REACH`, by separating axes."""
    candidates = [*one.axes, *other.axes, *(np.cross(a, b) for a in one.axes for b in other.axes)]
    for axis in candidates:
        if np.linalg.norm(axis) < 1e-9:
            continue
        a, b = corners(one) @ axis, corners(other) @ axis
        if max(a.min() - b.max(), b.min() - a.max()) > REACH * np.linalg.norm(axis):
            return False
    return True


def connected(recipe: Recipe) -> set[str]:
    """The parts that hang together with the first one."""
    reached, pending = set[str](), [recipe.parts[0]]
    while pending:
        part = pending.pop()
        if part.name not in reached:
            reached.add(part.name)
            pending += [other for other in recipe.parts if other.name not in reached and touches(part, other)]
    return reached


def test_at_least_twelve() -> None:
    assert len(shipped()) >= 12


@pytest.mark.parametrize("path", shipped(), ids=lambda path: path.stem)
def test_a_shipped_recipe(path: Path) -> None:
    recipe = read(path)
    assert recipe.name == path.stem
    assert recipe.about.endswith(".")
    assert recipe.direction is not None
    lowest = min(corners(part)[:, 2].min() for part in recipe.parts)
    assert abs(lowest) <= 1.0
    assert connected(recipe) == {part.name for part in recipe.parts}
