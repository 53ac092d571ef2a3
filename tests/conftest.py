"""Tiny named furniture in millimetres of print (scale 1), shared by the tests of all rooms, as fixtures.

Boards and walls are 4 mm thick, like the panels they become. Along -z, unless `DIRECTION` says otherwise.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foldfab.folding.model import FoldSolution
from foldfab.folding.solve import solve
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import FoldOptions, Part, Pattern, Printer, PrintOptions, Recipe
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import Scaffold

K = 4.0
DIRECTION = {"chair": (-1.0, 0.0, 0.0), "plain_chair": (-1.0, 0.0, 0.0)}


def make_box(
    name: str, center: tuple[float, ...], size: tuple[float, ...], axes: Array | None = None, hingeable: bool = True
) -> Part:
    """A part with its centre, its full size and the rows of its axes."""
    return Part(name, np.array(center), np.array(size), np.eye(3) if axes is None else axes, hingeable)


def board(name: str, z: float, width: float = 200.0, depth: float = 80.0, x: float = 0.0, y: float = 0.0) -> Part:
    """A horizontal board with its mid-plane at height z."""
    return make_box(name, (x, y, z), (width, depth, K))


def wall(
    name: str, x: float, low: float, high: float, depth: float = 60.0, y: float = 0.0, hingeable: bool = True
) -> Part:
    """An upright board facing x, from the face of the board at `low` to that of the board at `high`."""
    return make_box(name, (x, y, (low + high) / 2), (K, depth, high - low - K), hingeable=hingeable)


def leaning(name: str, foot: float, top: float, low: float, high: float, depth: float = 60.0, y: float = 0.0) -> Part:
    """A board that leans from x = foot on the board at `low` to x = top under the board at `high`."""
    tilt = np.arctan2(top - foot, high - low)
    sin, cos = np.sin(tilt), np.cos(tilt)
    axes = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
    length = float(np.hypot(top - foot, high - low)) - K / cos
    return make_box(name, ((foot + top) / 2, y, (low + high) / 2), (K, depth, length), axes)


def make_pair(
    height: float, one: float | None = None, three: float | None = None, hinges: tuple[int, int] = (1, 3)
) -> tuple[Part, ...]:
    """Walls beside each other that have to take as many hinges as told, each of its own thickness."""
    made = [board("ground", 0, 240), board("ceiling", height, 240)]
    for name, x, thickness, count in (("one", -60, one, hinges[0]), ("three", 60, three, hinges[1])):
        pin = Pattern(hinges=count, window=(0, 1))
        made.append(replace(wall(name, x, 0, height), pin=pin, thickness=thickness))
    return tuple(made)


def make_butting(depth: float = 100, apart: float = 1) -> tuple[Part, ...]:
    side = make_box("side", (-18 + apart, 0, 30), (40, K, 56))
    return board("low", 0, 160, 160), board("high", 60, 160, 160), wall("back", -40, 0, 60, depth), side


GROUND, CEILING = board("ground", 0), board("ceiling", 84)

FURNITURE: dict[str, tuple[Part, ...]] = {
    "t_scaffold": (GROUND, wall("leg", 0, 0, 72)),
    "h_scaffold": (GROUND, CEILING, wall("leg", 0, 0, 84)),
    "slanted_t": (GROUND, leaning("leg", 0, 20, 0, 72)),
    "slanted_h": (GROUND, CEILING, leaning("leg", -15, 15, 0, 84)),
    "same_way": (GROUND, CEILING, leaning("near", -60, -40, 0, 84), leaning("far", 40, 60, 0, 84)),
    "two_ways": (GROUND, CEILING, leaning("near", -70, -40, 0, 84), leaning("far", 70, 40, 0, 84)),
    "two_lean": (GROUND, CEILING, leaning("near", -60, -40, 0, 84), wall("far", 60, 0, 84)),
    "corner": (GROUND, CEILING, wall("side", -60, 0, 84), make_box("back", (0, 38, 42), (60, K, 80))),
    "beside": (GROUND, CEILING, wall("wall", 0, 0, 84), wall("flap", 6, 0, 54)),
    "roof": (GROUND, leaning("left", -40, 0, 0, 84), leaning("right", 40, 0, 0, 84)),
    "passage": (board("low", 0), board("middle", 64, 100), board("high", 128), wall("side", 0, 0, 128)),
    "three_walls": (
        board("ground", 0, 240, 160), board("ceiling", 84, 240, 160),
        wall("left", -110, 0, 84, 120), wall("right", 110, 0, 84, 120),
        make_box("back", (0, 74, 42), (200, K, 80)),
    ),
    "box_with_table": (
        board("ground", 0, 300, 120), board("ceiling", 104, 300, 120),
        wall("left", -140, 0, 104, 100), wall("right", 140, 0, 104, 100),
        board("top", 44, 80, 80), wall("leg-left", -30, 0, 44, 60), wall("leg-right", 30, 0, 44, 60),
    ),
    "shelf": (
        board("low", 0), board("middle", 64), board("high", 128),
        wall("a", -60, 0, 64), wall("b", 60, 0, 64), wall("c", -60, 64, 128), wall("d", 60, 64, 128),
    ),
    "table": (board("top", 72), wall("left", -80, 0, 72), wall("right", 80, 0, 72)),
    "tower": (board("low", 0), board("middle", 64), board("high", 128), wall("a", 0, 0, 64), wall("b", 0, 64, 128)),
    "deep_box": (
        board("ground", 0, 240, 56), board("ceiling", 124, 240, 56),
        wall("side", -60, 0, 124, 48), make_box("back", (30, 0, 62), (80, K, 120)),
    ),
    "plain_chair": (
        make_box("left", (-50, 0, 60), (K, 100, 150)), make_box("right", (50, 0, 60), (K, 100, 150)),
        make_box("seat", (0, -5, 60), (96, 80, K)), make_box("back", (0, 45, 100), (96, K, 70)),
    ),
    "chair": (
        make_box("left", (-50, 0, 60), (K, 100, 150)), make_box("right", (50, 0, 60), (K, 100, 150)),
        make_box("seat", (0, 0, 60), (96, 90, K)), make_box("back", (0, 30, 100), (96, K, 70)),
        make_box("apron", (0, 0, 30), (96, 90, K)),
    ),
}  # fmt: skip


def make_recipe(
    what: str | tuple[Part, ...], *, direction: tuple[float, ...] | Array | None = None, thickness: float = K,
    clearance: float = 0.3, **fold: Any,
) -> Recipe:  # fmt: skip
    """The recipe of named furniture, or of parts, with options of the fold."""
    name = what if isinstance(what, str) else "parts"
    parts = FURNITURE[what] if isinstance(what, str) else what
    along = np.array(DIRECTION.get(name, (0.0, 0.0, -1.0)) if direction is None else direction)
    printing = PrintOptions(
        printer=Printer("any", (500.0, 500.0, 500.0)), thickness=thickness, clearance=clearance, scale=1.0
    )
    return Recipe(name, along, parts, FoldOptions(**fold), printing)


def make_scaffold(what: str | tuple[Part, ...] | Recipe, **options: Any) -> Scaffold:
    """The scaffold of furniture along its direction."""
    recipe = what if isinstance(what, Recipe) else make_recipe(what, **options)
    assert recipe.direction is not None
    return abstract(recipe, recipe.direction, recipe.print.scale or 1.0)


@functools.cache
def _solved(name: str, options: tuple[tuple[str, Any], ...]) -> FoldSolution:
    return solve(make_scaffold(name, **dict(options)))


def make_solution(what: str | tuple[Part, ...], **options: Any) -> FoldSolution:
    """The folding solution of furniture; made once for named furniture."""
    if isinstance(what, str):
        return _solved(what, tuple(sorted(options.items())))
    return solve(make_scaffold(what, **options))


@pytest.fixture(autouse=True)
def own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No test reads or writes the calibrations of whoever runs it."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.fixture(scope="session")
def box() -> Callable[..., Part]:
    """Makes a part from its name, centre, size and, where it is turned, axes."""
    return make_box


@pytest.fixture(scope="session")
def board_at() -> Callable[..., Part]:
    """Makes a horizontal board: name, z, width, depth, x, y."""
    return board


@pytest.fixture(scope="session")
def wall_at() -> Callable[..., Part]:
    """Makes an upright wall that faces x between two boards: name, x, low, high, depth, y."""
    return wall


@pytest.fixture(scope="session")
def butting_on() -> Callable[..., tuple[Part, ...]]:
    """Makes a wall `back` and one that butts on its middle, both between two boards: how deep, and how far apart."""
    return make_butting


@pytest.fixture(scope="session")
def butting() -> tuple[Part, ...]:
    """The same so close that the side meets the back's knuckles but not its panels."""
    return make_butting()


@pytest.fixture(scope="session")
def leaning_at() -> Callable[..., Part]:
    """Makes a wall that leans along x between two boards: name, foot, top, low, high, depth, y."""
    return leaning


@pytest.fixture(scope="session")
def pair() -> Callable[..., tuple[Part, ...]]:
    """Makes a wall `one` and a wall `three` under one board: its height, their thickness, their hinges (1 and 3)."""
    return make_pair


@pytest.fixture(scope="session")
def furniture() -> dict[str, tuple[Part, ...]]:
    """The parts of all named furniture."""
    return FURNITURE


@pytest.fixture(scope="session")
def recipe() -> Callable[..., Recipe]:
    """Makes the recipe of named furniture or of parts."""
    return make_recipe


@pytest.fixture(scope="session")
def scaffold() -> Callable[..., Scaffold]:
    """Makes the scaffold of named furniture, of parts, or of a recipe."""
    return make_scaffold


@pytest.fixture(scope="session")
def solution() -> Callable[..., FoldSolution]:
    """Makes the folding solution of named furniture or of parts."""
    return make_solution
