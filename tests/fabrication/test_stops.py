"""Hinges are stopped at both ends, tried by turning them on; and a hinge without its stop is found."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.inspect import inspect
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.panels import panels
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stops import Stop, rests, stops
from foldfab.fabrication.trial import Trial
from foldfab.fabrication.turning import PAST, meets, turn
from foldfab.fabrication.walls import LINE, thin_sides
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

CASES = list(itertools.product(("shelter", "table"), ("open", "folded", "edge")))


@pytest.mark.parametrize(("name", "posture"), CASES)
def test_every_hinge_meets_material_past_its_range_and_none_within(
    name: str, posture: str, assembled: Callable[..., Assembly]
) -> None:
    assembly = assembled(name, posture)
    made = as_solids(assembly)
    for joint in assembly.joints:
        a, b = joint.parts
        range_ = turn(joint, assembly.poses[a], assembly.poses[b])
        for is_folded in (False, True):
            assert meets(range_, made[a], made[b], PAST, is_folded=is_folded), (joint.name, is_folded)
            assert not meets(range_, made[a], made[b], 0.0, is_folded=is_folded)
        for k in range(len(assembly.times)):
            relative = np.linalg.inv(assembly.poses[a][k]) @ assembly.poses[b][k]
            assert solids.overlap(made[a], solids.moved(made[b], relative)) <= 0.01
    assert all(angle is not None and angle <= PAST for joint in assembly.joints for angle in joint.stop_deg)
    assert "stop" not in {finding.code for finding in assembly.findings}


@pytest.mark.parametrize(("name", "posture"), CASES)
def test_a_hinge_without_its_stop_is_found(name: str, posture: str, assembled: Callable[..., Assembly]) -> None:
    assembly = assembled(name, posture)
    plain = without_stops(assembly)
    told = [f.text for f in inspect(assembly, plain, lambda _: None) if f.code == "stop"]
    assert any("past where it stands open" in text for text in told)
    if name == "shelter":
        assert any("past straight" in text for text in told)


def test_open_prints_get_levers_and_folded_ones_close_faces(assembled: Callable[..., Assembly]) -> None:
    kinds = {
        posture: {k for j in assembled("shelter", posture).joints for k in j.stops} for posture in ("open", "folded")
    }
    assert {"tongue", "lap"} <= kinds["open"]
    assert {"heel", "butt"} <= kinds["folded"]


@pytest.mark.parametrize("name", ["slanted_t", "slanted_h", "same_way"])
def test_the_slot_of_a_panel_that_leans_leaves_no_skin_below_it(
    name: str, solution: Callable[..., FoldSolution]
) -> None:
    for joint in build(solution(name), "open").joints:
        assert joint.stops == ("tongue",)
        assert joint.stop_deg[0] is not None and joint.stop_deg[0] <= PAST


@pytest.mark.parametrize("x", [-93.3, -93.1, -92.9])
def test_a_slot_close_to_the_edge_of_its_base_is_opened_there(
    x: float, solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    made = build(solution((board_at("top", 0), wall_at("leg", x, 0, 72))), "open")
    (joint,) = made.joints
    assert joint.stop_deg[0] is not None and joint.stop_deg[0] <= PAST
    assert all(thin_sides(body) == 0 for body in as_solids(made).values())


@pytest.mark.parametrize("height", [22.0, 24.0])
def test_a_lap_goes_right_through_a_panel_that_is_too_short_for_a_wall_beyond_it(
    height: float, solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    boards = board_at("bottom", 0), board_at("top", height + 4)
    found = solution((*boards, wall_at("wall", 0, 0, height + 4)), slanting=False)
    assembly = build(found, "open")
    (joint,) = [j for j in assembly.joints if j.is_inserted]
    assert joint.stops == ("lap",)
    assert joint.stop_deg[0] is not None and joint.stop_deg[0] <= PAST
    assert all(thin_sides(body) == 0 for body in as_solids(assembly).values())


def test_a_rest_on_edge_has_a_ramp_below_it(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("shelter", "edge")
    assert assembly.up is not None
    chain = assembly.solution.chain("wall")
    (tilted, *_) = rests(assembly.solution, chain, 0, assembly.up)
    vertices, faces = solids.mesh(printed(tilted.added))
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    down = (normals / np.linalg.norm(normals, axis=1, keepdims=True)) @ -assembly.up
    # All that looks down is the root, which is within the plate's own foot, and a ramp steeper than 45°.
    root = chain.root[0] + chain.panel / 2 * np.array([-1.0, 1.0])
    flat = corners[down > np.sqrt(0.5)][..., 0]
    assert len(flat) and ((flat >= root[0] - 1e-6) & (flat <= root[1] + 1e-6)).all()


def test_a_lap_is_whole_where_it_meets_and_lays_little_over_its_recess(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("shelter")
    (first, *_) = stops(assembly.solution, assembly.solution.chain("wall"), 1, in_open=True)
    made = printed(first.added)
    low, high = solids.bounds(made)
    # The face that meets is the one towards the axis; its edges are where the lap ends.
    axis = next(joint.axis for joint in assembly.joints if joint.name == first.joint)
    sides = [(low[0], high[0]), (high[0], low[0])]
    near, far = min(sides, key=lambda side: abs(side[0] - axis[0][0]))
    vertices = solids.mesh(made)[0]
    meeting, outer = (vertices[np.abs(vertices[:, 0] - x) < 1e-6] for x in (near, far))
    assert np.allclose(np.ptp(meeting, axis=0)[1:], (high - low)[1:])
    taper = abs(far - near) - LINE
    assert np.ptp(outer, axis=0)[1:] == pytest.approx((high - low)[1:] - [2 * taper, taper])
    tip, root = sorted(solids.section(made, z).area() for z in (low[2] + 0.01, high[2] - 0.01))
    assert tip < 0.35 * root


def test_a_stop_without_room_is_not_made(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("shelter")
    chain = assembly.solution.chain("wall")
    made = without_stops(assembly)
    trial = Trial(assembly, made)
    (first, *_) = stops(assembly.solution, chain, 1, in_open=True)
    assert has_room(trial, first)
    low, high = solids.bounds(printed(first.added))
    blocked = {**made, "roof": solids.union([made["roof"], pillar(made["roof"], low, high)])}
    assert not has_room(Trial(assembly, blocked), first)


def test_a_folded_panel_without_a_base_below_gets_a_rest(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("shelter")
    chain = assembly.solution.chain("wall")
    (rest, *_) = rests(assembly.solution, chain, 0)
    face = solids.bounds(without_stops(assembly)["wall/1"])[0][2] - assembly.solution.thickness.gap
    assert rest.body == "ground"
    assert solids.bounds(printed(rest.added))[1][2] == pytest.approx(face, abs=0.02)
    assert list(rests(assembly.solution, chain, 1)) == []


def has_room(trial: Trial, stop: Stop) -> bool:
    """Whether a stop can be made."""
    fitted = trial.fitted(stop)
    return fitted is not None and trial.has_room(fitted)


def as_solids(assembly: Assembly) -> dict[str, Solid]:
    """The bodies of an assembly, as the kernel knows them."""
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in assembly.bodies}


def without_stops(assembly: Assembly) -> dict[str, Solid]:
    """The same with panels as they are before they get stops."""
    made = as_solids(assembly)
    for chain in assembly.solution.chains:
        plain = panels(chain, assembly.solution.thickness)
        made.update((name, solids.tidied(printed(shape))) for name, shape in zip(chain.panels, plain, strict=True))
    return made


def pillar(roof: Solid, low: np.ndarray, high: np.ndarray) -> Solid:
    """Something that hangs from the roof down beside where a stop would be."""
    top = solids.bounds(roof)[0][2] + 1.0
    return solids.box((low[0] - 1.0, low[1], low[2]), (low[0] - 0.1, high[1], top))
