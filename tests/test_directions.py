"""Which direction is best, and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab import directions, pipeline
from foldfab.directions import HINGE, Row, ranked, settled
from foldfab.errors import FoldingError
from foldfab.geometry.arrays import Array
from foldfab.recipe.model import Part, Recipe
from foldfab.scaffold.directions import is_same

Make = Callable[..., Recipe]
Box = Callable[..., Part]


def free(recipe: Recipe) -> Recipe:
    """Without its direction."""
    return replace(recipe, direction=None)


def by_name(rows: tuple[Row, ...]) -> dict[str, Row]:
    return {row.best.name.strip("-"): row for row in rows}


def test_the_score_is_as_stated(recipe: Make) -> None:
    for row in ranked(free(recipe("chair"))):
        way = row.best
        if way.solution is None:
            assert (way.score, way.problem != "") == (0.0, True)
            continue
        hinges = sum(m.hinges for m in way.solution.modifications)
        saving = 1 - np.prod(way.folded) / np.prod(way.opened)
        assert way.score == pytest.approx(saving - way.solution.cost - HINGE * hinges - way.lost, abs=0.00501)
        assert row.other.score <= way.score or row.other.solution is None


def test_best_first_and_what_does_not_fold_last(recipe: Make) -> None:
    rows = ranked(free(recipe("h_scaffold")))
    scores = [row.best.score for row in rows if row.best.solution]
    assert scores == sorted(scores, reverse=True) and scores
    refused = [row.best.solution is None for row in rows]
    assert refused == sorted(refused) and refused[-1]
    assert all(row.best.problem and "try --direction" not in row.best.problem for row in rows if not row.best.solution)


def test_folding_the_whole_beats_a_flap_that_costs_nothing(recipe: Make) -> None:
    whole = ranked(free(recipe("three_walls")))[0].best
    nothing = by_name(ranked(free(recipe("table"))))["z"].best
    assert whole.cost > nothing.cost == 0 and whole.hinges
    flap = replace(nothing, opened=(240.0, 170.0, 90.0), folded=(240.0, 150.0, 90.0))
    assert 0 < flap.saving < 0.2
    assert whole.score > flap.score


def test_a_board_set_on_edge_is_lost(recipe: Make, box: Box) -> None:
    """Along x the legs, which face y, touch no base; taken for rails they would be printed as strips."""
    legs = (box("left", (-80, 0, 35), (50, 4, 70)), box("right", (80, 0, 35), (50, 4, 70)))
    rows = by_name(ranked(free(recipe((box("top", (0, 0, 72), (200, 60, 4)), *legs)))))
    assert not rows["z"].best.lost and not rows["y"].best.lost
    across = rows["x"].best
    assert set(across.level) == {"left", "right"}
    assert across.lost == pytest.approx(2 * 50 * 70 / (200 * 60 + 2 * 50 * 70))
    assert across.score < rows["z"].best.score


def test_where_most_is_lost_it_is_not_this_furniture(recipe: Make, box: Box) -> None:
    legs = (box("left", (-80, 0, 35), (50, 4, 70)), box("right", (80, 0, 35), (50, 4, 70)))
    rows = by_name(ranked(free(recipe((box("top", (0, 0, 72), (200, 30, 4)), *legs)))))
    assert rows["x"].best.problem == "what folds is another piece: 54 % of this one is laid level (left, right)"


def test_opposite_ways_share_a_row(recipe: Make) -> None:
    for row in ranked(free(recipe("table"))):
        assert np.array_equal(row.best.direction, -row.other.direction)
        if row.best.score == row.other.score:
            assert np.array_equal(row.best.direction, row.line.direction), "downwards where it is all the same"


def test_settled_names_the_direction_and_why(recipe: Make) -> None:
    found = settled(free(recipe("table")))
    assert found.direction is not None and found.direction.tolist() == [0, 0, -1]
    assert "direction -z was chosen of 6: it saves" in found.why
    named = recipe("table", direction=(0.0, 1.0, 0.0))
    assert settled(named) is named


def test_the_solution_says_which_direction_was_taken(recipe: Make) -> None:
    solution = pipeline.foldabilize(free(recipe("table")))
    assert solution.scaffold.recipe.direction is not None
    assert solution.notes[0].startswith("direction -z was chosen")
    named = pipeline.foldabilize(recipe("table"))
    assert named.notes == solution.notes[1:]
    assert named.modifications == solution.modifications


def test_turned_furniture_folds_the_same(recipe: Make, furniture: dict[str, tuple[Part, ...]]) -> None:
    turn = rotation(np.array([0.3, 0.5, 0.2]))
    parts = tuple(
        replace(p, center=turn @ p.center + [5.0, 6.0, 7.0], axes=p.axes @ turn.T) for p in furniture["shelf"]
    )
    straight, askew = ranked(free(recipe("shelf")))[0].best, ranked(free(recipe(parts)))[0].best
    assert is_same(askew.direction, turn @ straight.direction)
    assert askew.cost == pytest.approx(straight.cost, abs=1e-6)
    assert askew.saving == pytest.approx(straight.saving, abs=0.01)


def rotation(turn: Array) -> Array:
    """(3, 3) about the vector, by its length in radians."""
    angle = float(np.linalg.norm(turn))
    x, y, z = turn / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


@pytest.mark.parametrize("name", [path.stem for path in pipeline.shipped()])
def test_a_shipped_recipe_finds_the_direction_that_it_names(name: str) -> None:
    """Or it comes second, where a chair was made to be folded either way."""
    recipe = pipeline.load(name)
    assert recipe.direction is not None
    rows = ranked(free(recipe))
    place = next(rank for rank, row in enumerate(rows) if is_same(row.line.direction, recipe.direction))
    assert place <= (1 if name == "chair-across" else 0)


def test_nothing_folds(recipe: Make, box: Box) -> None:
    lump = free(recipe((box("lump", (0, 0, 0), (60, 60, 60)),)))
    rows = ranked(lump)
    assert [row.best.solution for row in rows] == [None] * 3
    with pytest.raises(FoldingError, match="none of the six axis directions") as caught:
        settled(lump)
    assert len(str(caught.value).splitlines()) == 7


def test_a_posture_that_is_still_open_does_not_stop_it(recipe: Make) -> None:
    made = free(recipe("table"))
    made = replace(made, print=replace(made.print, posture="auto"))
    assert settled(made).direction is not None


def test_directions_are_compared_at_the_thickness_that_is_asked_for(recipe: Make) -> None:
    """Thinner plates would save more: they are tried only where nothing folds with thicker ones."""
    made = free(recipe("chair"))
    rows = ranked(replace(made, print=replace(made.print, may_thin=True)))
    panels = {row.best.solution.thickness.panel for row in rows if row.best.solution}
    assert panels == {made.print.thickness}


def test_thinner_plates_are_tried_where_nothing_folds(monkeypatch: pytest.MonkeyPatch, recipe: Make) -> None:
    tried: list[bool] = []

    def refused(made: Recipe, direction: Array) -> object:
        tried.append(made.print.may_thin)
        raise FoldingError("too thick")

    monkeypatch.setattr(directions, "along", refused)
    made = free(recipe("table"))
    ranked(replace(made, print=replace(made.print, may_thin=True)))
    assert tried == [False] * 6 + [True] * 6
    ranked(made)
    assert tried[12:] == [False] * 6
