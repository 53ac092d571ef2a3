"""A lock pin holds on the solids, without it the hinge is free, and where there is no room for one that is told."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from foldfab.export.check import inspect_folder
from foldfab.export.write import write
from foldfab.fabrication import latching, solids
from foldfab.fabrication.build import build
from foldfab.fabrication.latches import (
    ACROSS,
    ALONG,
    FILAMENT,
    HOLDS_WITHIN,
    Lock,
    Tongue,
    held_at,
    is_free,
    is_seated,
    lock,
    moment,
)
from foldfab.fabrication.model import Assembly, Joint
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import box, common, cut, union
from foldfab.fabrication.solids import Solid
from foldfab.fabrication.stops import Stop, bolts, stops
from foldfab.fabrication.trial import Trial
from foldfab.fabrication.turning import rotation, turn_sign
from foldfab.folding.model import FoldSolution
from foldfab.folding.solve import solve
from foldfab.recipe.model import Part
from foldfab.report import summary
from foldfab.scaffold.abstract import abstract

UPRIGHT = Tongue(lean=0.0, back=2.0, thick=2.2, reach=6.1, low=0.0, high=5.0)
"""That of a plate of 4 mm, whose outer face is 6.3 mm below the axis."""


@pytest.mark.parametrize("posture", ["open", "folded"])
@pytest.mark.parametrize("name", ["table", "shelter"])
def test_base_hinges_are_held_open(name: str, posture: str, assembled: Callable[..., Assembly]) -> None:
    assembly = assembled(name, posture, latch=True)
    bases = [joint for joint in assembly.joints if not joint.is_inserted]
    assert bases
    for joint in bases:
        assert joint.latch is not None
        assert 0 < joint.latch.holds_at <= HOLDS_WITHIN
        assert joint.latch.moment > 30
        assert joint.latch.base in joint.parts
        assert joint.stop_deg[0] is not None and joint.stop_deg[0] <= 3.0
    assert all(joint.latch is None for joint in assembly.joints if joint.is_inserted)
    assert "latch" not in {finding.code for finding in assembly.findings}


def test_nothing_is_latched_unasked(assembled: Callable[..., Assembly]) -> None:
    assert all(joint.latch is None for joint in assembled("table").joints)


@pytest.mark.parametrize("posture", ["open", "folded"])
def test_with_its_pin_a_hinge_is_held_and_without_it_is_free(posture: str, assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table", posture, latch=True)
    made = as_solids(assembly)
    for joint in assembly.joints:
        assert joint.latch is not None
        pin = rod_between(np.array(joint.latch.pin), FILAMENT / 2)
        assert max(solids.overlap(pin, solid) for solid in made.values()) < 0.01
        (panel,) = (part for part in joint.parts if part != joint.latch.base)
        base = made[joint.latch.base]
        for angle in (1.0, 0.5 * joint.range_deg[1], joint.range_deg[1]):
            assert solids.overlap(base, solids.moved(made[panel], turned(assembly, joint, panel, angle))) < 0.01
        held = turned(assembly, joint, panel, joint.latch.holds_at)
        assert solids.overlap(base, solids.moved(made[panel], held)) < 0.01
        # It is in the way, and not only touched.
        assert solids.overlap(pin, solids.moved(made[panel], held)) > 0.05
        on = turned(assembly, joint, panel, 8.0)
        assert solids.overlap(pin, solids.moved(made[panel], on)) > 2.0


def test_a_pin_lies_within_its_plate_and_is_held_by_its_mouth(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table", latch=True)
    made = as_solids(assembly)
    for joint in assembly.joints:
        assert joint.latch is not None
        ends, into = np.array(joint.latch.pin), np.array(joint.latch.into)
        base = made[joint.latch.base]
        low, high = solids.bounds(base)
        assert (ends.min(axis=0) - FILAMENT / 2 > low).all() and (ends.max(axis=0) + FILAMENT / 2 < high).all()
        # Pulled out, pressed deeper, along or sideways it meets the base.
        along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
        for way in (-into, into, along, -along, np.cross(along, into), np.cross(into, along)):
            assert solids.overlap(base, rod_between(ends + 0.3 * way, FILAMENT / 2)) > 0.05


def test_the_moment_is_the_least_of_four() -> None:
    area, section = np.pi * FILAMENT**2 / 4, np.pi * FILAMENT**3 / 32
    assert moment(5.0, 2.2, 5.0, 0.3) == pytest.approx(ACROSS * 5.0 * 2.2**2 / 6)
    assert moment(8.0, 9.0, 5.0, 0.3) == pytest.approx(12 / 8.6 * ALONG * section * 5.0)
    assert moment(1.2, 20.0, 5.0, 0.1) == pytest.approx(2 * ALONG / np.sqrt(3) * area * 5.0)
    made = lock(UPRIGHT, 6.3, 4.0, 0.3)
    assert made is not None
    assert made.moment == pytest.approx(ACROSS * 5.0 * 2.2**2 / 6)


@pytest.mark.parametrize("gap", [0.15, 0.3, 1.0])
def test_a_groove_leaves_half_the_clearance_or_a_tenth(gap: float) -> None:
    made = lock(replace(UPRIGHT, reach=8.1), 8.3, 6.0, gap)
    assert made is not None
    fit = max(gap / 2, 0.1)
    back = solids.box((-2.0, 0.0, -8.1), (0.2, 5.0, 0.0))
    assert solids.gap(printed(made.pin), back, 1.0) == pytest.approx(fit, abs=0.01)
    width = np.ptp([corner[0] for corner in solids.bounds(printed(made.groove))])
    assert FILAMENT + fit - 1e-6 <= width <= FILAMENT + fit + 0.02


@pytest.mark.parametrize(
    ("tongue", "depth", "plate"),
    [
        (UPRIGHT, 6.3, 2.7),
        (replace(UPRIGHT, reach=3.0), 6.3, 4.0),
        (replace(UPRIGHT, lean=np.radians(-12.0)), 6.3, 4.0),
        (replace(UPRIGHT, lean=np.radians(50.0)), 6.3, 4.0),
    ],
    ids=["thin plate", "short tongue", "leans forward", "leans far back"],
)
def test_no_lock_is_made_without_room(tongue: Tongue, depth: float, plate: float) -> None:
    assert lock(tongue, depth, plate, 0.3) is None


def test_a_pin_is_seated_where_all_around_its_groove_is_of_the_base() -> None:
    made = lock(UPRIGHT, 6.3, 4.0, 0.3)
    assert made is not None
    low, high = solids.bounds(printed(made.seats))
    base, groove = solids.box(low - 1, high + 1), printed(made.groove)
    assert is_seated(base, made)
    assert is_seated(solids.cut(base, [groove]), made)
    assert not is_seated(solids.box(low + 0.1, high + 1), made)
    assert not is_seated(solids.cut(base, [groove, solids.box(high - 0.5, high + 2)]), made)


def test_a_pin_goes_deeper_where_its_tongue_leans_back() -> None:
    leaning = lock(replace(UPRIGHT, lean=np.radians(12.0)), 6.3, 4.0, 0.3)
    upright = lock(UPRIGHT, 6.3, 4.0, 0.3)
    assert leaning is not None and upright is not None
    assert upright.ends[0, 2] < leaning.ends[0, 2] < upright.ends[0, 2] + 0.5


@pytest.fixture(scope="module")
def trial(assembled: Callable[..., Assembly]) -> Trial:
    """A table with all its stops and no latch."""
    assembly = assembled("table", "open", latch=False)
    return Trial(assembly, as_solids(assembly))


def test_a_lock_holds_only_where_its_tongue_passes(trial: Trial) -> None:
    stop, held = a_bolt(trial)
    range_, panel = trial.hinges.turns[stop.joint], solids.union([trial.made[stop.body], printed(stop.added)])
    is_first = next(j for j in trial.assembly.joints if j.name == stop.joint).parts[0] == stop.other
    assert held_at(range_, panel, held, is_base_first=is_first) is not None
    bare = solids.cut(panel, [solids.box(*grown(printed(held.pushed), 4.0))])
    assert held_at(range_, bare, held, is_base_first=is_first) is None


def test_what_lies_over_a_groove_leaves_no_room_for_its_pin(trial: Trial) -> None:
    _, held = a_bolt(trial)
    low, high = solids.bounds(printed(held.way))
    board = solids.box(low, high)
    far = board.translate((100.0, 0.0, 0.0))
    assert is_free([far], held)
    assert not is_free([far, board], held)


def test_nothing_that_is_made_later_takes_a_latch_away(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table")
    trial = Trial(assembly, as_solids(assembly))
    solution = assembly.solution
    tried = ((stop, trial.fitted(stop)) for stop in bolts(solution, solution.chains[0], 0))
    stop, fitted, made = next(
        (s, f, m) for s, f in tried if f is not None and (m := latching.latched(trial, f)) is not None
    )
    held = stop.lock
    assert held is not None and made.latch.base == "top"
    trial.take(fitted)
    latching.fasten(trial, stop, made)
    filled = union([trial.shapes["top"], common(held.groove, held.seats)])
    assert trial.reshape("top", filled) == f"leaves {stop.joint} without a latch"
    (low, high), through = solids.bounds(printed(held.seats)), np.array([0.0, 0.0, 1.0])
    behind = box(low - through, np.array([held.ends[0, 0], *high[1:]]) + through)
    assert trial.reshape("top", cut(trial.shapes["top"], [behind])) == f"leaves {stop.joint} without a latch"
    assert trial.reshape("top", trial.shapes["top"]) == ""


def test_seats_are_added_where_a_base_ends_early_unless_something_is_there(
    solution: Callable[..., FoldSolution], board_at: Callable[..., Part], wall_at: Callable[..., Part]
) -> None:
    parts = (board_at("top", 72, 160), wall_at("left", -78, 0, 72), wall_at("right", 78, 0, 72))
    made = latched(solution(parts))
    low, _ = solids.bounds(as_solids(made)["top"])
    for joint in made.joints:
        assert joint.latch is not None
        assert abs(joint.latch.pin[0][0]) > 80.0
    assert low[0] < -82.0
    for body, solid in as_solids(made).items():
        assert printed(made.shapes[body]).volume() == pytest.approx(solid.volume(), abs=0.01)


def test_a_latch_is_left_out_where_plates_are_thin_and_that_is_told(assembled: Callable[..., Assembly]) -> None:
    assembly = assembled("table", latch=True, thickness=2.0, clearance=0.2)
    assert all(joint.latch is None for joint in assembly.joints)
    (finding,) = (finding for finding in assembly.findings if finding.code == "latch")
    assert "no room for a lock pin" in finding.text and not finding.is_fatal


def test_on_edge_there_are_stops_but_no_latches(assembled: Callable[..., Assembly]) -> None:
    plain, asked = (assembled("table", "edge", latch=latch) for latch in (False, True))
    assert [joint.stops for joint in plain.joints] == [joint.stops for joint in asked.joints]
    assert all(joint.latch is None for joint in asked.joints)
    (finding,) = (finding for finding in asked.findings if finding.code == "latch")
    assert "other postures have it" in finding.text


def test_the_maker_is_told_how_long_and_where(assembled: Callable[..., Assembly], tmp_path: Path) -> None:
    made = assembled("table", latch=True)
    length = made.joints[0].latch.length if made.joints[0].latch else 0.0
    told = summary(made, tmp_path)
    assert f"cut pins of 1.75 mm filament (2 of {length:.1f} mm)" in told
    assert "outer faces of top" in told
    assert "1.75 mm filament" not in summary(assembled("table"), tmp_path)


SPOILT: dict[str, Callable[[dict[str, Any]], None]] = {
    "meets": lambda latch: latch["ends"].__setitem__(0, [x + 1.0 for x in latch["ends"][0]]),
    "lies in no groove": lambda latch: latch.update(ends=[[x, y, z + 50.0] for x, y, z in latch["ends"]]),
    "turns past its pin": lambda latch: latch.update(ends=shortened(*latch["ends"])),
}


def shortened(start: list[float], end: list[float]) -> list[list[float]]:
    """The ends of a pin that lies in its first seat alone."""
    return [start, [a + 0.2 * (b - a) for a, b in zip(start, end, strict=True)]]


@pytest.fixture(scope="module")
def folder(assembled: Callable[..., Assembly], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A latched table, written."""
    folder = tmp_path_factory.mktemp("latched") / "table"
    write(assembled("table", latch=True), folder)
    return folder


