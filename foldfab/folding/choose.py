"""The cheapest choice of one option a group without conflicts: the MWISP of section 5.4.

All options of one patch form a clique, so a maximum-weight independent set of the conflict graph with weights
max cost - cost + 1 takes exactly one option of each patch; it is found here directly as the cheapest such choice.
Depth-first branch and bound: the group with the fewest options left is branched on first, options cheapest first, and
a branch is cut where the cheapest options left in each group cannot beat the best choice known. Exact; exponential in
the worst case, milliseconds on furniture. Options with the same cost are taken in the order given.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.geometry.arrays import Array, Bools

EPSILON = 1e-12
"""A choice must be cheaper by more than this to be better."""


def cheapest(
    costs: list[Array],
    conflicts: Mapping[tuple[int, int], Bools],
    forbidden: frozenset[tuple[tuple[int, int], ...]] = frozenset(),
    limit: int = 200_000,
) -> tuple[int, ...] | None:
    """The option of each group in the cheapest conflict-free choice, or None where there is none.

    Args:
        costs: for each group, the costs (n,) of its options; infinite where an option is out of the question.
        conflicts: by groups (g, h) with g < h, which options (n_g, n_h) exclude each other; a missing pair has none.
        forbidden: combinations of (group, option) that must not all be taken together.
        limit: branches to look at before the best choice so far is returned.
    """
    search = _Search(costs, conflicts, forbidden, limit)
    search.branch([np.isfinite(c) for c in costs], {}, 0.0)
    return search.best


class _Search:
    """State of one branch and bound."""

    def __init__(
        self, costs: list[Array], conflicts: Mapping[tuple[int, int], Bools],
        forbidden: frozenset[tuple[tuple[int, int], ...]], limit: int,
    ) -> None:  # fmt: skip
        self.costs = costs
        self.table = {**conflicts, **{(h, g): m.T for (g, h), m in conflicts.items()}}
        self.forbidden = sorted(forbidden)
        self.left = limit
        self.best: tuple[int, ...] | None = None
        self.bound = np.inf

    def branch(self, alive: list[Bools], taken: dict[int, int], spent: float) -> None:
        """Looks at all completions of the options `taken`, given the options still `alive` in each group."""
        rest = [g for g in range(len(self.costs)) if g not in taken]
        least = [float(np.where(alive[g], self.costs[g], np.inf).min()) for g in rest]
        self.left -= 1
        if spent + sum(least) >= self.bound - EPSILON or self.left < 0:
            return
        if not rest:
            self.best, self.bound = tuple(taken[g] for g in range(len(self.costs))), spent
            return
        group = min(rest, key=lambda g: (int(alive[g].sum()), g))
        order = np.argsort(np.where(alive[group], self.costs[group], np.inf), kind="stable")
        slack = sum(least) - least[rest.index(group)]
        for option in order[: int(alive[group].sum())]:
            if spent + float(self.costs[group][option]) + slack >= self.bound - EPSILON:
                return
            self._descend(alive, taken, spent, group, int(option))

    def _descend(self, alive: list[Bools], taken: dict[int, int], spent: float, group: int, option: int) -> None:
        now = {**taken, group: option}
        if any(all(now.get(g) == o for g, o in combination) for combination in self.forbidden):
            return
        left = list(alive)
        for other in range(len(left)):
            table = self.table.get((group, other))
            if table is not None and other not in now:
                left[other] = left[other] & ~table[option]
                if not left[other].any():
                    return
        self.branch(left, now, spent + float(self.costs[group][option]))
