"""What touches in the scaffold: boxes, but for what the recipe says; what is too far is stretched to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.errors import AbstractionError
from foldfab.folding.solve import solve
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.bridges import bridge
from foldfab.scaffold.model import Outline, Scaffold

Box = Callable[..., Part]
DOWN = np.array([0.0, 0.0, -1.0])


def made(recipe: Callable[..., Recipe], parts: tuple[Part, ...], **contacts: tuple[tuple[str, str], ...]) -> Scaffold:
    return abstract(replace(recipe(parts), **contacts), DOWN, 1.0)


def test_a_wall_reaches_up_to_the_board_that_it_is_said_to_touch(
    recipe: Callable[..., Recipe], board_at: Box, wall_at: Box
) -> None:
    parts = (board_at("ground", 0), board_at("top", 120), wall_at("leg", 0, 0, 84))
    with pytest.raises(AbstractionError, match=r"top is 36 mm from leg.*\"touching\": \[\[\"top\", \"leg\"\]\]"):
        made(recipe, parts)
    found = made(recipe, parts, touching=(("leg", "top"), ("ground", "leg")))
    leg = found.patch("leg")
    assert (leg.lower, leg.upper) == ("ground", "top")
    assert found.notes == ("leg and top are stretched to meet, by 36.0 mm in print",)
    assert leg.length == pytest.approx(120)


def test_a_board_reaches_out_to_the_wall_that_it_is_said_to_touch(
    recipe: Callable[..., Recipe], board_at: Box, wall_at: Box
) -> None:
    parts = (board_at("top", 80), wall_at("leg", 120, 0, 84), wall_at("inner", 0, 0, 84))
    found = made(recipe, parts, touching=(("leg", "top"),))
    top = found.base("top")
    assert found.patch("leg").upper == "top"
    assert [outline.part for outline in top.outlines] == ["top", "leg"]
    across = top.outlines[1]
    assert across.center == pytest.approx([109, 0])
    assert sorted(across.half) == pytest.approx([11, 30])
    assert len(solve(found).chains) == 2


def test_boards_whose_boxes_meet_are_two_bases_where_they_do_not_touch(
    recipe: Callable[..., Recipe], box: Box, board_at: Box, wall_at: Box
) -> None:
    deep = box("deep", (0, 0, 80), (200, 80, 60))
    parts = (board_at("ground", 0), deep, board_at("tray", 108), wall_at("leg", 0, 0, 84), wall_at("post", 60, 0, 108))
    assert len(made(recipe, parts).bases) == 2
    found = made(recipe, parts, apart=(("deep", "tray"),))
    assert [base.name for base in found.bases] == ["ground", "deep", "tray"]
    assert (found.patch("leg").upper, found.notes) == ("deep", ())


def test_plates_that_would_be_one_lump_stay_together_and_it_is_told(
    recipe: Callable[..., Recipe], box: Box, board_at: Box, wall_at: Box
) -> None:
    beside = box("beside", (150, 0, 80), (120, 80, 4))
    parts = (board_at("top", 80), beside, wall_at("leg", 0, 0, 80))
    found = made(recipe, parts, apart=(("beside", "top"),))
    assert [base.name for base in found.bases] == ["top"]
    assert found.notes == ("beside and top touch in print, where both are plates, although their shapes do not",)


def test_what_is_said_to_be_apart_hangs_together_no_more(
    recipe: Callable[..., Recipe], board_at: Box, box: Box
) -> None:
    parts = (board_at("ground", 0), box("block", (0, 0, 32), (100, 80, 60)))
    assert [base.parts for base in made(recipe, parts).bases] == [("block", "ground")]
    with pytest.raises(AbstractionError, match="the box of ground meets that of block, but not its shape"):
        made(recipe, parts, apart=(("block", "ground"),))


def strip(half: tuple[float, float]) -> Outline:
    return Outline("leg", np.zeros(2), np.array([0.6, 0.8]), np.array(half))


def test_a_bridge_reaches_into_both() -> None:
    along = np.array([0.6, 0.8])
    across = np.array([-0.8, 0.6])
    beside = Outline("top", 40 * across + 25 * along, across, np.array([30.0, 50.0]))
    found = bridge(strip((20, 2)), beside)
    assert found is not None
    assert found.half == pytest.approx([20, 6])
    assert found.center == pytest.approx(6 * across)
    at_corner = bridge(strip((20, 2)), Outline("top", 40 * across + 75 * along, across, np.array([30.0, 50.0])))
    assert at_corner is not None
    assert at_corner.half == pytest.approx([4.5, 6])
    assert at_corner.center == pytest.approx(6 * across + 22.5 * along)


def test_what_overlaps_needs_no_bridge() -> None:
    assert (
        bridge(strip((20, 2)), Outline("top", np.array([5.0, 5.0]), np.array([1.0, 0.0]), np.array([30, 30]))) is None
    )
