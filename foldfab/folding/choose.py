"""The cheapest choice of one option a group without conflicts: the MWISP of section 5.4.

All options of one patch form a clique, so a maximum-weight independent set of the conflict graph with weights
max cost - cost + 1 takes exactly one option of each patch; it is found here directly as the cheapest such choice.

Where the cheapest options of all groups go together, they are the choice. Else an option goes first where another one
of its group is no dearer and excludes no more (dominance); what is left falls into groups that have no conflicts with
each other, and each of these is solved by depth-first branch and bound: the group with the fewest options left is
branched on first, options cheapest first, and a branch is cut where the cheapest options left in each group cannot beat
the best choice known. Where that takes more than `LIMIT` branches the best
choice so far is handed to CP-SAT, which proves or betters it. Milliseconds on most furniture, exponential in the worst
case. Options of the same cost are taken in the order given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from foldfab.folding.eliminate import eliminated
from foldfab.folding.exact import WORK, proven
from foldfab.folding.work import ENGINE, STARTING, Work
from foldfab.geometry.arrays import Array, Bools, Indices

EPSILON = 1e-12
"""A choice must be cheaper by more than this to be better."""
LIMIT = 1_500
"""Branches after which CP-SAT takes over."""
SHORT = 100
"""The same where it had to before: as many as give it a choice to start from."""
FEW_BRANCHES = 600
"""The same where it is only asked whether there is something cheaper: most of what would be dearer is left out."""
FEW = 8
"""Groups beyond which elimination is tried first."""
WIDEST = 100
"""Groups beyond which CP-SAT is asked at once."""

Table = list[dict[int, Bools]]
"""For each group, by other group, which of their options (n, m) exclude each other."""

Combination = tuple[tuple[int, tuple[int, ...]], ...]
"""Groups that must not all take one of some options of theirs."""


def cheapest(
    costs: list[Array], conflicts: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination] = frozenset(),
    gaps: list[float] | None = None, tangled: set[tuple[int, ...]] | None = None, work: Work | None = None, *,
    is_brief: bool = False,
) -> tuple[int, ...] | None:  # fmt: skip
    """The option of each group in the cheapest conflict-free choice, or None where there is none.

    Args:
        costs: for each group, the costs (n,) of its options; infinite where an option is out of the question.
        conflicts: by groups (g, h) with g < h, which options (n_g, n_h) exclude each other; a missing pair has none.
        forbidden: what must not all be taken together.
        gaps: gets by how much the choice may be dearer than the cheapest one, where the work did not suffice to tell.
        tangled: gets the groups that plain branch and bound gave up on, and says on which it need not be tried again.
        work: is charged for what CP-SAT does.
        is_brief: leaves it with what a few branches find, or with None; the gap is infinite where they do not suffice.
    """
    least = tuple(int(c.argmin()) for c in costs)
    if not all(math.isfinite(c[i]) for c, i in zip(costs, least, strict=True)):
        return None
    if _go_together(least, conflicts, forbidden):
        return least
    table = _by_group(len(costs), conflicts)
    held = _held(costs, forbidden)
    alive = [_undominated(costs[g], [*table[g].values(), *held[g]]) for g in range(len(costs))]
    taken: dict[int, int] = {}
    for groups in _islands(alive, table, forbidden):
        own = {g: alive[g] for g in groups}
        known = tangled if tangled is not None else set()
        best, gap, spent = _solved(own, costs, table, forbidden, known, is_brief=is_brief)
        if work is not None:
            work.charge(spent)
        if gaps is not None and gap > 0:
            gaps.append(gap)
        if best is None:
            return None
        taken.update(best)
    return tuple(taken[g] for g in range(len(costs)))


def cheaper(
    costs: list[Array], conflicts: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination], than: float,
    work: Work | None = None,
) -> tuple[tuple[int, ...] | None, float]:  # fmt: skip
    """The cheapest conflict-free choice, or None where none costs less than something; and what any costs at least.

    Where `FEW_BRANCHES` do not suffice for groups with conflicts between them, CP-SAT is asked, as long as there is
    work left and of all those options alone that could be part of it: they are few where little may be spent.
    """
    least = [float(c.min()) for c in costs]
    # What may be spent beyond the cheapest options of all groups, and what must be.
    floor = sum(least)
    if floor >= than or floor == np.inf:
        return None, floor
    spare = than - floor
    table, held = _by_group(len(costs), conflicts), _held(costs, forbidden)
    able = [_undominated(costs[g], [*table[g].values(), *held[g]]) for g in range(len(costs))]
    alive = [own & (cost - low < spare) for own, cost, low in zip(able, costs, least, strict=True)]
    taken: dict[int, int] = {}
    for groups in _islands(alive, table, forbidden):
        own, part = {g: alive[g] for g in groups}, sum(least[g] for g in groups)
        best, gap = _cheaper(own, costs, table, forbidden, part + spare, work or Work())
        cost = sum(float(costs[g][o]) for g, o in best.items()) if best is not None else part + spare
        floor += max(cost - part - gap, 0.0) if gap < np.inf else 0.0
        if best is None or cost >= part + spare:
            return None, floor
        taken.update(best)
        spare -= cost - part
    return tuple(taken[g] for g in range(len(costs))), floor


def _cheaper(
    alive: Mapping[int, Bools], costs: list[Array], table: Table, forbidden: frozenset[Combination], than: float,
    work: Work,
) -> tuple[dict[int, int] | None, float]:  # fmt: skip
    """The best option for each group, and by how much it may be too dear; none where that is no less than something."""
    within = [c for c in forbidden if {g for g, _ in c} <= set(alive)]
    search = _Search(alive, costs, table, within, FEW_BRANCHES, than)
    best = search.found()
    if search.left >= 0:
        return best, 0.0
    if work.left <= STARTING:
        return best, np.inf
    limit = min((work.left - STARTING) / ENGINE, WORK)
    best, gap, spent = proven(alive, costs, table, sorted(within), best, limit)
    work.charge(spent)
    return best, gap


def _go_together(
    picked: tuple[int, ...], conflicts: Mapping[tuple[int, int], Bools], forbidden: frozenset[Combination]
) -> bool:
    """Whether no two options of a choice exclude each other, and no combination of them is forbidden."""
    return not any(table[picked[g], picked[h]] for (g, h), table in conflicts.items()) and not any(
        all(picked[g] in options for g, options in combination) for combination in forbidden
    )


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
    # What is dominated dominates nothing that its own dominator does not.
    dominators: list[int] = []
    found = np.zeros(len(excludes), dtype=bool)
    for i, own in enumerate(_sets(excludes)):
        found[i] = any(not other & ~own for other in dominators)
        if not found[i]:
            dominators.append(own)
    return found


def _islands(alive: list[Bools], table: Table, forbidden: frozenset[Combination]) -> list[list[int]]:
    """Sets of groups without a conflict between them."""
    beside: list[set[int]] = [set() for _ in alive]
    for g, row in enumerate(table):
        for h, excluded in row.items():
            if g < h and (excluded[alive[g]] & alive[h]).any():
                beside[g].add(h)
                beside[h].add(g)
    for combination in forbidden:
        for g, _ in combination:
            beside[g] |= {h for h, _ in combination}
    found, rest = [], set(range(len(alive)))
    while rest:
        island, fresh = set[int](), {min(rest)}
        while fresh:
            island |= fresh
            fresh = set().union(*(beside[g] for g in fresh)) - island
        rest -= island
        found.append(sorted(island))
    return found


def _solved(
    alive: Mapping[int, Bools], costs: list[Array], table: Table, forbidden: frozenset[Combination],
    tangled: set[tuple[int, ...]], *, is_brief: bool,
) -> tuple[dict[int, int] | None, float, float]:  # fmt: skip
    """The best option for each group, by how much it may be too dear, and the charge for CP-SAT."""
    groups = set(alive)
    own = [c for c in forbidden if {g for g, _ in c} <= groups]
    if len(groups) > FEW and not own:
        found = eliminated(alive, costs, table)
        if found is not None:
            return found, 0.0, 0.0
    best: dict[int, int] | None = None
    if len(groups) <= WIDEST:
        search = _Search(alive, costs, table, own, SHORT if tuple(alive) in tangled else LIMIT)
        best = search.found()
        if search.left >= 0:
            return best, 0.0, 0.0
        tangled.add(tuple(alive))
    if is_brief:
        return best, math.inf, 0.0
    return proven(_worthwhile(alive, costs, best), costs, table, sorted(own), best)


def _worthwhile(
    alive: Mapping[int, Bools], costs: list[Array], best: Mapping[int, int] | None
) -> Mapping[int, Bools]:  # fmt: skip
    """The options that may be part of a choice no dearer than the best known."""
    if best is None:
        return alive
    least = {g: float(costs[g][own].min()) for g, own in alive.items()}
    spare = sum(float(costs[g][o]) - least[g] for g, o in best.items()) + EPSILON
    return {g: own & (costs[g] - least[g] <= spare) for g, own in alive.items()}


class _Search:
    """State of one branch and bound.

    Sets of options of a group are the bits of a number, the lowest one for the cheapest option.
    """

    def __init__(
        self, alive: Mapping[int, Bools], costs: list[Array], table: Table, forbidden: list[Combination], limit: int,
        than: float = np.inf,
    ) -> None:  # fmt: skip
        self.options = {g: _cheapest_first(left, costs[g]) for g, left in alive.items()}
        """By group, its options, cheapest first; all else here goes by their places in it."""
        self.prices = {g: costs[g][own].tolist() for g, own in self.options.items()}
        self.excluded = {
            g: {h: _sets(m[np.ix_(own, self.options[h])]) for h, m in table[g].items() if h in self.options}
            for g, own in self.options.items()
        }
        """By group and other group, for each option of the one which options of the other it excludes."""
        self.forbidden: dict[tuple[int, int], list[dict[int, int]]] = {}
        """By group and option, the forbidden combinations that it belongs to: by group, the options that it is of."""
        for combination in sorted(forbidden):
            held = {g: np.isin(self.options[g], options) for g, options in combination}
            together = {g: _sets(own[None])[0] for g, own in held.items()}
            for g, own in held.items():
                for option in np.nonzero(own)[0].tolist():
                    self.forbidden.setdefault((g, option), []).append(together)
        self.left = limit
        self.best: dict[int, int] | None = None
        self.bound = than

    def found(self) -> dict[int, int] | None:
        """The cheapest option of each group, as far as the limit goes."""
        self._branch({g: (1 << len(own)) - 1 for g, own in self.options.items()}, {}, 0.0)
        return {g: int(self.options[g][i]) for g, i in self.best.items()} if self.best is not None else None

    def _branch(self, alive: dict[int, int], taken: dict[int, int], spent: float) -> None:
        """Looks at all completions of the options `taken`, given the options still `alive` in the other groups."""
        least = {g: self.prices[g][_lowest(left)] for g, left in alive.items()}
        total = sum(least.values())
        self.left -= 1
        if spent + total >= self.bound - EPSILON or self.left < 0:
            return
        if not alive:
            self.best, self.bound = taken, spent
            return
        group = min(alive, key=lambda g: (alive[g].bit_count(), g))
        left = alive[group]
        while left:
            option = _lowest(left)
            left &= left - 1
            if spent + self.prices[group][option] + total - least[group] >= self.bound - EPSILON:
                return
            self._descend(alive, taken, spent, group, option)

    def _descend(self, alive: dict[int, int], taken: dict[int, int], spent: float, group: int, option: int) -> None:
        now = {**taken, group: option}
        for together in self.forbidden.get((group, option), ()):
            if all(g in now and held >> now[g] & 1 for g, held in together.items()):
                return
        left = {}
        for other, options in alive.items():
            if other != group:
                sets = self.excluded[group].get(other)
                left[other] = options if sets is None else options & ~sets[option]
                if not left[other]:
                    return
        self._branch(left, now, spent + self.prices[group][option])


def _cheapest_first(alive: Bools, cost: Array) -> Indices:
    """The options that are alive, cheapest first; those of the same cost in the order given."""
    options = np.nonzero(alive)[0]
    return options[np.argsort(cost[options], kind="stable")]


def _sets(rows: Bools) -> list[int]:
    """For each row of Booleans (n, m), a number whose bits they are."""
    return [int.from_bytes(row.tobytes(), "little") for row in np.packbits(rows, axis=1, bitorder="little")]


def _lowest(options: int) -> int:
    """The place of the lowest bit."""
    return (options & -options).bit_length() - 1
