"""Rotations survive the way into quaternions and back."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from foldfab.export import quaternion

part = st.floats(-1.0, 1.0, allow_nan=False)


@given(st.tuples(part, part, part, part).filter(lambda q: sum(x * x for x in q) > 1e-2))
def test_matrices_come_back(values: tuple[float, ...]) -> None:
    matrix = quaternion.to_matrix(np.array(values))
    again = quaternion.to_matrix(quaternion.from_matrices(matrix[None])[0])
    assert np.allclose(matrix, again, atol=1e-9)


def test_a_full_turn_never_jumps_in_sign() -> None:
    angles = np.linspace(0.0, 2 * np.pi, 50)
    turns = np.array([[[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]] for a in angles])
    found = quaternion.from_matrices(turns)
    assert np.all(np.einsum("ij,ij->i", found[1:], found[:-1]) > 0.9)


def test_slerp_goes_the_short_way_at_constant_speed() -> None:
    first, second = np.array([0.0, 0, 0, 1]), -np.array([0, 0, np.sin(0.5), np.cos(0.5)])
    third = quaternion.slerp(first, second, 0.25)
    expected = np.array([0, 0, np.sin(0.125), np.cos(0.125)])
    assert np.allclose(np.abs(third), expected)
    assert np.allclose(quaternion.slerp(first, first, 0.3), first)
