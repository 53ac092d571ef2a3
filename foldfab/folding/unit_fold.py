"""Foldabilization of one unit at a given moment: the inner loop (sections 5.4 and 5.5).

The cheapest conflict-free choice is made real: bases are lowered by the longest paths, chains get the plinths they
lack, and the fold is simulated. What then meets is added to the conflicts and the choice is made anew, until it holds.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import networkx as nx
import numpy as np

from foldfab.folding import basic, press
from foldfab.folding.basic import Option, Variant
from foldfab.folding.candidates import (
    PAD_SHARE,
    Candidate,
    Problem,
    Surroundings,
    candidates,
    clearances,
    held,
    is_slantable,
    levels,
    options,
    seen_from,
    surroundings,
)
from foldfab.folding.choose import cheapest
from foldfab.folding.conflict import conflict_table, play_limit
from foldfab.folding.model import Chain
from foldfab.folding.press import Motion
from foldfab.folding.scene import Scene
from foldfab.folding.simulate import clashes
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools

ROUNDS = 60
"""Choices that are tried for one unit before it counts as not foldable at this moment."""


Limits = dict[tuple[str, str], tuple[float, float, str]]
"""By (lower, upper) base: how far the upper cluster may come down before it meets something that lies flat, before it
meets something that is not folded yet, and the owner of the latter."""


@dataclass(frozen=True, slots=True, eq=False)
class UnitFold:
    """A folding solution F_U of a unit (eq. 4) in its surroundings."""

    unit: Unit
    chosen: dict[str, Option]
    """By patch."""
    reasons: dict[str, str]
    """By patch that was changed, why."""
    chains: tuple[Chain, ...]
    motion: Motion
    cluster: dict[str, str]
    """By base of the furniture, the unit's base that it moves with."""
    cost: float
    """Sum of its terms of eq. 1."""
    weight: float
    """What the search minimises: the cost, with deletions counted many times."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a unit cannot fold at this moment."""

    unit: Unit
    reason: str


def fold_unit(
    problem: Problem, scene: Scene, unit: Unit, *, in_place: bool = False, is_final: bool = False
) -> UnitFold | Refusal:
    """The cheapest valid folding solution of a unit in the scene, or why there is none.

    A solution is found once for all scenes that look the same from the unit. Where it has been carried to decides
    only between options of equal cost, and is looked at only where the fold `is_final`.
    """
    around = surroundings(problem, scene, unit)
    limits = _limits(problem, unit, around)
    offset = np.round(scene.offset[unit.bases[0]], 3)
    gone = frozenset(p for u in scene.units if u.name in scene.done for p in u.patches if p not in scene.chains)
    key = (unit, in_place, tuple(offset) if is_final else None, gone, view(problem, unit, around, limits))
    if key not in problem.solved:
        problem.solved[key] = _fold(problem, scene, unit, around, limits, in_place=in_place)
    found: UnitFold | Refusal = problem.solved[key]
    return found


def view(problem: Problem, unit: Unit, around: Surroundings, limits: Limits) -> object:
    """All of its surroundings that the fold of a unit can depend on, hashable."""
    relevant = np.zeros(len(around.owner), dtype=bool)
    base = np.array([around.cluster[around.solids[s].base] for s in around.owner])
    for name, (low, high) in seen_from(problem, unit).items():
        near = (around.low <= high).all(1) & (around.high >= low).all(1)
        relevant |= near & (base == name)
    if is_slantable(problem, unit):
        relevant |= _crossing(problem, unit, around, base)
    labels = tuple(
        (around.solids[around.owner[i]].owner, around.solids[around.owner[i]].state) for i in np.nonzero(relevant)[0]
    )
    shape = np.round(np.concatenate([around.low[relevant], around.high[relevant]]), 4) + 0.0
    clear = clearances(problem, unit)
    numbers = tuple(
        (pair, round(min(flat, clear[pair]), 4), (round(up, 4), owner) if up < clear[pair] else None)
        for pair, (flat, up, owner) in limits.items()
    )
    return (labels, shape.tobytes(), numbers)


def _crossing(problem: Problem, unit: Unit, around: Surroundings, base: Array) -> Bools:
    """Boxes of the upper and of the lower cluster that may meet while the unit slants."""
    reach = max(problem.sites[p].clear / np.cos(problem.sites[p].lean) for p in unit.patches)
    below, above = base == unit.bases[0], base == unit.bases[1]
    low, high = around.low[above] - reach, around.high[above] + [reach, reach, 0.0]
    near = (around.low[below][:, None] <= high[None]).all(-1) & (around.high[below][:, None] >= low[None]).all(-1)
    found = np.zeros(len(base), dtype=bool)
    found[np.nonzero(below)[0][near.any(1)]] = True
    found[np.nonzero(above)[0][near.any(0)]] = True
    return found


