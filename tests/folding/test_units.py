"""Folding units are the clusters of hinges that share cycles, found without enumerating any cycle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding.units import Node, decompose, hinge_graph, merged
from foldfab.scaffold.model import BasePatch, Outline, Patch, Scaffold

Make = Callable[..., Scaffold]
Ends = list[tuple[int, int | None]]


def groups(scaffold: Scaffold) -> set[frozenset[str]]:
    return {frozenset(unit.patches) for unit in decompose(scaffold)}


def linked(scaffold: Scaffold, count: int, ends: Ends) -> Scaffold:
    """A scaffold of `count` bases and a patch for each pair of ends; None is a free tip."""
    outline = Outline("b0", np.zeros(2), np.array([1.0, 0.0]), np.ones(2))
    bases = tuple(BasePatch(f"b{i}", (f"b{i}",), 9.0 * i, 9.0 * i, (outline,)) for i in range(count))
    x, z = np.eye(3)[[0, 2]]
    patches = tuple(
        Patch(f"p{i:02}", (f"p{i:02}",), np.zeros(3), x, z, 9.0, 9.0, f"b{low}", None if high is None else f"b{high}")
        for i, (low, high) in enumerate(ends)
    )
    return replace(scaffold, bases=bases, patches=patches)


def by_cycles(scaffold: Scaffold) -> set[frozenset[str]]:
    """Section 5.2 to the letter: hinges of all simple cycles are clustered where cycles share a hinge."""
    clusters: nx.Graph[frozenset[Node]] = nx.Graph()
    graph = hinge_graph(scaffold)
    clusters.add_nodes_from(frozenset(edge) for edge in graph.edges)
    for cycle in nx.simple_cycles(graph):
        nx.add_path(clusters, [frozenset(edge) for edge in pairwise([*cycle, cycle[0]])])
    for patch in scaffold.patches:
        own = [frozenset({("patch", patch.name), ("base", base)}) for base in patch.bases]
        nx.add_path(clusters, own)
    return {
        frozenset(name for hinge in cluster for kind, name in hinge if kind == "patch")
        for cluster in nx.connected_components(clusters)
    }


@given(st.data())
@settings(deadline=None, derandomize=True, max_examples=80)
def test_units_are_what_the_cycles_of_the_hinge_graph_say(scaffold: Make, data: st.DataObject) -> None:
    count = data.draw(st.integers(2, 5))
    base = st.integers(0, count - 1)
    pair = st.tuples(base, st.none() | base).filter(lambda ends: ends[0] != ends[1])
    made = linked(scaffold("t_scaffold"), count, data.draw(st.lists(pair, min_size=1, max_size=8)))
    assert groups(made) == by_cycles(made)


def test_the_hinge_graph_has_an_edge_for_each_hinge(scaffold: Make) -> None:
    graph = hinge_graph(scaffold("box_with_table"))
    assert sorted(graph.nodes) == sorted(
        [("base", b) for b in ("ground", "top", "ceiling")]
        + [("patch", p) for p in ("left", "right", "leg-left", "leg-right")]
    )
    assert graph.number_of_edges() == 8
    assert not any(a[0] == b[0] for a, b in graph.edges)


def test_a_box_with_a_table_has_two_units(scaffold: Make) -> None:
    """Figure 8 b."""
    assert groups(scaffold("box_with_table")) == {frozenset({"left", "right"}), frozenset({"leg-left", "leg-right"})}


def test_walls_between_the_same_bases_are_one_unit(scaffold: Make) -> None:
    """Figure 13 a."""
    assert groups(scaffold("three_walls")) == {frozenset({"back", "left", "right"})}


@pytest.mark.parametrize("name", ["table", "tower"])
def test_patches_on_no_cycle_are_units_of_their_own(scaffold: Make, name: str) -> None:
    """The bridges of figures 3 a and 7."""
    assert all(len(group) == 1 for group in groups(scaffold(name)))


def test_stacked_shelves_are_a_unit_each(scaffold: Make) -> None:
    assert groups(scaffold("shelf")) == {frozenset({"a", "b"}), frozenset({"c", "d"})}


def test_a_wall_around_a_shelf_makes_one_unit_of_all(scaffold: Make) -> None:
    """Figure 3 c: the cycle runs through both shelves and the wall past them."""
    ends: Ends = [(0, 1), (1, 2), (0, 2)]
    assert len(groups(linked(scaffold("t_scaffold"), 3, ends))) == 1


def test_units_list_their_bases_lowest_first_and_are_named_after_their_first_patch(scaffold: Make) -> None:
    first, second = decompose(scaffold("box_with_table"))
    assert (first.name, first.patches, first.bases) == ("left", ("left", "right"), ("ground", "ceiling"))
    assert (second.name, second.bases) == ("leg-left", ("ground", "top"))


def test_every_patch_is_in_exactly_one_unit(scaffold: Make, furniture: dict[str, object]) -> None:
    for name in furniture:
        made = scaffold(name)
        assert sorted(p for unit in decompose(made) for p in unit.patches) == [p.name for p in made.patches]


def test_merged_units_hold_all_patches_and_bases(scaffold: Make) -> None:
    made = scaffold("box_with_table")
    whole = merged(made, decompose(made))
    assert whole.patches == ("left", "leg-left", "leg-right", "right")
    assert whole.bases == ("ground", "top", "ceiling")
