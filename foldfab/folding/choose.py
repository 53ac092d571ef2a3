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

from foldfab.folding.eliminate import eliminated
from foldfab.folding.exact import proven
from foldfab.folding.work import Work
from foldfab.geometry.arrays import Array, Bools

EPSILON = 1e-12
"""A choice must be cheaper by more than this to be better."""
LIMIT = 1_500
"""Branches after which CP-SAT takes over."""
SHORT = 100
"""The same where it had to before: as many as give it a choice to start from."""
FEW = 8
"""Groups beyond which elimination is tried first."""
WIDEST = 100
"""Groups beyond which CP-SAT is asked at once."""

Table = list[dict[int, Bools]]
"""For each group, by other group, which of their options (n, m) exclude each other."""

Combination = tuple[tuple[int, tuple[int, ...]], ...]
"""Groups that must not all take one of some options of theirs."""


def cheapest(
    costs: list[Array],
    conflicts: Mapping[tuple[int, int], Bools],
    forbidden: frozenset[Combination] = frozenset(),
    gaps: list[float] | None = None,
    tangled: set[tuple[int, ...]] | None = None,
    work: Work | None = None,
) -> tuple[int, ...] | None:
    """The option of each group in the cheapest conflict-free choice, or None where there is none.

    Args:
        costs: for each group, the costs (n,) of its options; infinite where an option is out of the question.
        conflicts: by groups (g, h) with g < h, which options (n_g, n_h) exclude each other; a missing pair has none.
        forbidden: what must not all be taken together.
        gaps: gets by how much the choice may be dearer than the cheapest one, where the work did not suffice to tell.
        tangled: gets the groups that plain branch and bound gave up on, and says on which it need not be tried again.
        work: is charged for what CP-SAT does.
    """
    if not conflicts and not forbidden:
        return tuple(int(np.argmin(c)) for c in costs) if all(np.isfinite(c.min()) for c in costs) else None
    table = _by_group(len(costs), conflicts)
    held = _held(costs, forbidden)
    alive = [_undominated(costs[g], [*table[g].values(), *held[g]]) for g in range(len(costs))]
    taken: dict[int, int] = {}
    for groups in _islands(alive, table, forbidden):
        if len(groups) == 1 and not held[groups[0]]:
            price = np.where(alive[groups[0]], costs[groups[0]], np.inf)
            best: dict[int, int] | None = {groups[0]: int(np.argmin(price))} if np.isfinite(price).any() else None
        else:
            own = {g: alive[g] for g in groups}
            best, gap, spent = _solved(own, costs, table, forbidden, tangled if tangled is not None else set())
            if work is not None:
                work.charge(spent)
            if gaps is not None and gap > 0:
                gaps.append(gap)
        if best is None:
            return None
        taken.update(best)
    return tuple(taken[g] for g in range(len(costs)))


def _by_group(count: int, conflicts: Mapping[tuple[int, int], Bools]) -> Table:
    table: Table = [{} for _ in range(count)]
    for (g, h), excluded in conflicts.items():
        table[g][h] = excluded
        table[h][g] = excluded.T
    return table


def _held(costs: list[Array], forbidden: frozenset[Combination]) -> list[list[Bools]]:
    """For each group, which of its options (n, 1) belong to each forbidden combination that it takes part in."""
    held: list[list[Bools]] = [[] for _ in costs]
    for combination in sorted(forbidden):
        for g, options in combination:
            held[g].append(np.isin(np.arange(len(costs[g])), options)[:, None])
    return held


def _undominated(price: Array, conflicts: list[Bools]) -> Bools:
    """Which options (n,) of a group are worth looking at: none that is no dearer excludes no more.

    To belong to a forbidden combination is to exclude something as well.
    """
    alive: Bools = np.isfinite(price)
    rest = np.nonzero(alive)[0]
    rest = rest[np.argsort(price[rest], kind="stable")]
    excludes = np.concatenate([np.zeros((len(rest), 1), dtype=bool), *(m[rest] for m in conflicts)], axis=1)
    if len(rest) and not excludes[0].any():
        # The cheapest option of all excludes nothing: it dominates every other one.
        alive[rest[1:]] = False
        return alive
    alive[rest[_dominated(excludes)]] = False
    return alive


def _dominated(excludes: Bools) -> Bools:
    """Which options (n,), cheapest first, one before them dominates, as it excludes (n, m) no more."""
    bits = np.packbits(excludes, axis=1)
    found = np.zeros(len(bits), dtype=bool)
    for i in range(len(bits)):
        # What is dominated dominates nothing that its own dominator does not.
        if not found[i]:
            found[i + 1 :] |= ~(bits[i] & ~bits[i + 1 :]).any(1)
    return found


def _islands(alive: list[Bools], table: Table, forbidden: frozenset[Combination]) -> list[list[int]]:
    """Sets of groups without a conflict between them."""
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(len(alive)))
    for g, row in enumerate(table):
        own = np.nonzero(alive[g])[0]
        graph.add_edges_from((g, h) for h, m in row.items() if g < h and m[own][:, alive[h]].any())
    for combination in forbidden:
        nx.add_path(graph, [g for g, _ in combination])
    return sorted(sorted(c) for c in nx.connected_components(graph))


def _solved(
    alive: Mapping[int, Bools], costs: list[Array], table: Table, forbidden: frozenset[Combination],
    tangled: set[tuple[int, ...]],
) -> tuple[dict[int, int] | None, float, float]:  # fmt: skip
    """The best option for each group, by how much it may be too dear, and the charge for CP-SAT."""
    groups = set(alive)
    own = [c for c in forbidden if {g for g, _ in c} <= groups]
    if len(groups) > FEW and not own:
        found = eliminated(alive, costs, table)
        if found is not None:
            return found, 0.0, 0.0
    search = _Search(costs, table, own, SHORT if tuple(alive) in tangled else LIMIT)
    if len(groups) <= WIDEST:
        search.branch(dict(alive), {}, 0.0)
        if search.left >= 0:
            return search.best, 0.0, 0.0
        tangled.add(tuple(alive))
    return proven(alive, costs, table, sorted(own), search.best)


class _Search:
    """State of one branch and bound."""

    def __init__(self, costs: list[Array], table: Table, forbidden: list[Combination], limit: int) -> None:
        self.costs = costs
        self.table = table
        self.forbidden: dict[tuple[int, int], list[Mapping[int, frozenset[int]]]] = {}
        """By (group, option), the forbidden combinations that it belongs to."""
        for combination in sorted(forbidden):
            together = {g: frozenset(options) for g, options in combination}
            for place in ((g, option) for g, options in combination for option in options):
                self.forbidden.setdefault(place, []).append(together)
        self.left = limit
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
        if any(all(now.get(g) in held for g, held in many.items()) for many in self.forbidden.get((group, option), ())):
            return
        left = {}
        for other, options in alive.items():
            if other != group:
                table = self.table[group].get(other)
                left[other] = options if table is None else options & ~table[option]
                if not left[other].any():
                    return
        self.branch(left, now, spent + float(self.costs[group][option]))
