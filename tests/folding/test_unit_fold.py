"""One unit at one moment: the cheapest choice that holds when it is played, or a reason why there is none."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding import realise, unit_fold
from foldfab.folding.conflict import drag_alike
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.options import options_of
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import prospects
from foldfab.folding.realise import Clash, realised
from foldfab.folding.scene import Scene, alone, open_scene
from foldfab.folding.simulate import clashes
from foldfab.folding.solve import NO_MORE
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import Refusal, UnitFold, fold_seen, fold_unit, least_choice
from foldfab.folding.units import Unit
from foldfab.recipe.model import Part

from .every import whole

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]


@pytest.fixture
def plays(monkeypatch: pytest.MonkeyPatch) -> list[Unit]:
    """The units whose folds are played through, one after another."""
    seen: list[Unit] = []
    monkeypatch.setattr(realise, "clashes", lambda unit, *rest: (seen.append(unit), clashes(unit, *rest))[1])
    return seen


def folds(made: Problem, patch: str, scene: Scene | None = None, **options: bool) -> UnitFold:
    found = fold_unit(made, scene or open_scene(made), made.unit_of[patch], **options)
    assert isinstance(found, UnitFold)
    return found


@pytest.mark.parametrize(("name", "options"), [
    ("h_scaffold", {"slanting": False, "shrink_steps": 2}),
    ("corner", {"shrink_steps": 2, "max_hinges": 1}),
    ("two_ways", {"shrink_steps": 1}),
    ("deep_box", {"shrink_steps": 1, "max_hinges": 3}),
    ("beside", {"shrink_steps": 2, "max_hinges": 1}),
])  # fmt: skip
def test_no_choice_that_holds_when_played_is_cheaper(problem: Make, name: str, options: dict[str, object]) -> None:
    """All choices are played, cheapest first."""
    made = problem(name, **options)
    scene, unit = open_scene(made), made.units[-1]
    own = whole(made, unit)
    around = look(made, scene, own)
    table = options_of(made, prospects(made, own, around, in_place=False), around.offset)
    every = itertools.product(*([i for i in range(len(o.price)) if np.isfinite(o.weight[i])] for o in table.values()))
    weights = {pick: sum(float(o.weight[i]) for o, i in zip(table.values(), pick, strict=True)) for pick in every}
    found = fold_unit(made, scene, unit)
    for pick in sorted(weights, key=lambda p: weights[p]):
        lanes = [o.lanes[i // len(o.windows)] for o, i in zip(table.values(), pick, strict=True) if o[i].variant]
        if not all(drag_alike(a, b) for a, b in itertools.combinations(lanes, 2)):
            continue
        chosen = {p: o[i] for (p, o), i in zip(table.items(), pick, strict=True)}
        if not isinstance(realised(made, scene, unit, around, chosen), Clash):
            assert isinstance(found, UnitFold) and found.weight == pytest.approx(weights[pick])
            return
    assert isinstance(found, Refusal)


def test_a_fold_adds_up(problem: Make) -> None:
    made = problem("three_walls")
    fold = folds(made, "back")
    assert fold.cost == pytest.approx(sum(o.cost for o in fold.chosen.values()))
    assert fold.cost <= fold.weight < fold.cost + 1e-5
    assert set(fold.chosen) == set(fold.unit.patches) == {c.patch for c in fold.chains}
    assert set(fold.motion.fold) == set(fold.unit.patches)
    assert fold.cluster.tolist() == [0, 1]


@pytest.mark.parametrize("name", ["three_walls", "box_with_table", "shelf", "chair", "deep_box", "table"])
@pytest.mark.parametrize("slanting", [True, False])
def test_nothing_folds_for_less_than_without_surroundings_and_unplayed(
    problem: Make, folded: Folded, name: str, slanting: bool
) -> None:
    made = problem(name, slanting=slanting)
    for scene, fold in folded(made)[1]:
        least = least_choice(made, repertoire(made, fold.unit)).weight
        by_itself = fold_unit(made, alone(scene, fold.unit), fold.unit)
        assert isinstance(by_itself, UnitFold)
        # Preferences depend on where it has been carried to.
        assert least <= by_itself.weight + NO_MORE and by_itself.weight <= fold.weight + NO_MORE


def test_the_least_choice_is_that_of_the_cheapest_options_where_nothing_conflicts(problem: Make) -> None:
    made = problem("h_scaffold", slanting=False)
    least = least_choice(made, repertoire(made, made.units[0]))
    assert least.weight == pytest.approx(0.5 / 3)
    lane, window = least.places["leg"]
    assert (lane.variant.mechanism, lane.variant.hinges, window) == ("in-place", 1, (0, 5))


def test_what_stands_unfolded_is_named(problem: Make) -> None:
    made = problem("box_with_table")
    found = fold_unit(made, open_scene(made), made.unit_of["left"])
    assert isinstance(found, Refusal)
    assert found.reason == "leg-left, leg-right in the way still stands unfolded"


def test_the_same_view_is_solved_once(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    made = problem("h_scaffold")
    first = folds(made, "leg")
    monkeypatch.setattr(unit_fold, "_fold", lambda *_, **__: pytest.fail("solved twice"))
    assert folds(made, "leg") is first


def test_in_place_and_slanted_folds_of_one_view_are_kept_apart(problem: Make) -> None:
    made = problem("h_scaffold")
    free, straight = folds(made, "leg"), folds(made, "leg", in_place=True)
    assert [c.mechanism for c in free.chains] == ["slanted"] and free.cost == 0.0
    assert [c.mechanism for c in straight.chains] == ["in-place"] and straight.cost > 0


def test_a_final_fold_is_chosen_anew_where_the_unit_has_been_carried(problem: Make) -> None:
    """The same view from another place: which of two equal options leaves the furniture differs."""
    made = problem("h_scaffold")
    own = repertoire(made, made.units[0])
    around = look(made, open_scene(made), own)
    here = fold_seen(made, open_scene(made), own, around)
    assert isinstance(here, UnitFold)
    left, right = (
        fold_seen(made, open_scene(made), own, replace(around, offset=np.array([x, 0.0, 0.0])), is_final=True)
        for x in (-90.0, 90.0)
    )
    assert isinstance(left, UnitFold) and isinstance(right, UnitFold)
    ways = [fold.motion.shift["ceiling"][-1, 0] for fold in (left, right)]
    assert ways[0] > 0 > ways[1]
    # Where it is not final, the place makes no difference.
    assert fold_seen(made, open_scene(made), own, replace(around, offset=np.array([90.0, 0.0, 0.0]))) is here


def test_what_a_simulation_finds_is_learned(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """The cheapest choice is refused as long as it is as wide as this; the next one is narrower."""
    made = problem("h_scaffold", slanting=False)
    asked: list[tuple[int, int]] = []

    def refuse(problem: Problem, scene: Scene, unit: object, around: object, chosen: dict[str, object]) -> object:
        asked.append(chosen["leg"].window)  # type: ignore[attr-defined]
        if asked[-1][1] - asked[-1][0] > 3:
            return Clash((("leg",),), "it is too wide", holds_for="wider windows")
        return realised(problem, scene, unit, around, chosen)  # type: ignore[arg-type]

    monkeypatch.setattr(unit_fold, "realised", refuse)
    fold = folds(made, "leg")
    assert fold.chosen["leg"].window[1] - fold.chosen["leg"].window[0] == 3
    # To either side with one hinge: the whole, and the two windows of four fifths.
    assert sorted(asked[:-1]) == sorted([(0, 5), (0, 4), (1, 5)] * 2)


def test_what_meets_while_accordions_snap_is_known_before_anything_is_played(
    problem: Make, box: Callable[..., Part], board_at: Callable[..., Part], plays: list[Unit]
) -> None:
    """Knuckles at the corners of a low box: past the snap they are out of each other's way, before it they are not."""
    walls = (box(name, (x, 0, 17), (4, 76, 30)) for name, x in (("left", -60), ("right", 60)))
    ends = (box(name, (0, y, 17), (124, 4, 30)) for name, y in (("front", -41), ("back", 41)))
    made = problem((board_at("ground", 0, 200, 120), board_at("ceiling", 34, 200, 120), *walls, *ends), slanting=False)
    assert folds(made, "back").cost > 4 / 24
    assert len(plays) == 1


