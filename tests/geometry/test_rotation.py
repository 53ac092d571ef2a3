"""Rotations are exact at quarter turns and rotations everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from foldfab.geometry.rotation import cosine, cross, sine, sine_and_cosine, upright

AXES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
DOWN = np.array([0.0, 0.0, -1.0])
entry = st.floats(-1, 1, allow_subnormal=False)


@pytest.mark.parametrize("quarters", range(-8, 9))
def test_sines_and_cosines_of_quarter_turns_are_whole_numbers(quarters: int) -> None:
    angle = np.array(quarters * np.pi / 2)
    assert cosine(angle) == [1, 0, -1, 0][quarters % 4]
    assert sine(angle) == [0, 1, 0, -1][quarters % 4]


def test_other_angles_keep_their_sines_and_cosines() -> None:
    angles = np.linspace(-7, 7, 99)
    assert np.allclose(cosine(angles), np.cos(angles), atol=1e-11, rtol=0)
    assert np.allclose(sine(angles), np.sin(angles), atol=1e-11, rtol=0)


def test_sines_and_cosines_together_are_those_of_each() -> None:
    angles = np.linspace(-2 * np.pi, 2 * np.pi, 33).reshape(3, 11)
    assert sine_and_cosine(angles).tobytes() == np.array([sine(angles), cosine(angles)]).tobytes()


@given(st.lists(entry, min_size=6, max_size=6))
def test_the_cross_product_is_that_of_numpy(entries: list[float]) -> None:
    a, b = np.array(entries[:3]), np.array(entries[3:])
    assert cross(a, b).tobytes() == np.cross(a, b).tobytes()


@pytest.mark.parametrize("axis", AXES)
def test_upright_permutes_the_axes_to_the_last_bit(axis: tuple[int, int, int]) -> None:
    turn = upright(np.array(axis, dtype=float))
    assert set(np.abs(turn).flat) == {0.0, 1.0}
    assert (turn @ turn.T == np.eye(3)).all()
    assert (turn @ np.array(axis) == DOWN).all()
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_upright_leaves_furniture_that_folds_down_as_it_is() -> None:
    assert (upright(DOWN) == np.eye(3)).all()


@given(st.tuples(entry, entry, entry))
@settings(deadline=None, derandomize=True)
def test_upright_turns_any_direction_down_by_a_proper_rotation(vector: tuple[float, float, float]) -> None:
    length = float(np.linalg.norm(vector))
    assume(length > 1e-3)
    direction = np.array(vector) / length
    turn = upright(direction)
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-12, rtol=0)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert np.allclose(turn @ direction, DOWN, atol=1e-12, rtol=0)
