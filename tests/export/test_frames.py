"""The canonical frame is left here, and only here."""

import numpy as np

from foldfab.export.frames import moved, pose_at, sheet_poses, to_sheet
from foldfab.fabrication.model import Assembly


def test_the_direction_comes_back_to_the_recipe(turned_assembly: Assembly) -> None:
    scaffold = turned_assembly.solution.scaffold
    assert np.array_equal(to_sheet(turned_assembly, np.array([0.0, 0.0, -1.0])), scaffold.direction)
    assert np.array_equal(scaffold.direction, [1.0, 0.0, 0.0])


def test_parts_of_the_recipe_lie_where_their_bodies_are(turned_assembly: Assembly) -> None:
    scaffold = turned_assembly.solution.scaffold
    floor = next(part for part in scaffold.recipe.parts if part.name == "floor")
    body = next(body for body in turned_assembly.bodies if body.name == "floor")
    points = to_sheet(turned_assembly, body.vertices)
    middle = scaffold.scale * floor.center
    assert np.all(points.min(axis=0) < middle + 1e-9) and np.all(points.max(axis=0) > middle - 1e-9)


def test_a_pose_moves_sheet_points_as_it_moves_canonical_ones(turned_assembly: Assembly) -> None:
    body = turned_assembly.bodies[0]
    there = to_sheet(turned_assembly, moved(body.vertices, turned_assembly.poses[body.name][20]))
    poses = sheet_poses(turned_assembly, body.name)
    assert np.allclose(moved(to_sheet(turned_assembly, body.vertices), poses[20]), there, atol=1e-9)


def test_between_two_keys_a_pose_is_halfway(assembly: Assembly) -> None:
    poses = sheet_poses(assembly, "flap")
    for time in (0.0, 1.0):
        assert np.allclose(pose_at(assembly.times, poses, time), poses[-1 if time else 0])
    half = pose_at(assembly.times[::2], poses[::2], float(assembly.times[7]))
    assert np.allclose(half[:3, :3], poses[7, :3, :3], atol=1e-9)
