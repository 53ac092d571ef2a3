"""Tight oriented boxes of points: of least volume, and the same for parts that are alike.

A box of least volume lies flush with hull edges on two sides at least (O'Rourke 1985); candidates here are those flush
with one of the largest faces of the hull, turned by rotating calipers, then about all their axes: the least for parts
with flat sides, and within some percent of it for lumps. Where one along the furniture's axes is all but as small it is
taken instead: symmetric and round parts have many least boxes, and a file's noise must not choose.
"""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

from foldfab.geometry.arrays import Array

TIE = 0.02
"""A box may be this share larger than the least to follow the furniture's axes: 0.04° for a board of 18 × 500 mm."""
MOST_FACES = 24
"""Directions that are tried for a side of the box, those of the largest faces of the hull."""
FLAT = 1e-6
"""Points that reach less far than this share of their longest reach make a sheet or a line."""
_SAME_NORMAL = 4
"""Digits to which normals of one side of a hull agree."""
_FEW = 300
"""Corners of a hull that are looked at for candidates, or as many directions in which they stick out most; the box
itself contains all."""
_MOST_FRAMES = 12
"""Frames of parts that are tried as the furniture's, those of the largest."""
_STARTS, _ROUNDS, _WORTHWHILE = 2, 4, 1e-3
"""Boxes that are made smaller by turning, turns of each at most, and the share that a turn has to spare."""
_MANY = 30_000
"""Of more points only some make the principal axes."""
_PARALLEL = 1e-9
"""Directions that differ by less, in every entry, are one."""

Frame = Array
"""(3, 3) right-handed orthonormal rows."""


def hull(points: Array) -> tuple[Array, Array]:
    """Corners (k, 3) of the convex hull of points (n, 3), and normals (f, 3) of its largest sides, largest first.

    Flat points have the normal of their plane, points on a line have none.
    """
    from scipy.spatial import ConvexHull, QhullError

    principal, reach = _principal(points)
    if reach[0] <= 0 or reach[1] <= FLAT * reach[0]:
        return points[_ends(points @ principal[0])], np.zeros((0, 3))
    if len(points) > _MANY:
        points = _outer(points)
    try:
        if reach[2] <= FLAT * reach[0]:
            return points[ConvexHull(points @ principal[:2].T).vertices], principal[2:]
        found = ConvexHull(points)
    except QhullError:
        return points, principal[2:]
    corners = found.points[found.simplices]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return points[found.vertices], _sides(found.equations[:, :3], np.linalg.norm(across, axis=1))


def _outer(points: Array) -> Array:
    """The points (k, 3) that do not lie well within those that lie outermost in some directions (Akl and Toussaint).

    What is within is no corner of the hull, and a hull of fewer points takes less time and memory.
    """
    from scipy.spatial import ConvexHull, QhullError

    size = np.ptp(points, axis=0)
    ways = [np.array(way) / size for way in product((-1, 0, 1), repeat=3) if way > (0, 0, 0)] if size.all() else []
    try:
        planes = ConvexHull(points[sorted({end for way in ways for end in _ends(points @ way)})]).equations
    except (QhullError, ValueError):
        return points
    limit = -FLAT * float(size.max())
    runs = (points[start : start + _MANY] for start in range(0, len(points), _MANY))
    return np.concatenate([run[(run @ planes[:, :3].T + planes[:, 3]).max(1) > limit] for run in runs])


def least(corners: Array, normals: Array) -> Frame:
    """The axes of the smallest box around the corners (k, 3) of a hull with these sides that is found.

    From boxes flush with a side, turning goes on about each axis as long as it helps.
    """
    few = corners if len(corners) <= _FEW else corners[_outermost(corners, normals)]
    frames = [_turned(few, normal) for normal in normals] or [_principal(corners)[0]]
    frames = sorted([*frames, _principal(corners)[0], np.eye(3)], key=lambda frame: volume(corners, frame))
    return min((_refined(few, frame) for frame in frames[:_STARTS]), key=lambda frame: volume(corners, frame))


def settled(corners: Array, smallest: Frame, main: Frame) -> Frame:
    """The axes that the box shall have: the furniture's `main` ones, or one of them, or turned upright to one.

    Each only where its box is no more than `TIE` larger than the `smallest`; rows as near those of `main` as can be.
    """
    limit = (1 + TIE) * volume(corners, smallest)
    leaning = [_upright(axis, other) for axis in smallest for other in main[::-1]]
    tiers = [[main], [_turned(corners, axis) for axis in main[::-1]], [f for f in leaning if f is not None]]
    for frames in tiers:
        sizes = [volume(corners, frame) for frame in frames]
        if sizes and min(sizes) <= limit:
            # The first of those that are as good as equal.
            best = next(f for f, size in zip(frames, sizes, strict=True) if size <= min(sizes) * (1 + 1e-6))
            return like(best, main)
    return like(smallest, main)


def fitted(corners: Array, axes: Frame) -> tuple[Array, Array]:
    """Centre (3,) and size (3,) of the box with these axes around the corners."""
    along = corners @ axes.T
    low, high = along.min(0), along.max(0)
    return (low + high) / 2 @ axes, high - low


def volume(corners: Array, axes: Frame) -> float:
    """Of the box with these axes; a sheet's counts as if it had some thickness."""
    # Along rows, which numpy is fastest at.
    size = np.ptp(axes @ corners.T, axis=1)
    return float(np.maximum(size, FLAT * size.max()).prod())


