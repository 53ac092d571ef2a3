"""Postures: on edge, and each part for itself; what stands in their way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab import pipeline
from foldfab.errors import FabricationError, FoldingError
from foldfab.fabrication import soles, solids
from foldfab.fabrication.build import build
from foldfab.fabrication.inspect import inspect, is_captive, printed_extent
from foldfab.fabrication.lying import lying, to_support
from foldfab.fabrication.model import LEVEL, Assembly
from foldfab.fabrication.posture import bed_turn, edge_problem, hanging, needs_pins, printed_pose
from foldfab.slicing.profile import LAYER_MM, SUPPORT_DEG

LEAST_SUPPORTED = 0.1
"""PrusaSlicer supports islands of about this area, mm²."""
ROUNDING = 0.02
"""mm."""


@pytest.fixture(scope="module")
def standing() -> Assembly:
    return pipeline.fabricate(pipeline.foldabilize(pipeline.load("bench-legs", posture="edge")))


def test_on_edge_all_hinge_axes_are_vertical(standing: Assembly) -> None:
    assert standing.up is not None
    for joint in standing.joints:
        along = bed_turn(standing.up) @ printed_pose(standing, joint.parts[0])[:3, :3] @ (joint.axis[1] - joint.axis[0])
        assert np.allclose(along[:2], 0)
    assert printed_extent(standing)[2] == pytest.approx(np.ptp(standing.joints[0].axis, axis=0).max(), abs=0.01)


def test_ramps_take_material_away_and_nothing_else(standing: Assembly, monkeypatch: pytest.MonkeyPatch) -> None:
    # Edges on the bed are others when it lies.
    monkeypatch.setattr(soles, "_wedges", lambda *_: iter(()))
    plain = build(standing.solution, "folded")
    for body, was in zip(standing.bodies, plain.bodies, strict=True):
        assert body.volume < was.volume
        one, other = (solids.from_mesh(b.vertices, b.faces) for b in (body, was))
        assert solids.overlap(one, other) == pytest.approx(body.volume, rel=1e-4)


def test_on_edge_nothing_hangs_over_but_on_the_bed(standing: Assembly) -> None:
    turn = bed_turn(standing.up)

    def overhang(made: Assembly) -> float:
        total = 0.0
        for body in made.bodies:
            points = (body.vertices @ printed_pose(standing, body.name)[:3, :3].T) @ turn.T
            total += to_support(points - [0, 0, points[:, 2].min()], body)
        return total

    assert overhang(standing) < 0.02 * overhang(build(standing.solution, "folded"))


def test_no_corner_of_a_heel_is_left_below_a_ramp_where_a_panel_leans(assembled: Callable[..., Assembly]) -> None:
    made = assembled("tent", "edge")
    assert any("heel" in joint.stops for joint in made.joints)
    assert starting(made) < LEAST_SUPPORTED


def test_ramps_never_make_a_hinge_come_apart(assembled: Callable[..., Assembly]) -> None:
    made = assembled("stilts", "edge")
    (told,) = [finding.text for finding in made.findings if finding.code == LEVEL]
    assert "the undersides of top~leg-left stay flat" in told and "leg-right" not in told
    bodies = {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}
    for joint in made.joints:
        first, second = (bodies[part] for part in joint.parts)
        assert is_captive(first, second, joint.axis, joint.radius, made.solution.thickness.gap)


def test_hinges_that_mirror_each_other_are_each_pulled_at_on_edge(assembled: Callable[..., Assembly]) -> None:
    made = assembled("table", "edge")
    bodies = {body.name: solids.from_mesh(body.vertices, body.faces) for body in made.bodies}
    # What is left of one leg holds nothing any more; the other leg, of the same width, is whole.
    bodies["leg-right"] = solids.within(bodies["leg-right"], np.array([-500, -500, -500]), np.array([500, 500, 50]))
    found = [f for f in inspect(made, bodies, lambda share: None) if f.code == "loose"]
    assert [f.text.split()[0] for f in found] == ["top~leg-right"]


def test_what_begins_in_the_air_is_named(assembled: Callable[..., Assembly]) -> None:
    made = assembled("stilts", "edge")
    assert [body.name for body in made.propped] == ["leg-right"]
    assert hanging(made) == ["leg-left"]
    assert hanging(assembled("tent", "edge")) == []


def starting(made: Assembly) -> float:
    """The largest area, mm², that a layer of a body adds beyond what a slope of 40° carries, on edge."""
    stand = np.eye(4)
    stand[:3, :3] = bed_turn(made.up)
    worst = 0.0
    for body in made.bodies:
        solid = solids.from_mesh(body.vertices, body.faces)
        solid = solids.moved(solid, stand @ printed_pose(made, body.name))
        low, high = (float(corner[2]) for corner in solids.bounds(solid))
        layers = [solids.section(solid, float(z)) for z in np.arange(low + LAYER_MM / 2, high, LAYER_MM)]
        carried = [solids.grown(layer, LAYER_MM / np.tan(np.radians(SUPPORT_DEG))) for layer in layers]
        fresh = [solids.grown(o - under, -ROUNDING) for under, o in zip(carried[:-1], layers[1:], strict=True)]
        worst = max([worst, *(layer.area() for layer in fresh)])
    return worst


def test_axes_that_are_not_parallel_are_named() -> None:
    solution = pipeline.foldabilize(pipeline.load("bench"))
    assert edge_problem(solution) is not None
    with pytest.raises(FabricationError, match="are not parallel"):
        build(solution, "edge")
    with pytest.raises(FoldingError, match="are not parallel"):
        pipeline.foldabilize(pipeline.load("bench", posture="edge"))


def test_loose_parts_need_pins_and_get_them() -> None:
    assert [p for p in ("open", "folded", "edge", "plate") if needs_pins(p)] == ["plate"]  # type: ignore[arg-type]
    solution = pipeline.foldabilize(pipeline.load("bench-legs", posture="plate"))
    assert solution.thickness.hinge == "filament"
    with pytest.raises(FoldingError, match="at least 4 mm"):
        pipeline.foldabilize(pipeline.load("hexagon-shelf", posture="plate"))
    with pytest.raises(FabricationError, match="print in place only"):
        build(pipeline.foldabilize(pipeline.load("bench-legs")), "plate")


def test_a_part_lies_on_its_side_with_less_to_support(standing: Assembly) -> None:
    for body in standing.bodies:
        points = lying(body)
        assert points[:, 2].min() == 0.0
        upside_down = points * [1, -1, -1]
        assert to_support(points, body) <= to_support(upside_down - [0, 0, upside_down[:, 2].min()], body) + 0.1


def test_a_part_above_the_bed_gets_a_prop_in_the_print_only() -> None:
    made = pipeline.fabricate(pipeline.foldabilize(pipeline.load("bed", posture="edge")))
    bodies = {body.name: body for body in made.bodies}
    assert made.propped
    assert all(body.name.startswith("leg-") for body in made.propped)
    assert all(body.volume > bodies[body.name].volume for body in made.propped)
    assert replace(made, propped=()).bodies == made.bodies


def test_what_is_a_little_wider_is_planed_flush() -> None:
    made = pipeline.fabricate(pipeline.foldabilize(pipeline.load("desk-shelf", posture="edge")))
    assert not made.propped
    assert [f.code for f in made.findings if f.code == "planed"] == ["planed"]
    turn = bed_turn(made.up)
    low = [
        float((body.vertices @ (turn @ printed_pose(made, body.name)[:3, :3]).T)[:, 2].min()) for body in made.bodies
    ]
    assert max(low) - min(low) < 0.02
