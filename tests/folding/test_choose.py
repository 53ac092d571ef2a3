"""The cheapest choice is the one that trying all of them finds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding import choose
from foldfab.folding.choose import Combination, cheaper, cheapest
from foldfab.folding.work import Work
from foldfab.geometry.arrays import Array, Bools

Conflicts = dict[tuple[int, int], Bools]
Forbidden = frozenset[Combination]
Instance = tuple[list[Array], Conflicts, Forbidden]
INF = float("inf")


def is_allowed(choice: tuple[int, ...], costs: list[Array], conflicts: Conflicts, forbidden: Forbidden) -> bool:
    return (
        all(np.isfinite(costs[g][o]) for g, o in enumerate(choice))
        and not any(table[choice[g], choice[h]] for (g, h), table in conflicts.items())
        and not any(all(choice[g] in many for g, many in combination) for combination in forbidden)
    )


def price(choice: tuple[int, ...], costs: list[Array]) -> float:
    return float(sum(costs[g][o] for g, o in enumerate(choice)))


@st.composite
def instances(draw: st.DrawFn) -> Instance:
    """Up to five patches of up to four options, with few prices so that ties are common."""
    sizes = draw(st.lists(st.integers(1, 4), min_size=1, max_size=5))
    prices = st.sampled_from([0.0, 0.1, 0.25, 0.5, 1.0, INF])
    costs = [np.array(draw(st.lists(prices, min_size=n, max_size=n))) for n in sizes]
    conflicts = {
        (g, h): np.array(draw(st.lists(st.booleans(), min_size=n * m, max_size=n * m))).reshape(n, m)
        for (g, n), (h, m) in itertools.combinations(enumerate(sizes), 2)
        if draw(st.booleans())
    }
    choices = st.tuples(*(st.sets(st.integers(0, n - 1), min_size=1) for n in sizes))
    parts = st.sets(st.integers(0, len(sizes) - 1), min_size=1)
    banned = draw(st.lists(st.tuples(choices, parts), max_size=4))
    return costs, conflicts, frozenset(tuple((g, tuple(sorted(c[g]))) for g in sorted(p)) for c, p in banned)


@given(instances())
@settings(deadline=None, derandomize=True, max_examples=300)
def test_no_choice_is_cheaper(instance: Instance) -> None:
    assert_cheapest(*instance)


@pytest.mark.parametrize(("limit", "widest"), [(0, 100), (2, 100), (1500, 0)])
@given(instance=instances())
@settings(deadline=None, derandomize=True, max_examples=60)
def test_nor_is_one_where_the_search_is_handed_over(limit: int, widest: int, instance: Instance) -> None:
    """At once, after a few branches, or because there are many groups."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choose, "LIMIT", limit)
        patch.setattr(choose, "WIDEST", widest)
        assert_cheapest(*instance)


@pytest.mark.parametrize(("limit", "widest"), [(0, 100), (2, 100), (1500, 100), (1500, 0)])
@given(instance=instances())
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_brief_search_says_whether_it_was_enough(limit: int, widest: int, instance: Instance) -> None:
    costs, conflicts, forbidden = instance
    gaps: list[float] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choose, "LIMIT", limit)
        patch.setattr(choose, "WIDEST", widest)
        patch.setattr(choose, "proven", None)
        found = cheapest(costs, conflicts, forbidden, gaps, is_brief=True)
    assert found is None or is_allowed(found, costs, conflicts, forbidden)
    if gaps:
        assert min(gaps) == INF and (limit < 1500 or not widest)
    else:
        best = cheapest(costs, conflicts, forbidden)
        assert (found is None) == (best is None)
        assert found is None or best is None or price(found, costs) == pytest.approx(price(best, costs))


@pytest.mark.parametrize("branches", [600, 2, 0])
@given(instance=instances(), than=st.sampled_from([0.3, 0.8, INF]))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_what_is_cheaper_than_something_is_found_where_there_is_any(
    branches: int, instance: Instance, than: float
) -> None:
    costs, conflicts, forbidden = instance
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choose, "FEW_BRANCHES", branches)
        best, (found, floor) = cheapest(costs, conflicts, forbidden), cheaper(costs, conflicts, forbidden, than)
    if best is None or price(best, costs) >= than - 1e-9:
        assert found is None and floor >= than - 1e-6
    else:
        assert found is not None and is_allowed(found, costs, conflicts, forbidden)
        assert price(found, costs) == pytest.approx(price(best, costs)) == pytest.approx(floor)


