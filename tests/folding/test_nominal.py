"""The nominal fold of a unit: higher bases first, and never a base into another."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding.nominal import CLIMB, FRAMES, evenly, nominal, snapped
from foldfab.folding.problem import Problem, clear_height
from foldfab.recipe.model import Part

Make = Callable[..., Problem]
STACK = 2 * 4.3 + 0.3
"""Clear height of a chain with one hinge, folded."""


def test_two_bases_come_together_by_all_but_a_stack(problem: Make) -> None:
    made = problem("h_scaffold")
    found = nominal(made, made.units[0])
    assert found.sections == 1 and found.down["ceiling"].shape == (1, FRAMES)
    assert not found.down["ground"].any()
    way = found.down["ceiling"][0]
    assert not way[: CLIMB + 1].any() and (np.diff(way[CLIMB:]) < 0).all()
    assert way[-1] == pytest.approx(STACK - 80.0)


def test_the_base_of_t_scaffolds_stands_still(problem: Make) -> None:
    made = problem("table")
    for unit in made.units:
        found = nominal(made, unit)
        assert found.sections == 1 and all(not way.any() for way in found.down.values())


def test_the_highest_base_comes_down_first_and_carries_on_with_the_next(
    problem: Make, levels: tuple[Part, ...]
) -> None:
    """Figure 11 a: one section until the middle board starts, one with both."""
    made = problem(levels)
    (unit,) = made.units
    found = nominal(made, unit)
    assert unit.bases == ("low", "middle", "high") and found.sections == 2
    assert not found.down["low"].any()
    assert not found.down["middle"][0].any() and (np.diff(found.down["high"][0, CLIMB:]) < 0).all()
    assert np.diff(found.down["middle"][1]) == pytest.approx(np.diff(found.down["high"][1]))
    assert found.down["high"][1, 0] == pytest.approx(found.down["high"][0, -1])
    clear = {pair: clear_height(made, *pair) for pair in itertools.combinations(unit.bases, 2)}
    end = {base: way[-1, -1] for base, way in found.down.items()}
    assert clear["low", "middle"] + end["middle"] == pytest.approx(STACK)
    assert clear["middle", "high"] + end["high"] - end["middle"] == pytest.approx(STACK)


def test_the_snap_comes_before_the_section_in_which_a_chain_starts() -> None:
    past = np.array([np.full(FRAMES, 0.2), np.linspace(0.2, 0.6, FRAMES), np.linspace(0.6, 1.0, FRAMES)])
    found = snapped(past)
    assert found[1, 0] == 0.0 and (np.diff(found[1, : CLIMB + 1]) > 0).all()
    assert (found[1, CLIMB:] == past[1, CLIMB:]).all() and (found[[0, 2]] == past[[0, 2]]).all()


@pytest.mark.parametrize("waits", [True, False])
def test_what_folds_evenly_waits_for_snaps(waits: bool) -> None:
    frames = FRAMES if waits else FRAMES - CLIMB
    found = evenly(2, frames)
    assert found.shape == (2, frames) and found[0, 0] == 0.0 and found[-1, -1] == 1.0
    moving = found[:, frames - (FRAMES - CLIMB) :]
    assert np.diff(moving.ravel()) == pytest.approx(1 / (moving.size - 1))
    assert (found[:, : frames - (FRAMES - CLIMB)] == moving[:, :1]).all()


@pytest.mark.parametrize("name", ["h_scaffold", "passage", "shelf", "box_with_table", "tower", "chair"])
def test_plates_over_one_another_never_meet(problem: Make, name: str) -> None:
    made = problem(name)
    for unit in made.units:
        found = nominal(made, unit)
        for a, b in itertools.combinations(unit.bases, 2):
            assert (clear_height(made, a, b) + found.down[b] - found.down[a] >= made.thickness.gap - 1e-9).all()


def test_boards_that_no_wall_keeps_apart_stop_above_each_other(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    """Two shelves that overlap: the walls that hold each from below and above would let them into each other."""
    parts = (
        board_at("low", 0), board_at("left", 44, 60, x=-20), board_at("right", 84, 60, x=20), board_at("top", 128),
        wall_at("a", -35, 0, 44), wall_at("b", -40, 44, 128), wall_at("c", 35, 0, 84), wall_at("d", 40, 84, 128),
    )  # fmt: skip
    made = problem(parts)
    (unit,) = made.units
    found = nominal(made, unit)
    assert unit.bases == ("low", "left", "right", "top")
    assert clear_height(made, "left", "right") + found.down["right"][-1, -1] - found.down["left"][-1, -1] == (
        pytest.approx(made.thickness.gap)
    )
    assert clear_height(made, "low", "right") + found.down["right"][-1, -1] > STACK
