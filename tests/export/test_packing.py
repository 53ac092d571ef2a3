"""Rectangles on plates."""

from __future__ import annotations

import itertools

import pytest

from foldfab.export.packing import Size, Spot, fits, packed

PLATE, SPACE = (100.0, 80.0), 5.0
MANY: list[Size] = [(90.0, 30.0), (20.0, 60.0), (40.0, 40.0), (70.0, 10.0), (99.0, 79.0), (15.0, 15.0), (15.0, 15.0)]


def _taken(size: Size, spot: Spot) -> tuple[float, float, float, float]:
    width, depth = size[::-1] if spot.is_turned else size
    return spot.corner[0], spot.corner[1], spot.corner[0] + width, spot.corner[1] + depth


def test_nothing_leaves_its_plate_or_comes_too_close() -> None:
    spots = packed(MANY, PLATE, SPACE)
    boxes = [(spot.plate, *_taken(size, spot)) for size, spot in zip(MANY, spots, strict=True)]
    assert all(x0 >= 0 and y0 >= 0 and x1 <= PLATE[0] and y1 <= PLATE[1] for _, x0, y0, x1, y1 in boxes)
    for a, b in itertools.combinations(boxes, 2):
        apart = max(b[1] - a[3], a[1] - b[3], b[2] - a[4], a[2] - b[4])
        assert a[0] != b[0] or apart >= SPACE


def test_what_fits_one_plate_takes_one() -> None:
    assert {spot.plate for spot in packed([(45.0, 35.0)] * 4, PLATE, SPACE)} == {0}


def test_what_is_too_large_is_refused() -> None:
    assert not fits((101.0, 81.0), PLATE)
    assert fits((80.0, 100.0), PLATE)
    with pytest.raises(ValueError, match="does not fit"):
        packed([(101.0, 81.0)], PLATE, SPACE)
