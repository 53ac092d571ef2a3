"""The first layer, drawn in: a bevel of 45° along every edge that a body has on the bed.

A first layer is squeezed wider than it was meant, by up to 0.2 mm a side: an elephant's foot, which fuses bodies that
stand a clearance apart on the bed, and jams knuckles that are put together later. Slicers draw that layer in where they
are asked to; an STL cannot ask. What would be left less than two lines wide keeps its edges, to stick.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.lying import stands
from foldfab.fabrication.model import Assembly, Body
from foldfab.fabrication.posture import ON_BED, needs_pins, printed_pose, printed_turn
from foldfab.fabrication.printed import printed
from foldfab.fabrication.shapes import Shape, cut, placed, union, wrap
from foldfab.fabrication.solids import Outline, Solid
from foldfab.fabrication.walls import LINE, OPPOSITE, thin_sides
from foldfab.geometry.arrays import Array, Bools

DRAWN_IN = 0.2
"""By how much the first layer is smaller than its body at half its height, on each side, mm: what slicers take off."""
BEYOND = 0.07
"""How far a cutter reaches out of its body: coplanar faces leave skins, mm."""
ROUND = 0.01
"""Detail of an outline that makes no bevel of its own, mm."""
STEP = 0.1
"""How often it is looked along an edge whether it is to be bevelled, mm."""
LAP = 0.02
"""How far wedges reach into each other in a corner, mm."""
UNEVEN = 0.01
"""By how much neighbouring bevels differ: where four faces meet in a point, kernels leave slivers, mm."""
TRIED = (0.0, 0.017, -0.013, 0.031)
"""By how much a bevel is wider than meant, mm, best first: where edges nearly meet, a mesh may not stay closed."""
PIECE = ":"
"""What stands between the name of a part and the number of a piece of it."""
SHARP = 0.5
"""1 + the cosine of the angle by which an outline turns in the sharpest corner that is mitred: 120°."""


def bevel(layer: float) -> float:
    """Height and width of the bevel for a layer height, mm: nothing is left of it in the middle of the second layer."""
    return DRAWN_IN + layer / 2


def stances(assembly: Assembly, bodies: Iterable[Body]) -> dict[str, Array]:
    """By body, the motion (4, 4) from its own frame to the bed, which is at z = 0."""
    found = {body.name: np.eye(4) for body in bodies}
    low = {}
    for body in bodies:
        pose = found[body.name]
        if needs_pins(assembly.posture):
            pose[:3, :3] = stands(body)
        else:
            pose[:3] = printed_turn(assembly) @ printed_pose(assembly, body.name)[:3]
        low[body.name] = float((body.vertices @ pose[2, :3]).min() + pose[2, 3])
    for name, pose in found.items():
        pose[2, 3] -= low[name] if needs_pins(assembly.posture) else min(low.values())
    return found


def eased(
    assembly: Assembly, bodies: Iterable[Body], made: Mapping[str, Solid], shapes: Mapping[str, Shape]
) -> tuple[dict[str, Solid], dict[str, Shape]]:
    """Solids, some of the bodies of an assembly, and what they are made of, without their edges on the bed."""
    stance = {name: pose for name, pose in stances(assembly, bodies).items() if name in made}
    stance = {name: pose for name, pose in stance.items() if not {name, name.rsplit(PIECE, 1)[0]} & assembly.spared}
    return bevelled(made, shapes, stance, assembly.solution.scaffold.recipe.print.layer)


def bevelled(
    made: Mapping[str, Solid], shapes: Mapping[str, Shape], stance: Mapping[str, Array], layer: float
) -> tuple[dict[str, Solid], dict[str, Shape]]:
    """Bodies without their edges on the bed, by the motions that take them there; what does not reach it stays.

    A body that no bevel would leave sound keeps its edges.
    """
    done, told = dict(made), dict(shapes)
    for name, pose in sorted(stance.items()):
        for more in TRIED:
            cutter = _cutter(solids.moved(made[name], pose), layer, bevel(layer) + more)
            if cutter is None:
                break
            back = placed(cutter, -pose[:3, 3] @ pose[:3, :3], pose[:3, :3])
            solid = solids.tidied(solids.cut(made[name], [printed(back)]))
            if _is_sound(solid, made[name]):
                done[name] = solid
                told.update({name: cut(shapes[name], [back])} if name in shapes else {})
                break
    return done, told


def _is_sound(body: Solid, before: Solid) -> bool:
    """Whether a body with its bevels is as whole as before, and no thinner anywhere."""
    is_whole = solids.stays_closed(body) and solids.pieces(body) == solids.pieces(before)
    return is_whole and thin_sides(body) <= thin_sides(before)


def _cutter(body: Solid, layer: float, width: float) -> Shape | None:
    """What lies below the bevels of a body that stands on z = 0, or None where it does not."""
    if abs(float(solids.bounds(body)[0][2])) > ON_BED:
        return None
    # What is wider above or below the middle of the layer, as a barrel that lies on the bed, is drawn in as a whole.
    around = solids.silhouette(solids.between(body, 0.0, width + BEYOND + 3 * UNEVEN))
    wedges = list(_wedges(_rings(around), _rings(solids.section(body, layer / 2)), width))
    return union(wedges) if wedges else None


def _rings(outline: Outline) -> list[Array]:
    """(n, 2) the corners of each ring."""
    return [np.asarray(ring, dtype=np.float64) for ring in outline.simplify(ROUND).to_polygons()]


def _edges(rings: list[Array]) -> Array:
    """(k, 2, 2) all edges of rings; they go round counter-clockwise, holes clockwise."""
    return np.concatenate([np.stack([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in rings])


def _wedges(around: list[Array], first: list[Array], width: float) -> Iterator[Shape]:
    """By the outline of all that the bevels reach, and by that of the first layer."""
    for ring in around if first else []:
        ends = _edges([ring])
        way = ends[:, 1] - ends[:, 0]
        way /= np.linalg.norm(way, axis=1)[:, None]
        turn = _turns(np.roll(way, 1, axis=0), way)
        turns = np.stack([turn, np.roll(turn, -1)], axis=1)
        widths = width + UNEVEN * np.append(np.arange(len(ring) - 1) % 2, 2)
        runs = [[*_runs(*edge, _edges(around), _edges(first))] for edge in zip(ends, way, strict=True)]
        for i, (place, along, size) in enumerate(zip(ends, way, widths.tolist(), strict=True)):
            before, after = runs[i - 1], runs[(i + 1) % len(runs)]
            # Where the next edge has no bevel, a wedge ends at the corner.
            first_turn = turns[i, 0] if turns[i, 0] > 0 or (before and before[-1][1] == 1) else 0.0
            last_turn = turns[i, 1] if turns[i, 1] > 0 or (after and after[0][0] == 0) else 0.0
            for start, end in runs[i]:
                a, b = (place[0] + share * (place[1] - place[0]) for share in (start, end))
                yield _wedge(a, b, along, (first_turn if start == 0 else None, last_turn if end == 1 else None), size)


def _turns(one: Array, other: Array) -> Array:
    """(n,) tangent of half the angle between unit vectors (n, 2), to the left; no more than at corners of 60°."""
    cross = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    found: Array = cross / np.maximum(1 + (one * other).sum(axis=1), SHARP)
    return found


def _wedge(a: Array, b: Array, along: Array, turns: tuple[float | None, float | None], width: float) -> Shape:
    """What is cut below the bevel of the edge from `a` to `b` (2,); `turns` says how the outline goes on at its ends.

    A wedge reaches a little into the next: faces that only touch leave skins. In an inward corner that is along the
    mitre, at an outward one straight on.
    """
    corners = []
    # Outlines go round counter-clockwise: outside is on the right.
    normal = np.array([along[1], -along[0]])
    for out, height in ((-width - BEYOND, -BEYOND), (BEYOND, -BEYOND), (BEYOND, width + BEYOND)):
        for end, sign, turn in ((a, -1.0, turns[0]), (b, 1.0, turns[1])):
            more = 0.0 if turn is None else BEYOND if turn > 0 else LAP + turn * out
            corners.append([*(end + sign * more * along + out * normal), height])
    return wrap(np.array(corners))


def _runs(place: Array, along: Array, around: Array, first: Array) -> Iterator[tuple[float, float]]:
    """The stretches of an edge (2, 2), as shares, that are bevelled: the first layer reaches there, no thin wall."""
    count = max(1, int(np.ceil(np.linalg.norm(place[1] - place[0]) / STEP)))
    points = place[0] + ((np.arange(count) + 0.5) / count)[:, None] * (place[1] - place[0])
    inward = np.array([-along[1], along[0]])
    # Just behind the tip of a sharp corner, or further in where the wall leans.
    reached = np.pad(np.logical_or(*(_is_inside(points + depth * inward, first) for depth in (2 * ROUND, DRAWN_IN))), 1)
    # A step further, so that no skin is left at the ends.
    is_cut = reached[:-2] | reached[1:-1] | reached[2:]
    is_cut &= _across(points, along, around) >= 2 * (DRAWN_IN + LINE)
    marks = np.flatnonzero(np.diff(np.concatenate([[False], is_cut, [False]])))
    for start, end in marks.reshape(-1, 2).tolist():
        yield start / count, end / count


def _is_inside(points: Array, edges: Array) -> Bools:
    """(n,) whether points (n, 2) lie within an outline with edges (k, 2, 2)."""
    (ax, ay), (bx, by) = edges[:, 0].T, edges[:, 1].T
    x, y = points[:, :1], points[:, 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        is_crossed = ((ay <= y) != (by <= y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    inside: Bools = is_crossed.sum(axis=1) % 2 == 1
    return inside


def _across(points: Array, along: Array, edges: Array) -> Array:
    """(n,) how thick the wall is behind points (n, 2) of an edge that runs `along` (2,), among edges (k, 2, 2).

    Infinite where what is behind does not run the opposite way: the sides of a corner are no wall.
    """
    inward, start, way = np.array([-along[1], along[0]]), edges[:, 0], edges[:, 1] - edges[:, 0]
    det = inward[0] * way[:, 1] - inward[1] * way[:, 0]
    rel = start[None] - points[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        far = (rel[..., 0] * way[:, 1] - rel[..., 1] * way[:, 0]) / det
        at = (rel[..., 0] * inward[1] - rel[..., 1] * inward[0]) / det
    far = np.where((far > ROUND) & (at >= 0) & (at <= 1), far, np.inf)
    next_one = np.argmin(far, axis=1)
    is_wall = way[next_one] @ along < -OPPOSITE * np.linalg.norm(way[next_one], axis=1)
    thickness: Array = np.where(is_wall, far[np.arange(len(points)), next_one], np.inf)
    return thickness
