"""Every kind of fault is found in a mesh that has it, and in no sound one."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from manifold3d import Manifold

from foldfab.export.bed import on_bed
from foldfab.export.printability import Mesh, Printability, as_json, as_text, printability
from foldfab.fabrication.model import Assembly

ERRORS = ["open edges", "non-manifold edges", "backwards edges", "degenerate facets", "thin walls", "narrow gaps"]
NOTES = ["overhangs", "floating regions", "slivers"]
CLEARANCE = 0.3


def mesh(solid: Manifold, name: str = "body") -> Mesh:
    made = solid.to_mesh()
    return name, np.asarray(made.vert_properties, dtype=np.float64), np.asarray(made.tri_verts, dtype=np.int64)


def cube(x: float, y: float, z: float) -> Manifold:
    return Manifold.cube((x, y, z))


def counts(*meshes: Mesh) -> dict[str, float | None]:
    return {kind.name: kind.count for kind in printability(meshes, CLEARANCE).kinds}


def found(*meshes: Mesh) -> set[str]:
    return {name for name, count in counts(*meshes).items() if count}


def test_a_sound_body_has_nothing() -> None:
    report = printability([mesh(cube(10, 10, 5))], CLEARANCE)
    assert report.ok and report.errors == ()
    assert [kind.name for kind in report.kinds if kind.is_error] == ERRORS
    assert [kind.name for kind in report.kinds if not kind.is_error] == NOTES
    assert {kind.count for kind in report.kinds} == {0}


def test_open_edges() -> None:
    name, vertices, faces = mesh(cube(10, 10, 5))
    assert counts((name, vertices, faces[1:]))["open edges"] == 3
    report = printability([(name, vertices, faces[1:])], CLEARANCE)
    assert not report.ok and report.errors == ("open edges: 3, in body",)
    assert [kind.count for kind in report.kinds if kind.name in (*ERRORS[4:], *NOTES[:2])] == [None] * 4


def test_nonmanifold_edges() -> None:
    # A third triangle, both ways round, on an edge that has two.
    name, vertices, faces = mesh(cube(10, 10, 5))
    apex = len(vertices)
    a, b, _ = faces[0]
    fin = np.array([[a, b, apex], [b, a, apex]])
    assert found((name, np.vstack([vertices, [[20.0, 20, 20]]]), np.vstack([faces, fin]))) == {"non-manifold edges"}


def test_backwards_edges() -> None:
    name, vertices, faces = mesh(cube(10, 10, 5))
    flipped = faces.copy()
    flipped[0] = flipped[0, ::-1]
    assert counts((name, vertices, flipped))["backwards edges"] == 3
    assert counts((name, vertices, faces[:, ::-1]))["backwards edges"] == 18, "inside out"


def test_degenerate_facets() -> None:
    name, vertices, faces = mesh(cube(10, 10, 5))
    a, b, c = faces[0]
    middle = len(vertices)
    split = np.vstack([faces[1:], [[a, b, middle], [b, c, middle], [c, a, middle]]])
    on_edge = (vertices[a] + vertices[b]) / 2
    assert counts((name, np.vstack([vertices, [on_edge]]), split))["degenerate facets"] == 1
    nearly = on_edge + 5e-5 * (vertices[c] - on_edge) / np.linalg.norm(vertices[c] - on_edge)
    found = counts((name, np.vstack([vertices, [nearly]]), split))
    assert (found["degenerate facets"], found["slivers"]) == (0, 1)
    inside = (vertices[a] + vertices[b] + vertices[c]) / 3
    assert counts((name, np.vstack([vertices, [inside]]), split))["degenerate facets"] == 0


@pytest.mark.parametrize(("wall", "is_thin"), [(0.3, True), (0.44, True), (0.5, False), (2.0, False)])
def test_thin_walls(wall: float, is_thin: bool) -> None:
    cup = cube(10, 10, 8) - cube(10 - 2 * wall, 10 - 2 * wall, 8).translate((wall, wall, 2))
    assert ("thin walls" in found(mesh(cup))) == is_thin


def test_a_pointed_cone_is_no_thin_wall() -> None:
    assert "thin walls" not in found(mesh(Manifold.cylinder(5, 5, 0.01, 32)))


@pytest.mark.parametrize(("gap", "is_narrow"), [(0.05, True), (0.09, True), (0.11, False), (0.3, False)])
def test_narrow_gaps(gap: float, is_narrow: bool) -> None:
    pair = mesh(cube(10, 10, 5), "a"), mesh(cube(10, 10, 5).translate((10 + gap, 0, 0)), "b")
    assert ("narrow gaps" in found(*pair)) == is_narrow
    kind = next(kind for kind in printability(pair, CLEARANCE).kinds if kind.name == "narrow gaps")
    assert f"least {gap:.3f} mm, between a and b" in kind.text


@pytest.mark.parametrize(("out", "is_over"), [(10.0, True), (6.0, True), (5.0, False), (4.0, False)])
def test_overhangs(out: float, is_over: bool) -> None:
    """A wedge that grows by `out` mm over 5 mm of height."""
    points = [(0, 0, 0), (10, 0, 0), (10 + out, 0, 5), (0, 0, 5)]
    points += [(x, 10, z) for x, _, z in points]
    assert (counts(mesh(Manifold.hull_points(np.array(points, dtype=np.float64))))["overhangs"] != 0) == is_over


def test_an_overhang_over_a_gap_is_told_apart() -> None:
    plates = mesh(cube(10, 10, 5), "a"), mesh(cube(10, 10, 5).translate((0, 0, 5.3)), "b")
    kind = next(kind for kind in printability(plates, CLEARANCE).kinds if kind.name == "overhangs")
    assert kind.count == 100 and "100 of them less than 0.6 mm above a body" in kind.text


def test_floating_regions() -> None:
    """A body in the air, and one that hangs from an arm; neither a foot on the bed nor the bottom of a hole floats."""
    post, lid = cube(10, 10, 30), cube(40, 10, 5).translate((0, 0, 25))
    lamp = (post + lid) + cube(5, 5, 10).translate((30, 2, 15))
    assert counts(mesh(post + lid))["floating regions"] == 0
    assert counts(mesh(lamp))["floating regions"] == 1
    assert counts(mesh(post, "a"), mesh(cube(5, 5, 5).translate((50, 0, 12)), "b"))["floating regions"] == 1
    drilled = cube(10, 10, 10) - Manifold.cylinder(12, 2, 2, 32).rotate((90, 0, 0)).translate((5, 11, 5))
    assert counts(mesh(drilled))["floating regions"] == 0


@pytest.mark.parametrize(("gap", "count"), [(0.15, 0), (0.3, 1)])
def test_what_is_laid_onto_a_body_does_not_float(gap: float, count: int) -> None:
    assert (
        counts(mesh(cube(9, 9, 5), "a"), mesh(cube(9, 9, 5).translate((0, 0, 5 + gap)), "b"))["floating regions"]
        == count
    )


def test_the_table_and_the_json_say_the_same() -> None:
    name, vertices, faces = mesh(cube(10, 10, 5))
    for report in (
        printability([(name, vertices, faces)], CLEARANCE),
        printability([(name, vertices, faces[2:])], 0.3),
    ):
        data = json.loads(as_json(report, {"name": "cube"}))
        assert (data["name"], data["ok"], data["closed_gap_mm"]) == ("cube", report.ok, 0.098)
        assert [kind["name"] for kind in data["kinds"]] == [*ERRORS, *NOTES]
        text = as_text(report)
        assert all(kind.name in text for kind in report.kinds) and ("ERROR" in text) != report.ok


def test_a_print_that_is_written_has_no_errors(make: Callable[..., Assembly]) -> None:
    for posture in ("open", "folded"):
        shells = on_bed(make(posture=posture))
        report: Printability = printability([(s.name, s.vertices, s.faces) for s in shells], CLEARANCE)
        assert report.ok, as_text(report)
