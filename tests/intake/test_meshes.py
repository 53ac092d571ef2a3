"""Shells, welding and damage."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from foldfab.errors import RecipeError
from foldfab.intake.meshes import body, distinct, joined, placed, shells
from foldfab.recipe.model import Mesh

from .furniture import box


def test_shells_come_apart_in_their_order() -> None:
    pieces = [box((x, 0, 0), (10, 10, 10)) for x in (50, 0, 100)]
    found = shells(joined(pieces))
    assert [piece.vertices.mean(0)[0] for piece in found] == [50, 0, 100]
    assert all(len(piece.faces) == 12 for piece in found)


def test_faces_with_vertices_of_their_own_hang_together() -> None:
    mesh = box((0, 0, 0), (10, 10, 10))
    soup = Mesh(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert shells(soup) == [soup]


@given(st.lists(st.tuples(*[st.integers(-2, 2)] * 3), min_size=1, max_size=30))
def test_distinct_rows(rows: list[tuple[int, int, int]]) -> None:
    given = np.array(rows, dtype=float)
    found, which = distinct(given)
    assert np.array_equal(found, np.unique(given, axis=0))
    assert np.array_equal(found[which], given)


def test_a_matrix_moves_a_mesh_and_nothing_leaves_it() -> None:
    mesh = box((0, 0, 0), (2, 2, 2))
    assert placed(mesh, np.eye(4)) is mesh
    matrix = np.diag([2.0, 2.0, 2.0, 1.0])
    matrix[:3, 3] = 5
    assert placed(mesh, matrix).vertices.min() == 3


def test_a_mesh_that_a_matrix_throws_away_is_refused() -> None:
    mesh = Mesh(np.full((3, 3), 1e200), np.array([[0, 1, 2]]))
    with pytest.raises(RecipeError, match="no place"):
        body("a.obj", "leg", np.full((3, 3), 1e200), mesh.faces)
