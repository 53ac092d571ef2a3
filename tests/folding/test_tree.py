"""Clusters are read off intervals of the tree of bases; here they are found by graph searches."""

from __future__ import annotations

from collections.abc import Callable

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from foldfab.folding.tree import UnitTree, between, clusters, unit_tree
from foldfab.folding.units import Unit, decompose, merged
from foldfab.scaffold.model import Scaffold

steady = settings(deadline=None, derandomize=True, max_examples=80)
Furniture = tuple[tuple[str, ...], tuple[Unit, ...]]


@st.composite
def furniture(draw: st.DrawFn) -> Furniture:
    """Bases in any order, and units that join them into a tree; some units are T-scaffolds on a single base."""
    joined, members = 1, list[list[int]]()
    for _ in range(draw(st.integers(1, 7))):
        new = draw(st.integers(0, 3))
        members.append([draw(st.integers(0, joined - 1)), *range(joined, joined + new)])
        joined += new
    names = [f"b{i}" for i in draw(st.permutations(range(joined)))]
    bases = tuple(sorted(names))
    order = draw(st.permutations(members))
    units = tuple(
        Unit(f"u{i}", (f"p{i}", f"q{i}"), tuple(sorted(names[b] for b in many))) for i, many in enumerate(order)
    )
    return bases, units


def without(bases: tuple[str, ...], units: tuple[Unit, ...], unit: Unit) -> nx.Graph[str]:
    """What hangs together when the patches of a unit are taken away."""
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(bases)
    for other in units:
        if not set(other.patches) & set(unit.patches):
            nx.add_path(graph, other.bases)
    return graph


def by_search(bases: tuple[str, ...], units: tuple[Unit, ...], unit: Unit) -> list[int]:
    """For each base, the lowest of the unit's bases that it hangs together with."""
    graph = without(bases, units, unit)
    return [
        next(i for i, own in enumerate(unit.bases) if own in nx.node_connected_component(graph, base)) for base in bases
    ]


@given(furniture())
@steady
def test_every_base_moves_with_the_base_of_the_unit_that_it_hangs_on(made: Furniture) -> None:
    bases, units = made
    tree = unit_tree(bases, units)
    for unit in units:
        assert clusters(tree, unit).tolist() == by_search(bases, units, unit)


@given(furniture(), st.data())
@steady
def test_so_it_is_for_units_that_are_merged(made: Furniture, data: st.DataObject) -> None:
    bases, units = made
    some = data.draw(st.sets(st.sampled_from(range(len(units))), min_size=1))
    parts = [units[i] for i in sorted(some)]
    patches = tuple(sorted(p for u in parts for p in u.patches))
    # A merged unit has the name of one of its own.
    whole = Unit(parts[0].name, patches, tuple(sorted({b for u in parts for b in u.bases})))
    assert clusters(unit_tree(bases, units), whole).tolist() == by_search(bases, units, whole)


@given(furniture(), st.data())
@steady
def test_between_two_bases_are_the_units_on_the_way_from_one_to_the_other(made: Furniture, data: st.DataObject) -> None:
    bases, units = made
    tree = unit_tree(bases, units)
    graph: nx.Graph[str] = nx.Graph()
    graph.add_edges_from((unit.name, base) for unit in units for base in unit.bases)
    graph.add_nodes_from(bases)
    a, b = (data.draw(st.integers(0, len(bases) - 1)) for _ in range(2))
    way = nx.shortest_path(graph, bases[a], bases[b])
    assert {unit.name for unit in between(tree, a, b)} == {name for name in way if name.startswith("u")}


@pytest.fixture
def tower() -> UnitTree:
    """Three boards over one another, on a wall each, and a flap on the middle one."""
    units = (Unit("a", ("a",), ("low", "mid")), Unit("b", ("b",), ("mid", "top")), Unit("flap", ("flap",), ("mid",)))
    return unit_tree(("low", "mid", "top"), units)


def test_the_tree_is_rooted_in_the_first_base(tower: UnitTree) -> None:
    assert tower.parent.tolist() == [-1, 0, 1]
    assert [unit and unit.name for unit in tower.above] == [None, "a", "b"]
    assert (tower.last - tower.first).tolist() == [3, 2, 1]


def test_what_stands_on_the_middle_board_moves_with_it_while_the_lower_wall_folds(tower: UnitTree) -> None:
    assert clusters(tower, tower.units["a"]).tolist() == [0, 1, 1]
    assert clusters(tower, tower.units["b"]).tolist() == [0, 0, 1]
    assert clusters(tower, tower.units["flap"]).tolist() == [0, 0, 0]


def test_a_unit_is_not_between_a_base_and_itself(tower: UnitTree) -> None:
    assert between(tower, 1, 1) == set()
    assert {unit.name for unit in between(tower, 2, 0)} == {"a", "b"}


def test_numbers_cannot_be_changed(tower: UnitTree) -> None:
    with pytest.raises(ValueError, match="read-only"):
        tower.first[0] = 1


def test_real_furniture_makes_the_tree_of_its_units(scaffold: Callable[..., Scaffold]) -> None:
    made = scaffold("box_with_table")
    units = decompose(made)
    bases = tuple(b.name for b in made.bases)
    tree = unit_tree(bases, units)
    for unit in (*units, merged(made, units)):
        assert clusters(tree, unit).tolist() == by_search(bases, units, unit)
