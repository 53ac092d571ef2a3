"""A z-buffer in numpy: which triangle is seen at each pixel, orthographic, without a display or a GPU.

Each front-facing triangle is cut into its rows and each row into its pixels, all triangles at once.
O(triangles · rows + covered pixels); about 0.1 s for 15 000 triangles on a megapixel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from foldfab.geometry.arrays import Array, Bools, Indices

NOTHING = -1
"""In place of a triangle where the background is seen."""
FLATTEST = 1e-9
"""Twice the area in pixels², below which a triangle covers no pixel's centre."""


@dataclass(frozen=True, slots=True, eq=False)
class Spans:
    """Runs of pixels, one for each row of each triangle."""

    triangle: Indices
    """(s,)"""
    row: Indices
    """(s,)"""
    first: Indices
    """(s,) first column."""
    count: Indices
    """(s,) pixels."""


def visible(corners: Array, height: int, width: int) -> tuple[Indices, Array]:
    """What is seen of (m, 3, 3) triangles in pixel coordinates (x right, y down, z towards the eye).

    Returns:
        (height, width) index of the triangle, or NOTHING, and its (height, width) depth z, -inf where nothing is.
    """
    triangle, pixel, z = _fragments(corners, height, width)
    depth = np.full(height * width, -np.inf)
    np.maximum.at(depth, pixel, z)
    seen = np.full(height * width, NOTHING, dtype=np.int64)
    front = z == depth[pixel]
    # Of several at one depth the lowest index stays: written last.
    order = np.flatnonzero(front)[::-1]
    seen[pixel[order]] = triangle[order]
    return seen.reshape(height, width), depth.reshape(height, width)


def covered(corners: Array, height: int, width: int) -> Bools:
    """(height, width) which pixels any of (m, 3, 3) triangles covers."""
    _, pixel, _ = _fragments(corners, height, width)
    mask = np.zeros(height * width, dtype=bool)
    mask[pixel] = True
    return mask.reshape(height, width)


def _fragments(corners: Array, height: int, width: int) -> tuple[Indices, Indices, Array]:
    edge_x, edge_y = _edges(corners)
    twice_area = edge_x[:, 0] * edge_y[:, 1] - edge_y[:, 0] * edge_x[:, 1]
    # With y down, what is counter-clockwise seen from outside turns the other way: negative faces the eye.
    facing = np.flatnonzero(twice_area < -FLATTEST)
    spans = _spans(corners, facing, height, width)
    triangle = np.repeat(spans.triangle, spans.count)
    starts = np.cumsum(spans.count) - spans.count
    column = np.arange(len(triangle)) - np.repeat(starts - spans.first, spans.count)
    row = np.repeat(spans.row, spans.count)
    slope = _slopes(corners, facing, twice_area)
    a, b, c = slope[:, triangle]
    return triangle, row * width + column, a * column + b * row + c


def _edges(corners: Array) -> tuple[Array, Array]:
    ahead = np.roll(corners, -1, axis=1)
    return ahead[..., 0] - corners[..., 0], ahead[..., 1] - corners[..., 1]


def _spans(corners: Array, facing: Indices, height: int, width: int) -> Spans:
    y = corners[facing, :, 1]
    top = np.clip(np.ceil(y.min(axis=1)), 0, height).astype(np.int64)
    end = np.clip(np.floor(y.max(axis=1)) + 1, 0, height).astype(np.int64)
    rows = np.maximum(end - top, 0)
    triangle = np.repeat(facing, rows)
    row = np.arange(len(triangle)) - np.repeat(np.cumsum(rows) - rows - top, rows)
    low, high = _interval(corners, triangle, row)
    first = np.clip(np.ceil(low), 0, width).astype(np.int64)
    count = np.clip(np.floor(high) + 1, 0, width).astype(np.int64) - first
    is_hit = count > 0
    return Spans(triangle[is_hit], row[is_hit], first[is_hit], count[is_hit])


def _interval(corners: Array, triangle: Indices, row: Indices) -> tuple[Array, Array]:
    """Between which x the row lies within the triangle: each edge bounds it on one side."""
    low, high = np.full(len(row), -np.inf), np.full(len(row), np.inf)
    edge_x, edge_y = _edges(corners)
    for k in range(3):
        dx, dy = edge_x[triangle, k], edge_y[triangle, k]
        rise = row - corners[triangle, k, 1]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = corners[triangle, k, 0] + rise * dx / dy
        low = np.where(dy > 0, np.maximum(low, x), low)
        high = np.where(dy < 0, np.minimum(high, x), high)
    return low, np.minimum(high, 1e9)


def _slopes(corners: Array, facing: Indices, twice_area: Array) -> NDArray[np.float64]:
    """(3, m) a, b, c of each facing triangle's plane z = a x + b y + c."""
    p = corners[facing]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = twice_area[facing]
    a = (u[:, 2] * v[:, 1] - v[:, 2] * u[:, 1]) / area
    b = (v[:, 2] * u[:, 0] - u[:, 2] * v[:, 0]) / area
    planes = np.zeros((3, len(corners)))
    planes[:, facing] = a, b, p[:, 0, 2] - a * p[:, 0, 0] - b * p[:, 0, 1]
    return planes
