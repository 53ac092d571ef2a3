"""What the figures of the paper say about solutions holds, and every solution adds up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import foldfab
from foldfab.errors import LossError
from foldfab.folding.model import FoldSolution, Modification, Thickness
from foldfab.folding.options import DELETION
from foldfab.folding.problem import Problem
from foldfab.folding.solve import posed, solve
from foldfab.folding.work import Work
from foldfab.recipe.model import FoldOptions, Part, Pattern, Recipe
from foldfab.scaffold.model import Scaffold

Make = Callable[..., FoldSolution]
Box = Callable[..., Part]
RECIPES = Path(__file__).resolve().parents[2] / "recipes"
NAMES = ("t_scaffold", "slanted_h", "two_ways", "deep_box", "box_with_table", "shelf", "three_walls", "chair")


def by_patch(solution: FoldSolution) -> dict[str, Modification]:
    return {m.patch: m for m in solution.modifications}


def is_whole(modification: Modification) -> bool:
    return modification.window == (0.0, 1.0)


@pytest.mark.parametrize("name", ["t_scaffold", "slanted_t", "h_scaffold", "slanted_h", "same_way"])
def test_slanting_costs_nothing(solution: Make, name: str) -> None:
    """Figure 4 a and b, 12 c."""
    made = solution(name)
    assert made.cost == made.lower_bound == 0.0
    assert {(m.mechanism, m.hinges, m.window) for m in made.modifications} == {("slanted", 0, (0.0, 1.0))}


@pytest.mark.parametrize("name", ["h_scaffold", "slanted_h", "same_way", "shelf"])
def test_without_slanting_h_scaffolds_fold_in_place(solution: Make, name: str) -> None:
    """Figure 4 c."""
    made = solution(name, slanting=False)
    assert {m.mechanism for m in made.modifications} == {"in-place"}
    assert made.cost == pytest.approx(0.5 / 3)
    assert all(step.travel[b][:, :2].any() == False for step in made.steps for b in step.travel)  # noqa: E712


def test_where_parts_certainly_go_that_is_told_before_anything_is_searched(
    scaffold: Callable[..., Scaffold], furniture: dict[str, tuple[Part, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = tuple(
        replace(p, pin=Pattern(mechanism="deleted")) if p.name in ("back", "left") else p
        for p in furniture["three_walls"]
    )
    made = scaffold(parts)
    assert sum(m.is_deleted for m in solve(made, most=2).modifications) == 2
    monkeypatch.setattr("foldfab.folding.solve.greedy", None)
    with pytest.raises(LossError, match="at least 2 parts would have to go") as lost:
        solve(made, most=1)
    assert lost.value.gone == 2


def test_what_is_not_worth_it_is_not_bettered(
    scaffold: Callable[..., Scaffold], furniture: dict[str, tuple[Part, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The search is told to keep to what loses no more than that, and what there is without it stands."""
    limits: list[float] = []
    monkeypatch.setattr(
        "foldfab.folding.solve.optimal", lambda _, __, known, floor, limit: (limits.append(limit), (known, 0.0))[1]
    )
    monkeypatch.setattr("foldfab.folding.solve.NO_MORE", -1.0)
    made = scaffold(furniture["three_walls"])
    assert solve(made, worth=0).cost == solve(made, worth=3).cost == solve(made).cost
    assert limits == [DELETION, 4 * DELETION, np.inf]


