"""The k best distinct solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from foldfab.folding.alternatives import alternatives
from foldfab.folding.model import FoldSolution, Modification
from foldfab.folding.options import DELETION
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold
from foldfab.validity.verify import violations


@pytest.mark.parametrize(("name", "count"), [("h_scaffold", 2), ("three_walls", 4), ("box_with_table", 4)])
def test_they_come_in_the_order_of_their_cost(scaffold: Callable[..., Scaffold], name: str, count: int) -> None:
    found = alternatives(scaffold(name, slanting=False), 4)
    assert len(found) == count
    costs = [one.cost for one in found]
    assert costs == pytest.approx(sorted(costs))
    for one in found:
        assert violations(one) == ()


def test_none_is_another_with_less_left_of_it(scaffold: Callable[..., Scaffold]) -> None:
    found = alternatives(scaffold("three_walls", slanting=False), 5)
    for i, earlier in enumerate(found):
        assert not any(_is_less(later, earlier) for later in found[i + 1 :])


def test_there_may_be_fewer_than_asked_for(scaffold: Callable[..., Scaffold]) -> None:
    found = alternatives(scaffold("h_scaffold", slanting=False, max_hinges=1), 5)
    assert [m.hinges for one in found for m in one.modifications] == [1]


def _is_less(later: FoldSolution, earlier: FoldSolution) -> bool:
    return all(_leaves_less(m, earlier.modification(m.patch)) for m in later.modifications)


def _leaves_less(a: Modification, b: Modification) -> bool:
    same = (a.mechanism, a.hinges) == (b.mechanism, b.hinges)
    return a.is_deleted or (same and b.window[0] <= a.window[0] and a.window[1] <= b.window[1])


@pytest.mark.parametrize("name", ["three_walls", "corner", "deep_box", "shelf"])
@pytest.mark.parametrize("slanting", [True, False])
def test_the_first_is_the_best_and_all_are_distinct_and_valid(
    scaffold: Callable[..., Scaffold], solution: Callable[..., FoldSolution], name: str, slanting: bool
) -> None:
    found = alternatives(scaffold(name, slanting=slanting, shrink_steps=3), 4)
    assert len(found) > 1
    assert found[0].modifications == solution(name, slanting=slanting, shrink_steps=3).modifications
    counted = [sum(m.cost + DELETION * m.is_deleted for m in one.modifications) for one in found]
    assert counted == pytest.approx(sorted(counted), abs=1e-5)
    told = [tuple((m.patch, m.mechanism, m.hinges, m.window) for m in one.modifications) for one in found]
    assert len(set(told)) == len(told)
    for i, earlier in enumerate(found):
        assert not any(_is_less(later, earlier) for later in found[i + 1 :])
    for one in found:
        assert violations(one) == ()


def test_between_two_of_them_there_is_no_other(scaffold: Callable[..., Scaffold]) -> None:
    """All that one wall can do, by eq. 3: slanted, with one hinge, with three; what is narrower is none of its own."""
    found = alternatives(scaffold("h_scaffold", shrink_steps=3), 9)
    assert [(m.mechanism, m.hinges, m.window) for one in found for m in one.modifications] == [
        ("slanted", 0, (0.0, 1.0)), ("in-place", 1, (0.0, 1.0)), ("in-place", 3, (0.0, 1.0)),
    ]  # fmt: skip


@pytest.mark.parametrize("slanting", [True, False])
def test_parts_that_must_not_be_split_stay_whole_in_all_of_them(
    scaffold: Callable[..., Scaffold], furniture: dict[str, tuple[Part, ...]], slanting: bool
) -> None:
    parts = tuple(replace(p, hingeable=p.name != "left") for p in furniture["three_walls"])
    found = alternatives(scaffold(parts, slanting=slanting), 3)
    assert len(found) > 1
    for one in found:
        assert one.modification("left").hinges == 0
        assert violations(one) == ()
