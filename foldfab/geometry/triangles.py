"""Triangles in bulk: how far points are from them, how far they are from each other, and what lies inside many.

A point is as far from a triangle as from its plane where the foot lies within, else as from its edges. Two triangles
are nearest at a corner of one or at an edge of both, or an edge of one pierces the other (Ericson, *Real-Time Collision
Detection*, 2005, 5.1). Inside is where the solid angles of all triangles add up (Van Oosterom and Strackee 1983).
Exact but for rounding; about a hundred flops for a point, two thousand for two triangles.
"""

from __future__ import annotations

import numpy as np

from foldfab.geometry.arrays import Array, Bools

_NO_LENGTH = 1e-300
"""mm²; what is divided by instead of an edge or triangle without any."""
_ALL_AROUND = 0.95
"""Share of all directions in which a surface is seen from within; through a missing side one sees more of the rest."""
_AT_ONCE = 1 << 16
"""Triangles that are looked at at once, so that many take little memory."""
_SIDES = ((0, 1), (1, 2), (2, 0))


def to_points(points: Array, corners: Array) -> Array:
    """(…) squared distances of points (…, 3) to triangles (…, 3, 3), of leading shapes that go together."""
    a = corners[..., 0, :]
    first, second = corners[..., 1, :] - a, corners[..., 2, :] - a
    normal = np.cross(first, second)
    area = _dot(normal, normal)
    offset = points - a
    with np.errstate(divide="ignore", invalid="ignore"):
        height = _dot(offset, normal)
        u = _dot(offset, np.cross(second, normal)) / area
        v = _dot(offset, np.cross(normal, first)) / area
        is_above = (u >= 0) & (v >= 0) & (u + v <= 1) & (area > 0)
        found = np.where(is_above, height**2 / area, np.inf)
    for one, other in _SIDES:
        found = np.minimum(found, _to_segment(points, corners[..., one, :], corners[..., other, :]))
    return found


def between(a: Array, b: Array) -> Array:
    """(n,) squared distances of triangles (n, 3, 3) to others (n, 3, 3); 0 where they meet."""
    found = np.full(len(a), np.inf)
    for corners, others in ((a, b), (b, a)):
        for index in range(3):
            found = np.minimum(found, to_points(corners[:, index], others))
    for one in _SIDES:
        for other in _SIDES:
            found = np.minimum(found, _segments(a[:, one], b[:, other]))
    return np.where(_pierced(a, b) | _pierced(b, a), 0.0, found)


def is_inside(point: Array, corners: Array) -> bool:
    """Whether a point (3,) lies within a surface of triangles (n, 3, 3) that closes, all but for small holes."""
    seen = 0.0
    for start in range(0, len(corners), _AT_ONCE):
        a, b, c = np.moveaxis(corners[start : start + _AT_ONCE] - point, 1, 0)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = _dot(a, np.cross(b, c))
        rest = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
        seen += float(np.arctan2(volume, rest).sum())
    return abs(seen) > _ALL_AROUND * 2 * np.pi


def _dot(a: Array, b: Array) -> Array:
    found: Array = np.einsum("...i,...i->...", a, b)
    return found


def _to_segment(points: Array, start: Array, end: Array) -> Array:
    edge = end - start
    length = np.maximum(_dot(edge, edge), _NO_LENGTH)
    offset = points - start
    share = np.clip(_dot(offset, edge) / length, 0.0, 1.0)
    rest = offset - share[..., None] * edge
    return _dot(rest, rest)


def _segments(a: Array, b: Array) -> Array:
    """(n,) squared distances of the inner points of segments (n, 2, 3); infinite where an end is nearest."""
    along_a, along_b, offset = a[:, 1] - a[:, 0], b[:, 1] - b[:, 0], a[:, 0] - b[:, 0]
    aa, bb, ab = _dot(along_a, along_a), _dot(along_b, along_b), _dot(along_a, along_b)
    on_a, on_b = _dot(along_a, offset), _dot(along_b, offset)
    spread = aa * bb - ab**2
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (ab * on_b - on_a * bb) / spread
        t = (ab * s + on_b) / bb
        is_within = (spread > 0) & (bb > 0) & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
        apart = offset + s[:, None] * along_a - t[:, None] * along_b
        return np.where(is_within, _dot(apart, apart), np.inf)


def _pierced(edged: Array, face: Array) -> Bools:
    """Whether an edge of one triangle (n, 3, 3) goes through the other (n, 3, 3)."""
    a = face[:, 0]
    first, second = face[:, 1] - a, face[:, 2] - a
    normal = np.cross(first, second)
    area = _dot(normal, normal)
    height = np.einsum("nki,ni->nk", edged - a[:, None], normal)
    found = np.zeros(len(a), dtype=bool)
    for one, other in _SIDES:
        is_through = (height[:, one] < 0) != (height[:, other] < 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = height[:, one] / (height[:, one] - height[:, other])
            offset = edged[:, one] + share[:, None] * (edged[:, other] - edged[:, one]) - a
            u = _dot(offset, np.cross(second, normal)) / area
            v = _dot(offset, np.cross(normal, first)) / area
            found |= is_through & (area > 0) & (u >= 0) & (v >= 0) & (u + v <= 1)
    return found
