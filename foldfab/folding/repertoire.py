"""What the patches of a unit can do: every variant of every patch, swept along the unit's nominal fold (section 5.3).

A variant with its sweep is a *lane*. Lanes are made once for a unit, whatever stands around it, and so is the conflict
graph between them; lanes with more hinges are added when they may be cheaper in all, and lanes on plinths when the
surroundings ask for them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from foldfab.folding import basic
from foldfab.folding.anatomy import Ride, swept_boxes
from foldfab.folding.basic import Variant
from foldfab.folding.lanes import Lane, Movers, made, stopped, upright
from foldfab.folding.model import Chain
from foldfab.folding.nominal import FRAMES, Nominal, nominal
from foldfab.folding.problem import Problem, variants
from foldfab.folding.space import Batch, joined, still
from foldfab.folding.units import Unit
from foldfab.folding.work import SWEEPING
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, moved

ROOM_THICKNESSES = 2.0
"""Plinths and thicker panels may take a chain this many K out of what it sweeps without them."""

TOUCH = 1e-3
"""Parts exactly the gap apart do not meet: the grid that sizes stand on, mm."""
TALL = 1e6
"""Half the height of a folding region, mm: what lies above or below it counts."""
BARE = 0.1
"""How awkward hinges without knuckles are: of equal solutions the one with whole hinges is taken."""
_AWKWARD_DIGITS = 4
"""Of awkwardness: what differs by the grid of places alone is equally awkward."""


Place = tuple[Lane, tuple[int, int]]
"""A lane and a window in N_s-ths."""
Stretch = tuple[int, int]
"""First and last cutting point of the part of a patch in which its hinges have knuckles."""


@dataclass(frozen=True, slots=True, eq=False)
class Repertoire:
    """The lanes of a unit and what was found out about them; it only ever grows."""

    unit: Unit
    nominal: Nominal
    lanes: list[Lane] = field(default_factory=list)
    movers: list[Movers] = field(default_factory=list)
    """By lane and section, the moving boxes (FRAMES, n)."""
    by_variant: dict[tuple[str, Variant], Lane | None] = field(default_factory=dict)
    """Lanes by what they are; None where a variant does not fit."""
    plain: dict[str, tuple[Lane, ...]] = field(default_factory=dict)
    """By patch, its lanes without plinths that were made already, cheapest first."""
    aside: dict[str, tuple[Lane, ...]] = field(default_factory=dict)
    """By patch, such as only go together with deletions, as long as none is needed; cheaper than those in `plain`."""
    later: dict[str, list[Variant]] = field(default_factory=dict)
    """By patch, the variants that were not needed yet, cheapest first; all of them cost more than those in `plain`."""
    pieces: dict[tuple[int, int], Bools] = field(default_factory=dict)
    """By two lanes of different patches, the first one smaller, which of their pieces meet (N_s, N_s)."""
    parts: dict[tuple[int, int], Bools] = field(default_factory=dict)
    """The same told apart: a lane's panels have twice its number, and its knuckles and feet one more."""
    interrupted: set[int] = field(default_factory=set)
    """Lanes whose hinges were interrupted wherever they may be."""
    stretches: dict[int, tuple[Stretch, ...]] = field(default_factory=dict)
    """By lane, where its hinges may be interrupted, as far as that was asked for."""
    knuckled: dict[int, tuple[Array, Bools]] = field(default_factory=dict)
    """By lane, the pieces that keep knuckles in each window and stretch, and which of these each window may have."""
    plain_of: dict[int, int] = field(default_factory=dict)
    """By lane on plinths, the same without."""
    compared: set[int] = field(default_factory=set)
    """Lanes whose conflicts are known."""
    sheets: set[int] = field(default_factory=set)
    """Lanes that were compared without thickness as well, as far as that was needed."""
    tables: dict[object, Bools] = field(default_factory=dict)
    """Conflict tables between the options of two patches that were made already."""
    least: dict[str, Place] = field(default_factory=dict)
    """By patch, its lane and window in the cheapest choice without conflicts, where that is known for certain."""
    agreed: dict[object, bool] = field(default_factory=dict)
    """By two lanes whose snaps differ, by what they depend on, whether they can be balanced."""
    reach: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    """By base of the unit, lower and upper corner (3,) of all that the unit sweeps, as seen from that base."""


