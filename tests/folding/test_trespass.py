"""What only sheets cross of other units and of their own bases is found, and the solver folds another way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from foldfab.errors import FoldingError
from foldfab.folding import alternatives
from foldfab.folding import solve as solving
from foldfab.folding.basic import Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Crossed, Problem, as_sheet, kept_clear
from foldfab.folding.prospects import ruled_out
from foldfab.folding.scene import Scene
from foldfab.folding.trespass import trespasses
from foldfab.folding.unit_fold import UnitFold
from foldfab.recipe.model import Part, Pattern
from foldfab.scaffold.model import Scaffold
from foldfab.validity.verify import violations

Solutions = Callable[..., FoldSolution]
Make = Callable[..., Problem]
Parts = tuple[Part, ...]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]
ALL = (True,) * 5


@pytest.fixture
def room(board_at: Any, wall_at: Any) -> Callable[[float], Parts]:
    """A table between two walls: as sheets its top comes 44 mm aside where it slants, as plates 35.4."""

    def made(clear: float) -> Parts:
        x = 40 + clear
        return (
            board_at("ground", 0, 2 * x + 8, 120), board_at("ceiling", 104, 2 * x + 8, 120),
            wall_at("left", -x, 0, 104, 100), wall_at("right", x, 0, 104, 100),
            board_at("top", 44, 80, 80), wall_at("leg-left", -30, 0, 44, 60), wall_at("leg-right", 30, 0, 44, 60),
        )  # fmt: skip

    return made


@pytest.fixture
def landing(board_at: Any, wall_at: Any) -> Callable[..., Parts]:
    """A wall beside a low board of its own unit, to whose side it has to fold: its elbow comes to x = 23.5 there."""

    def made(edge: float, depth: float = 80.0) -> Parts:
        side = replace(wall_at("side", 80, 0, 128), pin=Pattern(side="l", hinges=1, window=(0, 1)))
        return (
            board_at("low", 0, 240), board_at("middle", 30, 100, depth, x=edge - 50), board_at("high", 128, 200, x=-18),
            wall_at("lower", -60, 0, 30), wall_at("upper", -60, 30, 128), side,
        )  # fmt: skip

    return made


def unaware(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "trespasses", lambda *_: {})


def ways(solution: FoldSolution) -> dict[str, tuple[str, int, tuple[float, float]]]:
    return {m.patch: (m.mechanism, m.hinges, m.window) for m in solution.modifications}


def told(solution: FoldSolution) -> set[tuple[str, str]]:
    return {(v.kind, v.model) for v in violations(solution)}


def test_what_is_carried_aside_into_another_units_wall(
    room: Callable[[float], Parts], solution: Solutions, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = solution(room(40.0))
    assert violations(good) == () and ways(good)["leg-left"] == ways(good)["leg-right"] == ("in-place", 1, (0.0, 1.0))
    unaware(monkeypatch)
    spoilt = solution(room(40.0))
    assert ways(spoilt)["leg-left"][0] == "slanted" and told(spoilt) == {("collision", "without thickness")}


def test_nor_is_it_an_alternative(
    room: Callable[[float], Parts], scaffold: Callable[..., Scaffold], monkeypatch: pytest.MonkeyPatch
) -> None:
    posed = scaffold(room(40.0), shrink_steps=2, max_hinges=1, time_limit=0.5)
    found = alternatives.alternatives(posed, 2)
    assert len(found) == 2 and all(violations(one) == () for one in found)
    assert all(one.cost > 0 for one in found)
    monkeypatch.setattr(alternatives, "trespasses", lambda *_: {})
    assert any(violations(one) for one in alternatives.alternatives(posed, 2))


def test_a_room_that_is_wide_enough(room: Callable[[float], Parts], solution: Solutions) -> None:
    good = solution(room(45.0))
    assert good.cost == good.lower_bound == 0 and violations(good) == ()


def test_who_carries_it_aside_is_to_blame(room: Callable[[float], Parts], problem: Make, folded: Folded) -> None:
    made = problem(room(40.0))
    folds = tuple(fold for _, fold in folded(made)[1])
    found = trespasses(made, folds)
    side = folds[0].chosen["leg-left"].variant
    assert side is not None and set(found) == {(leg, as_sheet(side)) for leg in ("leg-left", "leg-right")}
    wall = {"l": "left", "r": "right"}[side.side]
    assert all(c == Crossed(ALL, (wall, "top")) for c in found.values())


def test_what_lies_flat_already_is_in_no_ones_way(
    room: Callable[[float], Parts], problem: Make, folded: Folded
) -> None:
    """The table is carried along when the walls fold, and everything ends in one plane."""
    made = problem(room(45.0))
    folds = tuple(fold for _, fold in folded(made)[1])
    assert [fold.unit.name for fold in folds] == ["leg-left", "left"] and trespasses(made, folds) == {}


def test_what_is_deleted_is_in_no_ones_way(room: Callable[[float], Parts], problem: Make, folded: Folded) -> None:
    made = problem(room(40.0))
    table, walls = (fold for _, fold in folded(made)[1])
    assert trespasses(made, (table, walls)) and trespasses(made, (table, replace(walls, chains=()))) == {}
    assert trespasses(made, tuple(replace(fold, chains=()) for fold in (table, walls))) == {}


@pytest.mark.parametrize("edge", [24.0, 26.0])
def test_an_elbow_that_goes_through_a_base_of_its_own_unit(
    edge: float, landing: Callable[..., Parts], solution: Solutions, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(FoldingError, match="side"):
        solution(landing(edge), slanting=False)
    unaware(monkeypatch)
    assert told(solution(landing(edge), slanting=False)) == {("collision", "without thickness")}


def test_an_elbow_that_goes_past_a_base(landing: Callable[..., Parts], solution: Solutions) -> None:
    assert violations(solution(landing(23.0), slanting=False)) == ()


@pytest.mark.parametrize(("depth", "pieces"), [(10.0, (False, False, True, False, False)), (80.0, ALL)])
def test_only_the_pieces_that_cross_have_to_go(
    depth: float, pieces: tuple[bool, ...], landing: Callable[..., Parts], solution: Solutions,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The base is in the way of the middle fifth alone, or of all."""
    found: list[object] = []
    monkeypatch.setattr(solving, "trespasses", lambda *given: found.append(trespasses(*given)) or {})
    solution(landing(26.0, depth), slanting=False)
    assert found == [{("side", Variant("in-place", 1, "l")): Crossed(pieces, ("middle",), is_always=True)}]