def test_check_tries_every_pin(folder: Path) -> None:
    inspection = inspect_folder(folder)
    assert inspection.ok
    assert "2 lock pins" in next(row.text for row in inspection.rows if row.code == "latches")


@pytest.mark.parametrize("problem", SPOILT)
def test_check_finds_a_pin_that_is_not_as_stated(problem: str, folder: Path) -> None:
    bad = [row for row in spoilt(folder, SPOILT[problem]) if not row.ok]
    assert [row.code for row in bad] == ["latches"]
    assert problem in bad[0].text


@pytest.mark.parametrize(
    "change",
    [
        {"base": "nobody"},
        {"pin_mm": 0},
        {"pin_mm": 50},
        {"holds_at_deg": 90},
        {"holds_at_deg": "x"},
        {"ends": [[0, 0]]},
    ],
    ids=str,
)
def test_check_refuses_a_latch_that_is_none(change: dict[str, Any], folder: Path) -> None:
    assert [row.code for row in spoilt(folder, lambda latch: latch.update(change)) if not row.ok] == ["sheet"]


def spoilt(folder: Path, change: Callable[[dict[str, Any]], None]) -> Any:
    """What the check says of a folder whose first latch is stated otherwise."""
    sheet = folder / "sheet.json"
    text = sheet.read_text()
    facts = json.loads(text)
    change(facts["joints"][0]["latch"])
    sheet.write_text(json.dumps(facts))
    try:
        return inspect_folder(folder).rows
    finally:
        sheet.write_text(text)


