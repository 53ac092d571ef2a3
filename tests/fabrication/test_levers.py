"""Base hinges are stopped open however thin their base is, wherever it ends and whatever else is on it."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.build import build
from foldfab.fabrication.levers import LIFT, heels, levers
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.mounts import Mount, mount
from foldfab.fabrication.printed import printed
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.turning import PAST, meets, turn
from foldfab.folding.model import FoldSolution
from foldfab.recipe.model import Part

THIN = [
    *itertools.product(("table", "same_way", "two_ways", "corner"), ("open",)),
    ("same_way", "edge"),
    ("roof", "edge"),
]
"""Furniture with plates of 3 mm, on which no tongue along its panel would be long enough, and how it is printed."""


@pytest.fixture(scope="session")
def hinge_at(solution: Callable[..., FoldSolution]) -> Callable[..., Mount]:
    """The mount of the first hinge of a chain in named furniture."""

    def at(name: str, thickness: float, lean: float | None = None) -> Mount:
        made = solution(name, thickness=thickness)
        found = mount(made, made.chains[0], 0)
        return found if lean is None else replace(found, lean=np.radians(lean))

    return at


@pytest.mark.parametrize(("name", "posture"), THIN)
def test_thin_plates_stop_at_both_ends(name: str, posture: str, solution: Callable[..., FoldSolution]) -> None:
    assembly = build(solution(name, thickness=3.0), posture)  # type: ignore[arg-type]
    made = as_solids(assembly)
    for joint, is_folded in itertools.product(assembly.joints, (False, True)):
        a, b = joint.parts
        range_ = turn(joint, assembly.poses[a], assembly.poses[b])
        assert meets(range_, made[a], made[b], PAST, is_folded=is_folded), (joint.name, is_folded)
        assert not meets(range_, made[a], made[b], 0.0, is_folded=is_folded)
    assert all(angle is not None and angle <= PAST for joint in assembly.joints for angle in joint.stop_deg)
    assert "stop" not in {finding.code for finding in assembly.findings}


@pytest.mark.parametrize("name", ["same_way", "corner"])
def test_what_a_body_is_made_of_has_its_lips_slots_and_pockets(
    name: str, solution: Callable[..., FoldSolution]
) -> None:
    assembly = build(solution(name, thickness=3.0), "open")
    for body, solid in as_solids(assembly).items():
        assert printed(assembly.shapes[body]).volume() == pytest.approx(solid.volume(), abs=0.01)


def test_a_tongue_leans_where_its_base_is_thin(hinge_at: Callable[..., Mount]) -> None:
    thick, thin = (tongues(hinge_at("t_scaffold", thickness))[0] for thickness in (4.0, 3.0))
    assert solids.bounds(thick)[0][0] == pytest.approx(-2.0)
    # 0.95 of 0.3 mm at 2.75°.
    low = solids.bounds(thin)[0]
    assert np.hypot(*solids.mesh(thin)[0][:, [0, 2]].T).max() > 0.285 / np.sin(np.radians(2.75)) > -low[2]
    assert low[0] < -3.5


@pytest.mark.parametrize(("thickness", "lean"), list(itertools.product((3.0, 4.0), (-30.0, -10.0, 0.0, 10.0, 30.0))))
def test_no_tongue_comes_out_below_its_base_while_it_folds(
    thickness: float, lean: float, hinge_at: Callable[..., Mount]
) -> None:
    here = hinge_at("t_scaffold", thickness, lean)
    for tongue in tongues(here):
        x, z = solids.mesh(tongue)[0][:, [0, 2]].T
        # From open on it turns by a quarter and its lean; what points forward comes by below the axis.
        for turned in np.radians(np.linspace(0.0, 90.0 - lean, 60)):
            lowest = (z * np.cos(turned) - x * np.sin(turned)).min()
            assert lowest >= -(here.depth - LIFT) - 0.01


def test_a_tongue_beyond_the_edge_of_its_base_gets_a_lip(
    solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    parts = (board_at("top", 72, 164), wall_at("left", -80, 0, 72), wall_at("right", 80, 0, 72))
    made = build(solution(parts, thickness=3.0), "open")
    assert [(j.stops, j.stop_deg[0]) for j in made.joints] == [(("tongue",), 3.0)] * 2
    low, high = solids.bounds(as_solids(made)["top"])
    assert low[0] < -83.5 and high[0] > 83.5


def test_a_lip_is_as_wide_as_what_it_holds(hinge_at: Callable[..., Mount]) -> None:
    stop = next(s for s in levers(hinge_at("t_scaffold", 3.0), is_latched=False) if s.lip is not None)
    assert stop.lip is not None
    (low, high), (tip, end) = (solids.bounds(printed(shape)) for shape in (stop.lip, stop.added))
    assert high[1] - low[1] == pytest.approx(end[1] - tip[1])


def test_an_arm_lies_where_a_slot_would_cut_the_foot_of_another_hinge(
    solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    boards = board_at("low", 0), board_at("middle", 64), board_at("high", 128)
    wide = wall_at("a", -4, 0, 64)
    narrow = (wall_at("b", x, 64, 128, depth=15) for x in (0.0, -8.0))
    beside, clear = (build(solution((*boards, wide, wall)), "open").joints for wall in narrow)
    assert {j.name: j.stops for j in beside}["middle~b"] == ("arm",)
    assert {j.name: j.stops for j in clear}["middle~b"] == ("tongue",)
    assert all(j.stop_deg[0] is not None and j.stop_deg[0] <= PAST for j in (*beside, *clear))


def test_a_post_stands_behind_a_leg_on_a_bar_that_others_need_whole(
    solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    legs = [wall_at(f"{k}", 0, low, low + 64, depth=8) for k, low in enumerate((0, 64, 128))]
    bars = [board_at(f"bar {k}", 64 * k, 9, 80) for k in (1, 2)]
    made = build(solution((board_at("low", 0), *bars, *legs, board_at("high", 192))), "open")
    on_bars = [joint for joint in made.joints if any(part.startswith("bar") for part in joint.parts)]
    assert len(on_bars) == 4 and sum("post" in joint.stops for joint in on_bars) >= 2
    assert all(j.stop_deg[0] is not None and j.stop_deg[0] <= PAST for j in made.joints)


@pytest.mark.parametrize("lean", [-30.0, 0.0, 30.0])
def test_a_post_is_one_piece_a_clearance_behind_its_panel(lean: float, hinge_at: Callable[..., Mount]) -> None:
    here = hinge_at("t_scaffold", 4.0, lean)
    posts = [printed(stop.added) for stop in levers(here, is_latched=False) if stop.kind == "post"]
    assert len(posts) == len(here.marks.carrier)
    for post in posts:
        x, z = solids.mesh(post)[0][:, [0, 2]].T
        above = x * np.sin(here.lean) + z * np.cos(here.lean) > 2.0
        behind = (x * np.cos(here.lean) - z * np.sin(here.lean))[above]
        assert solids.pieces(post) == 1 and above.any()
        assert behind.max() == pytest.approx(-2.285)


@pytest.mark.parametrize("lean", [-60.0, -30.0, -12.0, 0.0, 12.0])
def test_a_heel_stays_within_the_layer_of_its_panel(lean: float, hinge_at: Callable[..., Mount]) -> None:
    here = hinge_at("t_scaffold", 3.0, lean)
    found = [printed(stop.added) for stop in heels(here)]
    assert bool(found) is (lean > -60.0)
    for heel in found:
        x, z = solids.mesh(heel)[0][:, [0, 2]].T
        assert (x * np.cos(here.lean) - z * np.sin(here.lean)).min() >= -1.5 - 1e-6
        # It does not touch its base, which it nears by 3° of its own length.
        assert -here.thickness.axis_height < z.min() < 0.04 - here.thickness.axis_height


def tongues(here: Mount) -> list[Solid]:
    """The solids of all tongues that a hinge may have."""
    return [printed(stop.added) for stop in levers(here, is_latched=False) if stop.kind == "tongue"]


def as_solids(assembly: Assembly) -> dict[str, Solid]:
    """The bodies of an assembly, as the kernel knows them."""
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in assembly.bodies}


def test_a_base_whose_edge_on_the_bed_stops_a_hinge_keeps_it(solution: Callable[..., FoldSolution]) -> None:
    made = build(solution("corner", thickness=3.0), "open")
    assert "ground" in made.spared
    ground = next(body for body in made.bodies if body.name == "ground")
    solid = solids.from_mesh(ground.vertices, ground.faces)
    low = float(ground.vertices[:, 2].min())
    assert solid.slice(low + 0.1).area() == pytest.approx(solid.slice(low + 0.5).area(), rel=1e-3)
    assert all(angle is not None and angle <= PAST for joint in made.joints for angle in joint.stop_deg)
