"""A solution as a linkage with thickness (section 5.6), from the data of its chains alone.

Bases are the plates of their outlines less their pockets, with the plinths and the feet of the hinges on them; panels
are slabs with half of their knuckles. Hinges stand where the solid's axes are. Of a panel, only what lies within the
room that is cut for a knuckle is exempt from meeting what carries that knuckle; it may never reach into the rest of it.
"""

from __future__ import annotations

import numpy as np

from foldfab.folding.mechanism import tilts
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, stacked
from foldfab.scaffold.model import BasePatch
from foldfab.validity.claim import (
    angles_of,
    axes_of,
    bases_at,
    frame,
    hinges_of,
    moments,
    root_first,
    sampled,
    step_of,
)
from foldfab.validity.model import Body, Folding, Hinge, Linkage
from foldfab.validity.pockets import pockets_in, without

UP = np.array([0.0, 0.0, 1.0])


def folding(solution: FoldSolution) -> Folding:
    """The solution's folding transform with the thickness of its material."""
    bodies = [Body(base.name, _plate(solution, base), UP, is_base=True) for base in solution.scaffold.bases]
    hinges: list[Hinge] = []
    for chain in solution.chains:
        thick = solution.thickness.of(chain.panel)
        points = axes_of(chain.root, chain, chain.lengths, chain.offsets, chain.lean)
        hinges += hinges_of(chain, points, thick.foot_room, thick.knuckle_room)
        bodies += _panels(chain, thick, points)

    def angles(times: Array) -> Array:
        # A chain whose lengths cannot close has no angles: not a number, which the verb tells.
        with np.errstate(invalid="ignore"):
            made = [angles_of(c, tilts(c, _progress(solution, c, times)), c.lean) for c in solution.chains]
        return np.concatenate([np.zeros((len(times), 0)), *made], axis=1)

    def slips(times: Array) -> Array:
        made = [_slips(solution, c, times) for c in solution.chains]
        return np.concatenate([np.zeros((len(times), 0, 3)), *made], axis=1)

    linkage = Linkage(root_first(solution, bodies), tuple(hinges))
    where = moments(solution)
    return Folding("with thickness", linkage, where, angles, slips, lambda times: bases_at(solution, times))


def faces(base: BasePatch, thickness: Thickness) -> tuple[float, float]:
    """Heights of the lower and the upper face of a base's plate, mm."""
    half = thickness.of(base.thickness).panel / 2
    return base.bottom - half, base.top + half


def slip_per_hinge(solution: FoldSolution, chain: Chain, times: Array) -> Array:
    """(k,) mm along `rise` that each hinge of a chain gives: they share its play evenly."""
    step = step_of(solution, chain.patch)
    shared: Array = sampled(step, step.play[chain.patch], times) / (len(chain.lengths) + 1)
    return shared


def _progress(solution: FoldSolution, chain: Chain, times: Array) -> Array:
    step = step_of(solution, chain.patch)
    return sampled(step, step.fold[chain.patch], times)


def _slips(solution: FoldSolution, chain: Chain, times: Array) -> Array:
    """(k, h, 3): each later body is lifted off the earlier one; the far base is the first body of its hinge."""
    count = len(chain.lengths)
    sign = np.array([1.0] * count + ([-1.0] if chain.far is not None else []))
    slips: Array = slip_per_hinge(solution, chain, times)[:, None, None] * sign[:, None] * chain.rise
    return slips


