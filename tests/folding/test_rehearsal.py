"""The whole fold played through with everything as it became; the later patch is to blame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding import solve as solving
from foldfab.folding.basic import Variant
from foldfab.folding.model import FoldSolution
from foldfab.folding.problem import Problem
from foldfab.folding.rehearsal import first_clash
from foldfab.folding.scene import Scene, open_scene
from foldfab.folding.unit_fold import UnitFold
from foldfab.scaffold.model import Scaffold

Make = Callable[..., Problem]
Folded = Callable[[Problem], tuple[Scene, list[tuple[Scene, UnitFold]]]]


def folds_of(made: Problem, folded: Folded) -> tuple[UnitFold, ...]:
    return tuple(fold for _, fold in folded(made)[1])


@pytest.mark.parametrize("name", ["box_with_table", "shelf", "tower", "three_walls", "chair", "table", "deep_box"])
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


def test_a_later_patch_is_in_the_way_with_the_hinges_that_it_has(problem: Make, folded: Folded) -> None:
    """A wall that stands so close to the table that only its knuckle reaches into the table's fold."""
    made = problem("box_with_table", slanting=False)
    table, walls = folds_of(made, folded)
    # Out to where the elbows of the table's legs come, on their left.
    reach = min(float(c.root[0] - c.lengths.max()) for c in table.chains)
    moved = tuple(replace(c, root=np.array([reach, *c.root[1:]])) if c.patch == "left" else c for c in walls.chains)
    assert first_clash(made, open_scene(made), (table, walls)) is None
    crowded = replace(walls, chains=moved)
    assert first_clash(made, open_scene(made), (table, crowded)) == ("left", walls.chosen["left"].variant)


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