def like(axes: Frame, main: Frame) -> Frame:
    """The same box's axes, in the order and sense that come closest to `main`."""
    along = np.abs(axes @ main.T)
    best = max(permutations(range(3)), key=lambda order: round(float(sum(along[order[k], k] for k in range(3))), 9))
    rows = axes[list(best)]
    rows = rows * np.where((rows * main).sum(1, keepdims=True) < 0, -1.0, 1.0)
    if np.linalg.det(rows) < 0:
        weakest = int(np.argmin(np.abs((rows * main).sum(1))))
        rows[weakest] *= -1
    if np.abs(rows - main).max() < _PARALLEL:
        return main
    return np.where(np.abs(rows - np.round(rows)) < _PARALLEL, np.round(rows) + 0.0, rows)


def main_frame(hulls: list[Array], frames: list[Frame]) -> Frame:
    """The furniture's main axes: x, y and z where they are those of parts with half the volume, else those of most.

    They are a part's where its box along them is no more than `TIE` larger than its least, in its frame of `frames`.
    """
    volumes = [volume(corners, frame) for corners, frame in zip(hulls, frames, strict=True)]
    largest = sorted(range(len(frames)), key=lambda index: -volumes[index])
    best, most = np.eye(3), _held(hulls, volumes, np.eye(3))
    if 2 * most >= sum(volumes):
        return best
    for index in largest[:_MOST_FRAMES]:
        candidate = like(frames[index], np.eye(3))
        held = _held(hulls, volumes, candidate)
        if held > most * (1 + 1e-6):
            best, most = candidate, held
    return best


def _held(hulls: list[Array], volumes: list[float], main: Frame) -> float:
    """The volume of the parts whose box along `main` is all but their least."""
    pairs = zip(hulls, volumes, strict=True)
    return sum(least for corners, least in pairs if volume(corners, main) <= (1 + TIE) * least)


def _principal(points: Array) -> tuple[Frame, Array]:
    """Right-handed principal axes of the points, and how far they reach along each, longest first."""
    few = points if len(points) <= _MANY else points[:: len(points) // _MANY]
    centred = few - few.mean(0)
    axes = np.linalg.eigh(centred.T @ centred)[1].T[::-1]
    # One by one, as all at once would take as much memory as the points.
    reach = np.array([np.ptp(points @ axis) for axis in axes])
    order = np.argsort(-reach, kind="stable")
    axes = axes[order]
    axes[2] = np.cross(axes[0], axes[1])
    return axes, reach[order]


def _sides(normals: Array, areas: Array) -> Array:
    """Distinct directions (f, 3) of faces with most area, largest first; opposite ones are one."""
    lead = np.argmax(np.abs(normals) > 0.1, axis=1)
    signed = normals * np.sign(normals[np.arange(len(normals)), lead])[:, None]
    _, first, group = np.unique(np.round(signed, _SAME_NORMAL) + 0.0, axis=0, return_index=True, return_inverse=True)
    total = np.bincount(group.reshape(-1), weights=areas)
    chosen = np.argsort(-total, kind="stable")[:MOST_FACES]
    found: Array = signed[first[chosen]]
    return found


def _turned(corners: Array, normal: Array) -> Frame:
    """The axes of the smallest box with `normal` as one of them, by calipers around the outline across it."""
    from scipy.spatial import ConvexHull, QhullError

    side = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = np.cross(normal, side)
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    flat = corners @ np.array([first, second]).T
    try:
        outline = flat[ConvexHull(flat).vertices]
    except QhullError:
        outline = flat[_ends(flat @ _widest(flat))]
    edges = np.roll(outline, -1, axis=0) - outline
    angles = np.unique(np.round(np.arctan2(edges[:, 1], edges[:, 0]) % (np.pi / 2), 9))
    ways = np.array([np.cos(angles), np.sin(angles)]), np.array([-np.sin(angles), np.cos(angles)])
    areas = np.ptp(outline @ ways[0], axis=0) * np.ptp(outline @ ways[1], axis=0)
    best = angles[int(np.argmin(np.round(areas / max(areas.max(), 1e-300), 12)))]
    along = np.cos(best) * first + np.sin(best) * second
    return np.array([along, np.cross(normal, along), normal])


def _outermost(corners: Array, normals: Array) -> Array:
    """(f,) the corners that lie outermost in some direction: across a side, or one of many evenly spread."""
    turn = np.pi * (1 + 5**0.5) * np.arange(_FEW)
    height = 1 - (2 * np.arange(_FEW) + 1) / _FEW
    across = np.sqrt(1 - height**2)
    spread = np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=1)
    along = np.concatenate([spread, normals, -normals]) @ corners.T
    return np.unique(np.argmax(along, axis=1))


def _refined(corners: Array, frame: Frame) -> Frame:
    """The axes of a box that turning about none of its axes makes smaller."""
    for _ in range(_ROUNDS):
        turned = min((_turned(corners, axis) for axis in frame), key=lambda found: volume(corners, found))
        if volume(corners, turned) >= (1 - _WORTHWHILE) * volume(corners, frame):
            break
        frame = turned
    return frame


def _upright(axis: Array, other: Array) -> Frame | None:
    """Axes with `axis` as one and a second across `other`; None where the two are parallel."""
    across = np.cross(other, axis)
    length = float(np.linalg.norm(across))
    if length < 1e-3:
        return None
    return np.array([across / length, np.cross(axis, across / length), axis])


def _widest(flat: Array) -> Array:
    centred = flat - flat.mean(0)
    widest: Array = np.linalg.eigh(centred.T @ centred)[1][:, -1]
    return widest


def _ends(along: Array) -> list[int]:
    return [int(np.argmin(along)), int(np.argmax(along))]