def pieces_met(tables: Mapping[tuple[int, int], Bools], one: int, two: int) -> Bools | None:
    """Which pieces of two numbers meet, those of the first one first, in what is kept by both, the smaller first."""
    found = tables.get((min(one, two), max(one, two)))
    return found if found is None or one < two else found.T


def made_from_scratch(problem: Problem, unit: Unit) -> Repertoire:
    """What the patches of a unit can do at least cost."""
    own = Repertoire(unit, nominal(problem, unit))
    for patch in unit.patches:
        own.later[patch] = sorted(variants(problem, unit, patch), key=lambda v: v.hinges)
        own.plain[patch] = ()
    while lacking := [p for p in unit.patches if own.later[p] and not own.plain[p]]:
        extend(problem, own, lacking)
    own.reach.update(_reach(problem, own))
    return own


def extend(problem: Problem, own: Repertoire, patches: Iterable[str]) -> None:
    """Adds the lanes of each patch that have the least number of hinges among those that were not needed yet."""
    wanted = [(p, v) for p in patches for v in own.later[p] if v.hinges == own.later[p][0].hinges]
    for (patch, variant), found in zip(wanted, lanes(problem, own, wanted), strict=True):
        own.later[patch].remove(variant)
        own.plain[patch] += (found,) if found is not None else ()


def lanes(problem: Problem, own: Repertoire, wanted: Sequence[tuple[str, Variant]]) -> list[Lane | None]:
    """The lanes of some patches' variants, or None where panels would be too short."""
    fresh = [key for key in dict.fromkeys(wanted) if key not in own.by_variant]
    many = made(problem, own.unit, own.nominal, [(problem.sites[p], v) for p, v in fresh], len(own.lanes))
    for key, found in zip(fresh, many, strict=True):
        own.by_variant[key] = found[0] if found is not None else None
        if found is not None:
            own.lanes.append(found[0])
            own.movers.append(found[1])
            problem.work.charge(SWEEPING)
    return [own.by_variant[key] for key in wanted]


def lane(problem: Problem, own: Repertoire, patch: str, variant: Variant) -> Lane | None:
    """The lane of one variant, or None where its panels would be too short."""
    return lanes(problem, own, [(patch, variant)])[0]


def interrupt(problem: Problem, own: Repertoire, x: Lane, stretches: Iterable[Stretch]) -> None:
    """Adds the lanes that do the same with knuckles in one stretch only, in N_s-ths of the width."""
    own.interrupted.add(x.number)
    steps = problem.options.shrink_steps
    variants = [replace(x.variant, hinged=(first / steps, end / steps)) for first, end in stretches]
    wanted = [(x.patch, v) for v in variants if (x.patch, v) not in problem.banned]
    own.plain[x.patch] += tuple(y for y in lanes(problem, own, wanted) if y is not None and y not in own.plain[x.patch])


def stretches(problem: Problem, own: Repertoire, x: Lane) -> tuple[Stretch, ...]:
    """The least stretch of knuckles that holds a lane, in each place."""
    if x.number not in own.stretches:
        steps, thickness = problem.options.shrink_steps, problem.thickness
        own.stretches[x.number] = basic.stretches(problem.sites[x.patch], x.chain, x.variant, steps, thickness)
    return own.stretches[x.number]


def swept(problem: Problem, own: Repertoire, many: Iterable[Lane], section: int) -> Batch | None:
    """The lanes that fold in a section, half the gap wider on every side, or None where there are none."""
    parts = [(own.movers[x.number][section], x.number) for x in many if section in x.active]
    return joined(parts, problem.thickness.gap / 2 - TOUCH) if parts else None


def resting(problem: Problem, own: Repertoire, many: Iterable[Lane], section: int) -> Batch | None:
    """The lanes that stand open or lie folded in a section, carried by their anchors."""
    parts = []
    for x in many:
        if section not in x.active:
            down = own.nominal.down[x.chain.anchor]
            if section < x.active.start:
                # Not the first frame of its sweep, in which an accordion has snapped already.
                at, was = swept_boxes([_at_home(x.chain)], problem.thickness)[0][0], 0.0
            else:
                at, was = own.movers[x.number][x.active.stop - 1][-1], float(down[x.active.stop - 1, -1])
            shift = upright(down[section] - was)
            parts.append((moved(still(at, FRAMES), shift[:, None]), x.number))
    return joined(parts, problem.thickness.gap / 2 - TOUCH) if parts else None


