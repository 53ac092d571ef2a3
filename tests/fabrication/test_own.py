"""Panels and plates take the solid, or else the outline, of parts that came with a shape of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.model import Assembly, Body
from foldfab.fabrication.turning import PAST
from foldfab.folding.model import FoldSolution
from foldfab.folding.solve import solve
from foldfab.recipe.hinges import HingeKind
from foldfab.recipe.model import Look, Mesh, Part, Posture, Recipe
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


def bowed(part: Part, sagitta: float, thick: float) -> Mesh:
    """A closed strip along a part's longest side, `thick` mm, that bows by `sagitta` mm along its shortest one."""
    long, thin = int(np.argmax(part.size)), int(np.argmin(part.size))
    wide = 3 - long - thin
    steps = np.linspace(-0.5, 0.5, ROUND + 1)
    middle = sagitta * (0.5 - 4 * steps**2)
    outline = [*zip(steps * part.size[long], middle + thick / 2, strict=True)]
    outline += [*zip(steps[::-1] * part.size[long], middle[::-1] - thick / 2, strict=True)]
    vertices, faces = solids.mesh(solids.prism(outline, -part.size[wide] / 2, part.size[wide] / 2))
    points = np.zeros_like(vertices)
    points[:, long], points[:, wide], points[:, thin] = vertices[:, 0], vertices[:, 1], vertices[:, 2]
    return Mesh(
        part.center + points @ part.axes, faces if np.linalg.det(np.eye(3)[[long, wide, thin]]) > 0 else faces[:, ::-1]
    )


def thickness_at(made: Body, axis: int, place: tuple[float, float]) -> tuple[float, float]:
    """From where to where a body reaches along an axis, over a place in the other two."""
    solid = solids.from_mesh(made.vertices, made.faces)
    start, end = np.insert(np.array(place), axis, -500.0), np.insert(np.array(place), axis, 500.0)
    hits = [float(hit.position[axis]) for hit in solid.ray_cast(start.tolist(), end.tolist())]
    return min(hits), max(hits)


