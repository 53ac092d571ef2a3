"""A choice made real: bases lowered, chains balanced to end flat, the fold simulated (sections 5.4 and 5.6)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import networkx as nx
import numpy as np

from foldfab.folding import basic, press
from foldfab.folding.balance import agree, filled, stack, sunk
from foldfab.folding.basic import Option, Variant
from foldfab.folding.congruent import repertoire
from foldfab.folding.mechanism import peak
from foldfab.folding.model import Chain
from foldfab.folding.options import Alike
from foldfab.folding.press import Motion
from foldfab.folding.problem import Problem, clear_height, levels
from foldfab.folding.prospects import PAD_SHARE
from foldfab.folding.scene import Scene, Solid
from foldfab.folding.sheets import crossings, swings_into
from foldfab.folding.simulate import clashes
from foldfab.folding.site import Site
from foldfab.folding.surroundings import Surroundings
from foldfab.folding.units import Unit
from foldfab.folding.work import PLAYING
from foldfab.geometry.boxes import Boxes

SAME = 1e-6
"""What has come no further than this against each other has not moved, mm."""


@dataclass(frozen=True, slots=True)
class Clash:
    """Why a choice does not work."""

    patches: tuple[tuple[str, ...], ...]
    """Sets of patches whose options must not be taken together again."""
    reason: str
    holds_for: Alike = "this"
    """Which other options it rules out: where parts meet, wider windows of the same patches meet as well."""
    depth: float = np.inf
    """How far a base has to come down for the same to happen, mm, where it depends on nothing else."""
    met: tuple[tuple[str, str], ...] = ()
    """For each of the sets, the two owners that meet; empty where nothing does."""
    cuts: bool = False
    """Whether it is about deletions that would leave the furniture in more than one piece."""
    also: tuple[Clash, ...] = ()
    """What else does not work, for other reasons."""
    is_unlike: bool = False
    """Whether chains fold to heights, or snap by amounts, that could not be balanced."""
    crosses: bool = False
    """Whether it is free with thickness but not without."""


def realised(
    problem: Problem, scene: Scene, unit: Unit, around: Surroundings, chosen: Mapping[str, Option]
) -> tuple[tuple[Chain, ...], Motion] | Clash:
    """The chains and the motion of a choice, or what is wrong with it."""
    if not _stays_connected(problem, scene, unit, chosen):
        gone = tuple(p for p in chosen if chosen[p].variant is None)
        return Clash((gone,), f"without {', '.join(gone)} the furniture would fall apart", cuts=True)
    result = _closed(problem, unit, around, chosen, if_alike=False)
    if isinstance(result, Clash) and result.is_unlike:
        kept = {p: o.variant for p, o in chosen.items() if o.variant is not None}
        for variants in sunk(problem, kept):
            lower = {p: replace(o, variant=variants.get(p)) for p, o in chosen.items()}
            made = _closed(problem, unit, around, lower, if_alike=True)
            if not isinstance(made, Clash):
                return made
    return result


def _closed(
    problem: Problem, unit: Unit, around: Surroundings, chosen: Mapping[str, Option], *, if_alike: bool
) -> tuple[tuple[Chain, ...], Motion] | Clash:
    """The chains and the motion with all chains as high as they have to be, by thickness or, if need be, by plinths.

    Played only where chains may start together, where that is asked for.
    """
    result: tuple[tuple[Chain, ...], Motion] | Clash = Clash((tuple(chosen),), "")
    for by_thickness in (True, False):
        made = _balanced(problem, unit, around, chosen, by_thickness=by_thickness)
        if isinstance(made, Clash):
            result = made
        elif not if_alike or agree(made[0], problem.thickness.gap):
            result = _played(problem, unit, around, chosen, *made)
        is_thicker = not isinstance(made, Clash) and any(c.panel > problem.sites[c.patch].panel for c in made[0])
        if not isinstance(result, Clash) or not is_thicker:
            break
    return result


def _played(
    problem: Problem, unit: Unit, around: Surroundings, chosen: Mapping[str, Option],
    chains: tuple[Chain, ...], way: Mapping[str, float],
) -> tuple[tuple[Chain, ...], Motion] | Clash:  # fmt: skip
    """The chains with their motion, or what meets while they fold."""
    problem.work.charge(PLAYING * len(unit.patches))
    is_slanted = any(c.mechanism == "slanted" and c.far is not None for c in chains)
    motion = (
        press.slanted(unit.bases, chains)
        if is_slanted
        else press.in_place(unit.bases, way, chains, problem.thickness.gap)
    )
    for chain in chains:
        worst, limit = float(np.abs(motion.play[chain.patch]).max()), press.play_limit(chain, problem.thickness.gap)
        if worst > limit:
            beside = _most_unlike(chain, chains, way)
            blamed = (chain.patch, beside) if beside else tuple(chosen)
            text = f"{chain.patch} cannot follow {beside or 'its unit'}: its hinges would have to give {worst:.2f} mm"
            return Clash((blamed,), f"{text}, and give {limit:.2f} mm", "any window", is_unlike=True)
    met = clashes(unit, problem.tree.number, chains, motion, around, problem.thickness)
    if met:
        reason = _told(*next(iter(met.items())))
        carried = [pair for pair in met if not set(pair) & set(chosen)]
        if carried and is_slanted:
            # What hangs on a base is dragged along with it, whatever is left of the patches that drag it.
            dragging = tuple((c.patch,) for c in chains if c.far is not None)
            return Clash(dragging, reason, "any window", met=(carried[0],) * len(dragging))
        own = tuple(pair for pair in met if pair not in carried)
        also = tuple(_carried_into(problem, unit, chains, motion, pair, met[pair]) for pair in carried[:1])
        mine = tuple(tuple(p for p in pair if p in chosen) for pair in own)
        return Clash(mine, reason, "wider windows", met=own, also=also)
    crossing = crossings(problem.scaffold, chains)
    if crossing:
        told = "{} and {} would fold through each other without thickness".format(*crossing[0])
        return Clash(crossing, told, "wider windows", met=crossing, crosses=True)
    swung = _swung(problem, chains, around)
    if swung:
        told = "{} would swing through {} without thickness".format(*swung[0])
        return Clash(tuple((tip,) for tip, _ in swung), told, "wider windows", met=swung)
    return chains, motion


def _swung(problem: Problem, chains: tuple[Chain, ...], around: Surroundings) -> tuple[tuple[str, str], ...]:
    """By T-scaffold, which of what stands to its base as in the open furniture it crosses as a sheet: bases, and what
    is not folded yet, as wide as it is left.
    """
    found: list[tuple[str, str]] = []
    for chain in (c for c in chains if c.far is None):
        stands = _standing_to(around, chain.anchor)
        others = sorted((s for s in stands if s.owner not in (chain.patch, chain.anchor)), key=lambda s: s.owner)
        near = [_left_of(problem.sites[s.owner], s.boxes) for s in others if s.state == "open"]
        bases = [problem.scaffold.base(s.owner) for s in others if s.state == "base"]
        found += [(chain.patch, name) for name in swings_into(problem.scaffold, chain, near, bases)]
    return tuple(found)


def _standing_to(around: Surroundings, anchor: str) -> list[Solid]:
    """What is near a unit and stands to one of its bases as in the open furniture."""
    first = np.searchsorted(around.owner, np.arange(len(around.solids)))
    start = np.array([s.boxes.center[0] for s in around.solids]).reshape(-1, 3)
    shift = around.boxes.center[first] - start
    (own,) = (i for i, s in enumerate(around.solids) if s.owner == anchor)
    still = (np.abs(shift - shift[own]) < SAME).all(1)
    return [s for s, is_still in zip(around.solids, still.tolist(), strict=True) if is_still]


def _left_of(site: Site, boxes: Boxes) -> Site:
    """A patch that stands open as these boxes (n,), as wide as they are together."""
    middle = (boxes.center - site.foot) @ site.along
    reach = (np.abs(boxes.axes @ site.along) * boxes.half).sum(-1)
    return replace(site, span=np.array([(middle - reach).min(), (middle + reach).max()]))


def _carried_into(
    problem: Problem, unit: Unit, chains: tuple[Chain, ...], motion: Motion, pair: tuple[str, str], time: float
) -> Clash:
    """A clash of what hangs on two bases: it happens at the same height however the bases are brought there."""
    holding = tuple(p for p in unit.patches if problem.sites[p].far is not None)
    depth = -float(np.interp(time, motion.samples, motion.shift[unit.bases[-1]][:, 2]))
    if len(unit.bases) > 2 or min(peak(c)[0] for c in chains if c.far is not None) < -depth:
        # It depends on how the bases move against each other, or on how the chains share the rise of their snaps.
        depth = np.inf
    return Clash((holding,), _told(pair, time), "any fall", depth, (pair,))


def _told(pair: tuple[str, str], time: float) -> str:
    return f"{pair[0]} meets {pair[1]} when {100 * time:.0f} % of that fold are done"


def _most_unlike(chain: Chain, chains: tuple[Chain, ...], way: Mapping[str, float]) -> str:
    """The patch that starts to fold at the same time and whose snap differs most, or nothing."""
    held = [c for c in chains if c is not chain and c.far is not None]
    others = [c for c in held if abs(way[c.far or ""] - way[chain.far or ""]) <= press.SAME_LEVEL]
    own = peak(chain)[0]
    return max(others, key=lambda c: (abs(peak(c)[0] - own), c.patch)).patch if others else ""


def _balanced(
    problem: Problem, unit: Unit, around: Surroundings, chosen: Mapping[str, Option], *, by_thickness: bool
) -> tuple[tuple[Chain, ...], dict[str, float]] | Clash:
    """The chains with what lets all of them end flat together, and the ways of the bases.

    What a chain lacks to the height of its neighbours is given to its panels where they may get so thick, or to a
    plinth under its last hinge.
    """
    clear = {pair: clear_height(problem, *pair) for pair in _pairs(problem, unit, around)}
    stacks = {p: stack(problem, p, o.variant) for p, o in chosen.items() if o.variant is not None}
    least = {pair: clear[pair] - flat for pair, (flat, _, _) in around.limits.items() if np.isfinite(flat)}
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
            variant = filled(variant, slack, site.panel, by_thickness=by_thickness)
        chain = chain_of(problem, unit, patch, variant, chosen[patch].window)
        if chain is None or sum(max(pad, 0.0) for pad in variant.pads) > PAD_SHARE * site.clear:
            highest = max((p for p in stacks if problem.sites[p].far == site.far), key=lambda p: (stacks[p], p))
            blamed = (patch,) if highest == patch else (patch, highest)
            text = f"{patch} is too short to end flat on a plinth of {sum(variant.pads):.1f} mm beside {highest}"
            return Clash((blamed,), text, holds_for="any window", is_unlike=True)
        chains.append(chain)
    return tuple(chains), way


def chain_of(problem: Problem, unit: Unit, patch: str, variant: Variant, window: tuple[int, int]) -> Chain | None:
    """The chain of a variant in a window, balanced or not, or None where it or its panels would be too small."""
    site, steps = problem.sites[patch], problem.options.shrink_steps
    known = repertoire(problem, unit).by_variant.get((patch, variant)) if window == (0, steps) else None
    if known is not None:
        return known.chain
    span = basic.window_span(site, window, steps, problem.thickness)
    return basic.chain(site, variant, span, problem.thickness) if span is not None else None


def _pairs(problem: Problem, unit: Unit, around: Surroundings) -> set[tuple[str, str]]:
    held = {(problem.sites[p].anchor, problem.sites[p].far) for p in unit.patches}
    return {(a, b) for a, b in held if b is not None} | set(around.limits)


def _stays_connected(problem: Problem, scene: Scene, unit: Unit, chosen: Mapping[str, Option]) -> bool:
    gone = {p for p, o in chosen.items() if o.variant is None}
    if not gone:
        return True
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(b.name for b in problem.scaffold.bases)
    gone |= scene.gone
    graph.add_edges_from(p.bases for p in problem.scaffold.patches if p.name not in gone and len(p.bases) == 2)
    return bool(nx.is_connected(graph))
