"""The conflict graph of a unit, and the lanes that are promised in it before they are made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from foldfab.folding import choose, unit_fold
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.options import Options
from foldfab.folding.ordering import floors
from foldfab.folding.problem import Problem
from foldfab.folding.promises import is_cheapest, promising
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
    """After the first choice, and all lanes that it wanted, there is only one more."""
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
    assert grown and len(proofs) == 2 and proofs[-1] == len(own.lanes)


def test_a_promise_is_taken_where_it_is_cheaper_than_what_is_known(problem: Make) -> None:
    graph = graph_of(problem("corner", slanting=False))
    assert promising(graph, {"back": 10.0, "side": 10.0}, np.inf).wanted == ()
    assert promising(graph, {"back": 0.0, "side": 10.0}, np.inf).wanted == ("back",)
    assert promising(graph, {"back": 0.0, "side": 0.0}, np.inf).wanted == ("back", "side")
    assert promising(graph, {"back": 0.1, "side": 0.1}, 0.2).wanted == ()


@pytest.mark.parametrize("name", ["three_walls", "chair", "corner", "two_ways", "deep_box", "table", "beside"])
@pytest.mark.parametrize("slanting", [True, False])
def test_what_is_too_tangled_for_a_few_branches_has_the_same_least_choice(
    problem: Make, name: str, slanting: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = floors(problem(name, slanting=slanting))
    monkeypatch.setattr(choose, "LIMIT", 0)
    monkeypatch.setattr(choose, "_go_together", lambda *_: False)
    found = floors(problem(name, slanting=slanting))
    assert {n: c.weight for n, c in found.items()} == pytest.approx({n: c.weight for n, c in usual.items()}, abs=1e-5)


@pytest.mark.parametrize("name", ["deep_box", "three_walls", "chair"])
def test_where_nothing_promises_more_the_least_choice_is_known_already(
    problem: Make, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The engine is asked for promises alone, and not once more for all options."""
    monkeypatch.setattr(choose, "LIMIT", 0)
    monkeypatch.setattr(choose, "_go_together", lambda *_: False)
    monkeypatch.setattr(Graph, "cheapest", lambda _: pytest.fail("it was asked for all options"))
    assert all(np.isfinite(c.weight) for c in floors(problem(name, slanting=False)).values())


def _is_split(options: Options) -> list[bool]:
    """Which options have hinges inserted."""
    return [(v := options[i].variant) is not None and v.hinges > 0 for i in range(len(options.price))]


def test_a_choice_is_the_cheapest_only_if_nothing_that_drags_counts_less(problem: Make) -> None:
    for slanting, is_least in ((True, False), (False, True)):
        made = problem("box_with_table", slanting=slanting)
        own = repertoire(made, made.unit_of["left"])
        extend(made, own, [p for p in own.unit.patches if not any(x.variant.hinges for x in own.plain[p])])
        graph = Graph(made, own, unhindered(made, own), np.zeros(3))
        straight = tuple(int(np.where(_is_split(o), o.weight, np.inf).argmin()) for o in graph.options)
        weight = graph.weight(straight)
        assert 0 < weight < 1 and is_cheapest(graph, straight, weight) is is_least
        assert not is_cheapest(graph, straight, weight - 0.01)


def test_what_was_left_out_beside_promises_is_asked_of_the_choice_itself(problem: Make) -> None:
    graph = graph_of(problem("three_walls", slanting=False))
    dear = dict.fromkeys(graph.patches, 10.0)
    found = promising(graph, dear, np.inf)
    assert found.least is not None and not found.wanted and found.floor == pytest.approx(graph.weight(found.least))
    gone = tuple(len(o.price) - 1 for o in graph.options)
    graph.forbidden.add(tuple((g, (i, gone[g])) for g, i in enumerate(found.least)))
    assert promising(graph, dear, np.inf).least is None


@pytest.mark.parametrize("patches", [("back",), ("back", "side")])
def test_a_promise_takes_over_no_conflicts_of_the_deletion_whose_place_it_takes(
    problem: Make, patches: tuple[str, ...]
) -> None:
    graph = graph_of(problem("corner", slanting=False))
    gone = tuple(len(o.price) - 1 for o in graph.options)
    graph.learn(gone, Clash((patches,), "the furniture would fall apart", cuts=True))
    assert promising(graph, {"back": 0.0, "side": 0.0}, np.inf).wanted == ("back", "side")


def test_beside_a_promise_nothing_is_dragged_along(problem: Make) -> None:
    """Slanted walls cost nothing, but what is promised comes straight down, and then all do."""
    made = problem("box_with_table")
    own = repertoire(made, made.unit_of["left"])
    graph = Graph(made, own, unhindered(made, own), np.zeros(3))
    assert {x.variant.mechanism for x in own.lanes} == {"slanted"}
    assert promising(graph, {"left": 0.0}, 10.0).wanted == ()
    assert promising(graph, {"left": 0.0, "right": 0.0}, 10.0).wanted == ("left", "right")


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