def _fold(
    problem: Problem, scene: Scene, unit: Unit, around: Surroundings, limits: Limits, *, in_place: bool
) -> UnitFold | Refusal:
    standing = _held_up(problem, unit, limits)
    if standing:
        return Refusal(unit, f"{standing} stands in the way unfolded")
    found = candidates(problem, unit, around, in_place=in_place)
    offset = scene.offset[unit.bases[0]]
    priced = {p: options(problem, problem.sites[p], found[p], offset) for p in unit.patches}
    costs = [np.array([cost for _, cost in priced[p]]) for p in unit.patches]
    table = _tables(problem, unit, found, priced)
    forbidden: set[tuple[tuple[int, int], ...]] = set()
    last = "no combination of options is free of conflicts"
    for _ in range(ROUNDS):
        picked = cheapest(costs, table, frozenset(forbidden))
        if picked is None:
            break
        chosen = {p: priced[p][i][0] for p, i in zip(unit.patches, picked, strict=True)}
        result = _realised(problem, scene, unit, around, limits, chosen)
        if not isinstance(result, _Clash):
            reasons = _reasons(problem, found, chosen)
            cost = sum(o.cost for o in chosen.values())
            weight = sum(priced[p][i][1] for p, i in zip(unit.patches, picked, strict=True))
            return UnitFold(unit, chosen, reasons, *result, around.cluster, cost, weight)
        last = result.reason
        _learn(unit, picked, result, costs, table, forbidden)
    return Refusal(unit, last)


@dataclass(frozen=True, slots=True)
class _Clash:
    """Why a choice does not work, and the patches whose options must not be taken together again."""

    patches: tuple[str, ...]
    reason: str


def _limits(problem: Problem, unit: Unit, around: Surroundings) -> Limits:
    found: Limits = {}
    group = np.array([unit.bases.index(around.cluster[around.solids[s].base]) for s in around.owner])
    is_open = np.array([around.solids[s].state == "open" for s in around.owner])
    for (i, a), (j, b) in itertools.combinations(enumerate(unit.bases), 2):
        p, q = np.nonzero(group == i)[0], np.nonzero(group == j)[0]
        over = (around.low[p, None, :2] < around.high[None, q, :2]).all(-1)
        over &= (around.low[None, q, :2] < around.high[p, None, :2]).all(-1)
        room = around.low[None, q, 2] - around.high[p, None, 2]
        room = np.where(over & (room > -1e-6), room, np.inf) - problem.thickness.gap
        standing = is_open[p, None] | is_open[None, q]
        flat, raised = np.where(standing, np.inf, room), np.where(standing, room, np.inf)
        owner = ""
        if np.isfinite(raised).any():
            at = np.unravel_index(int(np.argmin(raised)), raised.shape)
            blame = p[at[0]] if is_open[p[at[0]]] else q[at[1]]
            owner = around.solids[around.owner[int(blame)]].owner
        found[a, b] = (float(flat.min(initial=np.inf)), float(raised.min(initial=np.inf)), owner)
    return found


def _held_up(problem: Problem, unit: Unit, limits: Limits) -> str:
    """The owner of what stands unfolded between two bases that a chain of the unit would bring together."""
    clear = clearances(problem, unit)
    for site in held(problem, unit):
        assert site.far is not None
        pair = (site.anchor, site.far)
        least = problem.thickness.stack(2, has_upper_base=True)
        if limits[pair][1] < clear[pair] - least - PAD_SHARE * 0.5 * problem.thickness.panel:
            return limits[pair][2]
    return ""


def _tables(
    problem: Problem, unit: Unit, found: Mapping[str, list[Candidate]], priced: Mapping[str, list[tuple[Option, float]]]
) -> dict[tuple[int, int], Bools]:
    key = unit.name + "/".join(unit.patches)
    made = {}
    for (g, a), (h, b) in itertools.combinations(enumerate(unit.patches), 2):
        first, second = ((found[p], [o for o, _ in priced[p]]) for p in (a, b))
        made[g, h] = conflict_table(problem, key, first, second)
    return made


def _realised(
    problem: Problem, scene: Scene, unit: Unit, around: Surroundings, limits: Limits, chosen: Mapping[str, Option]
) -> tuple[tuple[Chain, ...], Motion] | _Clash:
    """The chains and the motion of a choice, or what is wrong with it."""
    if not _stays_connected(problem, scene, unit, chosen):
        return _Clash(
            tuple(p for p in chosen if chosen[p].variant is None), "deleting it would cut the furniture in two"
        )
    made = _balanced(problem, unit, limits, chosen)
    if isinstance(made, _Clash):
        return made
    chains, way = made
    is_slanted = any(c.mechanism == "slanted" and c.far is not None for c in chains)
    motion = press.slanted(unit.bases, chains) if is_slanted else press.in_place(unit.bases, way, chains)
    for chain in chains:
        if np.abs(motion.play[chain.patch]).max() > play_limit(chain, problem.thickness):
            return _Clash(tuple(chosen), f"{chain.patch} cannot follow the other chains of its unit")
    for a, b in clashes(chains, motion, around, problem.thickness):
        mine = tuple(p for p in (a, b) if p in chosen)
        return _Clash(mine or tuple(chosen), f"{a} meets {b}")
    return chains, motion


