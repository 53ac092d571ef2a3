"""Hinges are interrupted where only their knuckles or feet are in the way, and that pays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from foldfab.folding import choose, interruption, unit_fold
from foldfab.folding.basic import WHOLE
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.improve import weight
from foldfab.folding.lanes import Lane
from foldfab.folding.model import FoldSolution
from foldfab.folding.ordering import floors
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import unhindered
from foldfab.folding.repertoire import interrupt, stretches
from foldfab.folding.scene import open_scene
from foldfab.folding.solve import _ordered
from foldfab.folding.work import Work
from foldfab.recipe.model import Part
from foldfab.validity.verify import violations

from .brute import NO_MORE, cheaper

Make = Callable[..., Problem]
HINGE = 1 / 3 / 2
"""Eq. 3 of one hinge out of three, α = 0.5."""


def test_an_interrupted_hinge_is_the_cheapest_answer(
    solution: Callable[..., FoldSolution], butting: tuple[Part, ...]
) -> None:
    made = solution(butting, slanting=False)
    assert made.cost == pytest.approx(HINGE) and made.lower_bound == pytest.approx(HINGE)
    assert [c.patch for c in made.chains if c.breaks] == ["back"]
    assert "hinges of back interrupted at 0.4-0.6 where side would meet their knuckles" in made.notes
    assert violations(made) == ()


def test_without_it_a_part_is_shrunk(
    solution: Callable[..., FoldSolution], butting: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unit_fold, "interrupted", lambda *_: (False, np.inf))
    made = solution(butting, slanting=False)
    assert made.cost > HINGE + 1e-3 and not any(c.breaks for c in made.chains)


def test_what_is_left_would_be_too_narrow_for_a_hinge(
    solution: Callable[..., FoldSolution], butting_on: Callable[..., tuple[Part, ...]]
) -> None:
    made = solution(butting_on(depth=16), slanting=False)
    assert made.cost > HINGE + 1e-3 and not any(c.breaks for c in made.chains)
    assert violations(made) == ()


def test_a_panel_in_the_way_is_no_matter_of_hinges(
    solution: Callable[..., FoldSolution], butting_on: Callable[..., tuple[Part, ...]]
) -> None:
    made = solution(butting_on(apart=-20), slanting=False)
    assert made.cost > HINGE + 1e-3 and not any(c.breaks for c in made.chains)
    assert violations(made) == ()


def test_whole_hinges_are_taken_where_they_cost_no_more(
    solution: Callable[..., FoldSolution], butting_on: Callable[..., tuple[Part, ...]]
) -> None:
    made = solution(butting_on(apart=6), slanting=False)
    assert made.cost == pytest.approx(HINGE)
    assert not any(c.breaks for c in made.chains) and not any("interrupted" in note for note in made.notes)


def test_lanes_are_made_again_only_where_hinges_meet_something(problem: Make, butting: tuple[Part, ...]) -> None:
    made = problem(butting, slanting=False)
    floors(made)
    lanes = repertoire(made, made.units[0]).lanes
    assert any(x.variant.hinged != WHOLE for x in lanes)
    free = problem("h_scaffold", slanting=False)
    floors(free)
    assert all(x.variant.hinged == WHOLE for x in repertoire(free, free.units[0]).lanes)


def test_lanes_that_did_not_pay_are_no_options(
    problem: Make, butting: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interruption, "_are_hindered", lambda *_: True)
    made = problem(butting, slanting=False)
    floors(made)
    own = repertoire(made, made.units[0])
    assert any(x.variant.hinged != WHOLE for x in own.lanes) and not own.interrupted
    assert all(x.variant.hinged == WHOLE for many in own.plain.values() for x in many)


def test_a_choice_that_no_knuckles_suit_is_not_tried_again(
    problem: Make, butting: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Until none is cheaper: then there is nothing that interrupted hinges could better."""
    asked: list[float] = []
    usual = Graph.cheaper

    def watched(graph: Graph, than: float, work: Work) -> tuple[tuple[int, ...] | None, float]:
        best, floor = usual(graph, than, work)
        asked.append(graph.weight(best) if best is not None else np.inf)
        return best, floor

    monkeypatch.setattr(Graph, "cheaper", watched)
    monkeypatch.setattr(interruption, "_agreeing", lambda *_: {})
    monkeypatch.setattr(interruption, "ROUNDS", 200)
    made = problem(butting, slanting=False)
    ((choice),) = floors(made).values()
    assert asked == sorted(asked) and len(asked) > 1 and asked[-1] == np.inf and choice.spare == 0


