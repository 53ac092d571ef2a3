"""The folding options that each patch of a unit has at a given moment (sections 5.3 to 5.6).

Every variant of a patch is swept once along the unit's nominal fold; the pieces that meet anything but the unit itself
are pruned (section 5.5, inner loop). Where what it meets lies folded on its own bases, the variant is tried again
standing on plinths of that height: the horizontal cropping of figure 15(c). Without plinths the windows that keep
clear remain: the vertical cropping of figure 15(b). The choice decides by cost.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from foldfab.folding import anatomy, basic, press
from foldfab.folding.basic import Option, Variant
from foldfab.folding.mechanism import reach
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.outline import leaves_box, sticks_out
from foldfab.folding.scene import Scene, Solid, clusters, solids
from foldfab.folding.site import Site
from foldfab.folding.space import Sweep, blocked, sweep, window_blocked
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, bounds, grown, moved, stacked
from foldfab.recipe.model import FoldOptions
from foldfab.scaffold.model import Scaffold

FRAMES = 16
"""Instants of each section of a unit's nominal fold at which clashes are looked for."""
PAD_SHARE = 0.4
"""Plinths may take at most this share of the height between two bases; beyond it nothing flat is left."""
DELETION = 100.0
"""What deleting a patch counts in the search, times its importance, instead of eq. 3: nobody wants a shelf without its
wall because that is cheaper than a hinge. The cost that is reported is the paper's."""
PREFERENCE = 1e-6
"""Weight of the preferences that decide between options of equal cost: small plinths, staying within the outline."""


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """What stays the same while the units are folded one after another."""

    scaffold: Scaffold
    options: FoldOptions
    thickness: Thickness
    sites: Mapping[str, Site]
    furniture: Boxes
    """(n,) the open furniture with thickness."""
    sweeps: dict[tuple[str, str, Variant], tuple[Chain, Sweep, Array] | None] = field(default_factory=dict)
    """Sweeps that were made already, by unit, patch and variant."""
    pairs: dict[tuple[str, str, Variant, str, Variant], Bools] = field(default_factory=dict)
    """Piece conflicts that were found already."""
    forms: dict[tuple[str, bool], tuple[Variant, ...]] = field(default_factory=dict)
    """Variants of each patch, with and without slanting."""
    room: dict[str, dict[str, tuple[Array, Array]]] = field(default_factory=dict)
    """By unit and base, the bounds of all its sweeps as seen from that base."""
    solved: dict[object, Any] = field(default_factory=dict)
    """Solutions of units, by all that they depend on."""
    banned: frozenset[tuple[str, Variant]] = frozenset()
    """Variants, without plinths, that a rehearsal of the whole fold has shown to be in the way."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A variant of a patch with its sweep."""

    variant: Variant
    chain: Chain
    sweep: Sweep
    blocked: Bools
    """(N_s,) pieces that meet something outside the unit."""
    obstacles: tuple[str, ...]
    """Owners of what they meet."""


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """All that stands around a unit, in the frame in which the unit is open, by cluster."""

    solids: tuple[Solid, ...]
    cluster: dict[str, str]
    boxes: Boxes
    """(n,) all boxes."""
    owner: tuple[int, ...]
    """(n,) index into `solids`."""
    low: Array
    """(n, 3)."""
    high: Array
    """(n, 3)."""
    offset: Array
    """(3,) how far the unit has been carried since the open posture."""
    root: str
    """The unit's base that moves with the furniture's lowest base."""


def surroundings(problem: Problem, scene: Scene, unit: Unit) -> Surroundings:
    """Everything but the unit's own patches."""
    shift = scene.offset[unit.bases[0]]
    found = [replace(s, boxes=replace(s.boxes, center=s.boxes.center - shift)) for s in solids(scene, unit)]
    boxes = stacked([s.boxes for s in found])
    owner = tuple(i for i, s in enumerate(found) for _ in range(len(s.boxes)))
    cluster = clusters(scene, unit)
    root = cluster[problem.scaffold.bases[0].name]
    return Surroundings(tuple(found), cluster, boxes, owner, *bounds(boxes), shift, root)


def candidates(problem: Problem, unit: Unit, around: Surroundings, *, in_place: bool) -> dict[str, list[Candidate]]:
    """The variants of each patch of the unit, with the pieces that are blocked."""
    may_slant = not in_place and is_slantable(problem, unit)
    found: dict[str, list[Candidate]] = {}
    for patch in unit.patches:
        site = problem.sites[patch]
        found[patch] = []
        for variant in variants(problem, site, may_slant=may_slant):
            first = _candidate(problem, unit, around, site, variant)
            if first is None:
                continue
            found[patch].append(first)
            raised = _raised(problem, unit, around, site, first) if first.blocked.any() else None
            found[patch] += [raised] if raised is not None else []
    return found