def _balanced(
    problem: Problem, unit: Unit, limits: Limits, chosen: Mapping[str, Option]
) -> tuple[tuple[Chain, ...], dict[str, float]] | _Clash:
    """The chains with the plinths that let all of them end flat together, and the ways of the bases."""
    clear, thick = clearances(problem, unit), problem.thickness
    stacks = {p: _stack(problem, p, o.variant) for p, o in chosen.items() if o.variant is not None}
    least = {pair: clear[pair] - limits[pair][0] for pair in limits if np.isfinite(limits[pair][0])}
    for patch, height in stacks.items():
        site = problem.sites[patch]
        if site.far is not None:
            pair = (site.anchor, site.far)
            least[pair] = max(least.get(pair, -np.inf), height)
    way = press.ways(unit.bases, least, clear, levels(problem, unit))
    chains = []
    for patch in sorted(stacks):
        site, variant = problem.sites[patch], chosen[patch].variant
        assert variant is not None
        if site.far is not None:
            slack = clear[site.anchor, site.far] - (way[site.far] - way[site.anchor]) - stacks[patch]
            variant = replace(variant, pads=(variant.pads[0], variant.pads[1] + max(slack, 0.0)))
        span = basic.window_span(site, chosen[patch].window, problem.options.shrink_steps, thick)
        chain = basic.chain(site, variant, span, thick) if span is not None else None
        if chain is None or sum(variant.pads) > PAD_SHARE * site.clear:
            return _Clash((patch,), f"{patch} is too short to end flat on a plinth of {sum(variant.pads):.1f} mm")
        chains.append(chain)
    return tuple(chains), way


def _stack(problem: Problem, patch: str, variant: Variant) -> float:
    is_held = problem.sites[patch].far is not None
    return problem.thickness.stack(variant.hinges + 1, has_upper_base=is_held) + sum(variant.pads)


def _stays_connected(problem: Problem, scene: Scene, unit: Unit, chosen: Mapping[str, Option]) -> bool:
    gone = {p for p, o in chosen.items() if o.variant is None}
    if not gone:
        return True
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(b.name for b in problem.scaffold.bases)
    for other in scene.units:
        if other.name in scene.done:
            gone |= {p for p in other.patches if p not in scene.chains}
    graph.add_edges_from(p.bases for p in problem.scaffold.patches if p.name not in gone and len(p.bases) == 2)
    return bool(nx.is_connected(graph))


def _learn(
    unit: Unit, picked: tuple[int, ...], clash: _Clash, costs: list[Array],
    table: dict[tuple[int, int], Bools], forbidden: set[tuple[tuple[int, int], ...]],
) -> None:  # fmt: skip
    """Adds what a simulation found to the conflicts."""
    groups = [unit.patches.index(p) for p in clash.patches]
    if len(groups) == 1:
        costs[groups[0]][picked[groups[0]]] = np.inf
    elif len(groups) == 2:
        g, h = sorted(groups)
        table[g, h][picked[g], picked[h]] = True
    else:
        forbidden.add(tuple(sorted((g, picked[g]) for g in groups)))


def _reasons(problem: Problem, found: Mapping[str, list[Candidate]], chosen: Mapping[str, Option]) -> dict[str, str]:
    """Why each changed patch had to be changed: what its whole, unsplit self would meet."""
    reasons = {}
    for patch, option in chosen.items():
        if option.variant is not None and option.cost == 0.0:
            continue
        obstacles = {name for c in found[patch] for name in c.obstacles if _is_like(c, option)}
        if obstacles:
            reasons[patch] = "because of " + ", ".join(sorted(obstacles)[:3])
        elif option.variant is None or option.window != (0, problem.options.shrink_steps):
            others = sorted(p for p in chosen if p != patch and chosen[p].variant is not None)
            reasons[patch] = "to let " + ", ".join(others[:3]) + " fold through it" if others else ""
        else:
            reasons[patch] = "to come straight down"
    return reasons


def _is_like(candidate: Candidate, option: Option) -> bool:
    return option.variant is None or (candidate.variant.hinges, candidate.variant.side) == (
        option.variant.hinges,
        option.variant.side,
    )
