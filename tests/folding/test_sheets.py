"""What thickness leaves free but the paper's sheets do not is ruled out, and nothing else is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from foldfab.folding import realise, sheets, unit_fold
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.scene import open_scene, shown
from foldfab.folding.sheets import crossings
from foldfab.folding.surroundings import look
from foldfab.geometry.boxes import moved
from foldfab.recipe.model import Part
from foldfab.validity.verify import violations

Solutions = Callable[..., FoldSolution]


@pytest.fixture
def gate(wall_at: Any, board_at: Any) -> Callable[[float], tuple[Part, ...]]:
    """Two walls `apart` mm that can only fold towards each other: elbows reach 42 mm in as sheets, 39.7 as panels."""

    def made(apart: float) -> tuple[Part, ...]:
        walls = (wall_at("left", -apart / 2, 0, 84), wall_at("right", apart / 2, 0, 84))
        return (board_at("ground", 0, apart + 8), board_at("ceiling", 84, apart + 8), *walls)

    return made


def unaware(monkeypatch: pytest.MonkeyPatch) -> None:
    """Makes the solver look at panels only."""
    for room in (realise, unit_fold):
        monkeypatch.setattr(room, "crossings", lambda *_: ())
    monkeypatch.setattr(realise, "swings_into", lambda *_: ())


def hinges(solution: FoldSolution) -> list[int]:
    """How many hinges each patch gets."""
    return [change.hinges for change in solution.modifications]


@pytest.mark.parametrize("apart", [82.0, 83.0])
def test_elbows_that_only_sheets_have(
    apart: float, gate: Callable[[float], tuple[Part, ...]], solution: Solutions, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = solution(gate(apart), slanting=False)
    assert violations(good) == ()
    assert sum(hinges(good)) > 2 or min(np.ptp(m.window) for m in good.modifications) < 1
    unaware(monkeypatch)
    spoilt = solution(gate(apart), slanting=False)
    assert hinges(spoilt) == [1, 1] and all(m.window == (0, 1) for m in spoilt.modifications)
    assert {v.model for v in violations(spoilt)} == {"without thickness"}
    assert crossings(spoilt.scaffold, spoilt.chains) == (("left", "right"),)


def test_elbows_that_nothing_is_in_the_way_of(gate: Callable[[float], tuple[Part, ...]], solution: Solutions) -> None:
    good = solution(gate(85.0), slanting=False)
    assert hinges(good) == [1, 1] and violations(good) == ()
    assert crossings(good.scaffold, good.chains) == ()


def test_the_bound_knows_of_sheets(gate: Callable[[float], tuple[Part, ...]], solution: Solutions) -> None:
    """They are compared before anything is said to be proven."""
    good = solution(gate(82.0), slanting=False)
    assert good.lower_bound == pytest.approx(sum(m.cost for m in good.modifications))


def test_a_crossing_that_is_only_found_in_play(
    gate: Callable[[float], tuple[Part, ...]], solution: Solutions, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even where the cheapest choice was not asked, the conflicts are drawn anew as soon as one turns up."""
    monkeypatch.setattr(unit_fold, "crossings", lambda *_: ())
    asked: list[str] = []
    compare = unit_fold.compare_sheets
    monkeypatch.setattr(unit_fold, "compare_sheets", lambda *a: asked.append("") or compare(*a))
    assert violations(solution(gate(82.0), slanting=False)) == () and asked == [""]


