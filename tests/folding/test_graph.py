"""The conflict graph of a unit, and the lanes that are promised in it before they are made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding import unit_fold
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.ordering import floors
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import unhindered
from foldfab.folding.realise import Clash
from foldfab.folding.repertoire import extend

from .every import whole

Make = Callable[..., Problem]


def graph_of(made: Problem) -> Graph:
    (unit,) = made.units
    own = repertoire(made, unit)
    return Graph(made, own, unhindered(made, own), np.zeros(3))


@pytest.mark.parametrize("name", ["three_walls", "chair", "corner", "two_ways", "deep_box", "table", "beside"])
@pytest.mark.parametrize("slanting", [True, False])
def test_promises_find_the_same_choice_as_all_lanes(problem: Make, name: str, slanting: bool) -> None:
    made, full = problem(name, slanting=slanting), problem(name, slanting=slanting)
    for unit in full.units:
        whole(full, unit)
    few, all_of_them = floors(made), floors(full)
    assert {n: c.weight for n, c in few.items()} == pytest.approx({n: c.weight for n, c in all_of_them.items()})


@pytest.mark.parametrize("name", ["three_walls", "chair", "corner", "two_ways"])
def test_lanes_that_could_better_nothing_are_not_made(problem: Make, name: str) -> None:
    """One hinge is enough here, and with three one part alone would cost what all of them cost together."""
    made = problem(name)
    floors(made)
    (unit,) = made.units
    own = repertoire(made, unit)
    assert {x.variant.hinges for x in own.lanes} == {0, 1} and all(own.later[p] for p in unit.patches)


def test_a_choice_is_proven_only_once_no_lane_promises_to_better_it(
    problem: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many lanes are made after the first choice, there is only one more."""
    made = problem("deep_box")
    (unit,) = made.units
    own, proofs = repertoire(made, unit), list[int]()
    usual = Graph.soon

    def counted(graph: Graph) -> tuple[tuple[int, ...] | None, bool]:
        proofs.append(len(own.lanes))
        return usual(graph)

    monkeypatch.setattr(Graph, "soon", counted)
    grown = list[int]()
    monkeypatch.setattr(unit_fold, "extend", lambda *given: (grown.append(1), extend(*given)))
    floors(made)
    assert len(grown) > 1 and len(proofs) == 2 and proofs[-1] == len(own.lanes)


def test_a_promise_is_taken_where_it_is_cheaper_than_what_is_known(problem: Make) -> None:
    graph = graph_of(problem("corner", slanting=False))
    assert graph.promising({"back": 10.0, "side": 10.0}, np.inf).wanted == ()
    assert graph.promising({"back": 0.0, "side": 10.0}, np.inf).wanted == ("back",)
    assert graph.promising({"back": 0.0, "side": 0.0}, np.inf).wanted == ("back", "side")
    assert graph.promising({"back": 0.1, "side": 0.1}, 0.2).wanted == ()


@pytest.mark.parametrize("patches", [("back",), ("back", "side")])
def test_a_promise_takes_over_no_conflicts_of_the_deletion_whose_place_it_takes(
    problem: Make, patches: tuple[str, ...]
) -> None:
    graph = graph_of(problem("corner", slanting=False))
    gone = tuple(len(o.price) - 1 for o in graph.options)
    graph.learn(gone, Clash((patches,), "the furniture would fall apart", cuts=True))
    assert graph.promising({"back": 0.0, "side": 0.0}, np.inf).wanted == ("back", "side")


def test_beside_a_promise_nothing_is_dragged_along(problem: Make) -> None:
    """Slanted walls cost nothing, but what is promised comes straight down, and then all do."""
    made = problem("box_with_table")
    own = repertoire(made, made.unit_of["left"])
    graph = Graph(made, own, unhindered(made, own), np.zeros(3))
    assert {x.variant.mechanism for x in own.lanes} == {"slanted"}
    assert graph.promising({"left": 0.0}, 10.0).wanted == ()
    assert graph.promising({"left": 0.0, "right": 0.0}, 10.0).wanted == ("left", "right")


def test_what_was_learned_of_lanes_that_are_not_there_any_more_is_left_aside(problem: Make) -> None:
    """Surroundings that differ within rounding are the same, but plinths over what lies there are as high as it is."""
    made = problem("corner", slanting=False)
    (unit,) = made.units
    own = repertoire(made, unit)
    first = graph_of(made)
    picked = first.cheapest()
    assert picked is not None
    first.learn(picked, Clash((unit.patches,), "they meet"))
    ((clash, places),) = first.learned
    taken = first.options[0].place(picked[0])
    assert taken is not None
    raised = replace(taken[0], number=len(own.lanes), variant=replace(taken[0].variant, pads=(3.0, 0.0)))
    others = (clash, ((raised, taken[1]), *places[1:]))
    again = Graph(made, own, unhindered(made, own), np.zeros(3), [others])
    assert again.cheapest() == picked and not again.learned
    assert Graph(made, own, unhindered(made, own), np.zeros(3), [others, *first.learned]).cheapest() == first.cheapest()
