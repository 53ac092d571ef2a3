"""Round bodies as triangles."""

from __future__ import annotations

import numpy as np
import pytest

from foldfab.intake.primitives import box, capsule, cylinder, ellipsoid
from foldfab.recipe.model import Mesh

HALF = np.array([1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("mesh", "half", "volume"),
    [
        (box(HALF), HALF, 48.0),
        (cylinder(2.0, 3.0), [2, 2, 3], np.pi * 4 * 6),
        (capsule(2.0, 3.0), [2, 2, 5], np.pi * 4 * 6 + 4 / 3 * np.pi * 8),
        (ellipsoid(HALF), HALF, 4 / 3 * np.pi * 6),
    ],
    ids=["box", "cylinder", "capsule", "ellipsoid"],
)
def test_exact_box_and_nearly_its_volume(mesh: Mesh, half: list[float], volume: float) -> None:
    assert mesh.vertices.min(0).tolist() == [-side for side in half]
    assert mesh.vertices.max(0).tolist() == list(half)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    found = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    assert 0.97 * volume < found <= volume * (1 + 1e-9)