def test_what_was_found_is_ruled_out_for_all_that_is_the_same_sheet(problem: Make) -> None:
    made = problem("h_scaffold")
    variant = Variant("in-place", 1, "l")
    pieces = (True, False, False, False, False)
    told = kept_clear(made, {("leg", variant): Crossed(pieces, ("one",))})
    for lane in repertoire(told, told.units[0]).lanes:
        same = as_sheet(lane.variant) == variant
        assert ruled_out(told, lane).tolist() == (list(pieces) if same else [False] * 5)
    twice = kept_clear(told, {("leg", variant): Crossed(pieces[::-1], ("other",), is_always=True)})
    assert twice.crossed["leg", variant] == Crossed((True, False, False, False, True), ("one", "other"))
    raised = replace(variant, pads=(3.0, 0.0), extra=1.0, hinged=(0.2, 0.6))
    assert as_sheet(raised) == variant


@pytest.mark.parametrize("is_always", [True, False])
def test_the_bound_knows_what_holds_in_every_order(
    is_always: bool, scaffold: Callable[..., Scaffold], monkeypatch: pytest.MonkeyPatch
) -> None:
    sides = {("leg", Variant("in-place", 1, side)): Crossed(ALL, ("ground",), is_always) for side in ("l", "r")}
    answers = [sides, {}]
    monkeypatch.setattr(solving, "trespasses", lambda *_: answers.pop(0))
    found = solving.solve(scaffold("h_scaffold", slanting=False))
    assert found.modification("leg").hinges == 3 and not answers
    assert (found.lower_bound == pytest.approx(found.cost)) is is_always
