"""Flat triangles go, the surface stays."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.geometry.flat_triangles import flipped, heights

TETRAHEDRON = np.array([[0.0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def split_side(points: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """The tetrahedron with points on the side from corner 0 to corner 1, which belong to one face's flat triangles."""
    vertices = np.vstack([TETRAHEDRON, [[x, 0.0, 0.0] for x in points]])
    chain = [0, *range(4, 4 + len(points)), 1]
    # One face keeps the long side; the other one is a fan over the pieces; flat triangles lie between.
    other = [[chain[i + 1], chain[i], 2] for i in range(len(chain) - 1)]
    return vertices, np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], *other, *_strip(chain)])


def _strip(chain: list[int]) -> list[list[int]]:
    """Flat triangles that close the seam between the long side and its pieces."""
    return [[1, chain[0], chain[1]], *([1, chain[i], chain[i + 1]] for i in range(1, len(chain) - 2))]


def is_closed(faces: np.ndarray) -> bool:
    edges = [tuple(sorted((int(f[i]), int(f[(i + 1) % 3])))) for f in faces for i in range(3)]
    directed = [(int(f[i]), int(f[(i + 1) % 3])) for f in faces for i in range(3)]
    return all(edges.count(e) == 2 for e in edges) and len(set(directed)) == len(directed)


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    c = vertices[faces]
    return float(np.einsum("ij,ij->", c[:, 0], np.cross(c[:, 1], c[:, 2])) / 6)


@pytest.mark.parametrize("points", [[1.0], [1.0, 2.0], [0.5, 1.5, 2.5]])
def test_the_same_closed_surface_without_flat_triangles(points: list[float]) -> None:
    vertices, faces = split_side(points)
    assert is_closed(faces) and heights(vertices[faces]).min() == 0.0
    made = flipped(vertices, faces, 1e-4)
    assert is_closed(made) and len(made) == len(faces)
    assert heights(vertices[made]).min() > 0.1
    assert volume(vertices, made) == pytest.approx(volume(vertices, faces))


def test_what_is_not_flat_stays_as_it_is() -> None:
    assert np.array_equal(flipped(TETRAHEDRON, FACES, 1e-4), FACES)


def test_a_row_that_cannot_be_flipped_is_left() -> None:
    """Two flat triangles back to back enclose nothing; there is nothing to flip them into."""
    vertices = np.array([[0.0, 0, 0], [2, 0, 0], [1, 0, 0]])
    faces = np.array([[0, 1, 2], [1, 0, 2]])
    assert np.array_equal(flipped(vertices, faces, 1e-4), faces)