def test_what_hangs_on_a_base_meets_the_same_however_the_base_comes_down(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], leaning_at: Callable[..., Part],
    plays: list[Unit],
) -> None:  # fmt: skip
    """A post that leans out beside the ceiling: no choice keeps the ceiling above it, and two plays tell."""
    boards = (board_at("ground", 0, 240), board_at("ceiling", 84, x=-20))
    walls = (wall_at("left", -100, 0, 84), wall_at("right", 50, 0, 84))
    made = problem((*boards, *walls, leaning_at("post", 62, 107, 0, 124)), slanting=False)
    found = fold_unit(made, open_scene(made), made.unit_of["left"])
    assert isinstance(found, Refusal) and "post meets ceiling" in found.reason
    assert len(plays) <= 2
    alone_there = fold_unit(made, alone(open_scene(made), made.unit_of["left"]), made.unit_of["left"])
    assert isinstance(alone_there, UnitFold)


def test_it_does_not_where_a_higher_stack_stops_the_base_before(
    problem: Make, board_at: Callable[..., Part], wall_at: Callable[..., Part], leaning_at: Callable[..., Part],
    plays: list[Unit],
) -> None:  # fmt: skip
    """Where the ceiling would meet the post only at the end, three hinges in a wall keep it above that."""
    boards = (board_at("ground", 0, 240), board_at("ceiling", 84, x=-20))
    walls = (wall_at("left", -100, 0, 84), wall_at("right", 50, 0, 84))
    made = problem((*boards, *walls, leaning_at("post", 79, 107, 0, 124)), slanting=False)
    fold = folds(made, "left")
    assert max(option.variant.hinges for option in fold.chosen.values() if option.variant) == 3
    assert len(plays) <= 4


