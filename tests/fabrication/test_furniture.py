"""The furniture's own solids stand where their plates are, and what is not closed is no solid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.furniture import own_solid, placed_mesh
from foldfab.fabrication.printed import printed
from foldfab.geometry.arrays import Array, Indices
from foldfab.recipe.model import Mesh, Part, Recipe
from foldfab.scaffold.model import Scaffold

UP = np.array([0.0, 0.0, 1.0])
TILT = np.radians(10.0)
LEANING = np.array([[np.cos(TILT), 0.0, np.sin(TILT)], [0.0, 1.0, 0.0], [-np.sin(TILT), 0.0, np.cos(TILT)]])


def wedge(axes: Array) -> tuple[Array, Indices]:
    """A body of 2400 mm³ around the origin, 40 mm long along the first of three axes (rows)."""
    vertices, faces = solids.mesh(solids.prism([(-20, -2), (20, -2), (20, 2), (-20, 2)], -7.5, 7.5))
    return vertices @ axes, faces


@pytest.fixture
def with_top(recipe: Callable[..., Recipe], scaffold: Callable[..., Scaffold]) -> Callable[..., tuple[Scaffold, Part]]:
    """A table, and its top with this mesh around its middle, in a box with these axes."""

    def make(vertices: Array, faces: Indices, axes: Array) -> tuple[Scaffold, Part]:
        (top,) = (p for p in recipe("table").parts if p.name == "top")
        return scaffold("table"), replace(top, axes=axes, shape=Mesh(vertices + top.center, faces), look="own")

    return make


def test_what_leans_is_levelled_as_its_plate_is(with_top: Callable[..., tuple[Scaffold, Part]]) -> None:
    scaffold, top = with_top(*wedge(LEANING), LEANING)
    points, _ = placed_mesh(scaffold, top, UP)
    assert np.ptp(points, axis=0) == pytest.approx([40.0, 15.0, 4.0])
    assert points.mean(0) == pytest.approx(top.center)


def test_a_closed_mesh_is_a_solid_whichever_way_it_is_turned(with_top: Callable[..., tuple[Scaffold, Part]]) -> None:
    vertices, faces = wedge(np.eye(3))
    for some in (faces, faces[:, ::-1]):
        solid = own_solid(*with_top(vertices, some, np.eye(3)), UP)
        assert solid is not None
        assert printed(solid).volume() == pytest.approx(2400.0)


def test_corners_that_exports_write_for_each_face_are_one(with_top: Callable[..., tuple[Scaffold, Part]]) -> None:
    vertices, faces = wedge(np.eye(3))
    apart = np.arange(faces.size).reshape(-1, 3)
    solid = own_solid(*with_top(vertices[faces.reshape(-1)] + 1e-7, apart, np.eye(3)), UP)
    assert solid is not None


def test_an_open_mesh_is_none_and_so_is_one_with_a_face_turned(with_top: Callable[..., tuple[Scaffold, Part]]) -> None:
    vertices, faces = wedge(np.eye(3))
    turned = np.concatenate([faces[:1, ::-1], faces[1:]])
    for some in (faces[1:], turned):
        assert own_solid(*with_top(vertices, some, np.eye(3)), UP) is None
