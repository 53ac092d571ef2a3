"""What can be printed, and small chains and furniture to fabricate."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from manifold3d import Error, Manifold, Mesh

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.model import Assembly, Body
from foldfab.fabrication.solids import Solid
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.solve import solve
from foldfab.geometry.arrays import Array, Indices
from foldfab.recipe.model import FoldOptions, Part, Posture, Printer, PrintOptions, Recipe
from foldfab.scaffold.abstract import abstract
from foldfab.scaffold.model import BasePatch, Outline

BIG = Printer("big", (500.0, 500.0, 500.0))
LEAN = np.radians(30.0)
RECIPES: dict[str, tuple[Part, ...]] = {
    "tent": (
        Part("ground", np.array([0, 0, 0]), np.array([160, 60, 4]), np.eye(3)),
        Part("roof", np.array([0, 0, 84]), np.array([160, 60, 4]), np.eye(3)),
        Part(
            "wall",
            np.array([0, 0, 42]),
            np.array([4, 60, 80 / np.cos(LEAN)]),
            np.array([[np.cos(LEAN), 0, -np.sin(LEAN)], [0, 1, 0], [np.sin(LEAN), 0, np.cos(LEAN)]]),
        ),
    ),
    "shelter": (
        Part("ground", np.array([0, 0, 0]), np.array([160, 80, 4]), np.eye(3)),
        Part("roof", np.array([0, 0, 84]), np.array([160, 80, 4]), np.eye(3)),
        Part("wall", np.array([0, 0, 42]), np.array([4, 60, 80]), np.eye(3)),
    ),
    "stilts": (
        Part("top", np.array([0, 0, 70]), np.array([200, 70, 4]), np.eye(3)),
        Part("leg-left", np.array([-90, 0, 34]), np.array([4, 14.3, 68]), np.eye(3)),
        Part("leg-right", np.array([90, 0, 34]), np.array([4, 64, 68]), np.eye(3)),
    ),
    "table": (
        Part("top", np.array([0, 0, 70]), np.array([200, 70, 4]), np.eye(3)),
        Part("leg-left", np.array([-90, 0, 34]), np.array([4, 60, 68]), np.eye(3)),
        Part("leg-right", np.array([90, 0, 34]), np.array([4, 60, 68]), np.eye(3)),
    ),
}


@pytest.fixture(scope="session")
def assert_printable() -> Callable[[Solid | Body], None]:
    """Asserts that a solid, or the mesh of a body, is what a slicer wants."""
    return check_printable


@pytest.fixture(scope="session")
def assembled() -> Callable[..., Assembly]:
    """The assembly of `shelter` (a wall that folds in the middle), `tent` (one that leans) or `table` (legs)."""
    return cache(make_assembly)


@pytest.fixture(scope="session")
def make_chain() -> Callable[..., Chain]:
    """A chain that stands on a base whose upper face is at K/2: `lengths`, `width`, `turn`, `pad`."""
    return free_chain


@pytest.fixture(scope="session")
def make_base() -> Callable[..., BasePatch]:
    """A base with its mid-sheet at 0 from rectangles (x, y, half length, half width)."""
    return flat_base


def check_printable(thing: Solid | Body) -> None:
    """Closed, one body, of positive volume, and still closed after a file has rounded it to 32 bits."""
    vertices, faces = (thing.vertices, thing.faces) if isinstance(thing, Body) else solids.mesh(thing)
    rounded = np.asarray(vertices, np.float32)
    solid = Manifold(Mesh(rounded, np.asarray(faces, np.uint32)))
    assert solid.status() == Error.NoError
    assert solid.volume() > 0
    assert len([part for part in solid.decompose() if part.volume() > 0]) == 1
    assert has_closed_edges(*welded(rounded, faces))


def welded(vertices: Array, faces: Indices) -> tuple[Array, Indices]:
    """Vertices that are equal become one, as a reader of STL does it; triangles that vanish are left out."""
    unique, index = np.unique(vertices, axis=0, return_inverse=True)
    renamed = index.reshape(-1)[faces]
    a, b, c = renamed.T
    return unique, renamed[(a != b) & (b != c) & (c != a)]


def has_closed_edges(vertices: Array, faces: Indices) -> bool:
    """Whether every edge is passed as often one way as the other."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward, backward = (np.sort(edges @ np.array(w)) for w in ([len(vertices), 1], [1, len(vertices)]))
    return len(faces) > 0 and bool((forward == backward).all())


def make_recipe(name: str, **options: Any) -> Recipe:
    """The recipe of one of `RECIPES` at scale 1, with options of the print."""
    printing = PrintOptions(**{"printer": BIG, "scale": 1.0, **options})
    return Recipe(name, np.array([0.0, 0.0, -1.0]), RECIPES[name], FoldOptions(slanting=False), printing)


def make_assembly(name: str, posture: Posture = "open", **options: Any) -> Assembly:
    """One of `RECIPES`, fabricated."""
    recipe = make_recipe(name, posture=posture, **options)
    return build(solve(abstract(recipe, np.array([0.0, 0.0, -1.0]), 1.0)), posture)


def free_chain(
    thickness: Thickness,
    *,
    lengths: tuple[float, ...] = (30.0,),
    width: float = 30.0,
    turn: float = np.pi / 2,
    pad: float = 0.0,
) -> Chain:
    """A T-scaffold's chain at the origin, x across and y along, with hinges as wide as its panels."""
    inserted = -np.sign(turn) * np.where(np.arange(len(lengths) - 1) % 2 == 0, 1.0, -1.0) * thickness.axis_offset
    span = np.array([-width / 2, width / 2])
    return Chain(
        patch="leg",
        anchor="ground",
        far=None,
        mechanism="in-place",
        root=np.array([0.0, 0.0, thickness.panel / 2 + thickness.axis_height + pad]),
        across=np.array([1.0, 0.0, 0.0]),
        along=np.array([0.0, 1.0, 0.0]),
        rise=np.array([0.0, 0.0, 1.0]),
        lean=0.0,
        turn=turn,
        lengths=np.array(lengths),
        offsets=np.concatenate([[0.0], inserted, [0.0]]),
        span=span,
        hinge_spans=np.tile(span, (len(lengths) + 1, 1)),
        pads=(pad, 0.0),
        panel=thickness.panel,
    )


def flat_base(*rectangles: tuple[float, float, float, float]) -> BasePatch:
    """A base of rectangles."""
    outlines = tuple(
        Outline(f"part-{i}", np.array([x, y]), np.array([1.0, 0.0]), np.array([half_x, half_y]))
        for i, (x, y, half_x, half_y) in enumerate(rectangles)
    )
    return BasePatch("ground", tuple(o.part for o in outlines), 0.0, 0.0, outlines)
