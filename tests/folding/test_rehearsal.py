"""The whole fold played through with everything as it became; the later patch is to blame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from foldfab.folding import anatomy, rehearsal
from foldfab.folding import solve as solving
from foldfab.folding.basic import Variant
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.surroundings import Surroundings
from foldfab.folding.unit_fold import UnitFold
from foldfab.scaffold.model import Scaffold

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]


def folds_of(made: Problem, folded: Folded) -> tuple[UnitFold, ...]:
    """The folds of all units, as if nothing were known of what they saw: all of them are played."""
    return tuple(replace(fold, seen=None) for _, fold in folded(made)[1])


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "tower", "table"])
@pytest.mark.parametrize("slanting", [True, False])
def test_a_fold_that_holds_has_no_clash(problem: Make, folded: Folded, name: str, slanting: bool) -> None:
    made = problem(name, slanting=slanting)
    assert first_clash(made, open_scene(made), folds_of(made, folded)) is None


def test_a_table_that_is_folded_too_late_is_to_blame(problem: Make, folded: Folded) -> None:
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    assert table.unit.name == "leg-left"
    found = first_clash(made, open_scene(made), (walls, table))
    assert found is not None
    patch, variant = found
    assert patch in ("leg-left", "leg-right") and variant == table.chosen[patch].variant


def test_what_looks_as_it_did_when_it_was_folded_is_not_played_again(
    problem: Make, folded: Folded, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("box_with_table", slanting=False)
    folds = tuple(fold for _, fold in folded(made)[1])
    monkeypatch.setattr(rehearsal, "clashes", lambda *_: [("leg-left", "left")])
    assert first_clash(made, open_scene(made), folds[::-1]) is not None
    assert first_clash(made, open_scene(made), (replace(folds[0], seen=None), folds[1])) is not None
    monkeypatch.setattr(rehearsal, "clashes", lambda unit, *_: [("leg-left", "left")] if unit is folds[1].unit else [])
    assert first_clash(made, open_scene(made), folds) is None


def test_a_unit_that_folds_alone_is_not_played_again(
    problem: Make, folded: Folded, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("chair")
    folds = folds_of(made, folded)
    monkeypatch.setattr(rehearsal, "clashes", lambda *_: pytest.fail("it was played"))
    assert len(folds) == 1 and first_clash(made, open_scene(made), folds) is None


def test_later_units_are_shown_open_with_the_hinges_that_they_have(
    problem: Make, folded: Folded, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A wall that stands in the table's fold, as it became and not as it was."""
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    near = tuple(
        replace(c, root=c.root + np.array([100.0, 0.0, 0.0])) if c.patch == "left" else c for c in walls.chains
    )
    (wall,) = (c for c in near if c.patch == "left")
    seen: list[Surroundings] = []

    def watch(*given: Any) -> list[tuple[str, str]]:
        seen.append(given[4])
        return []

    monkeypatch.setattr(rehearsal, "clashes", watch)
    assert first_clash(made, open_scene(made), (table, replace(walls, chains=near))) is None
    during_table, during_walls = seen
    (shown, *_) = [s for s in during_table.solids if s.owner == "left"]
    assert shown.state == "open"
    assert shown.boxes.center == pytest.approx(anatomy.resting_boxes(wall, made.thickness, 0.0).center)
    assert {s.state for s in during_walls.solids if s.owner.startswith("leg")} == {"folded"}


def test_who_stands_in_the_way_later_is_to_blame(problem: Make, folded: Folded) -> None:
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    near = tuple(
        replace(c, root=c.root + np.array([100.0, 0.0, 0.0])) if c.patch == "left" else c for c in walls.chains
    )
    found = first_clash(made, open_scene(made), (table, replace(walls, chains=near)))
    assert found == ("left", walls.chosen["left"].variant)


def test_what_is_learned_has_no_plinths(problem: Make, folded: Folded) -> None:
    """The ban is on the way of folding, whatever it stands on."""
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    chosen = {p: replace(o, variant=replace(o.variant, pads=(3.0, 0.0))) for p, o in table.chosen.items() if o.variant}
    found = first_clash(made, open_scene(made), (walls, replace(table, chosen=chosen)))
    assert found is not None and found[1].pads == (0.0, 0.0)


def test_who_is_blamed_folds_another_way_next_time(
    scaffold: Callable[..., Scaffold], solution: Callable[..., FoldSolution], monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = solution("h_scaffold", slanting=False)
    first = usual.modification("leg")
    assert first.side is not None
    blamed = ("leg", Variant("in-place", first.hinges, first.side))
    told = [blamed, None]
    monkeypatch.setattr(solving, "first_clash", lambda *_: told.pop(0))
    now = solving.solve(scaffold("h_scaffold", slanting=False)).modification("leg")
    assert not told and (now.hinges, now.side) == (1, "l" if first.side == "r" else "r")


def test_of_two_patches_that_meet_the_later_one_is_to_blame(
    problem: Make, folded: Folded, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    monkeypatch.setattr(rehearsal, "clashes", lambda *_: [("leg-left", "left"), ("leg-right", "right")])
    assert first_clash(made, open_scene(made), (table, walls)) == ("left", walls.chosen["left"].variant)
    found = first_clash(made, open_scene(made), (walls, table))
    assert found == ("leg-left", table.chosen["leg-left"].variant)
