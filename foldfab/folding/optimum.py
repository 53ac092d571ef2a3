"""The choice of modifications and the order of units in one shot, to a proven optimum (beyond section 5.5).

What each unit costs by itself bounds any fold from below. Units whose folds reach into each other's space make groups;
where a group of the greedy solution costs more than its units by themselves, its options and its order become one
constraint program (`master`). Its cheapest proposal is played through; what then meets depends on more than a pair of
options (on the order, on where things lie folded) and is added as a cut, until a proposal holds. As the program is a
relaxation throughout, the first proposal that holds is optimal.

The limit is one of work: the deterministic time of the solver, and a fixed charge for each unit that is played.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from foldfab.folding import basic
from foldfab.folding.congruent import repertoire
from foldfab.folding.graph import Graph
from foldfab.folding.master import Cut, Master, Order, Proposal
from foldfab.folding.model import Chain
from foldfab.folding.options import Options
from foldfab.folding.ordering import Ordered, after, neighbouring
from foldfab.folding.problem import Problem
from foldfab.folding.prospects import Prospects, prospects, unhindered
from foldfab.folding.realise import Clash, realised
from foldfab.folding.reasons import reasons_of
from foldfab.folding.repertoire import Lane, extend
from foldfab.folding.scene import Scene, shown
from foldfab.folding.surroundings import Surroundings, depends_on, look
from foldfab.folding.symmetry import Signature, is_less, signature, unlike
from foldfab.folding.tree import between
from foldfab.folding.unit_fold import UnitFold
from foldfab.folding.units import Unit

NO_MORE = 1e-5
"""What preferences between options of equal cost may add up to."""
PLAYING = 4e-3
"""Charge for a unit that is played, s."""
BUILDING = 2e-2
"""Charge for a constraint program that is built, s."""
SHARE = 0.5
"""Share of the remaining work that one proposal may take."""

Place = tuple[int, tuple[int, int]] | None
"""A lane by its number and a window; None where a patch is deleted."""


@dataclass(frozen=True, slots=True)
class _Lesson:
    """A cut in terms that outlive one constraint program."""

    options: tuple[tuple[str, frozenset[Place]], ...]
    order: tuple[Order, ...]


@dataclass(slots=True, eq=False)
class _Group:
    """Units that are solved together."""

    problem: Problem
    scene: Scene
    """The furniture with everything else folded as it will be."""
    units: tuple[Unit, ...]
    known: float
    """What the best fold known counts."""
    floor: Mapping[str, float]
    """By unit, what it counts at least."""
    lanes: dict[str, tuple[Lane, ...]]
    """By patch; those on plinths are added as they are asked for."""
    lessons: list[_Lesson] = field(default_factory=list)
    excluded: tuple[Mapping[str, Signature], ...] = ()
    """Modifications of all patches that are not asked for again, nor with less left of them."""


def optimal(
    problem: Problem, scene: Scene, known: Ordered | None, floor: Mapping[str, float], work: float
) -> tuple[Ordered | None, float]:
    """The best order that was found, and what any order counts at least.

    Args:
        problem: the scaffold and its units.
        scene: the open furniture.
        known: the greedy order, if there is one.
        floor: by unit, what it counts at least by itself.
        work: the limit, in seconds of an ordinary machine.
    """
    if not np.isfinite(sum(floor.values())):
        return known, float(sum(floor.values()))
    folds = {f.unit.name: f for f in known.folds} if known else {}
    is_whole = set(folds) == set(floor)
    groups = neighbouring(problem) if is_whole else [set(floor)]
    order = [f.unit.name for f in known.folds] if known else sorted(floor)
    bound = 0.0
    for names in groups:
        least = sum(floor[n] for n in names)
        best = sum(folds[n].weight for n in names) if is_whole else (_weight(known) if known else np.inf)
        if best - least <= NO_MORE:
            bound += least
            continue
        others = [folds[n] for n in order if n not in names] if is_whole else []
        found, group_bound = _solved(_group(problem, scene, others, {n: floor[n] for n in names}, best), work)
        bound += min(group_bound, best)
        if found is not None:
            rest = [n for n in order if n not in names] if is_whole else []
            folds = {**{n: folds[n] for n in rest}, **{f.unit.name: f for f in found}}
            order, is_whole = [*rest, *(f.unit.name for f in found)], True
    if not is_whole:
        return known, bound
    return Ordered(tuple(folds[n] for n in order), ()), bound


def other(
    problem: Problem, scene: Scene, floor: Mapping[str, float], excluded: tuple[Mapping[str, Signature], ...],
    most: float, work: float,
) -> tuple[Ordered | None, float]:  # fmt: skip
    """The best order with other modifications than those excluded that counts less than `most`, and its bound."""
    group = replace(_group(problem, scene, [], dict(floor), most), excluded=excluded)
    folds, bound = _solved(group, work)
    return (Ordered(folds, ()) if folds is not None else None), bound


def _weight(known: Ordered) -> float:
    return sum(f.weight for f in known.folds)


def _group(problem: Problem, scene: Scene, others: list[UnitFold], floor: dict[str, float], known: float) -> _Group:
    spare = known - sum(floor.values())
    for fold in others:
        scene = after(problem, scene, fold)
    units = tuple(u for u in problem.units if u.name in floor)
    for unit in units:
        own = repertoire(problem, unit)
        for patch in unit.patches:
            first = own.plain[patch][0].variant if own.plain[patch] else None
            while own.later[patch] and _surcharge(problem, patch, first, own.later[patch][0]) < spare:
                extend(problem, own, patch)
    lanes = {p: repertoire(problem, u).plain[p] for u in units for p in u.patches}
    return _Group(problem, scene, units, known, floor, lanes)


def _surcharge(problem: Problem, patch: str, first: basic.Variant | None, variant: basic.Variant) -> float:
    """How much more a variant costs than the first one of its patch."""
    if first is None:
        return 0.0
    more = basic.cost(variant.hinges, 1.0, problem.options) - basic.cost(first.hinges, 1.0, problem.options)
    return problem.sites[patch].importance * more


def _solved(group: _Group, work: float) -> tuple[tuple[UnitFold, ...] | None, float]:
    """The cheapest folds of the group in their order, and what any folds of it count at least.

    No folds where none is cheaper than what is known, or none was found within the work.
    """
    bound, hint = sum(group.floor.values()), None
    while work > 0:
        options, master = _posed(group)
        work -= BUILDING
        fresh = len(group.lessons)
        lanes = sum(map(len, group.lanes.values()))
        while work > 0:
            proposal, least, spent = master.solved(work * SHARE, hint)
            work -= spent
            bound = max(bound, min(least, group.known))
            if proposal is None or least >= group.known - NO_MORE:
                return None, bound
            result = _played(group, options, proposal)
            work -= PLAYING * len(group.units)
            if isinstance(result, tuple):
                is_best = proposal.bound >= _total(options, proposal) - NO_MORE
                return (result, bound) if is_best else (result, min(bound, _total(options, proposal)))
            hint = proposal
            if sum(map(len, group.lanes.values())) > lanes:
                break
            for lesson in group.lessons[fresh:]:
                master.add(_cut(options, lesson))
            fresh = len(group.lessons)
    return None, bound


def _total(options: Mapping[str, Options], proposal: Proposal) -> float:
    return float(sum(options[p].weight[i] for p, i in proposal.chosen.items()))


def _posed(group: _Group) -> tuple[dict[str, Options], Master]:
    """The options of every patch, and the constraint program over those that may be part of something cheaper."""
    problem = group.problem
    options: dict[str, Options] = {}
    tables = {}
    for unit in group.units:
        own = repertoire(problem, unit)
        found = _all_of(group, unit)
        graph = Graph(problem, own, found, np.zeros(3))
        options.update({o.patch: o for o in graph.options})
        tables.update({(unit.patches[g], unit.patches[h]): m for (g, h), m in graph.tables.items()})
    spare = group.known - sum(float(o.weight.min()) for o in options.values())
    worth = {p: np.nonzero(o.weight - o.weight.min() <= spare)[0].tolist() for p, o in options.items()}
    worth = {p: keep if np.isfinite(spare) else _finite(options[p]) for p, keep in worth.items()}
    master = Master({u.name: u.patches for u in group.units}, options, tables, worth)
    for patch, twin in sorted(problem.twins.items()):
        if patch < twin.patch and patch in options and twin.patch in options:
            master.treat_alike(
                patch,
                twin.patch,
                unlike(options[patch], options[twin.patch], problem.options.shrink_steps, is_reversed=twin.is_reversed),
            )
    for unit in group.units:
        master.at_least({p: options[p].weight for p in unit.patches}, group.floor[unit.name])
    for one in group.excluded:
        alike = (
            (p, tuple(i for i in range(len(o.price)) if is_less(signature(o[i]), one[p]))) for p, o in options.items()
        )
        master.add(Cut(tuple(alike), ()))
    for lesson in group.lessons:
        master.add(_cut(options, lesson))
    return options, master


def _finite(options: Options) -> list[int]:
    found: list[int] = np.nonzero(np.isfinite(options.weight))[0].tolist()
    return found


def _all_of(group: _Group, unit: Unit) -> Prospects:
    """All lanes of a unit that are known by now, whatever stands around it."""
    steps = group.problem.options.shrink_steps
    free = unhindered(group.problem, repertoire(group.problem, unit))
    lanes = {p: group.lanes[p] for p in unit.patches}
    blocked = {x.number: np.full(steps, x.is_out) for many in lanes.values() for x in many}
    return replace(free, lanes=lanes, blocked=blocked)


def _cut(options: Mapping[str, Options], lesson: _Lesson) -> Cut:
    places = tuple(
        (p, tuple(i for i in range(len(options[p].price)) if _place(options[p], i) in held))
        for p, held in lesson.options
    )
    return Cut(places, lesson.order)


def _place(options: Options, index: int) -> Place:
    found = options.place(index)
    return (found[0].number, found[1]) if found is not None else None


def _played(group: _Group, options: Mapping[str, Options], proposal: Proposal) -> tuple[UnitFold, ...] | None:
    """The folds of a proposal, or None where it does not hold and something was learned from that."""
    problem, scene = group.problem, group.scene
    by_name = {u.name: u for u in group.units}
    for unit in group.units:
        scene = shown(scene, unit, _plain_chains(problem, unit, options, proposal), is_folded=False)
    folds: list[UnitFold] = []
    done: set[str] = set()
    for name in proposal.order:
        fold = _unit_played(group, scene, by_name[name], options, proposal, done)
        if fold is None:
            return None
        folds.append(fold)
        scene = after(problem, scene, fold)
        done.add(name)
    return tuple(folds)


def _plain_chains(problem: Problem, unit: Unit, options: Mapping[str, Options], proposal: Proposal) -> list[Chain]:
    """The chains of a proposal before anything is balanced."""
    made = []
    for patch in unit.patches:
        option = options[patch][proposal.chosen[patch]]
        span = basic.window_span(problem.sites[patch], option.window, problem.options.shrink_steps, problem.thickness)
        if option.variant is not None and span is not None:
            chain = basic.chain(problem.sites[patch], option.variant, span, problem.thickness)
            made += [chain] if chain is not None else []
    return made


def _unit_played(
    group: _Group, scene: Scene, unit: Unit, options: Mapping[str, Options], proposal: Proposal, done: set[str]
) -> UnitFold | None:
    problem, own = group.problem, repertoire(group.problem, unit)
    around = look(problem, scene, own)
    if around.standing:
        group.lessons += [_must_wait(problem, unit, options, patch) for patch in sorted(around.standing)]
        return None
    chosen = {p: options[p][proposal.chosen[p]] for p in unit.patches}
    result = realised(problem, scene, unit, around, chosen)
    found = prospects(problem, own, around, in_place=False)
    if not isinstance(result, Clash):
        reasons = reasons_of(problem, own, found, chosen)
        cost = sum(o.cost for o in chosen.values())
        weight = sum(float(options[p].weight[proposal.chosen[p]]) for p in unit.patches)
        return UnitFold(unit, chosen, reasons, *result, around.cluster, cost, weight)
    for patch, lanes in found.lanes.items():
        group.lanes[patch] += tuple(x for x in lanes if x not in group.lanes[patch])
    group.lessons += _lessons(group, scene, unit, around, options, proposal, done, result)
    group.lessons += _lessons_of_others(group, scene, unit, around, options, proposal, done, found)
    return None


def _must_wait(problem: Problem, unit: Unit, options: Mapping[str, Options], patch: str) -> _Lesson:
    """A unit that would bring bases together cannot fold before what stands between them, unless that is deleted."""
    kept = frozenset(_place(options[patch], i) for i in range(len(options[patch].price) - 1))
    return _Lesson(((patch, kept),), ((unit.name, problem.unit_of[patch].name),))


def _lessons_of_others(
    group: _Group, scene: Scene, unit: Unit, around: Surroundings, options: Mapping[str, Options],
    proposal: Proposal, done: set[str], found: Prospects,
) -> list[_Lesson]:  # fmt: skip
    """What the same surroundings would do to the lanes that were not chosen."""
    problem, lessons = group.problem, []
    for x in (x for many in found.lanes.values() for x in many if found.blocked[x.number].any() and not x.is_out):
        met = found.obstacles[x.number]
        strangers = [o for o in met if o in problem.unit_of and o in options]
        windows = {w for w in options[x.patch].windows if found.blocked[x.number][w[0] : w[1]].any()}
        held = [(x.patch, frozenset((x.number, w) for w in windows))]
        slabs = _slabs(problem, around, found.met[x.number], done)
        held += [(q, _as_wide(options[q], proposal.chosen[q], any_lane=q in slabs)) for q in strangers]
        deciding = {problem.unit_of[q].name for q in strangers}.union(
            *(_on_the_way(scene, unit, around, o) for o in met)
        )
        lessons.append(_Lesson(tuple(held), _as_it_is(group, unit, deciding, done)))
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
    """How many hinges are inserted in the open chain that a solid shows: its panels come first, then knuckles, then a foot."""
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


def _as_it_is(group: _Group, unit: Unit, deciding: set[str], done: set[str]) -> tuple[Order, ...]:
    """The order of the deciding units around this one, as it is now."""
    names = {u.name for u in group.units} & deciding - {unit.name}
    return tuple((n, unit.name) if n in done else (unit.name, n) for n in sorted(names))


def _lessons(
    group: _Group, scene: Scene, unit: Unit, around: Surroundings, options: Mapping[str, Options],
    proposal: Proposal, done: set[str], clash: Clash,
) -> list[_Lesson]:  # fmt: skip
    """What a clash forbids: the options that meet, as long as the units that decide it fold in this order."""
    problem, found = group.problem, []
    lies_low = any(np.isfinite(flat) for flat, _, _ in around.limits.values())
    for k, patches in enumerate(clash.patches):
        held = [(p, _alike(options[p], proposal.chosen[p], clash.holds_for)) for p in patches]
        met = clash.met[k] if clash.met else ()
        strangers = [o for o in met if o in problem.unit_of and problem.unit_of[o] is not unit and o in options]
        held += [(q, _alike(options[q], proposal.chosen[q], clash.holds_for)) for q in strangers]
        deciding = {problem.unit_of[q].name for q in strangers}
        for owner in met:
            deciding |= _on_the_way(scene, unit, around, owner)
        if lies_low:
            deciding |= depends_on(problem, unit, around)
            low = {s.owner for s in around.solids if s.state == "folded"} & set(options)
            held += [(q, _alike(options[q], proposal.chosen[q], "any window")) for q in sorted(low - set(strangers))]
        if clash.cuts:
            held += [(q, frozenset([None])) for q in sorted(scene.gone & set(options))]
            deciding = set()
        found.append(_Lesson(tuple(held), _as_it_is(group, unit, deciding, done)))
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


def _alike(options: Options, index: int, holds_for: str) -> frozenset[Place]:
    """The options that a clash of one rules out as well."""
    if holds_for == "this" or options.place(index) is None:
        return frozenset([_place(options, index)])
    return frozenset(_place(options, i) for i in options.like(index, wider=holds_for == "wider windows"))
