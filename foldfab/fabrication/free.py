"""The room beside a plate that nothing else uses at any instant of the fold.

It is found in steps of height: free is what no other body, a clearance grown, covers between the plate and that height
while everything folds. Between two instants nothing moves further than `STEP`. Costs a section of each
body that comes near, for each instant and each height.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.places import Place
from foldfab.fabrication.solids import Outline, Solid
from foldfab.geometry.arrays import Array

STEP = 2.0
"""Instants are so close that nothing that comes near moves further in between, mm."""
RISE = 0.5
"""Between two heights, mm."""
MOST_HEIGHTS = 8
"""But no more of them than this."""
ASIDE = 1.25
"""How far it keeps away from other bodies, in clearances: instants are not everything."""
SAME = 0.02
"""What is used over two heights is the same where it differs by less than this share of what is sought."""
STILL = 1e-6
"""Poses that differ by less are the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A body, and how it stands to another one's plate all along the fold."""

    body: Solid
    """As it is open."""
    poses: Array
    """(k, 4, 4) from there into u, v and w of the plate."""


def used_room(
    place: Place, wanted: Solid, is_above: bool, most: float, motions: list[Motion], gap: float
) -> list[tuple[Outline, float]]:
    """What others use, with the clearance, between a plate and some heights in w, the highest last.

    Only what `wanted` would fill is looked at, a solid in u, v and w, and that up to `most` mm beyond the layer; the
    clearance is `gap`, mm.
    """
    way, face = (1.0, place.layer[1]) if is_above else (-1.0, -place.layer[0])
    turned = wanted if is_above else _mirrored(wanted)
    reach = min(float(solids.bounds(turned)[1][2]) - face, most)
    if reach < RISE / 2:
        return []
    count = min(MOST_HEIGHTS, int(np.ceil(reach / RISE)))
    heights = [face + reach * (i + 1) / count for i in range(count)]
    sought = solids.silhouette(solids.between(turned, face, heights[-1]))
    if sought.is_empty():
        return []
    margin, same = ASIDE * gap, SAME * sought.area()
    top = heights[-1] + margin
    pieces = [p for motion in motions for p in _pieces(motion, way, face, top, sought, margin)]
    used = {count - 1: _covered(pieces, face, top), -1: solids.nothing()}
    for i in _halves(-1, count - 1, lambda low, high: used[high].area() - used[low].area() > same):
        used[i] = _covered(pieces, face, heights[i] + margin)
    found: list[tuple[Outline, float]] = []
    for i in sorted(used):
        taken = solids.grown(used[i], margin)
        if i >= 0:
            # Of heights up to which the same is used the highest says it all.
            found = [f for f in found if taken.area() - f[0].area() > same] + [(taken, way * heights[i])]
    return found


def _halves(low: int, high: int, differ: Callable[[int, int], bool]) -> Iterator[int]:
    """The numbers between two at which something is still to be found out, each after those around it."""
    if high - low > 1 and differ(low, high):
        middle = (low + high) // 2
        yield middle
        yield from _halves(low, middle, differ)
        yield from _halves(middle, high, differ)


def _covered(pieces: list[Solid], low: float, high: float) -> Outline:
    """What pieces cover between two heights."""
    found = solids.nothing()
    for piece in pieces:
        part = solids.between(piece, low, high)
        if not part.is_empty():
            found = found + solids.silhouette(part)
    return found


def _pieces(motion: Motion, way: float, low: float, high: float, sought: Outline, margin: float) -> list[Solid]:
    """The body between two heights over what is sought, at every instant at which it is there."""
    x0, y0, x1, y1 = sought.bounds()
    flip = np.diag([1.0, 1.0, way, 1.0])
    corners = np.array([[x0 - margin, y0 - margin, low], [x1 + margin, y1 + margin, high]])
    found = []
    for pose in _instants(motion, flip, corners):
        piece = solids.between(solids.moved(motion.body, pose), low, high)
        least, most = solids.bounds(piece)
        if not piece.is_empty() and (least <= corners[1]).all() and (most >= corners[0]).all():
            found.append(piece)
    return found


def _instants(motion: Motion, flip: Array, room: Array) -> list[Array]:
    """Poses (4, 4) at which a body may be within a room (2, 3), and between them where it moves far."""
    low, high = solids.bounds(motion.body)
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
    poses = flip @ motion.poses
    places = np.einsum("kij,cj->kci", poses[:, :3, :3], corners) + poses[:, None, :3, 3]
    near = (places.min(1) <= room[1]).all(1) & (places.max(1) >= room[0]).all(1)
    found: list[Array] = [poses[0]] if near[0] else []
    for k in range(1, len(poses)):
        moved = float(np.linalg.norm(places[k] - places[k - 1], axis=1).max())
        if (near[k] or near[k - 1]) and (moved > STILL or not near[k - 1]):
            count = max(1, int(np.ceil(moved / STEP)))
            found += [_between(poses[k - 1], poses[k], (i + 1) / count) for i in range(count)]
    return found


def _between(before: Array, after: Array, share: float) -> Array:
    """A pose (4, 4) on the way from one to another that is not far."""
    mixed = before + share * (after - before)
    left, _, right = np.linalg.svd(mixed[:3, :3])
    mixed[:3, :3] = left @ right
    return mixed


def _mirrored(body: Solid) -> Solid:
    flip = np.eye(4)
    flip[2, 2] = -1.0
    return solids.moved(body, flip)