def latched(made: FoldSolution) -> Assembly:
    """The furniture of a solution, printed open with latches."""
    recipe = made.scaffold.recipe
    assert recipe.direction is not None
    recipe = replace(recipe, print=replace(recipe.print, latch=True))
    return build(solve(abstract(recipe, recipe.direction, 1.0)), "open")


def a_bolt(trial: Trial) -> tuple[Stop, Lock]:
    """A tongue of the first leg that a pin could hold."""
    solution = trial.assembly.solution
    stop = next(bolts(solution, solution.chains[0], 0))
    assert stop.lock is not None
    assert all(one.lock is None for one in stops(solution, solution.chains[0], 0, in_open=True))
    return stop, stop.lock


def turned(assembly: Assembly, joint: Joint, panel: str, degrees: float) -> Any:
    """(4, 4) a panel that is turned so far from open towards folded."""
    (base,) = (part for part in joint.parts if part != panel)
    way = np.linalg.inv(assembly.poses[base]) @ assembly.poses[panel]
    return rotation(joint.axis, np.radians(turn_sign(way, joint.axis) * degrees))


def grown(solid: Solid, by: float) -> tuple[Any, Any]:
    low, high = solids.bounds(solid)
    return low - by, high + by


def rod_between(ends: Any, radius: float) -> Solid:
    """A rod along the y axis of the print."""
    (x, low, z), (_, high, _) = sorted(ends.tolist(), key=lambda end: end[1])
    return solids.rod(radius, low, high, x, z)


def as_solids(assembly: Assembly) -> dict[str, Solid]:
    """The bodies of an assembly, as the kernel knows them."""
    return {body.name: solids.from_mesh(body.vertices, body.faces) for body in assembly.bodies}
