"""Figure 5: a spanning tree places all patches, the hinges beyond it say whether the configuration is valid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.geometry.arrays import Array
from foldfab.validity.configuration import Breaks, Poses, arranged, breaks, rotations, spanning_tree
from foldfab.validity.model import Body, Hinge, Linkage, no_slip


def configured(linkage: Linkage, angles: list[float], slips: Array | None = None) -> tuple[Poses, Breaks]:
    """One configuration: where it puts the bodies, and how its closing hinges are broken."""
    tree, given = spanning_tree(linkage), np.array([angles])
    given_slips = no_slip(np.zeros(1), len(angles)) if slips is None else slips
    poses = arranged(linkage, tree, given, given_slips)
    return poses, breaks(linkage, tree.closing, poses, given, given_slips)


def test_the_tree_is_breadth_first_and_sorted(table: Linkage) -> None:
    tree = spanning_tree(table)
    assert [table.hinges[h].second for h, _ in tree.edges] == ["left", "right", "left"]
    assert [is_second for _, is_second in tree.edges] == [True, True, False]
    assert tree.closing == (3,)
    assert tree.adrift == ()


def test_figure_5_valid(table: Linkage) -> None:
    poses, found = configured(table, [0.5, 0.5, 0.5, 0.5])
    assert found.distance.max() < 1e-12 and found.bend.max() < 1e-12 and found.twist.max() < 1e-12
    assert np.allclose(poses.turn[0, 1], np.eye(3))
    assert np.allclose(poses.place[0, 1], 40 * np.array([np.sin(0.5), 0.0, np.cos(0.5) - 1]))


def test_figure_5_invalid(table: Linkage) -> None:
    _, found = configured(table, [0.5, 0.5, 0.3, 0.3])
    assert found.distance[0, 0] == pytest.approx(40 * 2 * np.sin(0.1))
    assert found.twist.max() < 1e-12


def test_a_wrong_angle_of_a_closing_hinge(table: Linkage) -> None:
    _, found = configured(table, [0.5, 0.5, 0.5, 0.4])
    assert found.distance.max() < 1e-12
    assert found.twist[0, 0] == pytest.approx(0.1)


def test_angles_count_by_full_turns(table: Linkage) -> None:
    assert configured(table, [0.5, 0.5, 0.5, 0.5 + 2 * np.pi])[1].twist.max() < 1e-12


def test_an_axis_that_points_elsewhere(table: Linkage) -> None:
    skew = Hinge("ground", "left", table.hinges[0].point, np.array([0.0, np.cos(0.1), np.sin(0.1)]))
    _, found = configured(Linkage(table.bodies, (skew, *table.hinges[1:])), [0.5, 0.5, 0.5, 0.5])
    assert found.bend.max() > 0.01


def test_play_moves_bodies_and_may_close_a_hinge(table: Linkage) -> None:
    slips = np.zeros((1, 4, 3))
    slips[0, 0] = [0.0, 0.0, 0.2]
    poses, found = configured(table, [0.0, 0.0, 0.0, 0.0], slips)
    assert np.allclose(poses.place[0, 2], [0, 0, 0.2]) and np.allclose(poses.place[0, 1], [0, 0, 0.2])
    assert found.distance[0, 0] == pytest.approx(0.2)
    slips[0, 2] = [0.0, 0.0, 0.2]
    assert configured(table, [0.0, 0.0, 0.0, 0.0], slips)[1].distance.max() < 1e-12


def test_bodies_adrift_stay(table: Linkage, sheet: Callable[..., Body]) -> None:
    loose = Linkage((*table.bodies, sheet("lamp", (0, 90), (10, 90))), table.hinges)
    assert spanning_tree(loose).adrift == ("lamp",)
    assert np.allclose(configured(loose, [0.5, 0.5, 0.5, 0.5])[0].place[0, 4], 0)


def test_rotations_are_right_handed_and_exact() -> None:
    turn = rotations(np.array([0.0, 1.0, 0.0]), np.array([np.pi / 2]))[0]
    assert (turn @ [0, 0, 1] == [1, 0, 0]).all()
