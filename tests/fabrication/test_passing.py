"""What a piece passes between two instants of a fold is met as well."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.passing import Passage
from foldfab.geometry.arrays import Array

PIECE = solids.box((40, -5, 60), (50, 5, 62))
"""Below the roof of the shelter, which comes straight down by more than 60 mm."""
ENDS = np.array([0.0, 1.0])


@pytest.fixture
def passage(assembled: Callable[..., Assembly]) -> Callable[[Array], Passage]:
    """The fold of the shelter, known at some instants."""
    return lambda times: Passage(assembled("shelter").solution, times)


@pytest.mark.parametrize("times", [ENDS, np.linspace(0, 1, 8)], ids=["ends", "some"])
@pytest.mark.parametrize(("at", "is_met"), [(45.0, True), (35.0, False)])
def test_a_thin_shelf_on_the_way_down(
    passage: Callable[[Array], Passage], times: Array, at: float, is_met: bool
) -> None:
    shelf = solids.box((at, -5, 30), (at + 4, 5, 30.5))
    assert passage(times).meets("roof", PIECE, "ground", shelf, above=0.005) is is_met


def test_what_is_met_at_an_instant_alone(passage: Callable[[Array], Passage]) -> None:
    there = passage(ENDS).poses["roof"][1]
    low, high = solids.bounds(solids.moved(PIECE, there))
    assert passage(ENDS).meets("roof", PIECE, "ground", solids.box(low, high), above=0.005)
    assert not passage(ENDS).meets("roof", PIECE, "ground", solids.box(low - 9, low - 1), above=0.005)


def test_bodies_that_do_not_move_against_each_other_never_meet(passage: Callable[[Array], Passage]) -> None:
    beside = solids.box((50.3, -5, 60), (55, 5, 62))
    assert not passage(ENDS).meets("roof", PIECE, "roof", beside, above=0.005)


def test_what_a_piece_takes_from_another_body_at_the_instants(passage: Callable[[Array], Passage]) -> None:
    there = solids.moved(PIECE, passage(ENDS).poses["roof"][1])
    low, high = solids.bounds(there)
    below = solids.box(low - [5, 5, 5], high - [0, 0, 1])
    (taken,) = passage(ENDS).taken("roof", PIECE, "ground", below)
    assert taken.volume() == pytest.approx(PIECE.volume() / 2)
    assert passage(ENDS).taken("roof", PIECE, "ground", solids.box(low - 9, low - 1)) == []
