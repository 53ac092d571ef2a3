"""A part is found again in a print file, however it was turned."""

import numpy as np

from foldfab.export.placed import is_within, placement
from foldfab.geometry.arrays import Array, Indices


def wedge() -> tuple[Array, Indices]:
    vertices = np.array([[0.0, 0, 0], [5, 0, 0], [0, 3, 0], [1, 1, 4]])
    return vertices, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def motion(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, 70], [0, 0, -1, 20], [s, c, 0, 3], [0, 0, 0, 1.0]])


def moved(mesh: tuple[Array, Indices], by: Array) -> tuple[Array, Indices]:
    return mesh[0] @ by[:3, :3].T + by[:3, 3], mesh[1]


def test_a_rigid_motion_is_found() -> None:
    for angle in (0.0, 0.3, np.pi / 2, 3.0):
        found = placement(wedge(), moved(wedge(), motion(angle)))
        assert found is not None and np.allclose(found, motion(angle), atol=1e-9)


def test_a_triangle_that_collapsed_in_one_file_does_not_matter() -> None:
    vertices, faces = moved(wedge(), motion(0.3))
    found = placement(wedge(), (vertices, faces[1:]))
    assert found is not None and np.allclose(found, motion(0.3), atol=1e-9)


def test_another_shape_or_a_mirrored_one_is_no_copy() -> None:
    mirrored = np.diag([-1.0, 1, 1, 1])
    assert placement(wedge(), moved(wedge(), mirrored)) is None
    assert placement(wedge(), (wedge()[0] * 1.01, wedge()[1])) is None
    assert placement(wedge(), (wedge()[0] * 1.01, wedge()[1][1:])) is None


def test_a_part_is_within_what_is_printed_of_it_only_where_it_lies() -> None:
    vertices, faces = moved(wedge(), motion(0.3))
    middle = vertices.mean(axis=0)
    larger = ((vertices - middle) * 1.2 + middle, faces)
    assert is_within(wedge(), (vertices, faces), motion(0.3))
    assert is_within(wedge(), larger, motion(0.3))
    assert not is_within(wedge(), larger, motion(0.5))
    assert not is_within((wedge()[0] * 1.05, wedge()[1]), (vertices, faces), motion(0.3))