def test_what_was_not_looked_at_to_its_end_is_not_proven(
    problem: Make, butting: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interruption, "_agreeing", lambda *_: {})
    monkeypatch.setattr(interruption, "ROUNDS", 1)
    for ordering in ("greedy", "optimal"):
        made = problem(butting, slanting=False, ordering=ordering)
        ((choice),) = floors(made).values()
        assert choice.spare > interruption.WORTH
        found, bound = _ordered(made, open_scene(made), floors(made))
        assert bound == pytest.approx(choice.weight) and bound + choice.spare == pytest.approx(weight(found))


def test_without_any_work_it_is_as_if_any_hinge_might_be_interrupted(
    problem: Make, butting: tuple[Part, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choose, "FEW_BRANCHES", 0)
    monkeypatch.setattr(interruption, "ENOUGH", 0.0)
    made = problem(butting, slanting=False)
    (choice,) = floors(made).values()
    assert choice.weight == pytest.approx(HINGE, abs=1e-5) and choice.spare > interruption.WORTH


def test_each_place_gets_the_least_stretch_that_holds(problem: Make, butting: tuple[Part, ...]) -> None:
    made = problem(butting, slanting=False, shrink_steps=20)
    own = repertoire(made, made.units[0])
    interrupt(made, own, own.plain["back"][0], stretches(made, own, own.plain["back"][0]))
    found = [x.variant.hinged for x in own.plain["back"] if x.variant.hinged != WHOLE]
    # A twentieth of 100 mm is less than a hinge wants, two are enough.
    assert found == [pytest.approx((k / 20, k / 20 + 0.1)) for k in range(19)]


def test_windows_hold_the_stretch(problem: Make, butting: tuple[Part, ...]) -> None:
    made = problem(butting, slanting=False)
    own = repertoire(made, made.units[0])
    interrupt(made, own, own.plain["back"][0], stretches(made, own, own.plain["back"][0]))
    options = Graph(made, own, unhindered(made, own), np.zeros(3)).options[made.units[0].patches.index("back")]
    steps = made.options.shrink_steps
    for i in np.nonzero(np.isfinite(options.weight[:-1]))[0].tolist():
        lane, (low, high) = _place(options.place(i))
        assert low / steps <= lane.variant.hinged[0] or lane.variant.hinged == WHOLE
        assert lane.variant.hinged[1] <= high / steps or lane.variant.hinged == WHOLE


@pytest.mark.parametrize("apart", [1.0, -20.0])
def test_it_equals_brute_force(problem: Make, butting_on: Callable[..., tuple[Part, ...]], apart: float) -> None:
    made = problem(
        butting_on(apart=apart), slanting=False, shrink_steps=3, max_hinges=1, ordering="optimal", time_limit=60.0
    )
    found, bound = _ordered(made, open_scene(made), floors(made))
    assert bound == pytest.approx(weight(found), abs=NO_MORE)
    assert cheaper(made, weight(found) - 2 * NO_MORE)[0] is None
    assert cheaper(made, weight(found) + 2 * NO_MORE)[0] == pytest.approx(weight(found), abs=NO_MORE)


def _place(place: tuple[Lane, tuple[int, int]] | None) -> tuple[Lane, tuple[int, int]]:
    assert place is not None
    return place
