"""What is changed says why, and what does not fold says which parts meet, and when."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.errors import FoldingError
from foldfab.folding.congruent import repertoire
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects, prospects
from foldfab.folding.reasons import NAMED, reason_against
from foldfab.folding.scene import open_scene
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import Refusal, fold_unit
from foldfab.recipe.model import Part, Pattern

Solve = Callable[..., FoldSolution]
Make = Callable[..., Problem]
Parts = tuple[Part, ...]


def reasons(made: FoldSolution) -> dict[str, str]:
    return {m.patch: m.reason for m in made.modifications}


def seen(made: Problem, patch: str) -> Prospects:
    own = repertoire(made, made.unit_of[patch])
    return prospects(made, own, look(made, open_scene(made), own), in_place=False)


def test_who_only_needs_a_hinge_comes_straight_down(solution: Solve) -> None:
    assert reasons(solution("h_scaffold", slanting=False)) == {"leg": "to come straight down"}


def test_who_needs_nothing_says_nothing(solution: Solve) -> None:
    assert reasons(solution("h_scaffold")) == {"leg": ""}


def test_who_is_narrowed_says_through_whom_it_would_fold(solution: Solve) -> None:
    made = solution("three_walls")
    for m in made.modifications:
        narrowed = m.window != (0.0, 1.0)
        assert m.reason.startswith("because it would fold through") == narrowed
        others = {"back", "left", "right"} - {m.patch}
        assert not narrowed or set(re.findall(r"\w+", m.reason.partition("through ")[2].partition(";")[0])) <= others
    assert sum(m.window != (0.0, 1.0) for m in made.modifications) == 2


def test_who_needs_more_hinges_says_what_fewer_would_meet(solution: Solve) -> None:
    """The back of the deep box sticks out of it with one hinge."""
    assert reasons(solution("deep_box"))["back"] == "because with fewer hinges it would meet the bounding box"


def test_who_cannot_slant_beside_others_says_beside_whom(solution: Solve) -> None:
    assert reasons(solution("corner")) == {
        "back": "because it can slant only without side", "side": "because it can slant only without back"
    }  # fmt: skip


def test_a_refusal_tells_what_simulations_have_shown(problem: Make) -> None:
    made = problem("h_scaffold")
    own = repertoire(made, made.unit_of["leg"])
    told = reason_against(made, own, seen(made, "leg"), ["leg meets flap when 40 % of that fold are done"])
    assert told == "leg meets flap when 40 % of that fold are done"


def test_a_refusal_names_only_a_few_clashes(problem: Make) -> None:
    made = problem("h_scaffold")
    own = repertoire(made, made.unit_of["leg"])
    told = reason_against(made, own, seen(made, "leg"), [f"clash {i}" for i in range(9)])
    assert told == "; ".join(f"clash {i}" for i in range(NAMED))


def test_that_it_would_fall_apart_is_said_only_where_nothing_else_is(problem: Make) -> None:
    made = problem("h_scaffold")
    own, room = repertoire(made, made.unit_of["leg"]), seen(made, "leg")
    apart = "without leg the furniture would fall apart"
    assert reason_against(made, own, room, [apart, "leg meets flap"]) == "leg meets flap"
    assert reason_against(made, own, room, [apart]) == apart
    assert reason_against(made, own, room, []) == "whatever its parts do, two of them meet"


def test_where_no_lane_has_room_what_they_meet_is_named(problem: Make, furniture: dict[str, Parts]) -> None:
    rigid = tuple(replace(p, hingeable=p.name != "leg") for p in furniture["h_scaffold"])
    made = problem(rigid, stay_in_box=True)
    found = fold_unit(made, open_scene(made), made.unit_of["leg"])
    assert isinstance(found, Refusal)
    assert found.reason == "leg has no room: whichever way it folds it meets the bounding box"


@pytest.mark.parametrize("ordering", ["greedy", "optimal"])
def test_the_error_of_what_has_no_room_names_it(solution: Solve, furniture: dict[str, Parts], ordering: str) -> None:
    rigid = tuple(replace(p, hingeable=p.name != "leg") for p in furniture["h_scaffold"])
    with pytest.raises(FoldingError, match="leg has no room: whichever way it folds it meets the bounding box"):
        solution(rigid, stay_in_box=True, ordering=ordering)


def test_a_clash_that_is_played_says_when(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """The conflict graph sees nothing, so that it is left to the simulation to find what meets."""
    made = problem("three_walls", slanting=False, max_hinges=1, shrink_steps=1)
    monkeypatch.setattr("foldfab.folding.graph.table", lambda *_, **__: None)
    parts = {n: replace(p, forbid=(Pattern(mechanism="deleted"),)) for n, p in made.parts.items()}
    made = replace(made, parts=parts)
    found = fold_unit(made, open_scene(made), made.units[0])
    assert isinstance(found, Refusal)
    told = re.findall(r"(\w+) meets (\w+) when (\d+) % of that fold are done", found.reason)
    assert told and all({a, b} <= {"back", "left", "right"} and 0 < int(share) < 100 for a, b, share in told)
