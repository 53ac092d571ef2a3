"""Room beside a plate is free where nothing comes, up to where nothing comes, with the clearance around it."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.free import Motion, used_room
from foldfab.fabrication.places import Place, Plane
from foldfab.fabrication.solids import Solid
from foldfab.geometry.arrays import Array

GAP = 0.3
MARGIN = 1.25 * GAP
BLOCK = solids.box((0, 0, -2), (40, 20, 8))
PLACE = Place("seat", ("seat",), Plane(np.zeros(3), np.eye(3)), (-2.0, 2.0), (), (), ((), ()))


def still(body: Solid) -> Motion:
    return Motion(body, np.tile(np.eye(4), (3, 1, 1)))


def areas(*motions: Motion, is_above: bool = True, most: float = 100.0) -> list[tuple[float, float]]:
    """Heights, and over which area of the block nothing is up to there."""
    whole = solids.silhouette(BLOCK)
    found = used_room(PLACE, BLOCK, is_above, most, list(motions), GAP)
    return [(round(height, 3), round((whole - outline).area(), 1)) for outline, height in found]


def test_with_nothing_around_all_of_it_is_free() -> None:
    assert areas() == [(8.0, 800.0)]
    assert areas(most=3.0) == [(5.0, 800.0)]
    assert areas(is_above=False) == []


def test_below_what_stands_over_it_it_is_free_up_to_the_clearance() -> None:
    roof = solids.box((-5, -5, 5), (45, 25, 9))
    (height, area), above = areas(still(roof))
    assert (area, above) == (800.0, (8.0, 0.0))
    assert 5.0 - MARGIN - 0.8 < height <= 5.0 - MARGIN


def test_beside_what_stands_on_it_it_keeps_the_clearance() -> None:
    post = solids.box((10, -5, 2.3), (14, 25, 20))
    assert areas(still(post)) == [(8.0, round(800.0 - 20 * (4 + 2 * MARGIN), 1))]


def test_what_only_passes_by_takes_its_way_out_of_it() -> None:
    def at(x: float) -> Array:
        pose = np.eye(4)
        pose[0, 3] = x
        return pose

    ball = solids.box((-1, 8, 4), (1, 12, 6))
    ball_goes = Motion(ball, np.array([at(-30), at(20), at(70)]))
    low, high = areas(ball_goes)
    assert low == (3.5, 800.0)
    assert high == (8.0, pytest.approx(40 * (20 - 4 - 2 * MARGIN), rel=0.01))