def test_a_leg_that_swings_through_the_next_one(
    wall_at: Any, board_at: Any, solution: Solutions, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sheets are 70 mm long and the panels 65.7: 69 mm away there is room for panels alone."""
    parts = (board_at("top", 72, 80), wall_at("left", -34.5, 0, 72), wall_at("right", 34.5, 0, 72))
    good = solution(parts)
    assert violations(good) == () and sum(m.cost for m in good.modifications) == 0
    unaware(monkeypatch)
    spoilt = violations(solution(parts))
    assert {(v.kind, v.model, v.parts) for v in spoilt} == {("collision", "without thickness", ("left", "right"))}


def test_a_leg_swings_through_what_stands_on_its_base_alone(
    wall_at: Any, board_at: Any, solution: Solutions, problem: Callable[..., Problem]
) -> None:
    def through(apart: float) -> tuple[str, ...]:
        parts = (board_at("top", 72, 200), wall_at("left", -apart / 2, 0, 72), wall_at("right", apart / 2, 0, 72))
        made = solution(parts)
        chain = made.chain("left")
        inward = replace(chain, turn=abs(chain.turn) * np.sign(chain.across[0]))
        return sheets.swings_into(made.scaffold, inward, [problem(parts).sites["right"]])

    assert through(69.0) == ("right",) and through(71.0) == ()


@pytest.mark.parametrize(
    ("z", "x", "through"), [(71.4, -20, True), (71.4, 25, False), (72, -20, False), (-1, -20, False)]
)
def test_a_leg_swings_through_another_base(
    z: float, x: float, through: bool, wall_at: Any, board_at: Any, solution: Solutions
) -> None:
    """70 mm down from x = -34.5 at z = 72, and past the plane of a base 0.6 mm lower in its last degree alone."""
    made = solution((board_at("top", 72, 200), wall_at("left", -34.5, 0, 72)))
    chain, base = made.chain("left"), made.scaffold.bases[-1]
    inward = replace(chain, turn=abs(chain.turn) * np.sign(chain.across[0]))
    beside = replace(base.outlines[0], center=np.array([x + 50.0, 0.0]), half=np.array([40.0, 40.0]))
    other = replace(base, name="ledge", bottom=float(z), outlines=(beside,))
    found = sheets.swings_into(made.scaffold, inward, [], [other])
    assert found == (("ledge",) if through else ())


def test_what_has_come_nearer_is_left_to_the_rehearsal(
    wall_at: Any, board_at: Any, problem: Callable[..., Problem], solution: Solutions
) -> None:
    """A T is held against what stands to its base as in the open furniture, whatever carries it."""
    parts = (board_at("top", 72, 200), wall_at("left", -34.5, 0, 72), wall_at("right", 34.5, 0, 72))
    posed = problem(parts)
    unit = posed.unit_of["left"]
    around = look(posed, open_scene(posed), repertoire(posed, unit))
    (anchor,) = unit.bases
    assert {s.owner for s in realise._standing_to(around, anchor)} == {anchor, "right"}
    away = np.where((around.owner == [s.owner for s in around.solids].index("right"))[:, None], [0.0, 0.0, -1.0], 0.0)
    lower = replace(around, boxes=moved(around.boxes, away))
    assert {s.owner for s in realise._standing_to(lower, anchor)} == {anchor}


@pytest.mark.parametrize(("left", "is_free"), [((20.0, 30.0), True), ((0.0, 30.0), False)])
def test_a_leg_swings_past_what_will_be_too_narrow_to_be_met(
    left: tuple[float, float], is_free: bool, wall_at: Any, board_at: Any, solution: Solutions,
    problem: Callable[..., Problem],
) -> None:  # fmt: skip
    parts = (board_at("top", 72, 200), wall_at("left", -34.5, 0, 72), wall_at("right", 34.5, 0, 72))
    posed, made = problem(parts), solution(parts)
    chain, other = made.chain("left"), made.chain("right")
    side = float(np.sign(other.along @ chain.along))
    span = np.sort(side * np.array(left))
    narrow = replace(other, span=span, hinge_spans=np.tile(span, (len(other.hinge_spans), 1)))
    scene = shown(open_scene(posed), ["right"], [narrow], is_folded=False)
    unit = posed.unit_of["left"]
    around = look(posed, scene, repertoire(posed, unit))
    inward = replace(chain, turn=abs(chain.turn) * np.sign(chain.across[0]), span=np.array([-30.0, 10.0]))
    assert (realise._swung(posed, (inward,), around) == ()) is is_free


def test_copies_and_storeys_are_never_played(solution: Solutions, monkeypatch: pytest.MonkeyPatch) -> None:
    made = [solution(name, slanting=False) for name in ("tower", "same_way")]
    monkeypatch.setattr(sheets, "_played", None)
    for good in made:
        alike = tuple(replace(c, turn=abs(c.turn)) for c in good.chains)
        assert crossings(good.scaffold, alike) == ()


def test_sheets_come_down_with_their_bases(solution: Solutions) -> None:
    """Each panel of a sheet begins where the one before ends, and the last one ends in the plane of its far base."""
    good = solution("passage", slanting=False)
    (chain,) = (c for c in good.chains if c.far == good.scaffold.bases[-1].name)
    height = {b.name: b.bottom for b in good.scaffold.bases}
    sheet = sheets._sheet(chain, height)
    played = sheets._played({0: sheet}, height, 0.0)
    ends = played.boxes.center + played.boxes.axes[..., 2, :] * played.boxes.half[..., 2:]
    begins = played.boxes.center - played.boxes.axes[..., 2, :] * played.boxes.half[..., 2:]
    assert np.allclose(ends[:, :-1], begins[:, 1:], atol=1e-6)
    press = sheets._press([(height[chain.anchor], height[chain.far])])
    assert np.allclose(ends[:, -1, 2], press, atol=1e-3) and np.allclose(ends[:, -1, :2], ends[0, -1, :2], atol=1e-3)
