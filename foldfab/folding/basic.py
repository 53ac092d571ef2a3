"""All folding solutions of a basic scaffold in isolation (section 5.3), with thickness (section 5.6).

A *variant* says how a patch folds: slanted, or in place with N_h inserted hinges to the left or to the right, and how
high the plinths are on which its hinges stand. An *option* is a variant with a window of the patch, or deletion.
Costs are eq. 3, weighted by the importance λ of eq. 1.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from foldfab.folding.model import Chain, Mechanism, Modification, Side, Thickness
from foldfab.folding.site import Site
from foldfab.geometry.arrays import Array, Bools
from foldfab.recipe.model import FoldOptions

WHOLE = (0.0, 1.0)
"""Hinges that have knuckles all along."""
STEEPEST = np.radians(75.0)
"""A patch that leans more than this is too flat to be folded."""


@dataclass(frozen=True, slots=True, order=True)
class Variant:
    """How a patch folds, whatever its window."""

    mechanism: Mechanism
    hinges: int
    side: Side
    pads: tuple[float, float] = (0.0, 0.0)
    extra: float = 0.0
    """What is added to the thickness of its panels, mm."""
    hinged: tuple[float, float] = WHOLE
    """The share of the patch's width in which its hinges have knuckles."""


@dataclass(frozen=True, slots=True)
class Option:
    """A folding solution of a basic scaffold; `variant` is None where the patch is deleted."""

    variant: Variant | None
    window: tuple[int, int]
    """First and last cutting point, in N_s-ths of the width."""
    cost: float
    """λ · eq. 3."""


def variants(site: Site, options: FoldOptions, thickness: Thickness, *, may_slant: bool) -> tuple[Variant, ...]:
    """The variants without plinths that are long enough for their hinges, cheapest first.

    T-scaffolds may fold with any number of hinges, H-scaffolds slanted or in place with an odd number.
    """
    is_t = site.far is None
    counts = range(options.max_hinges + 1) if is_t else range(1, options.max_hinges + 1, 2)
    counts = counts if site.patch.hingeable else range(1 if is_t else 0)
    sides: tuple[Side, Side] = ("l", "r")
    found = [Variant("in-place", n, side) for n in counts if n or not is_t for side in sides]
    if is_t or (may_slant and options.slanting):
        found = [Variant("slanted", 0, side) for side in sides] + found
    span = window_span(site, (0, options.shrink_steps), options.shrink_steps, thickness)
    return tuple(v for v in found if span is not None and _lengths(site, v, thickness.of(site.panel)) is not None)


@cache
def windows(steps: int) -> tuple[tuple[int, int], ...]:
    """All windows of N_s cutting steps, the whole patch first, then by size and place."""
    found = [(a, b) for a in range(steps) for b in range(a + 1, steps + 1)]
    return tuple(sorted(found, key=lambda w: (w[0] - w[1], w)))


def cost(hinges: int, kept: float, options: FoldOptions) -> float:
    """Eq. 3: α N_h/N̂_h + (1 - α) R_s², with R_s = 1 - `kept`."""
    return options.alpha * hinges / options.max_hinges + (1 - options.alpha) * (1 - kept) ** 2


def window_span(site: Site, window: tuple[int, int], steps: int, thickness: Thickness) -> Array | None:
    """Extent (2,) along the hinge direction of a window, or None where it is too narrow for a hinge.

    A whole patch narrower than a hinge is widened to it. Two windows that meet at a cut are the gap apart.
    """
    thickness = thickness.of(site.panel)
    low, high = _extent(site, window, steps, thickness)
    if high - low >= thickness.hinge_width:
        return np.array([low, high])
    if window != (0, steps):
        return None
    middle = (low + high) / 2
    return np.array([middle - thickness.hinge_width / 2, middle + thickness.hinge_width / 2])


def too_narrow(
    sites: Sequence[Site], many: tuple[tuple[int, int], ...], steps: int, thickness: Thickness
) -> Bools:  # fmt: skip
    """Which windows of which patches (sites, windows) are too narrow for a hinge; the whole patch never is."""
    least = np.array([thickness.of(site.panel).hinge_width for site in sites])
    span = np.array([site.span for site in sites]).reshape(-1, 2)
    width = np.array([site.patch.width for site in sites]).reshape(-1, 1)
    first, last = np.array(many).T
    start = width * (first / steps - 0.5) + np.where(first > 0, thickness.gap / 2, 0.0)
    end = width * (last / steps - 0.5) - np.where(last < steps, thickness.gap / 2, 0.0)
    is_narrow = np.minimum(end, span[:, 1:]) - np.maximum(start, span[:, :1]) < least[:, None]
    found: Bools = is_narrow & np.array([one != (0, steps) for one in many])
    return found


