"""What a print has room for is asked for single pieces: on its bed, along its fold, and beside its hinges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.fabrication import solids
from foldfab.fabrication.judge import ROUNDING, Judge, beside, flaw
from foldfab.fabrication.model import Assembly
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import box
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.walls import LINE
from foldfab.recipe.model import Posture, Printer

HANGING = solids.box((40, -5, 60), (50, 5, 77))
"""Below the roof of the shelter, and of it: it comes straight down by 71.1 mm."""
AWAY = solids.box((60, -5, 60), (70, 5, 70))


@pytest.fixture(scope="module")
def shelter(assembled: Callable[..., Assembly]) -> Assembly:
    """160 × 80 × 88 mm as printed open: a ground and a roof on a wall that folds in the middle."""
    return assembled("shelter")


@pytest.fixture(scope="module")
def made(shelter: Assembly) -> dict[str, Solid]:
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in shelter.bodies}


@pytest.fixture(scope="module")
def judge(shelter: Assembly, made: dict[str, Solid]) -> Judge:
    return Judge(shelter, made)


@pytest.mark.parametrize(
    ("bed", "is_held"),
    [((200, 100, 88.1), True), ((100, 200, 88.1), True), ((200, 79, 88.1), False), ((160.1, 80.1, 88.1), False)],
)
def test_a_piece_has_to_fit_the_bed_with_all_the_rest_either_way_round(
    bed: tuple[float, float, float], is_held: bool, shelter: Assembly, made: dict[str, Solid]
) -> None:
    wing = solids.box((70, -5, 0), (90, 5, 2))
    assert Judge(on_bed(shelter, bed), made).fits("ground", wing) is is_held


def test_what_is_too_large_already_may_not_become_larger(shelter: Assembly, made: dict[str, Solid]) -> None:
    judge = Judge(on_bed(shelter, (100, 100, 100)), made)
    for beyond, is_held in ((-1.0, True), (ROUNDING / 2, True), (3 * ROUNDING, False)):
        assert judge.fits("ground", solids.box((0, 0, 0), (80 + beyond, 5, 2))) is is_held


def test_what_a_body_became_counts_for_what_fits(shelter: Assembly, made: dict[str, Solid]) -> None:
    judge = Judge(on_bed(shelter, (175, 100, 100)), made)
    wing, other = solids.box((-90, -5, 0), (-80, 5, 2)), solids.box((80, -5, 0), (90, 5, 2))
    assert judge.fits("ground", wing) and judge.fits("ground", other)
    judge.accept("ground", solids.union([made["ground"], wing]))
    assert judge.fits("ground", wing) and not judge.fits("ground", other)


def test_a_piece_is_looked_at_as_it_lies_in_print(assembled: Callable[..., Assembly]) -> None:
    folded = on_bed(assembled("shelter", "folded"), (500, 500, 50))
    made = {body.name: solids.from_mesh(body.vertices, body.faces) for body in folded.bodies}
    tower = solids.box((60, -5, 80), (70, 5, 110))
    # On the roof that lies on the ground it is 40 mm high, on the ground it would be 110.
    assert Judge(folded, made).fits("roof", tower)
    assert not Judge(folded, made).fits("ground", tower)


def test_on_edge_what_reaches_along_the_hinges_reaches_up(shelter: Assembly, made: dict[str, Solid]) -> None:
    wing, flat = solids.box((60, 35, 80), (70, 60, 81)), on_bed(shelter, (500, 500, 90))
    assert Judge(replace(flat, posture="folded"), made).fits("roof", wing)
    assert not Judge(replace(flat, posture="edge", up=np.array([0.0, 1.0, 0.0])), made).fits("roof", wing)


def test_parts_that_are_printed_apart_share_no_bed(shelter: Assembly, made: dict[str, Solid]) -> None:
    far, small = solids.box((0, 0, 0), (900, 5, 2)), on_bed(shelter, (100, 100, 100))
    assert Judge(replace(small, posture="plate"), made).fits("ground", far)
    assert not Judge(small, made).fits("ground", far)


def test_what_is_met_on_the_way_is_told_by_name(judge: Judge, made: dict[str, Solid]) -> None:
    on_the_way, beside_it = solids.box((40, -5, 20), (50, 5, 25)), solids.box((10, -5, 20), (20, 5, 25))
    bodies = {"roof": HANGING, "wall/1": beside_it, "ground": on_the_way, "wall/2": beside_it}
    assert list(judge.met("roof", HANGING, bodies)) == ["ground"]
    assert not judge.is_apart("roof", HANGING, bodies)
    assert judge.is_apart("roof", HANGING, {**bodies, "ground": beside_it})
    assert judge.is_apart("roof", HANGING, {})


def test_a_body_never_is_in_its_own_way(judge: Judge) -> None:
    assert judge.is_apart("roof", HANGING, {"roof": HANGING})
    assert not judge.is_apart("roof", HANGING, {"ground": HANGING})


def test_what_is_passed_between_two_instants_is_met_unless_it_is_not_asked_for(judge: Judge) -> None:
    down = judge.poses["roof"][:, 2, 3]
    k = int(np.abs(np.diff(down)).argmax())
    low = 60.0 + (down[k] + down[k + 1]) / 2 - 0.05
    plate, shelf = solids.box((40, -5, 60), (50, 5, 60.1)), solids.box((40, -5, low), (50, 5, low + 0.1))
    assert list(judge.met("roof", plate, {"ground": shelf})) == ["ground"]
    assert list(judge.met("roof", plate, {"ground": shelf}, in_between=False)) == []


@pytest.mark.parametrize(("posture", "key"), [("open", 0), ("folded", -1)])
@pytest.mark.parametrize("is_printed", [True, False])
@pytest.mark.parametrize("share", [0.5, 1.1])
def test_the_clearance_is_kept_where_bodies_stand_in_print(
    share: float, is_printed: bool, posture: Posture, key: int, shelter: Assembly, made: dict[str, Solid]
) -> None:
    judge, apart = Judge(replace(shelter, posture=posture), made), share * shelter.solution.thickness.gap
    # Beside the way of the piece; so far from it as printed, or else at the other end of the fold.
    way = judge.poses["roof"][key if is_printed else -1 - key, :3, 3]
    neighbour = solids.box((50 + apart, -5, 60), (55, 5, 61)).translate(way.tolist())
    piece = solids.box((40, -5, 60), (50, 5, 61))
    assert judge.is_apart("roof", piece, {"ground": neighbour}) is (share > 1 or not is_printed)


def test_one_piece_more_needs_room_on_the_bed_and_in_the_fold(shelter: Assembly, made: dict[str, Solid]) -> None:
    others = {"ground": solids.box((40, -5, 20), (50, 5, 25))}
    for bed, piece, is_had in (
        ((200.0, 100.0, 100.0), AWAY, True),
        ((200.0, 100.0, 100.0), HANGING, False),
        ((165.0, 100.0, 100.0), AWAY.translate((30, 0, 0)), False),
    ):
        assert Judge(on_bed(shelter, bed), made).has_room("roof", piece, others) is is_had


def test_a_hole_may_take_the_foot_of_its_own_hinge_alone(judge: Judge) -> None:
    foot, plate = solids.box((-3, -4, 1), (-1, 4, 5)), solids.box((-9, -4, 1), (-5, 4, 5))
    assert judge.is_spare(foot, "ground", "wall/1", {})
    assert not judge.is_spare(foot, "ground", "another", {})
    assert judge.is_spare(plate, "ground", "another", {})
    # At the same place in another body there is no foot.
    assert judge.is_spare(foot, "roof", "another", {})


def test_a_hole_may_not_take_what_is_in_it(judge: Judge) -> None:
    hole, rod = solids.box((30, -4, -2), (40, 4, 2)), solids.box((35, -1, -9), (36, 1, 9))
    assert judge.is_spare(hole, "ground", "wall/1", {"ground": rod, "wall/1": rod})
    assert not judge.is_spare(hole, "ground", "wall/1", {"ground": rod, "wall/2": rod})


def test_a_wall_thinner_than_a_line_is_noticed_where_it_is_looked_for(judge: Judge) -> None:
    plate = solids.box((0, 0, 0), (40, 40, 3))
    thin, thick = (solids.cut(plate, [solids.box((10, 10, z), (20, 20, 4))]) for z in (LINE / 2, 2 * LINE))
    assert judge.is_thinner("ground", thin, plate)
    assert not judge.is_thinner("ground", thick, plate)
    assert not judge.is_thinner("ground", thin, thin)
    here, there = (np.array([9, 9, -1.0]), np.array([21, 21, 1.0])), (np.array([30, 30, -1.0]), np.array([39, 39, 1.0]))
    assert judge.is_thinner("ground", solids.cut(thin, [solids.box((25, 0, -1), (26, 40, 4))]), plate, here)
    assert not judge.is_thinner("ground", solids.cut(thin, [solids.box((25, 0, -1), (26, 40, 4))]), plate, there)


def test_walls_are_looked_at_as_ramps_will_leave_them(shelter: Assembly, made: dict[str, Solid]) -> None:
    plate = solids.box((0, 0, 0), (40, 40, 3))
    slotted = solids.cut(plate, [solids.box((10, -1, -1), (11, 41, 2))])
    judge = Judge(shelter, made, {"ground": [box((10.3, -1.0, 1.0), (12.0, 41.0, 2.7))]})
    assert judge.is_thinner("ground", slotted, solids.box((0, 0, 0), (40, 40, 1)))
    assert not judge.is_thinner("roof", slotted, solids.box((0, 0, 0), (40, 40, 1)))


def test_a_piece_gets_a_pocket_in_what_it_enters(judge: Judge, shelter: Assembly) -> None:
    post, roof = solids.box((40, -5, 6), (44, 5, 11)), solids.box((-80, -40, 80), (80, 40, 84))
    hole = judge.pocket("ground", post, "roof", roof)
    assert hole is not None
    low, high = solids.bounds(printed(hole))
    gap = shelter.solution.thickness.gap
    assert (*low[:2], *high[:2]) == pytest.approx((40 - gap, -5 - gap, 44 + gap, 5 + gap))
    # The roof comes down by 71.1 mm: its lower face ends 2.1 mm below the top of the post.
    assert high[2] == pytest.approx(82.1 + gap, abs=0.05)
    assert low[2] < 80
    assert judge.pocket("ground", solids.box((40, -5, 4), (44, 5, 8)), "roof", roof) is None


@pytest.mark.parametrize(
    ("y", "lowest", "is_made"),
    [(-5.0, 82.5, False), (8.0, 82.5, True), (8.0, 80.0, False)],
    ids=["foot", "between feet and over the axis", "axis"],
)
def test_no_pocket_is_cut_into_a_hinge(y: float, lowest: float, is_made: bool, judge: Judge) -> None:
    post, roof = solids.box((-1, y, 6), (1, y + 4, 12)), solids.box((-80, -40, lowest), (80, 40, 90))
    assert (judge.pocket("ground", post, "roof", roof) is not None) is is_made
    aside = post.translate((20, 0, 0))
    assert judge.pocket("ground", aside, "roof", roof) is not None


def test_a_flaw_is_named() -> None:
    cube = solids.box((0, 0, 0), (1, 1, 1))
    assert flaw(cube) == ""
    assert flaw(solids.union([cube, cube.translate((3, 0, 0))])) == "falls apart"
    touching = solids.union([cube, cube.translate((1, 1, 0)), solids.box((0, 0, -1), (2, 2, 0.0))])
    assert flaw(touching) == "touches itself along an edge"


def test_beside_pieces_are_walls_of_a_line() -> None:
    low, high = beside([solids.box((0, 0, 0), (1, 1, 1)), solids.box((2, -3, 0), (3, 0, 1))])
    assert (*low, *high) == pytest.approx((-LINE, -3 - LINE, -LINE, 3 + LINE, 1 + LINE, 1 + LINE))


def on_bed(assembly: Assembly, size: tuple[float, float, float]) -> Assembly:
    """The same on another printer."""
    scaffold = assembly.solution.scaffold
    printing = replace(scaffold.recipe.print, printer=Printer("other", size))
    recipe = replace(scaffold.recipe, print=printing)
    return replace(assembly, solution=replace(assembly.solution, scaffold=replace(scaffold, recipe=recipe)))
