"""Tight boxes: least volume, and the same for what is alike."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.geometry.arrays import Array
from foldfab.intake.tight import TIE, fitted, hull, least, like, main_frame, settled, volume

from .furniture import box, cylinder

angles = st.floats(-3.0, 3.0)


def turned(a: float, b: float, c: float) -> Array:
    """A rotation by three angles."""
    (sa, sb, sc), (ca, cb, cc) = np.sin([a, b, c]), np.cos([a, b, c])
    x = np.array([[1, 0, 0], [0, ca, -sa], [0, sa, ca]])
    y = np.array([[cb, 0, sb], [0, 1, 0], [-sb, 0, cb]])
    z = np.array([[cc, -sc, 0], [sc, cc, 0], [0, 0, 1]])
    return x @ y @ z


def tight(points: Array, main: Array | None = None) -> tuple[Array, Array, Array]:
    corners, normals = hull(points)
    axes = settled(corners, least(corners, normals), np.eye(3) if main is None else main)
    return *fitted(corners, axes), axes


@given(angles, angles, angles)
@settings(max_examples=60, deadline=None)
def test_a_board_that_leans_any_way_keeps_its_size(a: float, b: float, c: float) -> None:
    axes = turned(a, b, c)
    center, size, found = tight(box((10, 20, 30), (500, 300, 18), axes).vertices)
    assert np.allclose(center, (10, 20, 30), atol=1e-6)
    assert np.prod(size) <= 500 * 300 * 18 * (1 + TIE) * (1 + 1e-9)
    assert np.allclose(found @ found.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found) > 0


@pytest.mark.parametrize("seed", range(30))
def test_no_turned_box_is_much_smaller(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = random.normal(size=(40, 3)) * (10, 4, 1)
    corners, normals = hull(points)
    smallest = volume(corners, least(corners, normals))
    tried = [volume(corners, turned(*angles)) for angles in random.uniform(-3, 3, (200, 3))]
    assert smallest <= min(tried) * (1 + TIE)


@given(angles)
@settings(max_examples=40, deadline=None)
def test_round_and_square_legs_follow_the_furniture(turn: float) -> None:
    _, size, axes = tight(cylinder(20, 400, 64, turn).vertices)
    assert np.array_equal(axes, np.eye(3))
    assert np.allclose(size, (40, 40, 400), rtol=0.01)


def test_a_leaning_round_leg_stays_in_the_plane_that_it_leans_in() -> None:
    lean = turned(0.0, 0.3, 0.0)
    _, size, axes = tight(cylinder(20, 400, 64).vertices @ lean)
    assert np.abs(axes[1]) @ (0, 1, 0) == pytest.approx(1)
    assert np.allclose(np.sort(size), (40, 40, 400), rtol=0.02)


def test_a_board_that_is_a_little_askew_is_not_straightened() -> None:
    axes = turned(0, 0.01, 0)
    _, size, found = tight(box((0, 0, 0), (500, 300, 18), axes).vertices)
    assert np.allclose(size, (500, 300, 18))
    assert np.allclose(np.abs(found @ axes.T), np.eye(3), atol=1e-6)


def test_noise_does_not_turn_a_box() -> None:
    noise = np.random.default_rng(1).normal(scale=1e-4, size=(8, 3))
    _, _, axes = tight(box((0, 0, 0), (500, 300, 18)).vertices + noise)
    assert np.array_equal(axes, np.eye(3))


def test_flat_and_straight_points() -> None:
    lean = turned(0.4, 0.3, 0.2)
    _, size, _ = tight(box((0, 0, 0), (500, 300, 0), lean).vertices)
    assert np.allclose(np.sort(size), (0, 300, 500), atol=1e-6)
    assert len(hull(np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2]]))[1]) == 0
    assert len(hull(np.zeros((4, 3)))[1]) == 0


def test_main_axes_are_those_of_most_volume() -> None:
    lean = turned(0, 0, 0.4)
    askew = [hull(box((0, 0, z), (500, 300, 18), lean).vertices) for z in (0, 100, 200)]
    straight = hull(box((0, 0, 0), (500, 300, 18)).vertices)

    def frame(*hulls: tuple[Array, Array]) -> Array:
        return main_frame([corners for corners, _ in hulls], [least(*one) for one in hulls])

    assert np.array_equal(frame(*askew[:1], straight), np.eye(3))
    assert np.allclose(frame(*askew, straight), lean)


def test_axes_come_in_the_order_of_the_main_ones() -> None:
    lean = turned(0, 0.1, 0)
    mixed = np.array([-lean[2], lean[0], -lean[1]])
    assert np.allclose(like(mixed, np.eye(3)), lean)
