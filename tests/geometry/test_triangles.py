"""Triangles in bulk, held against points spread over them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry.arrays import Array
from foldfab.geometry.triangles import between, is_inside, to_points

FLAT = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]])
STEPS = 24
_GRID = np.array([(i, j) for i in range(STEPS + 1) for j in range(STEPS + 1 - i)]) / STEPS
SHARES = np.column_stack([_GRID, 1 - _GRID.sum(1)])
"""(k, 3) of the corners, evenly over a triangle."""


def cube(side: float) -> Array:
    """Its twelve triangles, around the origin."""
    corners = side * np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    found: Array = corners[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]
    return found


@pytest.mark.parametrize(
    ("other", "distance"),
    [
        (FLAT + np.array([0, 0, 3]), 3),
        (FLAT + np.array([7, 0, 0]), 3),
        ([[1, 1, 5], [1, 1, 2], [9, 9, 9]], 2),
        ([[1, 1, 5], [1, 1, -2], [9, 9, 9]], 0),
        ([[2, -3, 2], [2, 5, -9], [2, 5, 9]], 0),
        ([[-1, -1, 1], [-1, -1, -1], [-2, -2, 0]], 2**0.5),
        ([[5, 0, 1], [5, 0, -1], [6, 0, 0]], 1),
        ([[1, 1, 1], [1, 1, 1], [1, 1, 1]], 1),
    ],
    ids=["above", "beside", "corner above", "pierced", "through an edge", "edges", "edge at a corner", "a point"],
)
def test_two_triangles(other: Array, distance: float) -> None:
    pair = np.array([FLAT]), np.array([other], dtype=np.float64)
    assert between(*pair) == pytest.approx([distance**2])
    assert between(*reversed(pair)) == pytest.approx([distance**2])


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None, derandomize=True, max_examples=25)
def test_as_far_apart_as_points_on_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(-1, 1, (2, 8, 3, 3)) + rng.uniform(-1, 1, (2, 8, 1, 3))
    found = np.sqrt(between(a, b))
    for one, other, distance in zip(a, b, found, strict=True):
        spread = np.linalg.norm((SHARES @ one)[:, None] - SHARES @ other, axis=2).min()
        longest = max(float(np.linalg.norm(t - np.roll(t, 1, 0), axis=1).max()) for t in (one, other))
        assert spread - 2 * longest / STEPS <= distance <= spread + 1e-12


def test_points_with_triangles_of_their_own() -> None:
    points = np.array([[1, 1, 2], [-3, 1, 0], [-3, -4, 0]])
    assert to_points(points, np.array([FLAT] * 3)) == pytest.approx([4, 9, 25])


def test_inside_is_within_what_closes() -> None:
    assert is_inside(np.array([0.4, 0.4, -0.4]), cube(1))
    assert is_inside(np.array([0.4, 0.4, -0.4]), cube(1)[:, ::-1])
    assert not is_inside(np.array([0.6, 0, 0]), cube(1))
    assert not is_inside(np.zeros(3), cube(1)[:9])
