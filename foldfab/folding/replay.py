"""A proposal of the constraint program played through: the proof that it holds, or what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import fsum

from foldfab.folding.congruent import repertoire
from foldfab.folding.group import NO_MORE, Group, learn
from foldfab.folding.lessons import lessons_of, lessons_of_others, must_wait, out_of_the_box
from foldfab.folding.master import Proposal
from foldfab.folding.model import Chain
from foldfab.folding.options import Options
from foldfab.folding.ordering import after
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import prospects
from foldfab.folding.realise import Clash, chain_of, realised
from foldfab.folding.reasons import reasons_of
from foldfab.folding.scene import Scene, shown
from foldfab.folding.surroundings import look
from foldfab.folding.unit_fold import Refusal, UnitFold, fold_unit
from foldfab.folding.units import Unit


def played(
    group: Group, options: Mapping[str, Options], proposal: Proposal
) -> tuple[tuple[UnitFold, ...] | None, bool]:
    """The folds of a proposal, and whether it holds as it is; where it does not, something was learned from that.

    A unit that cannot fold as proposed folds as it best can, so that a proposal that almost holds still makes a fold;
    none where that cannot count less than the best one known.
    """
    problem, scene, holds = group.problem, group.scene, True
    by_name = {u.name: u for u in group.units}
    for unit in group.units:
        scene = shown(scene, unit.patches, _plain_chains(problem, unit, options, proposal), is_folded=False)
    folds: list[UnitFold] = []
    done: set[str] = set()
    spare = group.known - fsum(group.floor.values())
    for name in proposal.order:
        fold = _unit_played(group, scene, by_name[name], options, proposal, done) if holds else None
        if fold is None:
            repaired = fold_unit(problem, scene, by_name[name])
            if holds:
                _learn_from_repair(group, scene, options, proposal, done, repaired)
            holds = False
            if isinstance(repaired, Refusal):
                return None, False
            fold = repaired
        spare -= fold.weight - group.floor[name]
        if not holds and spare <= NO_MORE:
            return None, False
        folds.append(fold)
        scene = after(problem, scene, fold)
        done.add(name)
    return tuple(folds), holds


def _learn_from_repair(
    group: Group, scene: Scene, options: Mapping[str, Options], proposal: Proposal, done: set[str],
    repaired: UnitFold | Refusal,
) -> None:  # fmt: skip
    """What else a unit has tried in vain, while all that was folded before it is as proposed."""
    unit = repaired.unit
    around = look(group.problem, scene, repertoire(group.problem, unit))
    for clash, places in repaired.learned:
        if all(options[p].has(place) for p, place in zip(unit.patches, places, strict=True)):
            tried = {p: options[p].index(place) for p, place in zip(unit.patches, places, strict=True)}
            other = replace(proposal, chosen={**proposal.chosen, **tried})
            learn(group, lessons_of(group, scene, unit, around, options, other, done, clash))


def _plain_chains(problem: Problem, unit: Unit, options: Mapping[str, Options], proposal: Proposal) -> list[Chain]:
    """The chains of a proposal before anything is balanced."""
    chosen = ((patch, options[patch][proposal.chosen[patch]]) for patch in unit.patches)
    made = [chain_of(problem, unit, p, o.variant, o.window) for p, o in chosen if o.variant is not None]
    return [chain for chain in made if chain is not None]


def _unit_played(
    group: Group, scene: Scene, unit: Unit, options: Mapping[str, Options], proposal: Proposal, done: set[str]
) -> UnitFold | None:
    problem, own = group.problem, repertoire(group.problem, unit)
    around = look(problem, scene, own)
    if around.standing:
        learn(group, (must_wait(problem, unit, options, patch) for patch in sorted(around.standing)))
        return None
    left = out_of_the_box(group, unit, around, options, proposal, done)
    if left:
        learn(group, left)
        return None
    chosen = {p: options[p][proposal.chosen[p]] for p in unit.patches}
    result = realised(problem, scene, unit, around, chosen)
    found = prospects(problem, own, around, in_place=False)
    if not isinstance(result, Clash):
        reasons = reasons_of(problem, own, found, chosen)
        cost = sum(o.cost for o in chosen.values())
        weight = sum(float(options[p].weight[proposal.chosen[p]]) for p in unit.patches)
        return UnitFold(unit, chosen, reasons, *result, around.cluster, cost, weight, around.key)
    for patch, lanes in found.lanes.items():
        group.lanes[patch] += tuple(x for x in lanes if x not in group.lanes[patch])
    learn(group, lessons_of(group, scene, unit, around, options, proposal, done, result))
    learn(group, lessons_of_others(group, scene, unit, around, options, proposal, done, found))
    return None