def regions(problem: Problem, own: Repertoire, many: Iterable[Lane]) -> Batch:
    """The folding regions of lanes (section 5.4): what their panels cover when folded, at whatever height."""
    parts = []
    for x in many:
        last = own.movers[x.number][x.active.stop - 1][-1][: len(x.chain.lengths)]
        # The panels lie flat: their second axis is the hinge direction, their third one the length.
        half = last.half.copy()
        axes = last.axes.copy()
        axes[:, 0] = [0.0, 0.0, 1.0]
        axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
        half[:, 0] = TALL
        parts.append((still(Boxes(last.center, axes, half), 1), x.number))
    return joined(parts, -TOUCH)


def awkwardness(problem: Problem, many: Sequence[Lane], offset: Array) -> Array:
    """(n,) how far lanes carry things out of the open furniture and how high their plinths are, relative to its size;
    and a little for hinges that are interrupted.

    `offset` (3,) is how far the unit has been carried since the open posture.
    """
    least, most = problem.outline
    low, high = np.array([x.low for x in many]).reshape(-1, 3), np.array([x.high for x in many]).reshape(-1, 3)
    out = np.maximum(least - low - offset, 0) + np.maximum(high + offset - most, 0)
    pads = np.array([sum(x.variant.pads) for x in many])
    bare = np.array([1 - x.variant.hinged[1] + x.variant.hinged[0] for x in many])
    found: Array = (out.sum(1) + 2 * pads) / math.dist(least, most) + BARE * bare
    return np.round(found, _AWKWARD_DIGITS)


def _at_home(chain: Chain) -> Ride:
    still = np.zeros((1, 3))
    return Ride(chain, np.zeros(1), still, still if chain.far is not None else None)


def cuts_of(own: Repertoire) -> Array:
    """(lanes, N_s + 1) cutting points of every lane."""
    return np.array([x.cuts for x in own.lanes])


def far_shift(own: Repertoire, lead: Lane, base: str, section: int) -> Array:
    """(FRAMES, 3) how a base of the unit moves in a section while the lane folds.

    A thick stack stops its far base before the nominal fold would.
    """
    if base != lead.chain.far:
        return upright(own.nominal.down[base][section])
    return lead.drag if lead.drag is not None else upright(stopped(own.nominal, lead.chain, section))


def stops_early(own: Repertoire, x: Lane) -> bool:
    """Whether the lane's far base stops before the nominal fold ends."""
    if x.chain.far is None or x.drag is not None:
        return False
    return bool(np.any(stopped(own.nominal, x.chain, -1) > own.nominal.down[x.chain.far][-1] + 1e-6))


def _reach(problem: Problem, own: Repertoire) -> dict[str, tuple[Array, Array]]:
    thickest = max(problem.sites[p].panel for p in own.unit.patches)
    margin = ROOM_THICKNESSES * (thickest + problem.thickness.gap)
    seen = [x.reach for x in own.lanes if x.reach is not None]
    if seen and len(seen) == len(own.lanes):
        ends = np.array(seen)
        low, high = ends[:, 0].min(0) - margin, ends[:, 1].max(0) + margin
        return {base: (low[i], high[i]) for i, base in enumerate(own.unit.bases)}
    found = {b: (np.full(3, np.inf), np.full(3, -np.inf)) for b in own.unit.bases}
    for section in range(own.nominal.sections):
        straight = [x for x in own.lanes if x.drag is None]
        for group in (straight, *([x] for x in own.lanes if x.drag is not None)):
            many = swept(problem, own, group, section)
            if many is None:
                continue
            far, drag = group[0].chain.far, group[0].drag
            least, most = many.low.min(1), many.high.max(1)
            for base in own.unit.bases:
                shift = drag if base == far and drag is not None else upright(own.nominal.down[base][section])
                low, high = (least - shift).min(0) - margin, (most - shift).max(0) + margin
                found[base] = (np.minimum(found[base][0], low), np.maximum(found[base][1], high))
    return found
