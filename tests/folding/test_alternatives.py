"""The k best distinct solutions."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from foldfab.folding.alternatives import alternatives
from foldfab.folding.model import FoldSolution, Modification
from foldfab.scaffold.model import Scaffold
from foldfab.validity.verify import violations


@pytest.mark.parametrize(("name", "count"), [("h_scaffold", 2), ("three_walls", 4), ("box_with_table", 4)])
def test_they_come_in_the_order_of_their_cost(scaffold: Callable[..., Scaffold], name: str, count: int) -> None:
    found = alternatives(scaffold(name, slanting=False), 4)
    assert len(found) == count
    costs = [one.cost for one in found]
    assert costs == pytest.approx(sorted(costs))
    for one in found:
        assert not [v for v in violations(one) if v.model != "without thickness"]


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
