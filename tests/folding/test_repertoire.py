"""What the patches of a unit can do: lanes that start open, end flat, and are made once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from foldfab.folding import anatomy
from foldfab.folding.basic import Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.lanes import Lane, upright
from foldfab.folding.mechanism import reach
from foldfab.folding.nominal import CLIMB, FRAMES
from foldfab.folding.press import follow_down
from foldfab.folding.problem import Problem, without
from foldfab.folding.repertoire import (
    ROOM_THICKNESSES,
    Repertoire,
    awkwardness,
    cuts_of,
    far_shift,
    lane,
    resting,
    stops_early,
    swept,
)
from foldfab.folding.scene import open_scene
from foldfab.folding.unit_fold import UnitFold, fold_unit
from foldfab.geometry.boxes import bounds
from foldfab.recipe.model import Part

from .every import whole

Make = Callable[..., Problem]
IN_PLACE = Variant("in-place", 1, "r")
K = 4.0


def only(made: Problem) -> Repertoire:
    (unit,) = made.units
    return whole(made, unit)


def lanes_of(own: Repertoire, patch: str, mechanism: str, hinges: int) -> list[Lane]:
    return [x for x in own.plain[patch] if (x.variant.mechanism, x.variant.hinges) == (mechanism, hinges)]


def test_every_variant_that_fits_has_a_lane(problem: Make) -> None:
    own = only(problem("h_scaffold"))
    found = {(x.variant.mechanism, x.variant.hinges, x.variant.side) for x in own.plain["leg"]}
    assert found == {(m, n, s) for m, n in (("slanted", 0), ("in-place", 1), ("in-place", 3)) for s in "lr"}
    assert [x.number for x in own.lanes] == list(range(6)) and len(own.movers) == 6


def test_a_repertoire_and_its_lanes_are_made_once(problem: Make) -> None:
    made = problem("h_scaffold")
    own = only(made)
    assert only(made) is own
    first = own.plain["leg"][0]
    assert lane(made, own, "leg", first.variant) is first
    raised = lane(made, own, "leg", replace(IN_PLACE, pads=(5.0, 0.0)))
    assert raised is not None and raised.number == 6 and own.lanes[6] is raised
    assert lane(made, own, "leg", replace(IN_PLACE, pads=(5.0, 0.0))) is raised


def test_a_variant_whose_panels_would_be_too_short_has_no_lane(problem: Make) -> None:
    made = problem("h_scaffold")
    own = only(made)
    assert lane(made, own, "leg", replace(IN_PLACE, pads=(70.0, 0.0))) is None
    assert len(own.lanes) == 6


def test_what_was_banned_is_no_variant(problem: Make) -> None:
    made = problem("h_scaffold")
    own = only(replace(made, banned=frozenset({("leg", IN_PLACE)}), repertoires={}))
    assert IN_PLACE not in {x.variant for x in own.plain["leg"]} and len(own.lanes) == 5


def test_a_ban_forgets_nothing_of_other_units(problem: Make) -> None:
    made = problem("tower")
    scene, (a, b) = open_scene(made), (made.unit_of["a"], made.unit_of["b"])
    for unit in (a, b):
        fold_unit(made, scene, unit)
    other = without(made, frozenset({("a", IN_PLACE)}))
    assert repertoire(other, b) is repertoire(made, b) and repertoire(other, a) is not repertoire(made, a)
    assert {key[0][0] for key in other.solved} == {b}
    assert {key: found for key, found in made.solved.items() if key[0][0] is b} == other.solved
    assert isinstance(found := fold_unit(other, scene, a), UnitFold)
    assert found.chosen["a"].variant != IN_PLACE
    # What is allowed again is as it was, and not as it is remembered from while it was banned.
    assert repertoire(without(other, frozenset()), a).plain.keys() == repertoire(made, a).plain.keys()
    assert {x.variant for x in repertoire(without(other, frozenset()), a).plain["a"]} == {
        x.variant for x in repertoire(made, a).plain["a"]
    }


@pytest.mark.parametrize("name", ["h_scaffold", "slanted_h", "deep_box", "t_scaffold", "chair"])
def test_a_lane_starts_as_high_as_it_stood_open_and_ends_flat(problem: Make, name: str) -> None:
    """Until the snap of accordions is over their bases stand still."""
    made = problem(name)
    for unit in made.units:
        own = whole(made, unit)
        for x in own.lanes:
            start, end = own.movers[x.number][x.active.start], own.movers[x.number][x.active.stop - 1]
            for frame, over in ((0, np.zeros(1)), (CLIMB, follow_down(x.chain, np.zeros(1)))):
                if frame == 0 or x.snap > 0:
                    assert reach(x.chain, over)[0, 1] == pytest.approx(reach(x.chain, np.zeros(1))[0, 1], abs=1e-3)
                    expected = anatomy.moving_boxes(x.chain, made.thickness, over)
                    count = expected.center.shape[1]
                    assert start.center[frame, :count] == pytest.approx(expected.center[0], abs=1e-6)
            panels = end.axes[-1, : len(x.chain.lengths)]
            assert np.abs(panels[:, 0, 2]) == pytest.approx(np.ones(len(panels)), abs=1e-6)
            # Where no base comes down, nothing waits for snaps.
            assert len(start.center) == (FRAMES if len(unit.bases) > 1 else FRAMES - CLIMB)


def test_a_slanted_lane_drags_its_base_along_an_arc_and_the_others_do_not(problem: Make) -> None:
    own = only(problem("h_scaffold"))
    for x in lanes_of(own, "leg", "slanted", 0):
        assert x.drag is not None and not x.drag[0].any()
        assert x.drag[-1] == pytest.approx(x.way)
        side = 1 if x.variant.side == "r" else -1
        assert side * x.way @ x.chain.across == pytest.approx(80 - 2 * 2.3)
        assert x.way @ x.chain.rise == pytest.approx(-(80 - 2 * 2.3))
    for x in lanes_of(own, "leg", "in-place", 1):
        assert x.drag is None and x.way[:2] == pytest.approx([0, 0]) and x.snap > 0


def test_a_thick_stack_stops_its_far_base_before_the_nominal_fold_does(problem: Make) -> None:
    own = only(problem("h_scaffold"))
    (thin, _), (thick, _) = (lanes_of(own, "leg", "in-place", n) for n in (1, 3))
    assert not stops_early(own, thin) and stops_early(own, thick)
    nominal = own.nominal.down["ceiling"][0]
    assert far_shift(own, thin, "ceiling", 0)[:, 2] == pytest.approx(nominal)
    assert far_shift(own, thick, "ceiling", 0)[:, 2] == pytest.approx(np.maximum(nominal, nominal[-1] + 2 * 4.3))
    assert not far_shift(own, thick, "ground", 0).any()


def test_a_slanted_lane_takes_its_far_base_with_it(problem: Make) -> None:
    own = only(problem("h_scaffold"))
    (slanted, _) = lanes_of(own, "leg", "slanted", 0)
    assert slanted.drag is not None
    assert (far_shift(own, slanted, "ceiling", 0) == slanted.drag).all()
    assert not far_shift(own, slanted, "ground", 0).any()
    assert not stops_early(own, slanted)


def test_lanes_fold_in_the_sections_in_which_their_bases_come_together(problem: Make, levels: tuple[Part, ...]) -> None:
    own = only(problem(levels))
    active = {p: {(x.active.start, x.active.stop) for x in own.plain[p]} for p in ("lower", "upper", "side")}
    assert active == {"upper": {(0, 1)}, "lower": {(1, 2)}, "side": {(0, 2)}}


def test_a_lane_rests_open_before_it_folds_and_folded_on_its_base_after(
    problem: Make, levels: tuple[Part, ...]
) -> None:
    made = problem(levels)
    own = only(made)
    (lower, *_), (upper, *_) = own.plain["lower"], own.plain["upper"]
    before = resting(made, own, [lower], 0)
    assert before is not None and resting(made, own, [upper], 0) is None
    still = np.zeros((1, 3))
    standing, _ = anatomy.swept_boxes([anatomy.Ride(lower.chain, np.zeros(1), still, still)], made.thickness)
    assert before.boxes.center == pytest.approx(np.broadcast_to(standing.center, before.boxes.center.shape))
    behind = resting(made, own, [upper], 1)
    assert behind is not None and resting(made, own, [lower], 1) is None
    last, down = own.movers[upper.number][0], upright(own.nominal.down["middle"][1])
    assert behind.boxes.center == pytest.approx(last.center[-1:] + down[:, None])


def test_sweeps_are_half_a_gap_wider_than_what_moves(problem: Make) -> None:
    made = problem("h_scaffold")
    own = only(made)
    found = swept(made, own, own.lanes[2:4], 0)
    assert found is not None and set(found.lane.tolist()) == {2, 3}
    mover = own.movers[2][0]
    grown = found.boxes.half[:, found.lane == 2] - mover.half
    assert grown == pytest.approx(np.full(grown.shape, made.thickness.gap / 2), abs=2e-3)
    assert swept(made, own, [], 0) is None


def test_cuts_share_the_width_and_the_outermost_pieces_hold_the_gap(problem: Make) -> None:
    own = only(problem("h_scaffold", shrink_steps=4))
    for cuts in cuts_of(own):
        assert cuts[1:-1] == pytest.approx([-15, 0, 15])
        assert cuts[0] < -30 and cuts[-1] > 30


@pytest.mark.parametrize("name", ["h_scaffold", "slanted_h", "deep_box", "box_with_table", "chair", "t_scaffold"])
def test_all_that_is_swept_is_in_reach_as_seen_from_every_base(problem: Make, name: str) -> None:
    made = problem(name)
    margin = ROOM_THICKNESSES * 4.3
    for unit in made.units:
        first = {x.number for x in repertoire(made, unit).lanes}
        own = whole(made, unit)
        for x in own.lanes:
            for section, boxes in own.movers[x.number].items():
                low, high = bounds(boxes)
                for base in unit.bases:
                    shift = far_shift(own, x, base, section)[:, None]
                    assert x.reach is not None
                    own_least, own_most = (corners[unit.bases.index(base)] for corners in x.reach)
                    assert (low - shift >= own_least).all() and (high - shift <= own_most).all()
                    least, most = own.reach[base]
                    # Lanes that were not needed at first may take up some of the room for plinths.
                    spare = margin - 1.0 if x.number in first else K / 2
                    assert (low - shift >= least + spare).all() or stops_early(own, x)
                    assert (high - shift <= most - spare).all()


def test_awkward_is_what_leaves_the_furniture_and_what_stands_high(problem: Make) -> None:
    made = problem("h_scaffold")
    own = only(made)
    (inside, _), (slanted, _) = lanes_of(own, "leg", "in-place", 1), lanes_of(own, "leg", "slanted", 0)
    raised = lane(made, own, "leg", replace(inside.variant, pads=(5.0, 0.0)))
    assert raised is not None
    about = partial(pytest.approx, abs=1e-4)
    none, out, high = awkwardness(made, (inside, slanted, raised), np.zeros(3)).tolist()
    size = float(np.linalg.norm(made.outline[1] - made.outline[0]))
    # The ceiling is dragged as far to the side as the leg is long.
    assert none == 0.0 and out == about((80 - 2 * 2.3) / size) and high == about(2 * 5.0 / size)
    for away in (150.0, -150.0):
        (carried,) = awkwardness(made, (inside,), np.array([away, 0.0, 0.0])).tolist()
        assert carried == about(150.0 / size)


def test_what_would_leave_the_outline_is_known(problem: Make) -> None:
    """The back of the deep box would stick out of its depth with one hinge and not with three."""
    own = only(problem("deep_box"))
    assert all(x.is_out for x in lanes_of(own, "back", "in-place", 1))
    assert not any(x.is_out for x in lanes_of(own, "back", "in-place", 3))


def test_units_of_many_bases_keep_no_reach_for_each(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("foldfab.folding.lanes.FEW_BASES", 1)
    assert all(x.reach is None for x in only(problem("h_scaffold")).lanes)
