"""Whether a piece of one body meets another body anywhere along a fold, between the instants too.

The piece is seen from the other body. It is tried at every instant at which their boxes meet, and where it passes the
other's box between two instants, at as many places in between as it takes to move on by no more than `STRIDE`.
Costs a boolean a place; what meets at an instant is found before anything is looked at in between.
"""

from __future__ import annotations

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.solids import Solid
from foldfab.folding.kinematics import configuration
from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array, Bools

STRIDE = 0.5
"""How far a piece moves on between two places at which it is tried, mm: less than half the width of any piece."""
MOST = 63
"""But it is tried at no more places than this between two instants."""
BULGE = 0.05
"""How far an arc may swell beyond its ends, as a share of the way between them: enough for 22°."""
STILL = 1e-7
"""Relative poses that differ by less are the same."""


class Passage:
    """Where all bodies are at the instants of a fold and, on demand, between them."""

    def __init__(self, solution: FoldSolution, times: Array) -> None:
        """Of the fold at `times` (k,)."""
        self.poses = configuration(solution, times)
        """By body, (k, 4, 4) motions from the open posture."""
        self._solution, self._times = solution, times
        self._ways: dict[tuple[str, str], Array] = {}
        self._between: dict[tuple[int, int], dict[str, Array]] = {}

    def meets(self, body: str, piece: Solid, name: str, other: Solid, *, above: float, in_between: bool = True) -> bool:
        """Whether a piece of `body` and the solid of the body `name` ever share more than `above` mm³.

        Without `in_between` at the instants alone.
        """
        way, corners, box = self._way(name, body), _corners(piece), solids.bounds(other)
        low, high = _reach(corners, way)
        strides = np.linalg.norm(_moved(corners, way[1:]) - _moved(corners, way[:-1]), axis=2).max(axis=1)
        swell = BULGE * strides[:, None]
        passed = np.minimum(low[1:], low[:-1]) - swell, np.maximum(high[1:], high[:-1]) + swell
        is_near, is_passing = _near((low, high), box), _near(passed, box)
        if not is_near.any() and not is_passing.any():
            return False
        near = solids.within(other, passed[0][is_passing].min(axis=0), passed[1][is_passing].max(axis=0))
        if near.is_empty():
            return False
        if _meets(piece, near, way[is_near], above):
            return True
        if not in_between:
            return False
        box = solids.bounds(near)
        for k in np.nonzero(_near(passed, box) & (strides > STRIDE))[0].tolist():
            poses = self._amid(k, strides[k] / STRIDE)
            way = seen_from(poses[name], poses[body])
            if _meets(piece, near, way[_near(_reach(corners, way), box)], above):
                return True
        return False

    def taken(self, body: str, piece: Solid, name: str, other: Solid) -> list[Solid]:
        """What a piece of `body` shares with the solid of the body `name` at the instants, as that one sees it."""
        way = self._way(name, body)
        near = way[_near(_reach(_corners(piece), way), solids.bounds(other))]
        shared = [solids.common(other, solids.moved(piece, pose)) for pose in near]
        return [solid for solid in shared if not solid.is_empty()]

    def _way(self, name: str, body: str) -> Array:
        """(k, 4, 4) a body at the instants, seen from another one."""
        if (name, body) not in self._ways:
            self._ways[name, body] = seen_from(self.poses[name], self.poses[body])
        return self._ways[name, body]

    def _amid(self, k: int, strides: float) -> dict[str, Array]:
        """By body, poses between instants k and k + 1 that cut the way into so many strides or more, up to `MOST`."""
        count = min(2 ** int(np.ceil(np.log2(max(strides, 2.0)))) - 1, MOST)
        if (k, count) not in self._between:
            times = np.linspace(self._times[k], self._times[k + 1], count + 2)[1:-1]
            self._between[k, count] = configuration(self._solution, times)
        return self._between[k, count]


def seen_from(frame: Array, poses: Array) -> Array:
    """(k, 4, 4) poses in the frame of another body at (k, 4, 4)."""
    seen: Array = np.linalg.inv(frame) @ poses
    return seen


def _meets(piece: Solid, other: Solid, way: Array, above: float) -> bool:
    last: Array | None = None
    for pose in way:
        if last is not None and np.abs(last - pose).max() < STILL:
            continue
        last = pose
        if solids.overlap(other, solids.moved(piece, pose)) > above:
            return True
    return False


def _corners(piece: Solid) -> Array:
    low, high = solids.bounds(piece)
    return np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1).reshape(8, 3)


def _moved(points: Array, way: Array) -> Array:
    moved: Array = points @ way[:, :3, :3].swapaxes(1, 2) + way[:, None, :3, 3]
    return moved


def _reach(corners: Array, way: Array) -> tuple[Array, Array]:
    points = _moved(corners, way)
    return points.min(axis=1), points.max(axis=1)


def _near(reach: tuple[Array, Array], box: tuple[Array, Array]) -> Bools:
    found: Bools = np.all((reach[0] <= box[1]) & (box[0] <= reach[1]), axis=1)
    return found