def test_all_ways_to_spare_rigid_parts_share_the_work(
    scaffold: Callable[..., Scaffold], furniture: dict[str, tuple[Part, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = tuple(replace(p, hingeable=p.name not in ("left", "right")) for p in furniture["three_walls"])
    limits: list[float] = []

    def pose(made: Scaffold, thickness: Thickness, work: Work) -> Problem:
        limits.append(work.limit)
        work.charge(0.3)
        return posed(made, thickness, work)

    monkeypatch.setattr("foldfab.folding.solve.posed", pose)
    work = Work(4.0)
    solve(scaffold(parts), work)
    assert limits[0] == pytest.approx(1.0) and len(limits) == 4
    assert all(limit <= (4.0 - 0.3 * k) / (4 - k) for k, limit in enumerate(limits))
    assert work.spent >= 1.2


@pytest.mark.parametrize("name", ["t_scaffold", "table"])
def test_t_scaffolds_slant_even_without_slanting(solution: Make, name: str) -> None:
    assert {m.mechanism for m in solution(name, slanting=False).modifications} == {"slanted"}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("max_hinges", [1, 3, 5])
def test_in_place_folding_takes_an_odd_number_of_hinges(solution: Make, name: str, max_hinges: int) -> None:
    """Figure 9 b."""
    made = solution(name, slanting=False, max_hinges=max_hinges)
    for m in made.modifications:
        assert m.hinges <= max_hinges
        if made.scaffold.patch(m.patch).upper and not m.is_deleted and m.mechanism == "in-place":
            assert m.hinges % 2 == 1


@pytest.mark.parametrize("name", ["two_ways", "two_lean", "corner", "three_walls"])
def test_walls_that_would_drag_their_base_different_ways_fold_in_place(solution: Make, name: str) -> None:
    """Figure 12 b."""
    made = solution(name)
    assert {m.mechanism for m in made.modifications} == {"in-place"}
    (step,) = made.steps
    assert np.abs(step.travel["ceiling"][:, :2]).max() == 0.0


def test_walls_that_cannot_slant_the_same_way_nor_be_split_never_both_slant(
    solution: Make, furniture: dict[str, tuple[Part, ...]]
) -> None:
    """Figure 12 b, with both walls un-hingeable."""
    made = solution(tuple(replace(part, hingeable=False) for part in furniture["two_ways"]))
    assert {m.hinges for m in made.modifications} == {0}
    assert sum(chain.far is not None for chain in made.chains) == 1


def test_an_unhingeable_wall_that_cannot_slant_is_disconnected_and_not_deleted(
    solution: Make, furniture: dict[str, tuple[Part, ...]]
) -> None:
    made = solution(tuple(replace(part, hingeable=False) for part in furniture["two_ways"]))
    assert not any(m.is_deleted for m in made.modifications)


def test_three_walls_make_room_for_one_another(solution: Make) -> None:
    """Figure 13: one unit, and options that do not conflict although each alone would be whole."""
    made = solution("three_walls")
    (step,) = made.steps
    assert step.patches == ("back", "left", "right")
    assert all(m.hinges == 1 for m in made.modifications)
    assert 1 <= sum(not is_whole(m) for m in made.modifications) <= 2


def test_the_chair_shrinks_its_back_to_let_the_seat_fold(solution: Make) -> None:
    """Figure 1, top row."""
    changed = by_patch(solution("chair"))
    assert changed["back"].window[1] - changed["back"].window[0] < 1
    assert is_whole(changed["seat"]) and is_whole(changed["apron"])
    assert "seat" in changed["back"].reason


def test_without_bars_below_nothing_is_shrunk(solution: Make) -> None:
    assert all(is_whole(m) for m in solution("plain_chair").modifications)


def test_so_it_is_with_the_shipped_chair_and_bench() -> None:
    """Figures 1 and 18."""
    chair = by_patch(foldfab.foldabilize(foldfab.load(str(RECIPES / "chair-across.json"))))
    assert [name for name, m in chair.items() if not is_whole(m)] == ["back"]
    bench = foldfab.foldabilize(foldfab.load(str(RECIPES / "bench-down.json")))
    assert all(is_whole(m) for m in bench.modifications)


@pytest.mark.parametrize("name", ["three_walls", "chair"])
def test_finer_windows_never_cost_more(solution: Make, name: str) -> None:
    """Figure 17 b, for steps that divide one another."""
    costs = [solution(name, shrink_steps=steps).cost for steps in (1, 2, 4)]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("options", [{}, {"slanting": False}, {"alpha": 0.25}, {"max_hinges": 5, "shrink_steps": 3}])
def test_the_cost_adds_up_by_equations_1_and_3(solution: Make, name: str, options: dict[str, float]) -> None:
    made = solution(name, **options)
    fold = FoldOptions(**options)  # type: ignore[arg-type]
    total = sum(patch.area for patch in made.scaffold.patches)
    expected = 0.0
    for m in made.modifications:
        assert m.importance == pytest.approx(made.scaffold.patch(m.patch).area / total)
        lost = 1 - (m.window[1] - m.window[0])
        term = fold.alpha * m.hinges / fold.max_hinges + (1 - fold.alpha) * lost**2
        assert m.cost == pytest.approx(m.importance * term)
        expected += m.importance * term
    assert made.cost == pytest.approx(expected)
    assert 0 <= made.lower_bound <= made.cost + 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_every_patch_is_modified_once_and_every_kept_one_has_a_chain(solution: Make, name: str) -> None:
    made = solution(name)
    assert [m.patch for m in made.modifications] == [patch.name for patch in made.scaffold.patches]
    assert [c.patch for c in made.chains] == [m.patch for m in made.modifications if not m.is_deleted]
    for chain in made.chains:
        m = by_patch(made)[chain.patch]
        assert (len(chain.panels), chain.mechanism) == (m.hinges + 1, m.mechanism)
        assert chain.turn == pytest.approx(np.pi / 2 if m.side == "r" else -np.pi / 2)


def same(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray):
        return bool((a == b).all())
    if isinstance(a, tuple):
        return isinstance(b, tuple) and len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, dict):
        return isinstance(b, dict) and list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    if type(a).__module__.startswith("foldfab.folding"):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))  # type: ignore[arg-type]
    return a == b


@pytest.mark.parametrize("name", ["box_with_table", "three_walls", "chair", "deep_box"])
def test_the_same_scaffold_has_the_same_solution_to_the_last_bit(scaffold: Callable[..., Scaffold], name: str) -> None:
    made = scaffold(name)
    assert same(solve(made), solve(made))


def turned(recipe: Recipe, degrees: float) -> Recipe:
    """The same furniture turned about the vertical, along which it folds."""
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    parts = tuple(replace(p, center=turn @ p.center, axes=p.axes @ turn.T) for p in recipe.parts)
    return replace(recipe, parts=parts)


@pytest.mark.parametrize("degrees", [90, 180, 30])
@pytest.mark.parametrize("name", ["slanted_h", "two_ways", "box_with_table", "shelf", "three_walls", "deep_box"])
def test_turning_furniture_about_its_direction_changes_no_cost(
    recipe: Callable[..., Recipe], scaffold: Callable[..., Scaffold], solution: Make, name: str, degrees: float,
) -> None:  # fmt: skip
    there = turned(recipe(name), degrees)
    assert solve(scaffold(there)).cost == pytest.approx(solution(name).cost, abs=1e-9)
