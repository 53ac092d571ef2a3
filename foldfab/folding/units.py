"""Decomposition of a scaffold into folding units (section 5.2).

The hinge graph has the patches as nodes and the hinges as edges. Hinges that share a simple cycle, transitively, are
exactly the edges of one biconnected component, so no cycle is ever enumerated; a hinge on no cycle is merged with the
other hinge of its own basic scaffold. Linear in the number of hinges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import networkx as nx

from foldfab.scaffold.model import Scaffold

Node = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Unit:
    """Basic scaffolds whose foldings influence each other."""

    name: str
    patches: tuple[str, ...]
    """Sorted."""
    bases: tuple[str, ...]
    """In the scaffold's order, lowest first."""


def hinge_graph(scaffold: Scaffold) -> nx.Graph[Node]:
    """Definition 1: nodes ("base" | "patch", name), an edge for each hinge."""
    graph: nx.Graph[Node] = nx.Graph()
    graph.add_nodes_from(("base", base.name) for base in scaffold.bases)
    for patch in scaffold.patches:
        graph.add_edges_from((("patch", patch.name), ("base", base)) for base in patch.bases)
    return graph


def decompose(scaffold: Scaffold) -> tuple[Unit, ...]:
    """The folding units of the scaffold, sorted by name; each foldable patch is in exactly one."""
    groups: nx.Graph[str] = nx.Graph()
    groups.add_nodes_from(patch.name for patch in scaffold.patches)
    # The stubs of networkx nest the sets one level too deep.
    components: Any = nx.biconnected_components(hinge_graph(scaffold))
    for component in components:
        members = sorted(name for kind, name in component if kind == "patch")
        if len(component) > 2:
            nx.add_path(groups, members)
    return tuple(sorted((_unit(scaffold, sorted(c)) for c in nx.connected_components(groups)), key=lambda u: u.name))


def merged(scaffold: Scaffold, units: tuple[Unit, ...]) -> Unit:
    """One unit of all patches of several (section 5.5, the fallback)."""
    return _unit(scaffold, sorted(patch for unit in units for patch in unit.patches))


def _unit(scaffold: Scaffold, patches: list[str]) -> Unit:
    touched = {base for name in patches for base in scaffold.patch(name).bases}
    return Unit(patches[0], tuple(patches), tuple(b.name for b in scaffold.bases if b.name in touched))
