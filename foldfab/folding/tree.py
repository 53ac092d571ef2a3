"""How the units hang together: without its own patches, the furniture falls into one cluster for each base of a unit.

Bases and units make a tree (the block tree of the hinge graph), rooted in the furniture's lowest base. The cluster of
a unit's child base is that base's subtree, and everything else belongs to its parent base; with bases numbered in
depth-first order a subtree is an interval, so the clusters of any unit take one comparison a base.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import networkx as nx
import numpy as np

from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Indices, frozen_indices


@dataclass(frozen=True, slots=True, eq=False)
class UnitTree:
    """The bases of a scaffold, numbered in its own order, and the units that join them."""

    number: Mapping[str, int]
    """By base, its number."""
    first: Indices
    """(b,) place of each base in depth-first order."""
    last: Indices
    """(b,) one past the place of the last base of its subtree."""
    above: tuple[Unit | None, ...]
    """(b,) the unit that joins each base to its parent base; None for the root."""
    parent: Indices
    """(b,) number of each base's parent, -1 for the root."""
    units: Mapping[str, Unit]
    """By name."""

    def __post_init__(self) -> None:
        for name in ("first", "last", "parent"):
            object.__setattr__(self, name, frozen_indices(getattr(self, name), len(self.number)))


def unit_tree(bases: tuple[str, ...], units: tuple[Unit, ...]) -> UnitTree:
    """The tree of bases that the units join, rooted in the first base."""
    number = {base: i for i, base in enumerate(bases)}
    joined: dict[int, list[Unit]] = {i: [] for i in range(len(bases))}
    for unit in units:
        for name in unit.bases:
            joined[number[name]].append(unit)
    first, last = np.zeros(len(bases), dtype=np.int64), np.zeros(len(bases), dtype=np.int64)
    parent, above = np.full(len(bases), -1), list[Unit | None]([None] * len(bases))
    place, stack, entered = 0, [(0, False)], {0}
    while stack:
        base, is_done = stack.pop()
        if is_done:
            last[base] = place
            continue
        first[base], place = place, place + 1
        stack.append((base, True))
        for unit in joined[base]:
            for other in (number[b] for b in unit.bases):
                if other not in entered:
                    entered.add(other)
                    parent[other], above[other] = base, unit
                    stack.append((other, False))
    return UnitTree(number, first, last, tuple(above), parent, {u.name: u for u in units})


def clusters(tree: UnitTree, unit: Unit) -> Indices:
    """(b,) for each base, which of the unit's bases (by its place in `unit.bases`) it moves with."""
    own = [tree.number[b] for b in unit.bases]
    if tree.units.get(unit.name) is not unit:
        return _clusters_of_merged(tree, unit)
    root = min(range(len(own)), key=lambda i: int(tree.first[own[i]]))
    found = np.full(len(tree.first), root)
    for i, base in enumerate(own):
        if i != root:
            found[(tree.first >= tree.first[base]) & (tree.first < tree.last[base])] = i
    return found


def between(tree: UnitTree, a: int, b: int) -> set[Unit]:
    """The units on the way from one base to another; they decide how far apart the two are."""
    found: set[Unit] = set()
    while a != b:
        # The one that was entered later is not an ancestor of the other.
        if tree.first[a] > tree.first[b]:
            unit, a = tree.above[a], int(tree.parent[a])
        else:
            unit, b = tree.above[b], int(tree.parent[b])
        assert unit is not None
        found.add(unit)
    return found


def _clusters_of_merged(tree: UnitTree, unit: Unit) -> Indices:
    """The same for units merged into one, which are no block of the tree."""
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(tree.first)))
    for other in tree.units.values():
        if not set(other.patches) & set(unit.patches):
            nx.add_path(graph, [tree.number[b] for b in other.bases])
    own = {tree.number[b]: i for i, b in enumerate(unit.bases)}
    found = np.zeros(len(tree.first), dtype=np.int64)
    for component in nx.connected_components(graph):
        lead = min((own[b] for b in component if b in own), default=0)
        found[list(component)] = lead
    return found