def _plate(solution: FoldSolution, base: BasePatch) -> Boxes:
    """The outlines of a base, each at the heights of its own part, with what hinges need on them."""
    thickness = solution.thickness
    low, high = faces(base, thickness)
    least = thickness.of(base.thickness).panel / 2
    made = []
    for outline in base.outlines:
        bottom, top = low, high
        if outline.extent is not None:
            middle = sum(outline.extent) / 2
            rise = max((outline.extent[1] - outline.extent[0]) / 2, least)
            bottom, top = max(middle - rise, low), min(middle + rise, high)
        along = np.array([*outline.along, 0.0])
        axes = np.stack([along, np.cross(UP, along), UP])
        half = np.array([*np.maximum(outline.half, least), (top - bottom) / 2])
        made.append(Boxes(np.array([[*outline.center, (bottom + top) / 2]]), axes[None], half[None]))
    made = [without(stacked(made), pockets_in(solution, base.name))]
    for chain in solution.chains:
        points = axes_of(chain.root, chain, chain.lengths, chain.offsets, chain.lean)
        thick = thickness.of(chain.panel)
        if chain.anchor == base.name:
            made += _mount(chain, thick, points[0], chain.rise, chain.pads[0], _knuckled(chain, 0))
        if chain.far == base.name:
            made += _mount(chain, thick, points[-1], -chain.rise, chain.pads[1], _knuckled(chain, -1))
    return stacked(made)


def _mount(chain: Chain, thick: Thickness, axis: Array, out: Array, pad: float, hinge: list[Array]) -> list[Boxes]:
    """The foot of a base hinge, from the face or the pocket's floor to the far side of its knuckles, and its plinth."""
    foot = [_upright(chain, thick, axis, out, -thick.axis_height, 0.0, span) for span in hinge]
    foot += [half for span in hinge for half in _knuckle(chain, thick, axis, span)]
    low = -thick.axis_height - pad
    return [*foot, _upright(chain, thick, axis, out, low, -thick.axis_height, chain.span)] if pad > 0 else foot


def _knuckled(chain: Chain, hinge: int) -> list[Array]:
    """Where a hinge has knuckles (2,): all along it, but for what its breaks take."""
    left = [chain.hinge_spans[hinge]]
    for low, high in chain.breaks:
        cut = [np.array(part) for a, b in left for part in ((a, min(b, low)), (max(a, high), b))]
        left = [part for part in cut if part[1] > part[0]]
    return left


def _upright(chain: Chain, thick: Thickness, axis: Array, out: Array, low: float, high: float, span: Array) -> Boxes:
    """A block K wide below or above an axis, heights measured along `out`."""
    center = axis + out * (low + high) / 2 + chain.along * float(np.mean(span))
    half = np.array([[thick.panel / 2, float(np.ptp(span)) / 2, abs(high - low) / 2]])
    return Boxes(center[None], np.stack([chain.across, chain.along, chain.rise])[None], half)


def _knuckle(chain: Chain, thick: Thickness, axis: Array, span: Array) -> list[Boxes]:
    """A cylinder of radius K/2 as the two squares that stand in it, one on its corner."""
    side = thick.panel / 2 * np.sqrt(0.5)
    half = np.array([[side, float(np.ptp(span)) / 2, side]])
    center = (axis + chain.along * float(np.mean(span)))[None]
    made = []
    for turn in (0.0, np.pi / 4):
        normal, up = frame(chain, chain.lean + turn)
        made.append(Boxes(center, np.stack([normal, chain.along, up])[None], half))
    return made


def _panels(chain: Chain, thick: Thickness, points: Array) -> list[Body]:
    """The panels of a chain: slabs between the axes, a gap apart, each with the knuckles of its next inserted hinge."""
    normal, up = frame(chain, chain.lean)
    last, made = len(chain.lengths) - 1, []
    for i, name in enumerate(chain.panels):
        low = 0.0 if i == 0 else thick.gap / 2
        high = chain.lengths[i] - (0.0 if i == last else thick.gap / 2)
        middle = points[i] - chain.offsets[i] * normal + up * (low + high) / 2 + chain.along * chain.span.mean()
        half = np.array([thick.panel / 2, float(np.ptp(chain.span)) / 2, (high - low) / 2])
        slab = Boxes(middle[None], np.stack([normal, chain.along, up])[None], half[None])
        hinge = _knuckled(chain, i + 1) if i < last else []
        knuckle = [half for span in hinge for half in _knuckle(chain, thick, points[i + 1], span)]
        made.append(Body(name, stacked([slab, *knuckle]), normal))
    return made