@pytest.mark.parametrize("branches", [2, 0])
@given(instance=instances(), than=st.sampled_from([0.3, 0.8, INF]))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_without_work_only_little_is_claimed(branches: int, instance: Instance, than: float) -> None:
    costs, conflicts, forbidden = instance
    best = cheapest(costs, conflicts, forbidden)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(choose, "FEW_BRANCHES", branches)
        patch.setattr(choose, "proven", None)
        found, floor = cheaper(costs, conflicts, forbidden, than, Work(0.0))
    assert best is None or floor <= price(best, costs) + 1e-9
    assert found is None or (is_allowed(found, costs, conflicts, forbidden) and price(found, costs) < than)


def test_both_ways_to_search_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    monkeypatch.setattr(choose, "proven", lambda alive, *_: (asked.append(len(alive)), (None, 0.0, 0.0))[1])
    costs = [np.array([0.0, 1.0]), np.array([0.0, 0.4])]
    conflicts = {(0, 1): np.array([[True, False], [False, False]])}
    cheapest(costs, conflicts)
    assert not asked
    monkeypatch.setattr(choose, "LIMIT", 0)
    cheapest(costs, conflicts)
    assert asked == [2]


def assert_cheapest(costs: list[Array], conflicts: Conflicts, forbidden: Forbidden) -> None:
    """What is found is allowed, and nothing that is allowed costs less."""
    every = itertools.product(*(range(len(c)) for c in costs))
    allowed = [choice for choice in every if is_allowed(choice, costs, conflicts, forbidden)]
    found = cheapest(costs, conflicts, forbidden)
    if not allowed:
        assert found is None
    else:
        assert found in allowed
        assert price(found, costs) == pytest.approx(min(price(choice, costs) for choice in allowed))


def test_without_conflicts_each_patch_takes_its_cheapest_option() -> None:
    assert cheapest([np.array([2.0, 1.0]), np.array([0.5, 3.0])], {}) == (1, 0)


def test_options_of_equal_cost_are_taken_in_the_order_given() -> None:
    assert cheapest([np.array([1.0, 1.0, 1.0]), np.array([0.0, 0.0])], {}) == (0, 0)


def test_a_conflict_is_paid_for_where_it_costs_least() -> None:
    costs = [np.array([0.0, 1.0]), np.array([0.0, 0.4])]
    conflicts = {(0, 1): np.array([[True, False], [False, False]])}
    assert cheapest(costs, conflicts) == (0, 1)


def test_an_infinite_option_is_never_taken() -> None:
    assert cheapest([np.array([INF, 7.0])], {}) == (1,)
    assert cheapest([np.array([INF, INF])], {}) is None


def test_a_forbidden_combination_leaves_its_parts_allowed() -> None:
    costs = [np.array([0.0, 1.0]), np.array([0.0, 1.0]), np.array([0.0, 3.0])]
    forbidden = frozenset({((0, (0,)), (1, (0,)), (2, (0,)))})
    assert cheapest(costs, {}, forbidden) in {(0, 1, 0), (1, 0, 0)}


def test_a_forbidden_combination_may_hold_several_options_of_a_group() -> None:
    costs = [np.array([0.0, 1.0, 9.0]), np.array([0.0, 2.0, 5.0])]
    assert cheapest(costs, {}, frozenset({((0, (0, 1)), (1, (0, 1)))})) == (0, 2)


def test_a_patch_without_neighbours_heeds_what_is_forbidden() -> None:
    assert cheapest([np.array([0.0, 1.0])], {}, frozenset({((0, (0,)),)})) == (1,)
    assert cheapest([np.array([0.0])], {}, frozenset({((0, (0,)),)})) is None


def test_an_option_that_is_forbidden_with_another_leaves_its_place_to_one_like_it() -> None:
    """The first option is no dearer and excludes no more than the second, but it must not be taken with the other's."""
    costs = [np.array([0.0, 0.1]), np.array([0.0, 5.0])]
    assert cheapest(costs, {}, frozenset({((0, (0,)), (1, (0,)))})) == (1, 0)


def test_patches_that_exclude_each_other_have_no_choice() -> None:
    assert cheapest([np.zeros(2), np.zeros(3)], {(0, 1): np.ones((2, 3), dtype=bool)}) is None
