"""Structural soundness (section 5.7): parts without hinges in their interior.

Splits of an un-hingeable patch are pruned, so an H-scaffold of it can only slant. Where its unit cannot slant, or does
better without, it is disconnected at its top end and becomes a T-scaffold that folds slanted. Disconnections cost
nothing, like slanting, but they must leave the furniture in one piece.
"""

from __future__ import annotations

from dataclasses import replace

import networkx as nx
import numpy as np

from foldfab.folding.anatomy import faces
from foldfab.folding.model import Thickness
from foldfab.scaffold.model import Patch, Scaffold


def rigid_patches(scaffold: Scaffold) -> tuple[str, ...]:
    """Names of the un-hingeable patches that stand between two bases."""
    return tuple(p.name for p in scaffold.patches if not p.hingeable and len(p.bases) == 2)


def disconnected(scaffold: Scaffold, names: tuple[str, ...], thickness: Thickness) -> Scaffold:
    """The scaffold with those patches disconnected at their top end, as far as it stays in one piece."""
    loose: list[str] = []
    for name in names:
        loose += [name] if hangs_together(scaffold, {*loose, name}) else []
    cut = tuple(_cut_at_top(scaffold, p, thickness) if p.name in loose else p for p in scaffold.patches)
    notes = tuple(f"{name} is disconnected at its top end, because it must not get a hinge" for name in loose)
    return replace(scaffold, patches=cut, notes=(*scaffold.notes, *notes))


def hangs_together(scaffold: Scaffold, loose: set[str]) -> bool:
    """Whether the patches other than those that are loose hold all bases together."""
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(base.name for base in scaffold.bases)
    graph.add_edges_from(p.bases for p in scaffold.patches if len(p.bases) == 2 and p.name not in loose)
    return bool(nx.is_connected(graph))


def _cut_at_top(scaffold: Scaffold, patch: Patch, thickness: Thickness) -> Patch:
    """The patch as a T-scaffold on its lower base, a gap short of its upper one."""
    assert patch.upper is not None
    # The end of a leaning panel has a corner that stands higher than its middle.
    corner = thickness.of(patch.thickness).panel / 2 * float(np.hypot(patch.up[0], patch.up[1]))
    top = faces(scaffold.base(patch.upper), thickness).bottom - thickness.gap - corner
    taken = float(patch.center[2] + patch.up[2] * patch.length / 2 - top) / float(patch.up[2])
    center = patch.center - patch.up * taken / 2
    return replace(patch, center=center, length=patch.length - taken, upper=None)
