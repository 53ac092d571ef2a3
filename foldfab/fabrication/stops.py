"""Stops: what keeps a base hinge from turning past upright, and an inserted one past straight.

Two faces that are a clearance g apart as printed meet within an angle φ only if they are r ≥ g/sin φ from the axis:
5.7 mm for 0.3 mm and 3°, where a knuckle's radius is K/2 = 2 mm. So printed `open` base hinges get `levers`, and

- *lap*: at an inserted hinge the half of one panel away from the axis laps into a recess of the other one.

Printed in another posture these faces are far apart on the bed, and may be closer than g where they meet:

- *butt*: the ends of two panels are closer than g on the side away from the axis.

At the folded end a panel meets what it lies on, or a rest.

A stop is tried on the solids (`trial`) before it is made: there may be no room for it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from foldfab.fabrication import levers
from foldfab.fabrication.hinges import Mark
from foldfab.fabrication.levers import AIM, CLOSE, LEAST, NEAR
from foldfab.fabrication.mounts import WIDEST, Stop, mount, names, spots
from foldfab.fabrication.shapes import Shape, box, placed, wrap
from foldfab.fabrication.walls import LINE
from foldfab.folding.mechanism import frames, joints, tilts
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array

WEB = 1.5
"""How far a lap reaches into its own panel, mm."""
LEFT = 0.6
"""What is left of a panel beyond a recess, mm: a line and some."""


def stops(solution: FoldSolution, chain: Chain, hinge: int, *, in_open: bool) -> Iterator[Stop]:
    """The ways to stop a hinge (its number in the chain) at its open end, best first.

    `in_open` says whether the print is laid out open.
    """
    if 0 < hinge < len(chain.lengths):
        make = _laps if in_open else _butts
        yield from make(chain, hinge, solution.thickness.of(chain.panel), names(chain, hinge)[0])
        return
    here = mount(solution, chain, hinge)
    is_latched = solution.scaffold.recipe.print.latch
    heels, others = () if in_open else levers.heels(here), levers.levers(here, is_latched=is_latched)
    # A tongue can be held by a pin, a heel cannot.
    for stop in itertools.chain(others, heels) if is_latched else itertools.chain(heels, others):
        yield here.placed(stop)


def bolts(solution: FoldSolution, chain: Chain, hinge: int) -> Iterator[Stop]:
    """The tongues that a pin could hold a hinge by, beside the one that stops it; none at an inserted hinge."""
    if hinge == 0 or hinge == len(chain.lengths):
        here = mount(solution, chain, hinge)
        for stop in levers.bolts(here):
            yield here.placed(stop)


def rests(solution: FoldSolution, chain: Chain, hinge: int, up: Array | None = None) -> Iterator[Stop]:
    """The ways to stop a base hinge at its folded end.

    `up` (3,) is the hinge direction that points up in print, where it stands on edge.
    """
    if hinge == 0 or hinge == len(chain.lengths):
        here = mount(solution, chain, hinge)
        for stop in levers.rests(here, up):
            yield here.placed(stop)


def _laps(chain: Chain, hinge: int, thickness: Thickness, name: str) -> Iterator[Stop]:
    half, gap = thickness.panel / 2, thickness.gap
    close, back = CLOSE * gap, -float(np.sign(chain.offsets[hinge]))
    origin, axes = _straight(chain, hinge)
    # The longer panel gets the recess; then the other one is tried.
    for above in sorted((True, False), key=lambda above: -_free(chain, hinge, above, thickness)):
        below, over = chain.panels[hinge - 1], chain.panels[hinge]
        body, other = (over, below) if above else (below, over)
        z = -1.0 if above else 1.0
        for reach, end in _reaches(chain, hinge, above, thickness):
            tongue = (back * close / 2, back * half), (-z * WEB, z * reach)
            recess = _spread(-back * close / 2, back * (half + 1.0), 0.0, z * end)
            for low, high in spots((float(chain.span[0]), float(chain.span[1])), WIDEST, chain.breaks):
                added, hole = _tapered(tongue, low, high), _slab(recess, low - gap, high + gap)
                yield Stop(name, "lap", False, body, placed(added, origin, axes), other, cut=placed(hole, origin, axes))


def _reaches(chain: Chain, hinge: int, above: bool, thickness: Thickness) -> Iterator[Mark]:
    """How far a lap may reach into the other panel, and where its recess ends, mm from the hinge.

    A panel that is too short for a wall beyond the recess has it right through to the knuckles of its other hinge.
    """
    least, wanted = (CLOSE * thickness.gap / float(np.sin(angle)) for angle in (LEAST, AIM))
    free = _free(chain, hinge, above, thickness)
    end = float(chain.lengths[hinge - 1 if above else hinge]) - thickness.panel / 2
    if free < min(least, end - thickness.gap):
        yield min(wanted, end - thickness.gap), end
    yield min(wanted, free), min(wanted, free) + thickness.gap


def _butts(chain: Chain, hinge: int, thickness: Thickness, name: str) -> Iterator[Stop]:
    half, gap = thickness.panel / 2, thickness.gap
    back = -float(np.sign(chain.offsets[hinge]))
    origin, axes = _straight(chain, hinge)
    near = (thickness.axis_offset + half) * float(np.sin(NEAR)) - gap / 2
    low, high = (float(end) for end in chain.span)
    added = _slab(_spread(back * half / 2, back * half, near, WEB), low, high)
    below, over = chain.panels[hinge - 1], chain.panels[hinge]
    if near < gap / 2:
        yield Stop(name, "butt", False, over, placed(added, origin, axes), below)


def _free(chain: Chain, hinge: int, above: bool, thickness: Thickness) -> float:
    """How far a lap may reach into the panel below the hinge (where it comes from above), or above it, mm."""
    panel = hinge - 1 if above else hinge
    at_base = panel == 0 if above else panel == len(chain.lengths) - 1 and chain.far is not None
    at_tip = not above and panel == len(chain.lengths) - 1 and chain.far is None
    taken = 0.0 if at_tip else thickness.foot_room if at_base else thickness.knuckle_room
    return max(float(chain.lengths[panel]) - taken - thickness.gap - LEFT, 0.5)


def _straight(chain: Chain, hinge: int) -> tuple[Array, Array]:
    """The frame of the panels at an inserted hinge, open: its origin (3,) on the mid-plane, rows x, y, z."""
    axis = joints(chain, tilts(chain, np.zeros(1)))[0, hinge] @ np.stack([chain.across, chain.rise])
    axes = frames(chain, np.zeros(1))[1][0, hinge]
    return chain.root + axis - float(chain.offsets[hinge]) * axes[0], axes


def _spread(x0: float, x1: float, z0: float, z1: float) -> tuple[Mark, Mark]:
    return (min(x0, x1), max(x0, x1)), (min(z0, z1), max(z0, z1))


def _tapered(plane: tuple[Mark, Mark], low: float, high: float) -> Shape:
    """A slab that is whole where x begins and z begins; its other edges are bevelled, so that each lays little first.

    A line is left of its faces.
    """
    (x0, x1), (z0, z1) = plane
    taper = max(0.0, min(abs(x1 - x0), (high - low) / 2, abs(z1)) - LINE)
    way, up = np.sign(x1 - x0), np.sign(z1 - z0)
    rings = ((x0, 0.0), (x1 - way * taper, 0.0), (x1, taper))
    return wrap(np.array([(x, y, z) for x, t in rings for y in (low + t, high - t) for z in (z0, z1 - up * t)]))


def _slab(plane: tuple[Mark, Mark], low: float, high: float) -> Shape:
    (x0, x1), (z0, z1) = plane
    return box((x0, low, z0), (x1, high, z1))
