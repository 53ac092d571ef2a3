"""Turns as they are written."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.intake import turns

QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""About z."""


@pytest.mark.parametrize(
    "found",
    [
        turns.by_quaternion(2.0, 0.0, 0.0, 2.0),
        turns.by_angles("xyz", np.array([0.0, 0.0, np.pi / 2])),
        turns.by_axis(np.array([0.0, 0.0, 3.0]), np.pi / 2),
        turns.by_columns(np.array([0.0, 2.0, 0.0]), np.array([-1.0, 1.0, 0.0])),
    ],
    ids=["quaternion", "angles", "axis", "columns"],
)
def test_a_quarter_turn(found: Array) -> None:
    assert np.allclose(found, QUARTER, atol=1e-12)


def test_small_letters_turn_with_the_body() -> None:
    angles = np.array([0.3, 0.4, 0.5])
    x, y, z = (turns.by_axis(axis, angle) for axis, angle in zip(np.eye(3), angles, strict=True))
    assert np.allclose(turns.by_angles("xyz", angles), x @ y @ z)
    assert np.allclose(turns.by_angles("XYZ", angles), z @ y @ x)


@pytest.mark.parametrize("way", [[0, 0, 2], [0, 0, -2], [1, 0, 0], [0.3, -0.4, 0.5]])
def test_upright_to(way: list[float]) -> None:
    turn = turns.upright_to(np.array(way))
    assert np.allclose(turn @ [0, 0, 1], np.array(way) / np.linalg.norm(way))
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_rigid() -> None:
    matrix = turns.rigid(QUARTER, np.array([1.0, 2.0, 3.0]))
    assert np.allclose(matrix @ [1, 0, 0, 1], [1, 3, 3, 1])
