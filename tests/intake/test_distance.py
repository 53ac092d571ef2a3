"""How far boxes are from what they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.intake.distance import off_box, to_surface
from foldfab.intake.meshes import joined

from .furniture import box, cylinder


def test_to_the_inside_an_edge_and_a_corner_of_a_triangle() -> None:
    mesh = box((0, 0, 0), (2, 2, 2))
    points = np.array([[0, 0, 3], [0, 3, 3], [3, 3, 3], [0, 0, 0], [0.5, 0, 0]])
    assert np.allclose(to_surface(points, mesh), [2, 8**0.5, 12**0.5, 1, 0.5])


def test_a_box_is_its_box() -> None:
    assert off_box(box((5, 6, 7), (500, 300, 18)), np.array([5, 6, 7]), np.eye(3), np.array([500, 300, 18])) < 1e-9


def test_a_round_leg_is_off_at_its_corners() -> None:
    leg = cylinder(20, 400, 256)
    off = off_box(leg, np.array([0, 0, 200]), np.eye(3), np.array([40, 40, 400]))
    assert off == pytest.approx(20 * (2**0.5 - 1), rel=0.01)


def test_an_angle_is_off_across_from_its_bend() -> None:
    angle = joined([box((0, 0, 1), (100, 50, 2)), box((-49, 0, 25), (2, 50, 50))])
    assert off_box(angle, np.array([0, 0, 25]), np.eye(3), np.array([100, 50, 50])) == pytest.approx(48)
