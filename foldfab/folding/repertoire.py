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

from foldfab.folding import anatomy, basic
from foldfab.folding.basic import Variant
from foldfab.folding.mechanism import ends, peak, reach
from foldfab.folding.model import Chain
from foldfab.folding.nominal import FRAMES, Nominal, evenly, nominal, snapped
from foldfab.folding.outline import leaves_outline
from foldfab.folding.press import follow_down, play_limit
from foldfab.folding.problem import Problem, extent, variants
from foldfab.folding.site import Site
from foldfab.folding.space import Batch, joined, still
from foldfab.folding.units import Unit
from foldfab.folding.work import SWEEPING
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes, bounds, moved

ROOM_THICKNESSES = 2.0
"""Plinths and thicker panels may take a chain this many K out of what it sweeps without them."""

TOUCH = 1e-3
"""Parts exactly the gap apart do not meet: the grid that sizes stand on, mm."""
FEW_BASES = 8
"""Up to this many bases of a unit it is kept for each lane how it is seen from each of them."""
TALL = 1e6
"""Half the height of a folding region, mm: what lies above or below it counts."""
BARE = 0.1
"""How awkward hinges without knuckles are: of equal solutions the one with whole hinges is taken."""
_AWKWARD_DIGITS = 4
"""Of awkwardness: what differs by the grid of places alone is equally awkward."""


@dataclass(frozen=True, slots=True, eq=False)
class Lane:
    """A variant of a patch with its sweep along the unit's nominal fold."""

    number: int
    """Its place among the lanes of its unit."""
    patch: str
    variant: Variant
    chain: Chain
    """The whole patch folding by the variant."""
    active: range
    """The sections in which it folds."""
    way: Array
    """(3,) how far its far end comes."""
    snap: float
    """How far its far end rises first, mm."""
    give: float
    """How much of that the play in its hinges covers, mm."""
    drag: Array | None
    """(FRAMES, 3) how it carries its far base where that is not straight down."""
    cuts: Array
    """(N_s + 1,) cutting points along its hinge direction, absolute coordinates, mm."""
    beside: tuple[float, float]
    """Between which coordinates along its normal it stays, mm."""
    is_out: bool
    """Whether it leaves the outline that in-place folding keeps to."""
    low: Array
    """(3,) lower corner of all that it sweeps and of its far base when folded."""
    high: Array
    """(3,) upper corner."""
    reach: tuple[Array, Array] | None
    """Lower and upper corners (b, 3) of all that it sweeps and half the gap around it, as seen from each base of the
    unit; None where that has more than a few."""

    def comes_past(self, depth: float) -> bool:
        """Whether its far base, coming straight down, passes `depth` mm below its start, or above if negative."""
        if self.drag is not None or self.chain.far is None:
            return False
        return self.snap >= -depth if depth < 0 else float(-self.way @ self.chain.rise) >= depth


Place = tuple[Lane, tuple[int, int]]
"""A lane and a window in N_s-ths."""


@dataclass(frozen=True, slots=True, eq=False)
class Repertoire:
    """The lanes of a unit and what was found out about them; it only ever grows."""

    unit: Unit
    nominal: Nominal
    lanes: list[Lane] = field(default_factory=list)
    movers: list[dict[int, Boxes]] = field(default_factory=list)
    """By lane and section, the moving boxes (FRAMES, n)."""
    by_variant: dict[tuple[str, Variant], Lane | None] = field(default_factory=dict)
    """Lanes by what they are; None where a variant does not fit."""
    plain: dict[str, tuple[Lane, ...]] = field(default_factory=dict)
    """By patch, its lanes without plinths that were made already, cheapest first."""
    later: dict[str, list[Variant]] = field(default_factory=dict)
    """By patch, the variants that were not needed yet, cheapest first; all of them cost more than those in `plain`."""
    pieces: dict[tuple[int, int], Bools] = field(default_factory=dict)
    """By two lanes of different patches, the first one smaller, which of their pieces meet (N_s, N_s)."""
    parts: dict[tuple[int, int], Bools] = field(default_factory=dict)
    """The same told apart: a lane's panels have twice its number, and its knuckles and feet one more."""
    interrupted: set[int] = field(default_factory=set)
    """Lanes whose hinges were interrupted wherever they may be."""
    plain_of: dict[int, int] = field(default_factory=dict)
    """By lane on plinths, the same without."""
    compared: set[int] = field(default_factory=set)
    """Lanes whose conflicts are known."""
    tables: dict[object, Bools] = field(default_factory=dict)
    """Conflict tables between the options of two patches that were made already."""
    least: dict[str, Place] = field(default_factory=dict)
    """By patch, its lane and window in the cheapest choice without conflicts, where that is known for certain."""
    agreed: dict[object, bool] = field(default_factory=dict)
    """By two lanes whose snaps differ, by what they depend on, whether they can be balanced."""
    reach: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    """By base of the unit, lower and upper corner (3,) of all that the unit sweeps, as seen from that base."""


