"""Signed distances of boxes, rectangles and what is left of them around a hinge."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry.boxes import Boxes, overlaps
from foldfab.validity.model import Body
from foldfab.validity.separation import along, cut_back, separation

Sheets = Callable[..., Body]


@pytest.mark.parametrize(
    ("start", "end", "apart"),
    [
        ((10, 5), (20, 5), 5.0),  # beside, parallel
        ((10, 0), (20, 0), 0.0),  # in one plane, overlapping
        ((50, 0), (60, 0), 10.0),  # in one plane, apart
        ((20, 0), (20, 30), 0.0),  # standing on it
        ((40, 0), (40, 30), 0.0),  # sharing an edge
        ((20, -2), (20, 30), -2.0),  # through it
        ((39, -9), (39, 30), -1.0),  # through its rim
    ],
)
def test_rectangles(sheet: Sheets, start: tuple[float, float], end: tuple[float, float], apart: float) -> None:
    ground, other = sheet("ground", (0, 0), (40, 0)).pieces, sheet("other", start, end).pieces
    assert separation(ground, other)[0][0] == pytest.approx(apart, abs=1e-12)
    assert separation(other, ground)[0][0] == pytest.approx(apart, abs=1e-12)


def test_the_axis_points_to_the_second(sheet: Sheets) -> None:
    ground, above = sheet("ground", (0, 0), (40, 0), 4.0).pieces, sheet("above", (0, 10), (40, 10), 4.0).pieces
    apart, axis = separation(ground, above)
    assert np.allclose(axis[0], [0, 0, 1]) and apart[0] == pytest.approx(6.0)
    assert along(ground, above, axis)[0] == pytest.approx(6.0)
    assert along(above, ground, axis)[0] == pytest.approx(-14.0)


@given(st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_the_sign_is_that_of_the_overlap_test(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = (
        Boxes(rng.normal(0, 2, (1, 3)), np.linalg.qr(rng.normal(size=(1, 3, 3)))[0], rng.uniform(0.1, 2, (1, 3)))
        for _ in range(2)
    )
    apart = separation(a, b)[0][0]
    if abs(apart) > 1e-6:
        assert (apart < 0) == overlaps(a, b)[0]


def test_what_is_cut_back_around_an_axis(sheet: Sheets) -> None:
    panel = sheet("panel", (0, 0), (0, 30), 4.0).pieces
    rest = cut_back(panel, np.zeros(3), np.array([0.0, 1.0, 0.0]), 3.0)
    assert len(rest) == 1
    assert np.allclose(rest.center, [[0, 0, 16.5]]) and np.allclose(rest.half, [[2, 10, 13.5]])
    inside = cut_back(panel, np.array([0.0, 0.0, 15.0]), np.array([0.0, 1.0, 0.0]), 1.0)
    assert 8 * inside.half.prod(1).sum() == pytest.approx(20 * (4 * 30 - 2 * 2))
    assert len(cut_back(panel, np.zeros(3), np.array([0.6, 0.8, 0.0]), 3.0)) == 1
    assert len(cut_back(panel, np.array([0.0, 0.0, 15.0]), np.array([0.0, 1.0, 0.0]), 40.0)) == 0
