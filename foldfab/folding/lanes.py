"""Lanes: variants of patches with their sweeps along the unit's nominal fold (sections 5.3 and 5.4).

Lanes that fold in the same sections of the unit's time are swept together, as one batch of boxes over the frames of
these sections: most of a lane are a few small arrays, and to make them one by one would take most of a solve.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldfab.folding import basic
from foldfab.folding.anatomy import Ride, swept_boxes
from foldfab.folding.basic import Variant
from foldfab.folding.mechanism import ends, peak, reach
from foldfab.folding.model import Chain
from foldfab.folding.nominal import Nominal, evenly, snapped
from foldfab.folding.outline import leaves_outline
from foldfab.folding.press import follow_down, play_limit
from foldfab.folding.problem import Problem
from foldfab.folding.site import Site
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.boxes import Boxes, bounds

FEW_BASES = 8
"""Up to this many bases of a unit it is kept for each lane how it is seen from each of them."""

Movers = dict[int, Boxes]
"""By section, the moving boxes (FRAMES, n)."""


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


Swept = tuple[Lane, Movers]


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """A chain and how it folds along the nominal fold."""

    chain: Chain
    progress: Array
    """(sections, frames) fold progress."""
    drag: Array | None
    """(frames, 3) as in a lane."""
    active: range
    """The sections in which it folds."""

    def ride(self, nominal: Nominal) -> Ride:
        """Its way through all frames of its sections."""
        own, c = slice(self.active.start, self.active.stop), self.chain
        far = upright(stopped(nominal, c, own).ravel()) if self.drag is None and c.far is not None else self.drag
        return Ride(c, self.progress[own].ravel(), upright(nominal.down[c.anchor][own].ravel()), far)


def made(
    problem: Problem, unit: Unit, nominal: Nominal, wanted: Sequence[tuple[Site, Variant]], start: int
) -> list[Swept | None]:
    """The lanes of some variants, numbered from `start` on; None where panels would be too short, or nothing folds."""
    paths = [_path(problem, nominal, site, variant) for site, variant in wanted]
    able = [(i, path) for i, path in enumerate(paths) if path is not None]
    found: list[Swept | None] = [None] * len(wanted)
    for active in dict.fromkeys(path.active for _, path in able):
        together = [(start + k, i, path) for k, (i, path) in enumerate(able) if path.active == active]
        lanes = _swept(problem, unit, nominal, active, [(k, *wanted[i], path) for k, i, path in together])
        for (_, i, _), lane in zip(together, lanes, strict=True):
            found[i] = lane
    return found


def stopped(nominal: Nominal, chain: Chain, section: int | slice) -> Array:
    """Heights of the far base in a section or some, mm: a thick stack stops it before the nominal fold would."""
    assert chain.far is not None
    found: Array = np.maximum(nominal.down[chain.far][section], nominal.down[chain.anchor][section] + ends(chain)[2])
    return found


def upright(height: Array) -> Array:
    """(k, 3) translations along Z."""
    shift = np.zeros((len(height), 3))
    shift[:, 2] = height
    return shift


def _path(problem: Problem, nominal: Nominal, site: Site, variant: Variant) -> _Path | None:
    steps = problem.options.shrink_steps
    span = basic.window_span(site, (0, steps), steps, problem.thickness)
    chain = basic.chain(site, variant, span, problem.thickness) if span is not None else None
    if chain is None:
        return None
    down, drag = nominal.down[chain.anchor], None
    if chain.shape.comes_down and chain.far is not None:
        progress = snapped(follow_down(chain, down - nominal.down[chain.far]))
        sections = np.nonzero(progress[:, -1] > progress[:, 0])[0].tolist()
    else:
        progress, sections = evenly(*down.shape), list(range(len(down)))
        if chain.far is not None:
            end = reach(chain, progress[0])
            drag = (end - end[0]) @ chain.plane
    return _Path(chain, progress, drag, range(sections[0], sections[-1] + 1)) if sections else None


def _swept(
    problem: Problem, unit: Unit, nominal: Nominal, active: range, many: list[tuple[int, Site, Variant, _Path]]
) -> list[Swept]:
    """The lanes, by their numbers, of chains that fold in the same sections."""
    rides = [path.ride(nominal) for *_, path in many]
    boxes, whose = swept_boxes(rides, problem.thickness)
    first = np.searchsorted(whose, np.arange(len(rides) + 1))
    corners = bounds(boxes)
    low = np.minimum.reduceat(corners[0], first[:-1], axis=1)
    high = np.maximum.reduceat(corners[1], first[:-1], axis=1)
    beside = _beside(boxes, np.array([ride.chain.across for ride in rides])[whose], first[:-1])
    reaches = _seen_from_bases(problem, unit, nominal, active, rides, (low, high))
    frames, found = len(low) // len(active), list[Swept]()
    for i, (number, site, variant, path) in enumerate(many):
        chain, own, way = path.chain, boxes[:, first[i] : first[i + 1]], ends(path.chain)
        lane = Lane(
            number, site.patch.name, variant, chain, active, way, peak(chain)[0],
            play_limit(chain, problem.thickness.gap), path.drag, _cuts(problem, site, chain), beside[i],
            leaves_outline(problem, chain, beside[i]),
            *_with_far_base(problem, chain, way, low[:, i].min(0), high[:, i].max(0)), reaches[i],
        )  # fmt: skip
        found.append((lane, {k: own[j * frames : (j + 1) * frames] for j, k in enumerate(active)}))
    return found


def _cuts(problem: Problem, site: Site, chain: Chain) -> Array:
    steps, gap = problem.options.shrink_steps, problem.thickness.gap
    middle, width = float(site.foot @ site.along), site.patch.width
    start, end = chain.span.tolist()
    cuts: Array = middle - width / 2 + width * np.arange(steps + 1) / steps
    # Half the gap on either side belongs to the outermost pieces.
    cuts[0], cuts[-1] = min(cuts[0], middle + start) - gap, max(cuts[-1], middle + end) + gap
    return cuts


def _beside(boxes: Boxes, across: Array, first: Indices) -> list[tuple[float, float]]:
    """Between which coordinates along their normals `across` (n, 3) boxes (frames, n) stay, lane by lane."""
    middle = np.einsum("knj,nj->kn", boxes.center, across)
    out = np.einsum("kna,kna->kn", boxes.half, np.abs(np.einsum("knaj,nj->kna", boxes.axes, across)))
    low = np.minimum.reduceat((middle - out).min(0), first).tolist()
    return list(zip(low, np.maximum.reduceat((middle + out).max(0), first).tolist(), strict=True))


def _seen_from_bases(
    problem: Problem, unit: Unit, nominal: Nominal, active: range, rides: list[Ride], corners: tuple[Array, Array]
) -> list[tuple[Array, Array]] | list[None]:
    """What each lane sweeps, from its corners (k, lanes, 3) frame by frame, as seen from each base of the unit."""
    bases = unit.bases
    if len(bases) > FEW_BASES:
        return [None] * len(rides)
    own = slice(active.start, active.stop)
    shift = np.zeros((len(bases), *corners[0].shape))
    shift[..., 2] = np.array([nominal.down[base][own].ravel() for base in bases])[:, :, None]
    for i, ride in enumerate(rides):
        if ride.far is not None and ride.chain.far is not None:
            shift[bases.index(ride.chain.far), :, i] = ride.far
    # Where a tilted box gets wider by half the gap, its bounds do so by up to a diagonal of it.
    margin = math.sqrt(3.0) * problem.thickness.gap / 2
    low, high = (corners[0] - shift).min(1) - margin, (corners[1] - shift).max(1) + margin
    return [(low[:, i], high[:, i]) for i in range(len(rides))]


def _with_far_base(problem: Problem, chain: Chain, way: Array, low: Array, high: Array) -> tuple[Array, Array]:
    if chain.far is None:
        return low, high
    least, most = problem.plates[chain.far]
    return np.minimum(low, least + way), np.maximum(high, most + way)
