"""The bores of pins that are put in after printing: free from end to end, with a roof that prints without support.

Stops that were added may reach into a bore, so it is cut again when they are made. A round hole that lies on its side
has a ceiling that slicers support, where nobody gets the support out of it; a *teardrop* (two planes of 45° above the
round, flat at the top where the wall would else be too thin) has none. Threads stay round: they hold by all their wall.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.bodies import bodies
from foldfab.fabrication.hinges import knuckles
from foldfab.fabrication.lying import stands
from foldfab.fabrication.model import Assembly, Finding
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Common, Cut, Hull, Placed, Rod, Shape, Union, cut, placed, prism
from foldfab.fabrication.solids import SIDES, Solid
from foldfab.fabrication.styles import style
from foldfab.fabrication.walls import LINE
from foldfab.folding.model import FoldSolution, Thickness
from foldfab.geometry.arrays import Array
from foldfab.recipe.hinges import STYLES

WALL = 1.1 * LINE
"""What is left above a roof, mm."""
ON_SIDE = 0.1
"""A bore that rises by less than this along its way lies on its side, as a sine."""
LOOSE = 0.05
"""By how much a pin is thinner than its bore at least, mm."""
ROUNDING = 0.01
"""Shared volume below this is rounding, mm³."""

Frame = tuple[Array, Array]
"""Origin (3,) and rows x, y, z (3, 3)."""


def bored(
    solution: FoldSolution, made: dict[str, Solid], shapes: dict[str, Shape]
) -> tuple[dict[str, Solid], dict[str, Shape]]:
    """Bodies and their shapes with all bores open, and with roofs as each lies on the bed for itself."""
    done, told = dict(made), dict(shapes)
    for body in bodies(solution, made):
        holes: list[Shape] = []
        for rod, (origin, axes) in _bores(shapes[body.name], solution.thickness):
            roof = _roof(rod, axes @ stands(body)[2], solution.thickness)
            holes += [placed(hole, origin, axes) for hole in (rod, *roof)]
        if holes:
            told[body.name] = cut(shapes[body.name], holes)
            opened = solids.cut(made[body.name], [printed(hole) for hole in holes])
            done[body.name] = solids.tidied(solids.without_crumbs(opened))
    return done, told


def blocked(assembly: Assembly, made: dict[str, Solid]) -> list[Finding]:
    """A fatal finding for each hinge whose pin cannot be put in."""
    found = []
    for chain in assembly.solution.chains:
        thickness = assembly.solution.thickness.of(chain.panel)
        for hinge, pair in enumerate(pairwise(chain.bodies)):
            name = "~".join(pair)
            axis = next(joint.axis for joint in assembly.joints if joint.name == name)
            along = np.asarray(axis[1] - axis[0]) / np.linalg.norm(axis[1] - axis[0])
            origin = axis[0] - along * float(chain.hinge_spans[hinge][0])
            frame = np.stack([np.cross(along, chain.rise), along, chain.rise])
            marks = knuckles(chain.hinge_spans[hinge], thickness, chain.breaks)
            pins = [solids.placed(pin, origin, frame) for pin in _pins(marks.pins, thickness)]
            if any(solids.overlap(pin, made[part]) > ROUNDING for pin in pins for part in pair):
                text = f"the pin of {name} cannot be put in; print larger, or with thinner plates"
                found.append(Finding("pin", text, is_fatal=True))
    return found


def _pins(marks: tuple[tuple[float, float], ...], thickness: Thickness) -> Iterator[Solid]:
    radius = min(style(thickness.hinge).bores) - LOOSE
    for start, end in marks:
        way = 1.0 if end > start else -1.0
        low, high = sorted((start, end - way * STYLES[thickness.hinge].tip))
        yield solids.rod(radius, low, high, 0.0, 0.0)


def _bores(shape: Shape, thickness: Thickness) -> Iterator[tuple[Rod, Frame]]:
    """The holes for pins in a tree, each with the frame that it stands in."""
    radii = style(thickness.hinge).bores
    for rod, frame in _holes(shape, (np.zeros(3), np.eye(3)), is_hole=False):
        if rod.radius in radii:
            yield rod, frame


def _holes(shape: Shape, frame: Frame, *, is_hole: bool) -> Iterator[tuple[Rod, Frame]]:
    match shape:
        case Rod():
            yield from [(shape, frame)] if is_hole else []
        case Union(parts) | Hull(parts):
            for part in parts:
                yield from _holes(part, frame, is_hole=is_hole)
        case Common(first, second):
            for part in (first, second):
                yield from _holes(part, frame, is_hole=is_hole)
        case Cut(body, holes):
            yield from _holes(body, frame, is_hole=is_hole)
            for hole in holes:
                yield from _holes(hole, frame, is_hole=True)
        case Placed(body, origin, axes):
            # A point p of the body is at origin + p · axes.
            within = frame[0] + np.array(origin) @ frame[1], np.array(axes) @ frame[1]
            yield from _holes(body, within, is_hole=is_hole)
        case _:
            return


def _roof(rod: Rod, up: Array, thickness: Thickness) -> list[Shape]:
    """What makes a teardrop of a bore, in its frame; nothing where it stands, or holds a thread."""
    if abs(up[1]) > ON_SIDE or rod.radius != style(thickness.hinge).bores[0]:
        return []
    rise = np.array([up[0], up[2]]) / np.hypot(up[0], up[2])
    side = np.array([-rise[1], rise[0]])
    reach = rod.radius / np.cos(np.pi / SIDES)
    low, top = reach * np.sqrt(0.5), min(reach * np.sqrt(2.0), thickness.panel / 2 - WALL)
    flat = reach * np.sqrt(2.0) - top
    corners = [(-low, low), (-flat, top), (flat, top), (low, low), (0.0, 0.0)] if flat > 0 else []
    corners = corners or [(-low, low), (0.0, top), (low, low), (0.0, 0.0)]
    middle = np.array([rod.x, rod.z])
    outline = [middle + across * side + above * rise for across, above in corners]
    return [prism([(float(x), float(z)) for x, z in outline], rod.start, rod.end)]