def made_from_scratch(problem: Problem, unit: Unit) -> Repertoire:
    """What the patches of a unit can do at least cost."""
    made = Repertoire(unit, nominal(problem, unit))
    for patch in unit.patches:
        made.later[patch] = sorted(variants(problem, unit, patch), key=lambda v: v.hinges)
        made.plain[patch] = ()
        while made.later[patch] and not made.plain[patch]:
            extend(problem, made, patch)
    made.reach.update(_reach(problem, made))
    return made


def extend(problem: Problem, own: Repertoire, patch: str) -> None:
    """Adds the lanes of a patch that have the least number of hinges among those that were not needed yet."""
    later = own.later[patch]
    count = sum(v.hinges == later[0].hinges for v in later)
    found = (lane(problem, own, patch, v) for v in later[:count])
    own.plain[patch] += tuple(x for x in found if x is not None)
    del later[:count]


def lane(problem: Problem, own: Repertoire, patch: str, variant: Variant) -> Lane | None:
    """The lane of a variant, or None where its panels would be too short."""
    key = (patch, variant)
    if key not in own.by_variant:
        own.by_variant[key] = _made(problem, own, problem.sites[patch], variant)
    return own.by_variant[key]


def interrupt(problem: Problem, own: Repertoire, x: Lane) -> None:
    """Adds the lanes that do the same with the least stretch of knuckles in each place, in the lane's own N_s-ths.

    Fewer knuckles never meet more, and cost nothing: these do for all ways to interrupt its hinges.
    """
    own.interrupted.add(x.number)
    steps, start = problem.options.shrink_steps, 0
    for end in range(1, steps + 1):
        for first in range(end - 1, start - 1, -1):
            variant = replace(x.variant, hinged=(first / steps, end / steps))
            is_allowed = (x.patch, variant) not in problem.banned
            found = lane(problem, own, x.patch, variant) if is_allowed and (first, end) != (0, steps) else None
            if found is not None:
                own.plain[x.patch] += (found,)
                start = first + 1
                break


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
                at, was = anatomy.swept_boxes(x.chain, problem.thickness, np.zeros(1), *_at_home(x.chain))[0], 0.0
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
    found: Array = (out.sum(1) + 2 * pads) / float(np.linalg.norm(most - least)) + BARE * bare
    return np.round(found, _AWKWARD_DIGITS)


def _at_home(chain: Chain) -> tuple[Array, Array | None]:
    """No translation (1, 3) of the anchor, and none of the far base where there is one."""
    still = np.zeros((1, 3))
    return still, still if chain.far is not None else None


def cuts_of(own: Repertoire) -> Array:
    """(lanes, N_s + 1) cutting points of every lane."""
    return np.array([x.cuts for x in own.lanes])


def _made(problem: Problem, own: Repertoire, site: Site, variant: Variant) -> Lane | None:
    steps = problem.options.shrink_steps
    span = basic.window_span(site, (0, steps), steps, problem.thickness)
    chain = basic.chain(site, variant, span, problem.thickness) if span is not None else None
    if chain is None or span is None:
        return None
    movers, drag = _movers(problem, own, chain)
    if not movers:
        return None
    own.movers.append(movers)
    corners = {section: bounds(boxes) for section, boxes in movers.items()}
    low = np.array([low.min((0, 1)) for low, _ in corners.values()]).min(0)
    high = np.array([high.max((0, 1)) for _, high in corners.values()]).max(0)
    middle, width, gap = float(site.foot @ site.along), site.patch.width, problem.thickness.gap
    cuts = middle - width / 2 + width * np.arange(steps + 1) / steps
    # Half the gap on either side belongs to the outermost pieces.
    cuts[0], cuts[-1] = min(cuts[0], middle + span[0]) - gap, max(cuts[-1], middle + span[1]) + gap
    reaches = [extent(boxes, chain.across) for boxes in movers.values()]
    beside = (min(r[0] for r in reaches), max(r[1] for r in reaches))
    found = Lane(
        len(own.lanes), site.patch.name, variant, chain, _span(movers), ends(chain), peak(chain)[0],
        play_limit(chain, problem.thickness.gap), drag, cuts, beside, leaves_outline(problem, chain, beside),
        *_with_far_base(problem, chain, low, high), _seen_from_bases(problem, own, chain, drag, corners),
    )  # fmt: skip
    own.lanes.append(found)
    problem.work.charge(SWEEPING)
    return found


