"""What lanes that are not made yet could better, and what any choice counts at least because of it.

A *promise*, a lane at its patch's least price that conflicts with nothing, takes the place of the patch's deletion:
where the cheapest choice takes no promise, no lane that is not made yet can better it, and none that is made, but for
those that drag bases along.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from foldfab.folding.choose import EPSILON, cheapest
from foldfab.folding.graph import Graph, going_along
from foldfab.geometry.arrays import Array, Bools


@dataclass(frozen=True, slots=True)
class Outlook:
    """What lanes that are not made yet could better."""

    wanted: tuple[str, ...] = ()
    """The patches whose lanes could."""
    floor: float = -np.inf
    """What any choice counts at least that drags no bases along, be its lanes made or not."""
    least: tuple[int, ...] | None = None
    """The choice that counts no more than that, where there is one of lanes that are made."""


def promising(graph: Graph, prices: Mapping[str, float], known: float) -> Outlook:
    """What lanes not made yet, at `prices` by patch, could be part of a choice that counts less than `known`."""
    last = {g: len(graph.costs[g]) - 1 for g, p in enumerate(graph.patches) if p in prices}
    costs = [_undragged(graph, g) for g in range(len(graph.patches))]
    for g, end in last.items():
        costs[g][end] = prices[graph.patches[g]]
    tables = {pair: _without_last(table, pair, last) for pair, table in graph.tables.items()}
    forbidden = frozenset(c for c in graph.forbidden if not any(last.get(g) in many for g, many in c))
    gaps: list[float] = []
    picked = cheapest(costs, tables, forbidden, gaps, work=graph.work)
    if picked is None:
        return Outlook()
    if gaps:
        return Outlook(tuple(graph.patches[g] for g in last))
    floor = sum(float(cost[i]) for cost, i in zip(costs, picked, strict=True))
    wanted = tuple(graph.patches[g] for g, end in last.items() if picked[g] == end)
    # What was left out beside promises may still hold for other options.
    return Outlook(wanted if floor < known else (), floor, picked if not wanted and graph.is_free(picked) else None)


def is_cheapest(graph: Graph, picked: tuple[int, ...], floor: float) -> bool:
    """Whether nothing counts less than a choice, where what drags no bases along counts at least a `floor`.

    Where some lane drags bases along, so do all that are not deleted, and in the same way.
    """
    weight = graph.weight(picked) - EPSILON
    if floor < weight:
        return False
    drags = {x.number for o in graph.options for x in o.lanes if x.drag is not None}
    ways = going_along(graph.options, [way for way in graph.ways() if way & drags]) if drags else []
    return all(sum(float(c[mask].min()) for mask, c in zip(way, graph.costs, strict=True)) >= weight for way in ways)


def _undragged(graph: Graph, group: int) -> Array:
    """What the options of a patch cost beside lanes not made yet: those come straight down, none drags along."""
    options = graph.options[group]
    drags = np.repeat([x.drag is not None for x in options.lanes], len(options.windows))
    return np.where(np.append(drags, False), np.inf, graph.costs[group])


def _without_last(table: Bools, pair: tuple[int, int], last: Mapping[int, int]) -> Bools:
    """A table of two groups in which the last options of some groups conflict with nothing."""
    found = table.copy()
    if pair[0] in last:
        found[-1] = False
    if pair[1] in last:
        found[:, -1] = False
    return found