@pytest.mark.parametrize(("holds_for", "tries"), [("this", 61), ("any window", 5)])
def test_a_clash_rules_out_as_much_as_it_says(
    problem: Make, monkeypatch: pytest.MonkeyPatch, holds_for: str, tries: int
) -> None:
    """Where any window of the four variants is ruled out at once, four rounds and a deletion are all there is."""
    made = problem("h_scaffold", slanting=False)
    asked: list[object] = []

    def refuse(problem: Problem, scene: Scene, unit: object, around: object, chosen: dict[str, object]) -> Clash:
        asked.append(chosen["leg"])
        return Clash((("leg",),), "no", holds_for=holds_for)  # type: ignore[arg-type]

    monkeypatch.setattr(unit_fold, "realised", refuse)
    found = fold_unit(made, open_scene(made), made.units[0])
    assert isinstance(found, Refusal) and found.reason == "no"
    assert len(asked) == min(tries, unit_fold.ROUNDS) and len(set(asked)) == len(asked)


def test_a_clash_of_two_forbids_them_together_and_of_three_all_at_once(
    problem: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("three_walls")
    for patches in (("left", "right"), ("back", "left", "right")):
        asked: list[tuple[object, ...]] = []

        def refuse(
            problem: Problem, scene: Scene, unit: object, around: object, chosen: dict[str, object],
            patches: tuple[str, ...] = patches, asked: list[tuple[object, ...]] = asked,
        ) -> object:  # fmt: skip
            asked.append(tuple(chosen[p] for p in patches))
            if len(asked) <= 5:
                return Clash((patches,), "not together")
            return realised(problem, scene, unit, around, chosen)  # type: ignore[arg-type]

        monkeypatch.setattr(unit_fold, "realised", refuse)
        made = problem("three_walls")
        folds(made, "back")
        assert len(asked) > 5 and not set(asked[:5]) & set(asked[5:])


def test_all_that_a_play_shows_is_learned_at_once(problem: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two walls are too wide for each other, and besides the back must not fold as it does."""
    asked: list[dict[str, object]] = []

    def refuse(problem: Problem, scene: Scene, unit: object, around: object, chosen: dict[str, object]) -> object:
        asked.append(dict(chosen))
        if len(asked) == 1:
            return Clash((("left", "right"),), "not together", also=(Clash((("back",),), "nor so", "any window"),))
        return realised(problem, scene, unit, around, chosen)  # type: ignore[arg-type]

    monkeypatch.setattr(unit_fold, "realised", refuse)
    folds(problem("three_walls"), "back")
    first, second = asked[:2]
    assert (first["left"], first["right"]) != (second["left"], second["right"])
    assert first["back"].variant != second["back"].variant  # type: ignore[attr-defined]


def test_the_cheapest_choice_is_not_looked_for_again_where_nothing_is_in_its_way(
    problem: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("three_walls")
    unit, asked = made.unit_of["back"], []
    least = least_choice(made, repertoire(made, unit))
    search = Graph.soon
    monkeypatch.setattr(Graph, "soon", lambda graph: (asked.append(graph), search(graph))[1])
    assert folds(made, "back").weight == pytest.approx(least.weight)
    assert not asked
    # It is where it has been found out that the choice does not hold.
    monkeypatch.setattr(unit_fold, "realised", lambda *_: Clash((unit.patches,), "no", "any window"))
    made.solved.clear()
    assert isinstance(fold_unit(made, open_scene(made), unit), Refusal) and asked


def test_changed_patches_say_why(problem: Make, folded: Folded) -> None:
    """The flap makes the wall fold away from it or shrink; slanting needs no reason."""
    made = problem("three_walls")
    reasons = folds(made, "back").reasons
    assert reasons["back"].startswith("because it would fold through left; ")
    assert reasons["right"].startswith("because it would fold through back; ")
    assert set(reasons) == {"back", "left", "right"}
    free = problem("h_scaffold")
    assert folds(free, "leg").reasons == {}
    straight = problem("h_scaffold", slanting=False)
    assert folds(straight, "leg").reasons == {"leg": "to come straight down"}


def test_a_patch_too_short_is_named(problem: Make) -> None:
    made = problem("h_scaffold", thickness=30.0)
    found = fold_unit(made, open_scene(made), made.unit_of["leg"])
    assert isinstance(found, Refusal) and found.reason.startswith("leg is too short or too steep for hinges")