def _span(movers: Mapping[int, Boxes]) -> range:
    return range(min(movers), max(movers) + 1)


def _movers(problem: Problem, own: Repertoire, chain: Chain) -> tuple[dict[int, Boxes], Array | None]:
    """By section in which it folds, panels, knuckles and feet (FRAMES, n); and how it drags its far base."""
    down = own.nominal.down[chain.anchor]
    if chain.far is None:
        progress = evenly(*down.shape)
        far = None
    elif chain.mechanism == "slanted":
        progress = evenly(*down.shape)
        end = reach(chain, progress[0])
        far = (end - end[0]) @ chain.plane
    else:
        progress = snapped(follow_down(chain, down - own.nominal.down[chain.far]))
        far = None
    sections = [k for k in range(len(down)) if chain.far is None or progress[k, -1] > progress[k, 0]]
    found: dict[int, Boxes] = {}
    for k in range(min(sections, default=0), max(sections, default=-1) + 1):
        lead = upright(_stopped(own.nominal, chain, k)) if far is None and chain.far is not None else far
        found[k] = anatomy.swept_boxes(chain, problem.thickness, progress[k], upright(down[k]), lead)
    return found, far


def far_shift(own: Repertoire, lead: Lane, base: str, section: int) -> Array:
    """(FRAMES, 3) how a base of the unit moves in a section while the lane folds.

    A thick stack stops its far base before the nominal fold would.
    """
    if base != lead.chain.far:
        return upright(own.nominal.down[base][section])
    return lead.drag if lead.drag is not None else upright(_stopped(own.nominal, lead.chain, section))


def stops_early(own: Repertoire, x: Lane) -> bool:
    """Whether the lane's far base stops before the nominal fold ends."""
    if x.chain.far is None or x.drag is not None:
        return False
    return bool(np.any(_stopped(own.nominal, x.chain, -1) > own.nominal.down[x.chain.far][-1] + 1e-6))


def _stopped(nominal: Nominal, chain: Chain, section: int) -> Array:
    assert chain.far is not None
    found: Array = np.maximum(nominal.down[chain.far][section], nominal.down[chain.anchor][section] + ends(chain)[2])
    return found


def upright(height: Array) -> Array:
    """(k, 3) translations along Z."""
    shift = np.zeros((len(height), 3))
    shift[:, 2] = height
    return shift


def _seen_from_bases(
    problem: Problem, own: Repertoire, chain: Chain, drag: Array | None, corners: Mapping[int, tuple[Array, Array]]
) -> tuple[Array, Array] | None:
    bases = own.unit.bases
    if len(bases) > FEW_BASES:
        return None
    # Where a tilted box gets wider by half the gap, its bounds do so by up to a diagonal of it.
    margin = math.sqrt(3.0) * problem.thickness.gap / 2
    lows, highs = [], []
    for section, (low, high) in corners.items():
        shift = np.zeros((len(bases), len(low), 3))
        shift[..., 2] = [own.nominal.down[base][section] for base in bases]
        if chain.far is not None:
            shift[bases.index(chain.far)] = drag if drag is not None else upright(_stopped(own.nominal, chain, section))
        lows.append((low.min(1) - shift).min(1))
        highs.append((high.max(1) - shift).max(1))
    return np.array(lows).min(0) - margin, np.array(highs).max(0) + margin


def _reach(problem: Problem, own: Repertoire) -> dict[str, tuple[Array, Array]]:
    thickest = max(problem.sites[p].panel for p in own.unit.patches)
    margin = ROOM_THICKNESSES * (thickest + problem.thickness.gap)
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


def _with_far_base(problem: Problem, chain: Chain, low: Array, high: Array) -> tuple[Array, Array]:
    if chain.far is None:
        return low, high
    (least, most), way = problem.plates[chain.far], ends(chain)
    return np.minimum(low, least + way), np.maximum(high, most + way)