def variants(problem: Problem, site: Site, *, may_slant: bool) -> tuple[Variant, ...]:
    """The variants of a patch without plinths, found once."""
    key = (site.patch.name, may_slant)
    if key not in problem.forms:
        found = basic.variants(site, problem.options, problem.thickness, may_slant=may_slant)
        problem.forms[key] = tuple(v for v in found if (site.patch.name, v) not in problem.banned)
    return problem.forms[key]


def seen_from(problem: Problem, unit: Unit) -> dict[str, tuple[Array, Array]]:
    """By base of the unit, lower and upper corner (3,) of everything its chains sweep, relative to that base."""
    key = _key(unit)
    if key not in problem.room:
        down, found = _nominal(problem, unit), {}
        for base in unit.bases:
            corners = []
            for patch in unit.patches:
                site = problem.sites[patch]
                for variant in variants(problem, site, may_slant=is_slantable(problem, unit)):
                    made = _swept(problem, unit, site, variant)
                    if made is not None:
                        corners.append(_relative(made, base, down))
            low = np.min([c[0] for c in corners], axis=0) if corners else np.full(3, np.inf)
            high = np.max([c[1] for c in corners], axis=0) if corners else np.full(3, -np.inf)
            found[base] = (low, high)
        problem.room[key] = found
    return problem.room[key]


def _relative(made: tuple[Chain, Sweep, Array], base: str, down: Mapping[str, Array]) -> tuple[Array, Array]:
    chain, swept, far = made
    shift = far if base == chain.far else np.stack([0 * down[base], 0 * down[base], down[base]], axis=1)
    return (swept.low - shift[:, None]).min((0, 1)), (swept.high - shift[:, None]).max((0, 1))


def options(problem: Problem, site: Site, many: list[Candidate], offset: Array) -> list[tuple[Option, float]]:
    """The options of a patch, deletion last, each with what it counts in the search: its cost plus preferences.

    `offset` (3,) is how far the unit has been carried already.
    """
    made: list[tuple[Option, float]] = []
    steps = problem.options.shrink_steps
    for candidate in many:
        extra = PREFERENCE * _awkwardness(problem, candidate, offset)
        for window in basic.windows(steps):
            if window_blocked(candidate.blocked, window):
                continue
            if basic.window_span(site, window, steps, problem.thickness) is None:
                continue
            kept = (window[1] - window[0]) / steps
            price = site.importance * basic.cost(candidate.variant.hinges, kept, problem.options)
            made.append((Option(candidate.variant, window, price), price + extra))
    price = site.importance * basic.cost(0, 0.0, problem.options)
    made.append((Option(None, (0, 0), price), DELETION * site.importance))
    return made


def is_slantable(problem: Problem, unit: Unit) -> bool:
    """Whether all basic scaffolds of the unit are H-scaffolds that share the same pair of bases."""
    return len(unit.bases) == 2 and all(problem.sites[p].far is not None for p in unit.patches)


def clearances(problem: Problem, unit: Unit) -> dict[tuple[str, str], float]:
    """By (lower, upper), for all pairs of the unit's bases, the clear height between their faces, mm."""
    plates = {b: anatomy.faces(problem.scaffold.base(b), problem.thickness) for b in unit.bases}
    return {(a, b): plates[b].bottom - plates[a].top for a in unit.bases for b in unit.bases if a != b}


def levels(problem: Problem, unit: Unit) -> dict[str, float]:
    """Heights of the unit's bases above its lowest one, mm."""
    top = {b: anatomy.faces(problem.scaffold.base(b), problem.thickness).top for b in unit.bases}
    return {b: top[b] - top[unit.bases[0]] for b in unit.bases}


def held(problem: Problem, unit: Unit) -> list[Site]:
    """The sites of the unit's H-scaffolds."""
    return [problem.sites[p] for p in unit.patches if problem.sites[p].far is not None]


def _candidate(problem: Problem, unit: Unit, around: Surroundings, site: Site, variant: Variant) -> Candidate | None:
    made = _swept(problem, unit, site, variant)
    if made is None:
        return None
    chain, swept, shift = made
    others = _static(problem, unit, around, chain, shift)
    pieces, met = blocked(swept, others) if others is not None else (np.zeros(len(swept.cuts) - 1, dtype=bool), ())
    keep = _kept(around, chain)
    owners = tuple(sorted({around.solids[around.owner[keep[i]]].owner for i in met}))
    if _is_out(problem, unit, around, chain, swept, shift):
        pieces = np.ones_like(pieces)
        owners = (*owners, "the bounding box")
    return Candidate(variant, chain, swept, pieces, owners)


