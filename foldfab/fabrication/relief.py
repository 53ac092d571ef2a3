"""Undersides that a printer can build without support, for prints that stand with their hinge axes vertical.

There, each knuckle above a gap is a shelf that sticks out of its plate or panel. Its lower face is cut to a steep ramp
that starts where the shelf is rooted; a cone below it widens upward until it meets the ramp. Material is only
taken away, so that every gap and every clearance of the fold stays. What the ramps leave of a socket no longer encloses
the cone in it, but each cone that points down still stands in a whole socket, so that hinges hold. Where knuckles are
so short that a ramp would open that socket too, the carrier's undersides stay flat, and want support.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.hinges import Knuckles, knuckles
from foldfab.fabrication.inspect import is_captive
from foldfab.fabrication.model import Joint
from foldfab.fabrication.plates import axis_of
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cone, cut, placed, union, wrap
from foldfab.fabrication.solids import Solid
from foldfab.folding.mechanism import frames
from foldfab.folding.model import Chain, FoldSolution, Thickness
from foldfab.geometry.arrays import Array

CLEAR = 0.1
"""How far a cutter reaches beyond what it cuts, mm."""
KEPT = 0.02
"""How much thicker than a cone what is kept around it is: coplanar faces leave slivers, mm."""
STEEP = 1.25
"""Rise over run of a ramp, 51°: slicers see facets and layers of 45° as flatter than they are, and prop them up."""
STANDS = 0.5
"""A knuckle this close to the lower end of its body stands on the bed with it, and needs no ramp, mm."""


@dataclass(frozen=True, slots=True)
class _Shelf:
    """The knuckles of one hinge on one body, in a frame with y along the axis and z across the root."""

    x: tuple[float, float]
    """Where what sticks out begins and ends, mm."""
    axis: tuple[float, float]
    """x and z of the axis, mm."""
    root: float
    """z where it is rooted, mm."""
    away: float
    """±1: which way in z it sticks out."""
    far: float
    """How far it sticks out, mm."""
    faces: tuple[tuple[float, bool], ...]
    """y of each lower face, and whether a cone points down from it."""
    cone: float
    """Height of such a cone, mm."""
    surface: float = 0.0
    """x of the face of its own panel beside which an inserted hinge stands, mm; 0 for a hinge in mid-plane."""


def relief(
    solution: FoldSolution, made: dict[str, Solid], joints: Iterable[Joint], up: Array
) -> tuple[dict[str, list[Shape]], list[str]]:
    """By body, what is cut from it, open, to have ramps under all knuckles; `up` (3,) is a hinge direction.

    And the hinges that keep flat undersides. Hinges of other kinds than the cone stay as they are.
    """
    cutters: dict[str, list[Shape]] = {name: [] for name in made}
    level: list[str] = []
    if solution.thickness.hinge != "cone":
        return cutters, level
    named = {joint.name: joint for joint in joints}
    for chain in solution.chains:
        shelves = _shelves(chain, solution.thickness.of(chain.panel), up)
        for pair, halves in zip(pairwise(chain.bodies), zip(shelves[::2], shelves[1::2], strict=True), strict=True):
            joint = named["~".join(pair)]
            ramps = [(name, _ramps(made[name], shelf, at, rows, up)) for name, shelf, at, rows in halves]
            kept = next((some for some in (ramps, ramps[1:]) if _holds(joint, made, some, solution.thickness.gap)), [])
            level += [joint.name] if kept != ramps else []
            for name, some in kept:
                cutters[name] += some
    return cutters, level


def _ramps(body: Solid, shelf: _Shelf, origin: Array, axes: Array, up: Array) -> list[Shape]:
    way = 1.0 if float(axes[1] @ up) > 0 else -1.0
    low = float((solids.mesh(body)[0] @ up).min() - origin @ up) * way
    faces = [f for f in shelf.faces if (f[0] - low) * way > STANDS]
    return [placed(_cutter(shelf, face, way), origin, axes) for face in faces]


def _holds(joint: Joint, made: dict[str, Solid], ramps: list[tuple[str, list[Shape]]], gap: float) -> bool:
    """Whether a hinge cannot be pulled apart once these are cut from its halves."""
    below = dict(ramps)
    halves = [solids.cut(made[name], [printed(ramp) for ramp in below.get(name, [])]) for name in joint.parts]
    return is_captive(halves[0], halves[1], joint.axis, joint.radius, gap)


def _shelves(chain: Chain, thickness: Thickness, up: Array) -> list[tuple[str, _Shelf, Array, Array]]:
    """By body, its shelves with the frame (origin, rows) that each stands in: two a hinge, the carrier's first."""
    origins, axes = frames(chain, np.zeros(1))
    last, half = len(chain.lengths) - 1, thickness.panel / 2
    across = (-half - CLEAR, half + CLEAR)
    found = []
    for j in range(last + 2 if chain.far is not None else last + 1):
        marks, is_low = knuckles(chain.hinge_spans[j], thickness, chain.breaks), j <= last
        i, away = (j, -1.0) if is_low else (last, 1.0)
        z, x = (0.0 if is_low else float(chain.lengths[last])), float(chain.offsets[j])
        way = 1.0 if float(chain.along @ up) > 0 else -1.0
        if 0 < j <= last:
            side = 1.0 if x > 0 else -1.0
            ends = sorted((x - side * (thickness.knuckle_room + KEPT), x + side * (half + CLEAR)))
            width, room, near = (ends[0], ends[1]), thickness.knuckle_room, float(chain.lengths[j - 1])
            surface = side * half
            lower = _lower(marks.carrier, way)
            carried = _Shelf(width, (x, near), near - room, 1.0, room + half, lower, 0.0, surface)
            found.append((chain.panels[j - 1], carried, origins[0, j - 1], axes[0, j - 1]))
        else:
            width, room, surface = across, thickness.foot_room, 0.0
            found.append(_foot(chain, thickness, j, up))
        faces = _ceilings(marks, chain.span, thickness, way)
        # As far as the corner of a heel may reach, where its panel leans when it is open: none is left below a ramp.
        far = room + float(np.hypot(half, thickness.axis_height))
        shelf = _Shelf(width, (x, z), z - away * room, away, far, faces, thickness.pin_radius, surface)
        found.append((chain.panels[i], shelf, origins[0, i], axes[0, i]))
    return found


