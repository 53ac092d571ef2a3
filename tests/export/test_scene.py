"""One picture: colours, edges and shadows."""

import numpy as np
import pytest

from foldfab.export import raster, scene, shadow
from foldfab.export.camera import Camera, fitted, pixels
from foldfab.export.shell import sheet_shells
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Bools

CAMERA = Camera(-34.0, 21.0)


@pytest.fixture
def heap(assembly: Assembly) -> scene.Model:
    return scene.model(sheet_shells(assembly))


def test_bodies_are_moved_each_by_its_own_pose(heap: scene.Model, assembly: Assembly) -> None:
    poses = np.array([assembly.poses[body.name][-1] for body in assembly.bodies])
    points = scene.posed(heap, poses)
    assert np.allclose(np.ptp(points, axis=0), [125, 50, 16.9], atol=1e-3)
    assert np.array_equal(scene.posed(heap, np.tile(np.eye(4), (5, 1, 1))), heap.points)


def test_foldable_parts_are_hidden_from_straight_above_when_flat(heap: scene.Model) -> None:
    window = fitted(heap.points, CAMERA, width=200, height=160, margins=(5, 5))
    side = scene.foldable_share(heap, heap.points, Camera(-90.0, 5.0), window)
    above = scene.foldable_share(heap, heap.points, Camera(-90.0, 89.0), window)
    assert side > 5 * above


def test_outlines_are_drawn_dark(heap: scene.Model) -> None:
    window = fitted(heap.points, CAMERA, width=200, height=160, margins=(5, 5))
    image = scene.draw(heap, heap.points, CAMERA, window, -4.0).astype(int)
    assert image.shape == (160, 200, 3)
    assert (image.max(axis=2) < 140).sum() > 300
    assert np.all(abs(image[0, 0] - scene.BACKGROUND) <= 1)


def test_a_plate_shades_the_one_below(heap: scene.Model, assembly: Assembly) -> None:
    floor, top = (next(i for i, body in enumerate(assembly.bodies) if body.name == name) for name in ("floor", "top"))
    both = _floor_light(heap, np.isin(heap.body, (floor, top)), floor)
    alone = _floor_light(heap, heap.body == floor, floor)
    assert alone > 0.8 and both < alone - 0.1


def _floor_light(heap: scene.Model, is_kept: Bools, floor: int) -> float:
    """Mean light that reaches the floor where it is seen from the front."""
    faces, body = heap.faces[is_kept], heap.body[is_kept]
    window = fitted(heap.points, CAMERA, width=200, height=160, margins=(5, 5))
    seen, depth = raster.visible(pixels(heap.points, CAMERA, window)[faces], window.height, window.width)
    a, b, c = (heap.points[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    light = shadow.is_lit(faces, heap.points, normals, seen, depth, CAMERA, window)
    upright = (seen != raster.NOTHING) & (body[seen] == floor) & (normals[seen][..., 2] > 0.99)
    return float(light[upright].mean())
