"""Shapes are values: equal ones are one, and they hold nothing but numbers."""

from __future__ import annotations

import numpy as np

from foldfab.fabrication.shapes import Union, box, cone, cut, hull, placed, prism, rod, union


def test_equal_shapes_are_one() -> None:
    made = {
        placed(cut(union([box(np.zeros(3), (1, 1, 1)), rod(1, 0, 2, 0, 0)]), [cone(1, 0, 1, 0, 0)]), at, np.eye(3))
        for at in (np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), np.array([2.0, 0.0, 0.0]))
    }
    assert len(made) == 2


def test_numbers_of_any_kind_are_the_same() -> None:
    assert box(np.array([0, 0, 0]), [1, 1, np.float64(1)]) == box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    assert prism(np.array([[0, 0], [1, 0], [0, 1]]), 0, 1) == prism([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], 0.0, 1.0)


def test_nothing_is_wrapped_without_need() -> None:
    one = box((0, 0, 0), (1, 1, 1))
    assert union([one]) is one
    assert cut(one, []) is one
    assert isinstance(union([one, one]), Union)
    assert hull([one]) != one