def _swept(problem: Problem, unit: Unit, site: Site, variant: Variant) -> tuple[Chain, Sweep, Array] | None:
    """The chain, its sweep and the (frames, 3) shift of its far end, made once."""
    key = (_key(unit), site.patch.name, variant)
    if key not in problem.sweeps:
        problem.sweeps[key] = _sweep_of(problem, unit, site, variant)
    return problem.sweeps[key]


def _sweep_of(problem: Problem, unit: Unit, site: Site, variant: Variant) -> tuple[Chain, Sweep, Array] | None:
    span = basic.window_span(site, (0, problem.options.shrink_steps), problem.options.shrink_steps, problem.thickness)
    chain = basic.chain(site, variant, span, problem.thickness) if span is not None else None
    if chain is None or span is None:
        return None
    down = _nominal(problem, unit)
    frames = len(next(iter(down.values())))
    progress = np.linspace(0.0, 1.0, frames)
    base = np.zeros((frames, 3))
    base[:, 2] = down[chain.anchor]
    if chain.mechanism == "in-place" and chain.far is not None:
        progress = press.follow_down(chain, down[chain.anchor] - down[chain.far])
    end = reach(chain, progress)
    far = base + (end - end[0]) @ np.stack([chain.across, chain.rise])
    mover = _mover(chain, problem.thickness, progress, base, far)
    middle = float(site.foot @ site.along)
    width, steps = site.patch.width, problem.options.shrink_steps
    cuts = middle - width / 2 + width * np.arange(steps + 1) / steps
    cuts[0], cuts[-1] = min(cuts[0], middle + span[0]), max(cuts[-1], middle + span[1])
    return chain, sweep(grown(mover, problem.thickness.gap / 2), cuts), far


def _mover(chain: Chain, thickness: Thickness, progress: Array, base: Array, far: Array) -> Boxes:
    """Panels, knuckles and feet over time, (frames, n)."""
    panels = anatomy.moving_boxes(chain, thickness, progress)
    parts = [Boxes(panels.center + base[:, None], panels.axes, panels.half)]
    for feet, shift in ((anatomy.anchor_feet(chain, thickness), base), (anatomy.far_feet(chain, thickness), far)):
        shape = (len(progress), len(feet))
        parts.append(
            Boxes(
                feet.center + shift[:, None],
                np.broadcast_to(feet.axes, (*shape, 3, 3)),
                np.broadcast_to(feet.half, (*shape, 3)),
            )
        )
    return Boxes(*(np.concatenate([getattr(p, f) for p in parts], axis=1) for f in ("center", "axes", "half")))


def _nominal(problem: Problem, unit: Unit) -> dict[str, Array]:
    """How each base of the unit comes down at its clash-test instants, (frames,) mm, as if every chain were light."""
    clear = clearances(problem, unit)
    stack = problem.thickness.stack(2, has_upper_base=True)
    least = {(s.anchor, s.far): stack for s in held(problem, unit) if s.far is not None}
    way = press.ways(unit.bases, least, clear, levels(problem, unit))
    marks = sorted({round(w, 6) for w in way.values()} | {0.0}, reverse=True)
    if len(marks) == 1:
        return {b: np.zeros(FRAMES + 1) for b in unit.bases}
    turn = 1 - np.cos(np.linspace(0.0, np.pi / 2, FRAMES + 1))
    level = np.concatenate([a + (b - a) * turn for a, b in itertools.pairwise(marks)])
    return {b: np.minimum(level, way[b]) - way[b] for b in unit.bases}


def _kept(around: Surroundings, chain: Chain) -> list[int]:
    """Boxes that the chain may meet: all but the plates of its own bases."""
    own = {chain.anchor, chain.far}
    return [
        i
        for i, s in enumerate(around.owner)
        if not (around.solids[s].state == "base" and around.solids[s].owner in own)
    ]


