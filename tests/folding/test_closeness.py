"""What crosses for a moment between two samples is found, and what only touches is not told."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.folding.closeness import DEPTH, Moving, crossing
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes

TIMES = np.linspace(0.0, 1.0, 13)
LEVEL, UPRIGHT = np.eye(3)[[2, 1, 0]], np.eye(3)
"""Axes of sheets: normal, hinge direction, length."""


def moving(start: tuple[float, float], end: tuple[float, float], axes: Array, length: float = 20.0) -> Moving:
    """One sheet whose middle goes straight from (x, z) to (x, z)."""

    def at(times: Array) -> Boxes:
        here, there = np.array([start[0], 0.0, start[1]]), np.array([end[0], 0.0, end[1]])
        center = (here + times[:, None] * (there - here))[:, None]
        half = np.broadcast_to(np.array([0.0, 10.0, length / 2]), center.shape)
        return Boxes(center, np.broadcast_to(axes, (*center.shape, 3)), half)

    return at


def both(one: Moving, other: Moving) -> Moving:
    """Two sheets together."""

    def at(times: Array) -> Boxes:
        many = one(times), other(times)
        return Boxes(*(np.concatenate([getattr(b, of) for b in many], axis=1) for of in ("center", "axes", "half")))

    return at


@pytest.mark.parametrize(("over", "crosses"), [(0.02, False), (0.08, True)])
def test_a_moment_between_two_samples(over: float, crosses: bool) -> None:
    """A board comes up past a strip of 0.4 mm, whose plane its edge reaches."""
    board, strip = moving((over - 10, 0), (over - 10, 40), LEVEL), moving((0, 18), (0, 18), UPRIGHT, 0.4)
    assert crossing(board, strip, TIMES).tolist() == [[crosses]]
    height = board(TIMES).center[:, 0, 2]
    assert np.abs(height - 18).min() > 0.2 + DEPTH, "at the samples themselves there is nothing to see"


def test_what_comes_down_upon_another_touches_only() -> None:
    still = moving((0, 0), (0, 0), LEVEL)
    assert not crossing(moving((5, 30), (5, 0), LEVEL), still, TIMES).any()
    assert not crossing(moving((5, 30), (5, 10), UPRIGHT), still, TIMES).any()
    assert crossing(moving((5, 30), (5, 9), UPRIGHT), still, TIMES).all()


def test_each_pair_is_told_for_itself() -> None:
    ends = both(moving((5, 30), (5, 9), UPRIGHT), moving((-5, 30), (-5, 10), UPRIGHT))
    still = both(moving((0, 0), (0, 0), LEVEL), moving((40, 0), (40, 0), LEVEL))
    assert crossing(ends, still, TIMES).tolist() == [[True, False], [False, False]]
