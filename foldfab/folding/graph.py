"""The conflict graph of a unit in some surroundings, with what simulations have added to it (section 5.4)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

import numpy as np

from foldfab.folding.basic import Option
from foldfab.folding.choose import Combination, cheaper, cheapest
from foldfab.folding.conflict import compare, modes, neighbours, table, windows_table
from foldfab.folding.options import Options, options_of
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects
from foldfab.folding.realise import Clash
from foldfab.folding.repertoire import Place, Repertoire
from foldfab.folding.symmetry import bound, signature, unlike
from foldfab.folding.work import SEARCHING, Work
from foldfab.geometry.arrays import Array, Bools

MANY = 16
"""Patches of a unit beyond which each way to drag its bases is looked at by itself, and not every pair of patches."""

Lesson = tuple[Clash, tuple[Place | None, ...]]
"""A clash and what was chosen for each patch of the unit."""


class Graph:
    """The conflict graph of a unit in some surroundings, with what simulations have added to it."""

    def __init__(
        self,
        problem: Problem,
        own: Repertoire,
        found: Prospects,
        offset: Array,
        learned: Iterable[Lesson] = (),
        chosen: Mapping[str, Option] | None = None,
        *,
        is_bare: bool = False,
    ) -> None:
        """Where `is_bare`, hinges that may still be interrupted only conflict where no stretch of knuckles has room."""
        self.patches, self.work = own.unit.patches, problem.work
        options = options_of(problem, found, offset)
        self.options = [options[p] for p in self.patches]
        self.costs: list[Array] = [o.weight.copy() for o in self.options]
        self.tables: dict[tuple[int, int], Bools] = {}
        in_modes = len(self.patches) > MANY and any(x.drag is not None for x in own.lanes)
        self.modes: list[list[Bools]] = going_along(self.options, modes(own, found.lanes)) if in_modes else []
        self.ways = partial(modes, own, found.lanes)
        """The lanes, by number, of each way to drag the bases."""
        if len(self.patches) > 1:
            self._compare(problem, own, found, in_modes=in_modes, is_bare=is_bare)
        self._treat_alike(problem, chosen or {})
        self.forbidden: set[Combination] = set()
        self.gaps: list[float] = []
        self.tangled: set[tuple[int, ...]] = set()
        self.learned: list[Lesson] = []
        for clash, places in learned:
            # Lanes on plinths belong to one look around: the next may see the same a little higher, within rounding.
            if not all(o.has(place) for o, place in zip(self.options, places, strict=True)):
                continue
            self.learn(tuple(o.index(place) for o, place in zip(self.options, places, strict=True)), clash)

    def _compare(self, problem: Problem, own: Repertoire, found: Prospects, *, in_modes: bool, is_bare: bool) -> None:
        """Finds the options of different patches that exclude each other."""
        compare(problem, own, (x for many in found.lanes.values() for x in many))
        inside = windows_table(self.options[0].windows, problem.options.shrink_steps)
        place = {p: g for g, p in enumerate(self.patches)}
        for a, b in neighbours(own, found.lanes, in_modes=in_modes):
            made = table(problem, own, found.lanes[a], found.lanes[b], inside, in_modes=in_modes, is_bare=is_bare)
            if made is not None:
                self.tables[place[a], place[b]] = made

    def _treat_alike(self, problem: Problem, chosen: Mapping[str, Option]) -> None:
        """Rules out what differs between a patch and its mirror image, in this unit or in one that is folded."""
        place = {p: g for g, p in enumerate(self.patches)}
        for g, patch in enumerate(self.patches):
            asked, twin = bound(problem, chosen, patch), problem.twins.get(patch)
            if asked is not None:
                options = self.options[g]
                self.costs[g][[signature(options[i]) != asked for i in range(len(options.price))]] = np.inf
            elif twin is not None and place.get(twin.patch, -1) > g:
                h, steps = place[twin.patch], problem.options.shrink_steps
                apart = unlike(self.options[g], self.options[h], steps, is_reversed=twin.is_reversed)
                self.tables[g, h] = self.tables[g, h] | apart if (g, h) in self.tables else apart

    def cheapest(self) -> tuple[int, ...] | None:
        """The cheapest choice, one option a patch."""
        self.gaps.clear()
        if not self.modes:
            return self._cheapest(self.costs)
        best: tuple[int, ...] | None = None
        for masks in self.modes:
            costs = [np.where(mask, cost, np.inf) for mask, cost in zip(masks, self.costs, strict=True)]
            if best is None or sum(float(cost.min()) for cost in costs) < self.weight(best):
                picked = self._cheapest(costs)
                if picked is not None and (best is None or self.weight(picked) < self.weight(best)):
                    best = picked
        return best

    def soon(self) -> tuple[tuple[int, ...] | None, bool]:
        """The cheapest choice as far as a few branches tell, and whether it is."""
        if self.modes:
            return self.cheapest(), True
        self.gaps.clear()
        gaps: list[float] = []
        self.work.charge(SEARCHING * len(self.costs))
        tables, forbidden = self.tables, frozenset(self.forbidden)
        picked = cheapest(self.costs, tables, forbidden, gaps, self.tangled, self.work, is_brief=True)
        return picked, not gaps

    def cheaper(self, than: float, work: Work) -> tuple[tuple[int, ...] | None, float]:
        """The cheapest choice if it counts less, as far as the work goes, and what any counts at least.

        Not for graphs with several ways to drag bases.
        """
        self.work.charge(SEARCHING * len(self.costs))
        before = work.spent
        found = cheaper(self.costs, self.tables, frozenset(self.forbidden), than, work)
        self.work.charge(work.spent - before)
        return found

    def _cheapest(self, costs: list[Array]) -> tuple[int, ...] | None:
        self.work.charge(SEARCHING * len(costs))
        return cheapest(costs, self.tables, frozenset(self.forbidden), self.gaps, self.tangled, self.work)

    def holds(self, places: Mapping[str, Place]) -> tuple[int, ...] | None:
        """The choice of these lanes and windows, or None where it is not whole or something is against it here."""
        if any(places.get(o.patch, (None,))[0] not in o.lanes for o in self.options):
            return None
        picked = tuple(o.index(places[o.patch]) for o in self.options)
        return picked if self.is_free(picked) else None

    def is_free(self, picked: tuple[int, ...]) -> bool:
        """Whether nothing is known against a choice."""
        is_free = all(np.isfinite(cost[i]) for cost, i in zip(self.costs, picked, strict=True))
        is_free &= not any(table[picked[g], picked[h]] for (g, h), table in self.tables.items())
        return is_free and not any(all(picked[g] in many for g, many in combination) for combination in self.forbidden)

    def weight(self, picked: tuple[int, ...]) -> float:
        """What a choice counts in the search."""
        return float(sum(o.weight[i] for o, i in zip(self.options, picked, strict=True)))

    def learn(self, picked: tuple[int, ...], clash: Clash) -> None:
        """Adds what a simulation found: what is too wide for its neighbours is so when it is still wider."""
        self.learned.append((clash, tuple(o.place(i) for o, i in zip(self.options, picked, strict=True))))
        for one in (clash, *clash.also):
            self._learn(picked, one)

    def _learn(self, picked: tuple[int, ...], clash: Clash) -> None:
        place = {p: g for g, p in enumerate(self.patches)}
        for patches in clash.patches:
            groups = sorted(place[p] for p in patches)
            alike = [self.options[g].like(picked[g], clash.holds_for, clash.depth) for g in groups]
            if len(groups) == 1:
                self.costs[groups[0]][alike[0]] = np.inf
            elif len(groups) == 2:
                g, h = groups
                shape = (len(self.costs[g]), len(self.costs[h]))
                own = self.tables[g, h].copy() if (g, h) in self.tables else np.zeros(shape, dtype=bool)
                own[np.ix_(*alike)] = True
                self.tables[g, h] = own
            else:
                self.forbidden.add(tuple((g, tuple(many)) for g, many in zip(groups, alike, strict=True)))


def going_along(options: Sequence[Options], modes: list[set[int]]) -> list[list[Bools]]:
    """For each way to drag the bases, which options of each patch (n,) go along; deletion always does."""
    made = []
    for mode in modes:
        alike = [[x.number in mode for x in o.lanes] for o in options]
        masks = [np.repeat(own, len(o.windows)) for own, o in zip(alike, options, strict=True)]
        made.append([np.append(mask, True).astype(bool) for mask in masks])
    return made
