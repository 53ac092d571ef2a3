"""The cheapest choice of one option a group without conflicts: the MWISP of section 5.4.

All options of one patch form a clique, so a maximum-weight independent set of the conflict graph with weights
max cost - cost + 1 takes exactly one option of each patch; it is found here directly as the cheapest such choice.

First an option goes where another one of its group is no dearer and excludes no more (dominance); what is left falls
into groups that have no conflicts with each other, and each of these is solved by depth-first branch and bound: the
group with the fewest options left is branched on first, options cheapest first, and a branch is cut where the cheapest
options left in each group cannot beat the best choice known. Where that takes more than `LIMIT` branches the best
choice so far is handed to CP-SAT, which proves or betters it. Milliseconds on most furniture, exponential in the worst
case. Options of the same cost are taken in the order given.
"""

from __future__ import annotations

from collections.abc import Mapping

import networkx as nx
import numpy as np

from foldfab.folding.exact import proven
from foldfab.geometry.arrays import Array, Bools

EPSILON = 1e-12
"""A choice must be cheaper by more than this to be better."""
LIMIT = 1_500
"""Branches after which CP-SAT takes over."""

Combination = tuple[tuple[int, int], ...]
"""Options that must not all be taken together, each as (group, option)."""


def cheapest(
    costs: list[Array],
    conflicts: Mapping[tuple[int, int], Bools],
    forbidden: frozenset[Combination] = frozenset(),
    worth: list[Bools] | None = None,
) -> tuple[int, ...] | None:
    """The option of each group in the cheapest conflict-free choice, or None where there is none.

    Args:
        costs: for each group, the costs (n,) of its options; infinite where an option is out of the question.
        conflicts: by groups (g, h) with g < h, which options (n_g, n_h) exclude each other; a missing pair has none.
        forbidden: combinations of (group, option) that must not all be taken together.
        worth: for each group, which of its options (n,) are `undominated`, where that is known already.
    """
    table = {**conflicts, **{(h, g): m.T for (g, h), m in conflicts.items()}}
    worth = worth or [undominated(g, costs, conflicts, forbidden) for g in range(len(costs))]
    alive = [mask & np.isfinite(price) for mask, price in zip(worth, costs, strict=True)]
    taken: dict[int, int] = {}
    for groups in _islands(alive, table, forbidden):
        search = _Search(costs, table, forbidden)
        search.branch({g: alive[g] for g in groups}, {}, 0.0)
        best = search.best
        if search.left < 0:
            best = proven({g: alive[g] for g in groups}, costs, table, sorted(forbidden), best)
        if best is None:
            return None
        taken.update(best)
    return tuple(taken[g] for g in range(len(costs)))


def undominated(
    group: int, costs: list[Array], conflicts: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination]
) -> Bools:
    """Which options (n,) of a group are worth looking at; it holds until a conflict or a cost of the group changes."""
    price = costs[group]
    count = len(price)
    rows = [m for (g, _), m in sorted(conflicts.items(), key=_key) if g == group]
    rows += [m.T for (_, h), m in sorted(conflicts.items(), key=_key) if h == group]
    excludes = np.concatenate([np.zeros((count, 1), dtype=bool), *rows], axis=1).astype(np.float32)
    more = excludes @ (1 - excludes).T > 0
    order = np.arange(count)
    is_cheaper = (price[:, None] < price) | ((price[:, None] == price) & (order[:, None] < order))
    # An option that belongs to a forbidden combination may have to give way to one that it would dominate.
    free = np.ones(count, dtype=bool)
    free[[o for combination in forbidden for g, o in combination if g == group]] = False
    dominates: Bools = ~more & is_cheaper & free[:, None]
    alive: Bools = np.isfinite(price) & ~np.logical_or.reduce(dominates, axis=0)
    return alive


def _key(item: tuple[tuple[int, int], Bools]) -> tuple[int, int]:
    return item[0]


def _islands(
    alive: list[Bools], table: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination]
) -> list[list[int]]:
    """Sets of groups without a conflict between them."""
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(alive)))
    graph.add_edges_from((g, h) for (g, h), m in table.items() if m[alive[g]][:, alive[h]].any())
    for combination in forbidden:
        nx.add_path(graph, [g for g, _ in combination])
    return sorted(sorted(c) for c in nx.connected_components(graph))


class _Search:
    """State of one branch and bound."""

    def __init__(
        self, costs: list[Array], table: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination]
    ) -> None:
        self.costs = costs
        self.table = table
        self.forbidden = sorted(forbidden)
        self.left = LIMIT
        self.best: dict[int, int] | None = None
        self.bound = np.inf

    def branch(self, alive: dict[int, Bools], taken: dict[int, int], spent: float) -> None:
        """Looks at all completions of the options `taken`, given the options still `alive` in the other groups."""
        least = {g: float(np.where(left, self.costs[g], np.inf).min()) for g, left in alive.items()}
        total = sum(least.values())
        self.left -= 1
        if spent + total >= self.bound - EPSILON or self.left < 0:
            return
        if not alive:
            self.best, self.bound = taken, spent
            return
        group = min(alive, key=lambda g: (int(alive[g].sum()), g))
        order = np.argsort(np.where(alive[group], self.costs[group], np.inf), kind="stable")
        for option in order[: int(alive[group].sum())]:
            if spent + float(self.costs[group][option]) + total - least[group] >= self.bound - EPSILON:
                return
            self._descend(alive, taken, spent, group, int(option))

    def _descend(self, alive: dict[int, Bools], taken: dict[int, int], spent: float, group: int, option: int) -> None:
        now = {**taken, group: option}
        if any(all(now.get(g) == o for g, o in combination) for combination in self.forbidden):
            return
        left = {}
        for other, options in alive.items():
            if other != group:
                table = self.table.get((group, other))
                left[other] = options if table is None else options & ~table[option]
                if not left[other].any():
                    return
        self.branch(left, now, spent + float(self.costs[group][option]))
