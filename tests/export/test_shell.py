"""Rounding to the file's grid keeps meshes closed."""

from collections.abc import Sequence

import numpy as np
import pytest

from foldfab.export.faults import DEGENERATE_MM
from foldfab.export.shell import FLAT_MM, bounds, sheet_shells, snapped
from foldfab.fabrication.model import Assembly, Body
from foldfab.geometry import flat_triangles
from foldfab.geometry.closed import is_closed
from foldfab.geometry.flat_triangles import flipped, heights


def _body(vertices: Sequence[Sequence[float]], faces: list[list[int]]) -> Body:
    return Body("b", "panel", np.array(vertices), np.array(faces), np.array([0.0, 0, 1]), 1.0, np.array([0]))


@pytest.fixture
def needle() -> Body:
    """A tetrahedron whose base edge was split into a piece of 1e-7 mm."""
    vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1e-7, 0.0, 0.0]]
    faces = [[0, 2, 4], [4, 2, 1], [0, 4, 3], [4, 1, 3], [1, 2, 3], [2, 0, 3]]
    return _body(vertices, faces)


def test_collapsed_triangles_are_dropped_together(needle: Body) -> None:
    assert is_closed(needle.faces)
    shell = snapped(needle, needle.vertices)
    assert len(shell.vertices) == 4 and len(shell.faces) == 4 and is_closed(shell.faces)
    assert len(shell.is_hinge) == 4 and not shell.is_hinge.any()


def test_what_is_nearly_flat_is_not_made_quite_flat(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a row of needles lies another that ends on their line: flipped, one has no area left."""
    monkeypatch.setattr(flat_triangles, "ROUNDS", 1)
    ends = np.array([[0, 0], [5.94, 0.0246], [5.755, 0.0246], [5.7475, 0.0246], [5.74, 0.0246]])
    low, high = (np.insert(ends, 1, depth, axis=1) for depth in (0.0, 4.0))
    fan = np.array([[0, k, k + 1] for k in range(1, 4)])
    walls = [[[k, k + 5, j], [j, k + 5, j + 5]] for k, j in zip(range(5), [1, 2, 3, 4, 0], strict=True)]
    faces = np.concatenate([fan, fan[:, ::-1] + 5, np.array(walls).reshape(-1, 3)])
    body = _body(np.concatenate([low, high]).tolist(), faces.tolist())
    assert heights(body.vertices[flipped(body.vertices, body.faces, FLAT_MM)]).min() < DEGENERATE_MM
    made = snapped(body, body.vertices)
    assert is_closed(made.faces) and heights(made.vertices[made.faces]).min() > DEGENERATE_MM


def test_sheets_that_would_touch_stay_apart_by_index() -> None:
    one = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    two = [[i + 4 for i in face] for face in one]
    vertices = 2 * [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    body = _body(vertices, one + [face[::-1] for face in two] + one)
    shell = snapped(body, body.vertices)
    assert len(shell.vertices) == 8 and len(shell.faces) == 12


def test_every_value_is_a_float_of_32_bits(turned_assembly: Assembly) -> None:
    for shell in sheet_shells(turned_assembly):
        assert np.array_equal(shell.vertices, shell.vertices.astype(np.float32).astype(float))
        assert is_closed(shell.faces)


def test_bounds(assembly: Assembly) -> None:
    low, high = bounds(sheet_shells(assembly))
    assert np.allclose(low, [-50, -5, -4]) and np.allclose(high[:2], [75, 45])


def test_open_and_empty_meshes_are_not_closed() -> None:
    assert not is_closed(np.zeros((0, 3), dtype=np.int64))
    assert not is_closed(np.array([[0, 1, 2]]))