def chain(site: Site, variant: Variant, span: Array, thickness: Thickness) -> Chain | None:
    """The thick chain of a variant with the given extent, or None where its panels would be too short."""
    thickness = thickness.of(site.panel + variant.extra)
    lengths = _lengths(site, variant, thickness)
    if lengths is None or float(span[1] - span[0]) < thickness.hinge_width - 1e-9:
        return None
    turn = math.pi / 2 if variant.side == "r" else -math.pi / 2
    first = -math.copysign(thickness.axis_offset, turn)
    offsets = np.array([0.0, *(first if i % 2 == 0 else -first for i in range(variant.hinges)), 0.0])
    rise = thickness.axis_height + variant.pads[0]
    root = site.foot + rise * (site.rise + math.tan(site.lean) * site.across)
    start, end = span.tolist()
    ends = [_on(start, end, held, thickness) for held in site.held]
    hinge_spans = np.array([ends[0], *([(start, end)] * variant.hinges), ends[1]])
    made = Chain(
        site.patch.name, site.anchor, site.far, variant.mechanism, root, site.across, site.along, site.rise, site.lean,
        turn, lengths, offsets, span, hinge_spans, variant.pads, thickness.panel, _breaks(site, variant, thickness),
    )  # fmt: skip
    return made if not made.breaks or holds(made, thickness) else None


def holds(chain: Chain, thickness: Thickness) -> bool:
    """Whether every hinge of a chain has, beside its breaks, a stretch that is wide enough for one."""
    least = thickness.of(chain.panel).hinge_width - 1e-9
    return all(
        any(high - low >= least for low, high in chain.stretches(hinge)) for hinge in range(len(chain.bodies) - 1)
    )


def stretches(
    site: Site, chain: Chain, variant: Variant, steps: int, thickness: Thickness
) -> tuple[tuple[int, int], ...]:
    """The least stretch of knuckles that holds a whole chain, in each place, in N_s-ths of the width.

    Fewer knuckles never meet more, and cost nothing: these do for all ways to interrupt its hinges.
    """
    spans, least = chain.hinge_spans.tolist(), thickness.of(chain.panel).hinge_width - 1e-9
    found, start = list[tuple[int, int]](), 0
    for end in range(1, steps + 1):
        for first in range(end - 1, start - 1, -1):
            marks = _breaks(site, replace(variant, hinged=(first / steps, end / steps)), thickness)
            low = marks[0][1] if first > 0 else -np.inf
            high = marks[-1][0] if end < steps else np.inf
            if marks and all(min(b, high) - max(a, low) >= least for a, b in spans):
                found.append((first, end))
                start = first + 1
                break
    return tuple(found)


def _breaks(site: Site, variant: Variant, thickness: Thickness) -> tuple[tuple[float, float], ...]:
    first, last = variant.hinged
    return breaks(site, [mark for mark in ((0.0, first), (last, 1.0)) if mark[0] < mark[1]], thickness)


def breaks(site: Site, free: Sequence[tuple[float, float]], thickness: Thickness) -> tuple[tuple[float, float], ...]:
    """What hinges leave free, half a gap on from every cut, a whole one at the ends, mm; `free` in shares of width."""
    width, gap = site.patch.width, thickness.gap
    return tuple(
        (
            width * (first - 0.5) - (gap if first == 0 else gap / 2),
            width * (last - 0.5) + (gap if last == 1 else gap / 2),
        )
        for first, last in free
    )


def modification(site: Site, option: Option, options: FoldOptions, reason: str) -> Modification:
    """What an option does to its patch, in the paper's terms."""
    name, steps = site.patch.name, options.shrink_steps
    if option.variant is None:
        return Modification(name, "deleted", 0, None, (0.0, 0.0), site.importance, option.cost, reason)
    kept = (option.window[0] / steps, option.window[1] / steps)
    v = option.variant
    return Modification(name, v.mechanism, v.hinges, v.side, kept, site.importance, option.cost, reason)


def _extent(site: Site, window: tuple[int, int], steps: int, thickness: Thickness) -> tuple[float, float]:
    """Lower and upper end of a window along the hinge direction, half a gap short of every cut."""
    (low, high), (a, b) = site.span.tolist(), window
    start = site.patch.width * (a / steps - 0.5) + (thickness.gap / 2 if a > 0 else 0.0)
    end = site.patch.width * (b / steps - 0.5) - (thickness.gap / 2 if b < steps else 0.0)
    return max(start, low), min(end, high)


def _lengths(site: Site, variant: Variant, thickness: Thickness) -> Array | None:
    """Axis spacings (N_h + 1,): equal, and one longer by Δ where the patch starts slanted (figure 9)."""
    if abs(site.lean) > STEEPEST:
        return None
    taken = thickness.axis_height + variant.pads[0]
    taken += thickness.axis_height + variant.pads[1] if site.far is not None else 0.0
    total = (site.clear - taken) / math.cos(site.lean)
    count, ends_free = variant.hinges + 1, site.far is None
    shift = 0.0 if ends_free or variant.mechanism == "slanted" else total * abs(math.sin(site.lean))
    lengths = [(total - shift) / count] * count
    folds_with_lean = (variant.side == "r") == (site.lean > 0)
    lengths[0 if folds_with_lean else -1] += shift
    least = (thickness.least_length(is_first=i == 0, is_last=i == count - 1, ends_free=ends_free) for i in range(count))
    is_short = total <= 0 or any(length < needed for length, needed in zip(lengths, least, strict=True))
    return None if is_short else np.array(lengths)


def _on(start: float, end: float, held: tuple[float, float], thickness: Thickness) -> tuple[float, float]:
    """The part of a span that lies over its base, at least as wide as a hinge and within the span."""
    low, high, half = max(start, held[0]), min(end, held[1]), thickness.hinge_width / 2
    if high - low >= 2 * half:
        return low, high
    middle = min(max((low + high) / 2, start + half), end - half)
    return middle - half, middle + half
