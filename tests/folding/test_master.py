"""The constraint program of options and order: its cheapest proposal is that of brute force."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding.master import Cut, Master, Order, Proposal
from foldfab.folding.options import Options
from foldfab.geometry.arrays import Bools

WORK = 5.0
FINE = 1e-6


def options(patch: str, *weights: float) -> Options:
    """Options of a patch that count that much."""
    return Options(patch, (), np.array(weights), np.array(weights), ())


def master(
    units: dict[str, tuple[str, ...]], weights: dict[str, tuple[float, ...]],
    tables: dict[tuple[str, str], Bools] | None = None,
) -> Master:  # fmt: skip
    made = {p: options(p, *w) for p, w in weights.items()}
    return Master(units, made, tables or {}, {p: range(len(w)) for p, w in weights.items()})


def solved(made: Master) -> Proposal:
    proposal, bound, _ = made.solved(WORK, None)
    assert proposal is not None and proposal.bound == bound
    return proposal


def test_without_cuts_every_patch_takes_its_cheapest_option() -> None:
    found = solved(master({"u": ("a", "b")}, {"a": (0.3, 0.1), "b": (0.0, 0.2, 0.4)}))
    assert found.chosen == {"a": 1, "b": 0} and found.bound == pytest.approx(0.1, abs=FINE)
    assert found.order == ("u",)


def test_options_that_exclude_each_other_are_not_taken_together() -> None:
    table = {("a", "b"): np.array([[True, False], [False, False]])}
    found = solved(master({"u": ("a",), "v": ("b",)}, {"a": (0.0, 0.3), "b": (0.0, 0.2)}, table))
    assert found.chosen == {"a": 0, "b": 1} and found.bound == pytest.approx(0.2, abs=FINE)


@pytest.mark.parametrize("is_conflict", [True, False])
def test_only_programs_with_conflicts_are_presolved(is_conflict: bool) -> None:
    """In others nothing is to be found but in the cuts, which are few at a time."""
    table = {("a", "b"): np.array([[is_conflict, False], [False, False]])}
    made = master({"u": ("a",), "v": ("b",)}, {"a": (0.0, 0.3), "b": (0.0, 0.2)}, table)
    assert solved(made).bound == pytest.approx(0.2 if is_conflict else 0.0, abs=FINE)
    assert made.solver.parameters.cp_model_presolve is is_conflict


def test_only_what_is_worth_it_may_be_taken() -> None:
    made = Master({"u": ("a",)}, {"a": options("a", 0.0, 0.1)}, {}, {"a": [1]})
    assert solved(made).chosen == {"a": 1}


def test_a_cut_forbids_all_of_it_at_once_and_no_part_of_it() -> None:
    made = master({"u": ("a",), "v": ("b",)}, {"a": (0.0, 0.3), "b": (0.0, 0.2)})
    made.add(Cut((("a", (0,)), ("b", (0,))), ()))
    assert solved(made).chosen == {"a": 0, "b": 1}
    made.add(Cut((("b", (1,)),), ()))
    assert solved(made).chosen == {"a": 1, "b": 0}


def test_a_cut_with_an_order_can_be_met_by_turning_the_order() -> None:
    made = master({"u": ("a",), "v": ("b",)}, {"a": (0.0, 0.3), "b": (0.0, 0.2)})
    made.add(Cut((("a", (0,)), ("b", (0,))), (("u", "v"),)))
    found = solved(made)
    assert found.chosen == {"a": 0, "b": 0} and found.order == ("v", "u")
    # The other way round is a cut as well: now something has to be paid for.
    made.add(Cut((("a", (0,)), ("b", (0,))), (("v", "u"),)))
    assert solved(made).bound == pytest.approx(0.2, abs=FINE)


def test_orders_are_those_of_a_line() -> None:
    """Where each of three has to fold before the next one, there is no way round in a circle."""
    made = master({n: (f"{n}-patch",) for n in "uvw"}, {f"{n}-patch": (0.0,) for n in "uvw"})
    for first, second in (("u", "v"), ("v", "w")):
        made.add(Cut(((f"{first}-patch", (0,)),), ((second, first),)))
    assert solved(made).order == ("u", "v", "w")
    made.add(Cut((("u-patch", (0,)),), (("u", "w"),)))
    assert made.solved(WORK, None)[0] is None


def test_options_that_are_not_worth_it_make_a_cut_idle() -> None:
    made = Master({"u": ("a",)}, {"a": options("a", 0.0, 0.1)}, {}, {"a": [0]})
    made.add(Cut((("a", (1,)),), ()))
    assert solved(made).chosen == {"a": 0}


def test_where_nothing_is_left_there_is_no_proposal_and_no_bound() -> None:
    made = master({"u": ("a",)}, {"a": (0.0, 0.1)})
    made.add(Cut((("a", (0, 1)),), ()))
    proposal, bound, _ = made.solved(WORK, None)
    assert proposal is None and bound == np.inf


def test_weights_add_up_to_at_least_as_much_as_demanded() -> None:
    weights = {"a": (0.0, 0.3, 0.5), "b": (0.0, 0.2)}
    made = master({"u": ("a", "b")}, weights)
    made.at_least({p: np.array(w) for p, w in weights.items()}, 0.25)
    assert solved(made).bound == pytest.approx(0.3, abs=FINE)
    # A demand that is met exactly is met, whatever is lost in rounding.
    made = master({"u": ("a", "b")}, weights)
    made.at_least({p: np.array(w) for p, w in weights.items()}, 0.2)
    assert solved(made).bound == pytest.approx(0.2, abs=FINE)


def test_all_patches_take_the_same_one_of_several_ways() -> None:
    made = master({"u": ("a", "b")}, {"a": (0.0, 0.3), "b": (0.1, 0.0)})
    first, second = np.array([True, False]), np.array([False, True])
    made.one_of([{"a": first, "b": first}, {"a": second, "b": second}])
    assert solved(made).chosen == {"a": 0, "b": 0}


def test_a_hint_changes_nothing_but_where_it_starts() -> None:
    made = master({"u": ("a",), "v": ("b",)}, {"a": (0.0, 0.3), "b": (0.0, 0.2)})
    best = solved(made)
    worse = Proposal({"a": 1, "b": 1}, ("v", "u"), 0.0)
    assert made.solved(WORK, worse)[0] is not None
    assert solved(made).chosen == best.chosen


@given(st.integers(0, 10_000))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_no_choice_and_order_that_the_cuts_allow_is_cheaper(seed: int) -> None:
    rng = np.random.default_rng(seed)
    units = {n: (f"{n}0", f"{n}1") for n in "uvw"[: rng.integers(1, 4)]}
    patches = [p for many in units.values() for p in many]
    weights = {p: tuple(rng.integers(0, 9, 3) / 8) for p in patches}
    tables = {(many[0], many[1]): rng.random((3, 3)) < 0.4 for many in units.values()}
    cuts = [_random_cut(rng, patches, sorted(units)) for _ in range(8)]
    made = master(units, weights, tables)
    for cut in cuts:
        made.add(cut)
    best = np.inf
    for picked in itertools.product(range(3), repeat=len(patches)):
        chosen = dict(zip(patches, picked, strict=True))
        if any(table[chosen[p], chosen[q]] for (p, q), table in tables.items()):
            continue
        if any(_allows(cuts, chosen, order) for order in itertools.permutations(sorted(units))):
            best = min(best, sum(weights[p][i] for p, i in chosen.items()))
    proposal, bound, _ = made.solved(WORK, None)
    if proposal is None:
        assert best == np.inf
        return
    assert bound == pytest.approx(best, abs=FINE)
    assert _allows(cuts, dict(proposal.chosen), proposal.order)
    assert sum(weights[p][i] for p, i in proposal.chosen.items()) == pytest.approx(best, abs=FINE)


def _random_cut(rng: np.random.Generator, patches: list[str], units: list[str]) -> Cut:
    held = rng.choice(patches, size=rng.integers(1, 3), replace=False)
    some = tuple((str(p), tuple(np.nonzero(rng.random(3) < 0.6)[0].tolist())) for p in held)
    order: tuple[Order, ...] = ()
    if len(units) > 1 and rng.random() < 0.7:
        first, second = rng.choice(units, size=2, replace=False)
        order = ((str(first), str(second)),)
    return Cut(some, order)


def _allows(cuts: list[Cut], chosen: dict[str, int], order: tuple[str, ...]) -> bool:
    return not any(
        all(chosen[p] in many for p, many in cut.options) and all(order.index(a) < order.index(b) for a, b in cut.order)
        for cut in cuts
    )