def _foot(chain: Chain, thickness: Thickness, j: int, up: Array) -> tuple[str, _Shelf, Array, Array]:
    """The knuckles on their feet, rooted in the plate or on the plinth."""
    end = 0 if j == 0 else 1
    flip = 1.0 if end == 0 else -1.0
    marks = knuckles(chain.hinge_spans[j], thickness, chain.breaks)
    marks = marks if end == 0 else marks.mirrored
    axes = np.stack([chain.across, flip * chain.along, flip * chain.rise])
    way = 1.0 if float(axes[1] @ up) > 0 else -1.0
    half, name = thickness.panel / 2, chain.anchor if end == 0 else chain.far or ""
    far = thickness.axis_height + half
    reach = (-half - CLEAR, half + CLEAR)
    shelf = _Shelf(reach, (0.0, 0.0), -thickness.axis_height, 1.0, far, _lower(marks.carrier, way), 0.0)
    return name, shelf, axis_of(chain, end), axes


def _lower(marks: tuple[tuple[float, float], ...], way: float) -> tuple[tuple[float, bool], ...]:
    return tuple((a if way > 0 else b, False) for a, b in marks)


def _ceilings(marks: Knuckles, span: Array, thickness: Thickness, way: float) -> tuple[tuple[float, bool], ...]:
    """Lower faces of a panel: above each of the carrier's knuckles, with a cone where its own knuckle begins."""
    own = {round(a if way > 0 else b, 6) for a, b in marks.follower}
    tops = [b + thickness.gap if way > 0 else a - thickness.gap for a, b in marks.carrier]
    # In a stretch that is left free there is nothing above.
    tops = [t for t in tops if not any(a < t < b for a, b in marks.free)]
    inside = [t for t in tops if (t < span[1] - CLEAR if way > 0 else t > span[0] + CLEAR)]
    return tuple((t, round(t, 6) in own) for t in inside)


def _cutter(shelf: _Shelf, face: tuple[float, bool], way: float) -> Shape:
    """What lies below the ramp over one lower face, without the cone that points down from it."""
    y, has_cone = face
    if shelf.surface:
        low, high = shelf.x
        out = high if shelf.surface > 0 else low
        within = low if shelf.surface > 0 else high
        # Beside its panel a knuckle is rooted in the panel's face as well, and would else begin as a sliver.
        ramps = [_ramp(shelf, y, way, (within, shelf.surface), 0.0), _ramp(shelf, y, way, (shelf.surface, out), 1.0)]
    else:
        ramps = [_ramp(shelf, y, way, shelf.x, 0.0)]
    if not has_cone:
        return union(ramps)
    radius, far = shelf.cone + KEPT, shelf.far + CLEAR
    tip = y - way * STEEP * radius
    kept = cone(2 * far, tip + way * STEEP * 2 * far, tip, *shelf.axis)
    return cut(union(ramps), [kept])


def _ramp(shelf: _Shelf, y: float, way: float, x: tuple[float, float], sideways: float) -> Shape:
    """What lies below a plane that rises from the root on, and `sideways` as much from the first x on."""
    corners = []
    for across in x:
        for out in (KEPT, shelf.far + CLEAR):
            rise = STEEP * (out - KEPT + sideways * abs(across - x[0]))
            z = shelf.root + shelf.away * out
            corners += [[across, y - way * CLEAR, z], [across, y + way * rise, z]]
    return wrap(np.array(corners))
