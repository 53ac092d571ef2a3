"""Props under what would begin in the air on edge: blocks that are printed with a part and broken off it.

Where parts are narrower than others by no more than half a plate, the others are planed flush. What is narrower still
does not reach the bed: a block stands below its lowest face, a layer of air apart from it but for thin stripes, with
short bridges between them.
Only the print file has props: the part that folds, its STL and the animation are without.
"""

from __future__ import annotations

import numpy as np

from foldfab.fabrication import shapes, solids
from foldfab.fabrication.posture import HANGS, ON_BED, bed_turn
from foldfab.fabrication.shapes import Shape
from foldfab.fabrication.soles import DRAWN_IN
from foldfab.fabrication.solids import Outline, Solid
from foldfab.geometry.arrays import Array

AIR = 0.25
"""Between a prop and its part: a layer or two, as slicers leave above their own support, mm."""
NECK, SPACING, BITE = 0.8, 5.0, 0.15
"""Width of a neck, how far apart necks stand, and how far they reach into part and prop, mm."""
TALL = 8.0
"""A part higher than this over the bed gets no prop: slicers build better towers, mm; the lowest need none."""
ASIDE = 1.25
"""How far a prop keeps away from other parts, in clearances: what is tidied may move a little."""
STEP = 0.2
"""Up to where a prop is as much smaller as parts are there, mm: a first layer."""
FAR = 1000.0
"""Beyond every print, mm."""


def planed(
    made: dict[str, Solid], poses: dict[str, Array], up: Array, most: float
) -> tuple[dict[str, Shape], dict[str, float]]:
    """What has to go for the bodies to be flush at the bed, open posture, and what that takes off, mm; by name.

    All are cut where the highest body begins that begins at most `most` mm above the bed.
    """
    stand = {name: _pose(poses[name][-1], up) for name in made}
    placed = {name: solids.moved(body, stand[name]) for name, body in made.items()}
    low = {name: float(solids.bounds(body)[0][2]) for name, body in placed.items()}
    level = max(z for z in low.values() if z - min(low.values()) <= most)
    found, taken = dict[str, Shape](), dict[str, float]()
    for name in sorted(made):
        if level - low[name] > ON_BED:
            back = _inverse(stand[name])
            below = shapes.box((-FAR, -FAR, level - FAR), (FAR, FAR, level))
            found[name], taken[name] = shapes.placed(below, back[:3, 3], back[:3, :3].T), level - low[name]
    return found, taken


def propped(made: dict[str, Solid], poses: dict[str, Array], up: Array, gap: float) -> dict[str, Solid]:
    """By name, the parts that need a prop, with it, in the open posture; `gap` is left to everything else, mm."""
    stand = {name: _pose(poses[name][-1], up) for name in made}
    level = min(float(solids.bounds(solids.moved(made[name], stand[name]))[0][2]) for name in made)
    for pose in stand.values():
        pose[2, 3] -= level
    placed = {name: solids.moved(body, stand[name]) for name, body in made.items()}
    low = {name: float(solids.bounds(body)[0][2]) for name, body in placed.items()}
    found = {}
    for name in sorted(made):
        if not HANGS < low[name] <= TALL:
            continue
        reach = low[name] + gap
        others = [body for other, body in sorted(placed.items()) if other != name and low[other] < reach]
        prop = _prop(placed[name], low[name], others, gap)
        whole = solids.union([placed[name], prop]) if prop is not None else placed[name]
        if prop is not None and solids.pieces(whole) == 1:
            found[name] = solids.merged(solids.moved(whole, _inverse(stand[name])))
    return found


def _pose(folded: Array, up: Array) -> Array:
    turn = np.eye(4)
    turn[:3, :3] = bed_turn(up)
    pose: Array = turn @ folded
    return pose


def _inverse(pose: Array) -> Array:
    return np.asarray(np.linalg.inv(pose), dtype=np.float64)


def _prop(body: Solid, low: float, others: list[Solid], gap: float) -> Solid | None:
    """The prop of a part whose lowest face is `low` above the bed; None where others stand below all of it."""
    sole = body.slice(low + ON_BED)
    for other in others:
        sole = sole - solids.grown(other.trim_by_plane((0.0, 0.0, -1.0), -low - gap).project(), ASIDE * gap)
    made: list[Solid] = []
    for face in sole.decompose():
        if face.area() > NECK**2:
            first = solids.grown(face, -DRAWN_IN)
            made += [_pillar(first, 0.0, STEP), _pillar(face, STEP, low - AIR), *_necks(face, low - AIR, low)]
    return solids.union(made) if made else None


def _necks(face: Outline, top: float, low: float) -> list[Solid]:
    """Stripes over the air between prop and part, across the face: at its ends and steps, and short bridges between."""
    x0, y0, x1, y1 = face.bounds()
    size, start = np.array([x1 - x0, y1 - y0]), np.array([x0, y0])
    long = int(np.argmax(size))
    ends = [float(start[long]) + NECK / 2, float(start[long] + size[long]) - NECK / 2]
    marks = sorted([*ends, *(m for m in _steps(face, long) if ends[0] + NECK < m < ends[1] - NECK)])
    found = []
    for at in _filled(marks):
        sides, middle = size + 2.0, start + size / 2
        sides[long], middle[long] = NECK, at
        stripe = solids.rectangle(middle, sides) ^ face
        if stripe.area() > ON_BED:
            found.append(_pillar(stripe, top - BITE, low + BITE))
    return found


def _steps(face: Outline, long: int) -> list[float]:
    """Where, just inside an edge that runs across, a stripe has to stand."""
    found = []
    for outline in face.to_polygons():
        for way, place in zip(np.roll(outline, -1, axis=0) - outline, outline, strict=True):
            if abs(way[long]) < ON_BED and abs(way[1 - long]) > NECK:
                # Outlines go round counter-clockwise: inside is on the left.
                inward = -np.sign(way[1]) if long == 0 else np.sign(way[0])
                found.append(float(place[long] + inward * NECK / 2))
    return found


def _filled(marks: list[float]) -> list[float]:
    """Places from the first to the last, no further apart than bridges reach; those that would meet are one."""
    kept = [marks[0]]
    for at in marks[1:]:
        if at - kept[-1] < NECK:
            continue
        parts = int(np.ceil((at - kept[-1]) / SPACING))
        kept += [kept[-1] + (at - kept[-1]) * (i + 1) / parts for i in range(parts)]
    return kept


def _pillar(outline: Outline, start: float, end: float) -> Solid:
    return outline.extrude(end - start).translate((0.0, 0.0, start))
