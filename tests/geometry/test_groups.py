"""Groups are the connected components."""

from __future__ import annotations

import networkx as nx
from hypothesis import given
from hypothesis import strategies as st

from foldfab.geometry.groups import Groups

joints = st.integers(1, 30).flatmap(
    lambda n: st.tuples(st.just(n), st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=40))
)


@given(joints)
def test_groups_are_the_connected_components(made: tuple[int, list[tuple[int, int]]]) -> None:
    count, pairs = made
    graph: nx.Graph[int] = nx.Graph(pairs)
    graph.add_nodes_from(range(count))
    found = Groups(count, pairs)
    assert found.all() == sorted(sorted(c) for c in nx.connected_components(graph))
    assert all(found.of(member) == min(group) for group in found.all() for member in group)


def test_nothing_has_no_groups() -> None:
    assert Groups(0).all() == []
