"""The cube as triangles."""

from __future__ import annotations

import numpy as np

from foldfab.geometry.cube import CORNERS, FACES


def test_it_is_closed_and_faces_outwards() -> None:
    a, b, c = (CORNERS[FACES[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == 8.0
    edges = {tuple(edge) for face in FACES.tolist() for edge in zip(face, face[1:] + face[:1], strict=True)}
    assert len(edges) == 36 and all((second, first) in edges for first, second in edges)
