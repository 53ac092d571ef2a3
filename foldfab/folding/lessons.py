"""What a proposal that does not hold teaches: cuts that say what must not be together, in which order of the units.

A cut may only forbid what cannot hold. What meets depends on the two options and on where the two things are, so the
order of all units that decide that belongs to the cut; what lies folded between bases decides how far they come down.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from foldfab.folding.congruent import repertoire
from foldfab.folding.group import Group, Lesson, Place, place_of
from foldfab.folding.master import Order, Proposal
from foldfab.folding.options import Alike, Options
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects, leaves_the_box
from foldfab.folding.realise import Clash
from foldfab.folding.scene import Scene
from foldfab.folding.surroundings import Surroundings, depends_on
from foldfab.folding.tree import between
from foldfab.folding.units import Unit


def must_wait(problem: Problem, unit: Unit, options: Mapping[str, Options], patch: str) -> Lesson:
    """A unit that would bring bases together cannot fold before what stands between them, unless that is deleted."""
    kept = frozenset(place_of(options[patch], i) for i in range(len(options[patch].price) - 1))
    return Lesson(((patch, kept),), ((unit.name, problem.unit_of[patch].name),))


def out_of_the_box(
    group: Group, unit: Unit, around: Surroundings, options: Mapping[str, Options], proposal: Proposal, done: set[str]
) -> list[Lesson]:
    """The lanes of a proposal that leave the bounding box from where the units before it have carried the unit."""
    problem, own = group.problem, repertoire(group.problem, unit)
    found = []
    for patch in unit.patches if problem.options.stay_in_box else ():
        place = options[patch].place(proposal.chosen[patch])
        if place is not None and leaves_the_box(problem, own, around, place[0]):
            held = frozenset((place[0].number, w) for w in options[patch].windows)
            others = {u.name for u in group.units}
            found.append(Lesson(((patch, held),), _as_it_is(group, unit, others, done)))
    return found


def lessons_of_others(
    group: Group, scene: Scene, unit: Unit, around: Surroundings, options: Mapping[str, Options],
    proposal: Proposal, done: set[str], found: Prospects,
) -> list[Lesson]:  # fmt: skip
    """What the same surroundings would do to the lanes that were not chosen.

    Where the unit's own bases are depends on all that is chosen in it: what meets them has to be played.
    """
    problem, lessons = group.problem, []
    for x in (x for many in found.lanes.values() for x in many if found.blocked[x.number].any() and not x.is_out):
        met = found.obstacles[x.number]
        if not set(met).isdisjoint(unit.bases):
            continue
        strangers = [o for o in met if o in problem.unit_of and o in options]
        windows = {w for w in options[x.patch].windows if found.blocked[x.number][w[0] : w[1]].any()}
        held: list[tuple[str, frozenset[Place]]] = [(x.patch, frozenset((x.number, w) for w in windows))]
        slabs = _slabs(problem, around, found.met[x.number], done)
        held += [(q, _as_wide(options[q], proposal.chosen[q], any_lane=q in slabs)) for q in strangers]
        deciding = {problem.unit_of[q].name for q in strangers}.union(
            *(_on_the_way(scene, unit, around, o) for o in met)
        )
        lessons.append(Lesson(tuple(held), _as_it_is(group, unit, deciding, done)))
    return lessons


def _slabs(problem: Problem, around: Surroundings, met: set[int], done: set[str]) -> set[str]:
    """The unfolded patches of which nothing but panels is met: those stand there whichever way the patch folds."""
    slabs, others = set[str](), set[str]()
    starts = np.searchsorted(around.owner, np.arange(len(around.solids)))
    for box in met - {-1}:
        solid = int(around.owner[box])
        owner = around.solids[solid].owner
        is_panel = around.solids[solid].state == "open" and box - starts[solid] <= _inserted(problem, around, solid)
        (slabs if is_panel and problem.unit_of[owner].name not in done else others).add(owner)
    return slabs - others


def _inserted(problem: Problem, around: Surroundings, solid: int) -> int:
    """How many hinges the open chain has that a solid shows: its panels come first, then knuckles, then a foot."""
    site = problem.sites[around.solids[solid].owner]
    base = problem.tree.number[site.anchor]
    return (len(around.solids[solid].boxes) - 2) // 2 if around.solids[solid].base == base else -1


def _as_wide(options: Options, index: int, *, any_lane: bool) -> frozenset[Place]:
    """The options of the same lane, or of any, with windows that hold the one of an option."""
    own = options.place(index)
    if own is None or not any_lane:
        return _alike(options, index, "wider windows")
    low, high = own[1]
    wide = [w for w in options.windows if w[0] <= low and w[1] >= high]
    return frozenset((x.number, w) for x in options.lanes for w in wide)


def _as_it_is(group: Group, unit: Unit, deciding: set[str], done: set[str]) -> tuple[Order, ...]:
    """The order of the deciding units around this one, as it is now."""
    names = {u.name for u in group.units} & deciding - {unit.name}
    return tuple((n, unit.name) if n in done else (unit.name, n) for n in sorted(names))


def lessons_of(
    group: Group, scene: Scene, unit: Unit, around: Surroundings, options: Mapping[str, Options],
    proposal: Proposal, done: set[str], clash: Clash,
) -> list[Lesson]:  # fmt: skip
    """What a clash forbids: the options that meet, as long as the units that decide it fold in this order."""
    problem, found = group.problem, []
    lies_low = any(np.isfinite(flat) for flat, _, _ in around.limits.values())
    for k, patches in enumerate(clash.patches):
        held = [(p, _alike(options[p], proposal.chosen[p], clash.holds_for, clash.depth)) for p in patches]
        met = clash.met[k] if clash.met else ()
        strangers = [o for o in met if o in problem.unit_of and problem.unit_of[o] is not unit and o in options]
        # A stranger may get out of the way of what is dragged along by being narrowed.
        wide: Alike = "this" if clash.holds_for == "this" else "wider windows"
        held += [(q, _alike(options[q], proposal.chosen[q], wide)) for q in strangers]
        deciding = {problem.unit_of[q].name for q in strangers}
        for owner in met:
            deciding |= _on_the_way(scene, unit, around, owner)
        # What lies or stands between the bases decides how far they come down, and so how the chains fold.
        deciding |= depends_on(problem, unit, around)
        if lies_low:
            low = {s.owner for s in around.solids if s.state == "folded"} & set(options)
            held += [(q, _alike(options[q], proposal.chosen[q], "any window")) for q in sorted(low - set(strangers))]
        if clash.cuts:
            held += [(q, frozenset([None])) for q in sorted(scene.gone & set(options))]
            deciding = set()
        found.append(Lesson(tuple(held), _as_it_is(group, unit, deciding, done)))
    for other in clash.also:
        found += lessons_of(group, scene, unit, around, options, proposal, done, other)
    return found


def _on_the_way(scene: Scene, unit: Unit, around: Surroundings, owner: str) -> set[str]:
    """The units that decide how far something is from the unit."""
    tree = scene.problem.tree
    if owner in tree.number:
        bases = {tree.number[owner]}
    else:
        bases = {scene.solids[i].base for i in scene.places.get(owner, ())}
    found: set[str] = set()
    for base in bases:
        lead = tree.number[unit.bases[int(around.cluster[base])]]
        found |= {u.name for u in between(tree, base, lead)}
    return found


def _alike(options: Options, index: int, alike: Alike, depth: float = np.inf) -> frozenset[Place]:
    """The options that a clash of one rules out as well."""
    return frozenset(place_of(options, i) for i in options.like(index, alike, depth))