def _static(problem: Problem, unit: Unit, around: Surroundings, chain: Chain, far: Array) -> Sweep | None:
    """The surroundings as they move with the unit's bases, in time with the chain."""
    keep = _kept(around, chain)
    if not keep:
        return None
    down = _nominal(problem, unit)
    shift = np.zeros((len(far), len(keep), 3))
    for k, i in enumerate(keep):
        base = around.cluster[around.solids[around.owner[i]].base]
        if base == chain.far:
            shift[:, k] = far
        else:
            shift[:, k, 2] = down[base]
    boxes = around.boxes[keep]
    shape = shift.shape[:2]
    spread = Boxes(
        boxes.center + shift, np.broadcast_to(boxes.axes, (*shape, 3, 3)), np.broadcast_to(boxes.half, (*shape, 3))
    )
    return Sweep(spread, np.zeros(2), around.low[keep] + shift, around.high[keep] + shift)


def _raised(problem: Problem, unit: Unit, around: Surroundings, site: Site, first: Candidate) -> Candidate | None:
    """The variant on plinths as high as what it meets folded on its own bases, or None where that does not help."""
    current = first
    for _ in range(4):
        pads = _needed_pads(problem, unit, around, site, current)
        if pads is None or sum(pads) > PAD_SHARE * site.clear:
            return None
        if pads == current.variant.pads:
            break
        raised = _candidate(problem, unit, around, site, replace(current.variant, pads=pads))
        if raised is None:
            return None
        current = raised
        if not current.blocked.any():
            return current
    return current if current.blocked.sum() < first.blocked.sum() else None


def _needed_pads(
    problem: Problem, unit: Unit, around: Surroundings, site: Site, candidate: Candidate
) -> tuple[float, float] | None:
    """Heights above the anchor's face and below the far face of the folded things that the candidate meets."""
    plates = {b: anatomy.faces(problem.scaffold.base(b), problem.thickness) for b in (site.anchor, site.far) if b}
    made = _swept(problem, unit, site, candidate.variant)
    assert made is not None
    others = _static(problem, unit, around, candidate.chain, made[2])
    if others is None:
        return candidate.variant.pads
    keep = _kept(around, candidate.chain)
    pads = list(candidate.variant.pads)
    for i in blocked(candidate.sweep, others)[1]:
        solid = around.solids[around.owner[keep[i]]]
        base = around.cluster[solid.base]
        if solid.state == "open" or base not in plates:
            continue
        end = 0 if base == site.anchor else 1
        rises = (site.rise[2] > 0) == (end == 0)
        height = around.high[keep[i], 2] - plates[base].top if rises else plates[base].bottom - around.low[keep[i], 2]
        pads[end] = max(pads[end], float(height))
    return (pads[0], pads[1])


def _is_out(problem: Problem, unit: Unit, around: Surroundings, chain: Chain, swept: Sweep, far: Array) -> bool:
    if chain.mechanism == "in-place" and sticks_out(problem.furniture, chain, swept, problem.thickness):
        return True
    if not problem.options.stay_in_box:
        return False
    down = _nominal(problem, unit)
    shift = {b: np.stack([0 * d, 0 * d, d], axis=1) for b, d in down.items()}
    if chain.far is not None:
        shift[chain.far] = far
    held = {base: _bounds_of(around, base) for base in unit.bases}
    return leaves_box(problem.furniture, swept, held, shift, around.offset, around.root, problem.thickness)


def _bounds_of(around: Surroundings, base: str) -> tuple[Array, Array]:
    """Lower and upper corner (3,) of what moves with a base of the unit."""
    own = [i for i, s in enumerate(around.owner) if around.cluster[around.solids[s].base] == base]
    return around.low[own].min(0), around.high[own].max(0)


def _key(unit: Unit) -> str:
    """Tells units apart, merged ones too."""
    return "/".join(unit.patches)


def _awkwardness(problem: Problem, candidate: Candidate, offset: Array) -> float:
    """How far a candidate carries things out of the open furniture and how high its plinths are, relative."""
    corners = bounds(problem.furniture)
    least, most = corners[0].min(0), corners[1].max(0)
    size = float(np.linalg.norm(most - least))
    low, high = candidate.sweep.low.min((0, 1)), candidate.sweep.high.max((0, 1))
    if candidate.chain.far is not None:
        plate = anatomy.base_boxes(problem.scaffold.base(candidate.chain.far), problem.thickness)
        ends = reach(candidate.chain, np.array([0.0, 1.0])) @ np.stack([candidate.chain.across, candidate.chain.rise])
        landed = bounds(moved(plate, ends[1] - ends[0]))
        low, high = np.minimum(low, landed[0].min(0)), np.maximum(high, landed[1].max(0))
    out = np.maximum(least - low - offset, 0) + np.maximum(high + offset - most, 0)
    return float(out.sum() + 2 * sum(candidate.variant.pads)) / size
