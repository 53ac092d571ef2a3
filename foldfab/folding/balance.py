"""What makes chains of different folded heights end flat together (section 5.6), cheapest first.

What a chain lacks to the height of its neighbours is given

1. to the *thickness* of its panels, up to `THICKEST` times what they had: no part is changed but itself, nor shortened;
2. or to *pads*, plinths under its last hinge, up to `PAD_SHARE` of the height between its bases: panels get shorter;
3. and where neither holds, the highest chains sink into *pockets* of their bases, no deeper than they must or may: the
   bases get weaker, and a tongue has less of them to meet. What is still lacking is made up by 1 or 2.

A pocket is a negative pad. It leaves a sound skin even where another one is let into the other face, and it is only
made in a base whose parts lie at one height, along the hinges or across, and where no pin comes along the axis. All
others see the base whole: that only rules something out.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from foldfab.folding import basic
from foldfab.folding.basic import Variant
from foldfab.folding.mechanism import peak
from foldfab.folding.model import POCKET_SKIN, Chain
from foldfab.folding.press import play_limit
from foldfab.folding.problem import Problem
from foldfab.folding.site import Site
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES

THICKEST = 1.5
"""Panels may be this many times as thick as the others where that closes a stack flat."""
SUNK_SHARE = 0.4
"""A chain sinks by at most this share of its panels' thickness, so that its tongue stays above the face."""
SHALLOWEST = 0.2
"""A pocket less deep than a layer is none, mm."""
ROUNDING = 1e-9
"""What a chain lacks less than this is nothing, mm."""
SQUARE = 1e-6
"""Sine of the angle within which outlines lie along hinges."""

Variants = Mapping[str, Variant]
"""By patch, of those that are kept."""


def stack(problem: Problem, patch: str, variant: Variant) -> float:
    """How high a folded chain is between the faces of its bases, mm."""
    site = problem.sites[patch]
    thick = problem.thickness.of(site.panel)
    return thick.stack(variant.hinges + 1, has_upper_base=site.far is not None) + sum(variant.pads)


def filled(variant: Variant, slack: float, panel: float, *, by_thickness: bool) -> Variant:
    """The variant that takes up `slack` mm more when folded."""
    if slack < ROUNDING:
        return variant
    extra = slack / (variant.hinges + 1)
    if by_thickness and panel + extra <= THICKEST * panel:
        return replace(variant, extra=extra)
    return replace(variant, pads=(variant.pads[0], variant.pads[1] + slack))


def sunk(problem: Problem, wanted: Variants) -> Iterator[Variants]:
    """The same with the highest chains of each two bases in pockets: as deep as thickness wants, then as they may be.

    Nothing where no base is sound enough, or all chains are equally high.
    """
    pairs: dict[tuple[str, str], list[str]] = {}
    for patch in sorted(wanted):
        site = problem.sites[patch]
        if site.far is not None:
            pairs.setdefault((site.anchor, site.far), []).append(patch)
    depths = {pair: found for pair, many in pairs.items() if (found := _depths(problem, wanted, many))}
    for i in range(max(map(len, depths.values()), default=0)):
        made = dict(wanted)
        for pair, found in depths.items():
            top = max(stack(problem, p, wanted[p]) for p in pairs[pair])
            for patch in pairs[pair]:
                made[patch] = _let_in(problem, patch, wanted[patch], top - found[min(i, len(found) - 1)])
        yield made


def can_agree(problem: Problem, first: tuple[str, Variant, Array], second: tuple[str, Variant, Array]) -> bool:
    """Whether two chains between the same bases can be balanced so that the play in their hinges covers their snaps.

    Each is given by its patch, its variant and its extent (2,) along its hinges.
    """
    spans = {patch: span for patch, _, span in (first, second)}
    wanted = {patch: variant for patch, variant, _ in (first, second)}
    for variants in (wanted, *sunk(problem, wanted)):
        heights = {p: stack(problem, p, v) for p, v in variants.items()}
        top = max(heights.values())
        for by_thickness in (True, False):
            chains = [
                basic.chain(
                    problem.sites[p],
                    filled(v, top - heights[p], problem.sites[p].panel, by_thickness=by_thickness),
                    spans[p],
                    problem.thickness,
                )
                for p, v in variants.items()
            ]
            if None not in chains and agree([c for c in chains if c is not None], problem.thickness.gap):
                return True
    return False


def agree(chains: Iterable[Chain], gap: float) -> bool:
    """Whether chains that bring the same base down may start together: the play in their hinges covers their snaps."""
    straight = [c for c in chains if c.shape.comes_down]
    return all(
        abs(peak(a)[0] - peak(b)[0]) <= play_limit(a, gap) + play_limit(b, gap)
        for a, b in itertools.combinations(straight, 2)
        if a.far == b.far
    )


def _depths(problem: Problem, wanted: Variants, many: list[str]) -> list[float]:
    """How far the highest of the chains between two bases are tried to sink, ascending, mm."""
    heights = {p: stack(problem, p, wanted[p]) for p in many}
    top, least = max(heights.values()), min(heights.values())
    most = min(sum(_rooms(problem, p, wanted[p])) + top - heights[p] for p in many)
    most = min(most, top - least)
    # What the lowest chain lacks beyond what its panels may be thicker.
    lowest = min(many, key=lambda p: (heights[p], p))
    spare = (THICKEST - 1) * problem.sites[lowest].panel * (wanted[lowest].hinges + 1)
    enough = top - least - spare
    return [depth for depth in sorted({enough, most}) if SHALLOWEST <= depth <= most]


def _let_in(problem: Problem, patch: str, variant: Variant, height: float) -> Variant:
    """The variant no higher than `height` mm: first its anchor takes it in, then its far base."""
    depth = stack(problem, patch, variant) - height
    if depth <= 0:
        return variant
    below = min(depth, _rooms(problem, patch, variant)[0])
    return replace(variant, pads=(variant.pads[0] - below, variant.pads[1] - (depth - below)))


def _rooms(problem: Problem, patch: str, variant: Variant) -> tuple[float, float]:
    """How deep the pockets of a chain may be at its anchor and at its far base, mm: 0 at a pad."""
    site = problem.sites[patch]
    near, far = (
        pocket_room(problem, site, base) if pad == 0 else 0.0
        for base, pad in zip((site.anchor, site.far), variant.pads, strict=True)
    )
    return near, far


def pocket_room(problem: Problem, site: Site, name: str | None) -> float:
    """How deep a pocket for a chain of the site may be in a base, mm; 0 where there may be none, or no base."""
    if name is None:
        return 0.0
    base, face = problem.scaffold.base(name), problem.faces[name]
    if STYLES[problem.thickness.hinge].has_loose_pin or any(o.extent is not None for o in base.outlines):
        return 0.0
    lies = np.array([o.along for o in base.outlines]) @ site.along[:2]
    if (np.minimum(np.abs(lies), np.sqrt(np.maximum(1 - lies**2, 0.0))) > SQUARE).any():
        return 0.0
    deepest = min((face.top - face.bottom - POCKET_SKIN) / 2, SUNK_SHARE * site.panel)
    return deepest if deepest >= SHALLOWEST else 0.0
