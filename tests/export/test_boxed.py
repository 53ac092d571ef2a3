"""Pictures of a solution before there are solids."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
from PIL import Image

from foldfab.export.boxed import folded_png, shells_of
from foldfab.export.page import CELL, HEAD
from foldfab.folding.kinematics import size_at
from foldfab.folding.model import FoldSolution
from foldfab.geometry.closed import is_closed

Make = Callable[..., FoldSolution]


def test_every_body_is_there_closed_and_as_large_as_the_solver_knows_it(solution: Make) -> None:
    made = solution("chair")
    shells = shells_of(made)
    names = [base.name for base in made.scaffold.bases] + [name for chain in made.chains for name in chain.panels]
    assert [shell.name for shell in shells] == names
    assert all(is_closed(shell.faces) for shell in shells)
    assert all(volume(shell.vertices, shell.faces) > 0 for shell in shells)
    assert sum(bool(shell.is_hinge.any()) for shell in shells) == sum(m.hinges for m in made.modifications)
    size = np.ptp(np.vstack([shell.vertices for shell in shells]), axis=0)
    assert np.allclose(size, size_at(made, 0.0, made.scaffold.rotation.T), atol=1.01)


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Of a closed mesh, mm³; positive where its faces look outwards."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_open_beside_flat_with_the_direction(solution: Make) -> None:
    data = folded_png(solution("h_scaffold"), "stool along -z", "facts")
    assert data == folded_png(solution("h_scaffold"), "stool along -z", "facts")
    pixels = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)
    assert pixels.shape == (505, 1000, 3)
    drawn = (pixels.min(axis=2) < 200)[HEAD + 1 : HEAD + CELL[1] - 40]
    heights = [np.ptp(np.flatnonzero(half.any(axis=1))) for half in (drawn[:, 120 : CELL[0]], drawn[:, CELL[0] :])]
    assert heights[1] < 0.8 * heights[0]
    ink = (pixels.max(axis=2) < 60)[HEAD:, :]
    # Down, in the corner of the open picture alone.
    corner = ink[290:380, 20:90]
    assert np.ptp(np.flatnonzero(corner.any(axis=1))) > 50 > np.ptp(np.flatnonzero(corner.any(axis=0)))
    assert not ink[290:380, CELL[0] + 20 : CELL[0] + 90].any()
