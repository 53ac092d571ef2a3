"""Panels and plates take the outline of parts that came with a shape of their own, where that holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication.build import build
from foldfab.fabrication.model import Assembly, Body
from foldfab.folding.model import FoldSolution
from foldfab.folding.solve import solve
from foldfab.recipe.model import Mesh, Part, Recipe
from foldfab.scaffold.model import Scaffold

ROUND = 24


def disc(part: Part, share: float = 1.0) -> Mesh:
    """An ellipse that fills the two long sides of a part's box by a share, as two fans of triangles."""
    thin = int(np.argmin(part.size))
    u, v = (k for k in range(3) if k != thin)
    angle = 2 * np.pi * np.arange(ROUND) / ROUND
    points = np.zeros((ROUND + 1, 3))
    points[:ROUND, u] = share * part.size[u] / 2 * np.cos(angle)
    points[:ROUND, v] = share * part.size[v] / 2 * np.sin(angle)
    faces = np.array([[i, (i + 1) % ROUND, ROUND] for i in range(ROUND)])
    return Mesh(part.center + points @ part.axes, faces)


@pytest.fixture
def table(recipe: Callable[..., Recipe]) -> Recipe:
    return recipe("table")


def made(table: Recipe, scaffold: Callable[..., Scaffold], shapes: dict[str, Mesh], shape: str = "own") -> Assembly:
    parts = tuple(replace(p, shape=shapes.get(p.name)) for p in table.parts)
    wanted = replace(table, parts=parts, print=replace(table.print, shape=shape))  # type: ignore[arg-type]
    solution: FoldSolution = solve(scaffold(wanted))
    return build(solution, "open")


def body(assembly: Assembly, name: str) -> Body:
    return next(b for b in assembly.bodies if b.name == name)


def test_a_plate_gets_the_outline_of_its_part(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    top = next(p for p in table.parts if p.name == "top")
    shapes = {"top": disc(top, 1.1)}
    plain, own = made(table, scaffold, shapes, "plain"), made(table, scaffold, shapes)
    lost = 1 - body(own, "top").volume / body(plain, "top").volume
    assert 0.02 < lost < 0.2
    assert np.ptp(body(own, "top").vertices, axis=0) == pytest.approx(
        np.ptp(body(plain, "top").vertices, axis=0), abs=0.1
    )
    assert not [f for f in own.findings if f.code == "plain"]


def test_a_panel_keeps_its_plain_plate_around_its_hinge(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    wall = next(p for p in table.parts if p.name == "left")
    shapes = {"left": disc(wall, 1.15)}
    plain, own = made(table, scaffold, shapes, "plain"), made(table, scaffold, shapes)
    name = next(b.name for b in own.bodies if b.name.startswith("left"))
    assert body(own, name).volume < 0.99 * body(plain, name).volume
    (joint,) = (j for j in own.joints if name in j.parts)
    near = [abs(b.vertices[:, 2] - joint.axis[0, 2]) < 2.0 for b in (body(own, name), body(plain, name))]
    widths = [np.ptp(b.vertices[n, 1]) for b, n in zip((body(own, name), body(plain, name)), near, strict=True)]
    assert widths[0] == pytest.approx(widths[1], abs=0.1)


def test_an_outline_that_leaves_too_little_is_told(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    top = next(p for p in table.parts if p.name == "top")
    own = made(table, scaffold, {"top": disc(top, 0.5)})
    plain = made(table, scaffold, {"top": disc(top, 0.5)}, "plain")
    assert body(own, "top").volume == body(plain, "top").volume
    assert any(f.code == "plain" and "top stays a plain plate" in f.text for f in own.findings)


def test_boxes_stay_plates(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    own, plain = made(table, scaffold, {}), made(table, scaffold, {}, "plain")
    assert [b.volume for b in own.bodies] == [b.volume for b in plain.bodies]