def test_a_base_keeps_its_relief_where_nothing_folds(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    top = next(p for p in table.parts if p.name == "top")
    own = made(table, scaffold, {"top": bowed(top, 3.0, 4.0)})
    z = top.center[2]
    assert thickness_at(body(own, "top"), 2, (0.0, 35.0))[1] == pytest.approx(z + 1.5 + 2.0, abs=0.1)
    assert thickness_at(body(own, "top"), 2, (95.0, 35.0))[1] == pytest.approx(z - 1.2 + 2.0, abs=0.15)
    assert [f.code for f in own.findings if f.code in ("plain", "outline")] == []


def test_a_panel_keeps_its_relief_within_its_layer_and_its_hinges(
    table: Recipe, scaffold: Callable[..., Scaffold]
) -> None:
    wall = next(p for p in table.parts if p.name == "left")
    bow = bowed(wall, 1.0, 2.5)
    plain, own = made(table, scaffold, {"left": bow}, "plain"), made(table, scaffold, {"left": bow})
    (name,) = (b.name for b in own.bodies if b.name.startswith("left"))
    x, middle, low = wall.center[0], wall.center[2], wall.center[2] - wall.size[2] / 2
    assert thickness_at(body(plain, name), 0, (10.0, middle)) == pytest.approx((x - 2, x + 2), abs=0.01)
    first, last = thickness_at(body(own, name), 0, (10.0, middle))
    assert last - first == pytest.approx(2.5, abs=0.1)
    assert abs((first + last) / 2 - x) == pytest.approx(0.5, abs=0.1)
    assert thickness_at(body(own, name), 0, (10.0, low + 1.0)) != pytest.approx((first, last), abs=0.2)
    for joint, was in zip(own.joints, plain.joints, strict=True):
        assert joint.stops == was.stops
        assert max(angle or 90.0 for angle in joint.stop_deg) <= PAST


def test_a_round_top_is_round(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    """An ellipse covers 79 % of its box, but nearly all of the plate is close to it."""
    top = next(p for p in table.parts if p.name == "top")
    plain, own = made(table, scaffold, {"top": disc(top)}, "plain"), made(table, scaffold, {"top": disc(top)})
    assert 0.7 < body(own, "top").volume / body(plain, "top").volume < 0.95
    assert [f.code for f in own.findings if "top" in f.text] == ["outline"]


def test_a_panel_whose_part_begins_late_still_hangs_on_its_hinge(
    table: Recipe, scaffold: Callable[..., Scaffold]
) -> None:
    wall = next(p for p in table.parts if p.name == "left")
    short = replace(wall, size=wall.size - [0.0, 0.0, 20.0])
    own = made(table, scaffold, {"left": bowed(short, 1.0, 3.0)})
    assert [f.code for f in own.findings if f.code in ("plain", "outline")] == []


def test_parts_of_one_base_that_only_touch_are_one_body(
    recipe: Callable[..., Recipe], scaffold: Callable[..., Scaffold], board_at: Callable[..., Part]
) -> None:
    parts = (*recipe("table").parts, board_at("leaf", 72, 60, 80, 130.5))
    table = recipe(parts)
    shapes = {p.name: bowed(p, 0.5, 3.0) for p in parts if p.name in ("top", "leaf")}
    own, plain = made(table, scaffold, shapes), made(table, scaffold, shapes, "plain")
    (base,) = (b.name for b in own.bodies if b.kind == "base")
    assert body(own, base).volume < 0.9 * body(plain, base).volume
    assert [f.code for f in own.findings if f.code in ("plain", "outline")] == []


def test_what_is_too_thin_keeps_its_outline_and_what_is_open_too(
    table: Recipe, scaffold: Callable[..., Scaffold]
) -> None:
    top = next(p for p in table.parts if p.name == "top")
    thin, whole = bowed(top, 1.0, 0.9), bowed(top, 1.0, 4.0)
    for shape, why in ((thin, "it is thin"), (Mesh(whole.vertices, whole.faces[1:]), "the mesh of top is not closed")):
        own = made(table, scaffold, {"top": shape})
        (told,) = (f.text for f in own.findings if f.code == "outline")
        assert told.startswith("top keeps only the outline") and why in told


def test_each_part_may_have_its_own_way(table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    top = next(p for p in table.parts if p.name == "top")

    def volume(print_: Look, part: Look | None) -> float:
        parts = tuple(replace(p, shape=bowed(p, 3.0, 4.0), look=part) if p is top else p for p in table.parts)
        wanted = replace(table, parts=parts, print=replace(table.print, shape=print_))
        return body(build(solve(scaffold(wanted)), "open"), "top").volume

    assert volume("plain", "own") == volume("own", None) != volume("plain", None)
    assert volume("own", "plain") == volume("plain", None)


@pytest.mark.parametrize("posture", ["folded", "edge", "plate"])
def test_own_shapes_in_other_postures(posture: Posture, table: Recipe, scaffold: Callable[..., Scaffold]) -> None:
    shapes = {p.name: bowed(p, 2.0, 4.0) for p in table.parts}
    parts = tuple(replace(p, shape=shapes[p.name]) for p in table.parts)
    hinge: HingeKind = "filament" if posture == "plate" else "cone"
    printing = replace(table.print, shape="own", posture=posture, hinge=hinge)
    solution = solve(scaffold(replace(table, parts=parts, print=printing)))
    own, plain = (build(replace_shape(solution, look), posture) for look in ("own", "plain"))
    assert any(b.volume != body(plain, b.name).volume for b in own.bodies)


def test_a_base_keeps_its_pockets_in_its_own_shape(
    recipe: Callable[..., Recipe], scaffold: Callable[..., Scaffold], pair: Callable[..., tuple[Part, ...]]
) -> None:
    parts = tuple(replace(p, shape=bowed(p, 0.0, 4.0)) if p.name == "ground" else p for p in pair(74))
    wanted = recipe(parts, slanting=False)
    solution = solve(scaffold(replace(wanted, print=replace(wanted.print, shape="own"))))
    assert solution.chain("three").pads[0] == pytest.approx(-1.4)
    own, plain = (build(replace_shape(solution, look), "open") for look in ("own", "plain"))
    assert body(own, "ground").volume != body(plain, "ground").volume
    assert not [f for f in own.findings if f.code in ("plain", "outline")]


def replace_shape(solution: FoldSolution, look: Look) -> FoldSolution:
    recipe = solution.scaffold.recipe
    kept = replace(recipe, print=replace(recipe.print, shape=look))
    return replace(solution, scaffold=replace(solution.scaffold, recipe=kept))
