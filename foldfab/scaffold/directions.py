"""Directions that furniture may fold along: the six axis directions, and those that its parts face.

Each side of a part's box votes for its normal with its area, so that boards count by their faces. Normals within
`SAME` of a stronger one are that one; of those that are no axes the strongest are kept. O(parts · directions).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from foldfab.geometry.arrays import Array, frozen
from foldfab.geometry.rotation import upright
from foldfab.recipe.model import Recipe

AXES = {"-z": (0, 0, -1), "-x": (-1, 0, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "+x": (1, 0, 0), "+y": (0, 1, 0)}
"""The axis directions, in the order in which they are preferred."""
SAME = np.radians(2.0)
"""Directions closer than this are one: the fold tells boards apart from level ones at far larger angles only."""
MOST_OBLIQUE = 4
"""Lines that are tried beside the three axes, each both ways: at most 14 directions in all."""
LEAST_SHARE = 0.05
"""Of the area of all parts that a line must have facing it to be tried."""
_NOISE = 1e-4
"""Entries of directions below this are errors of the file."""
_DIGITS = 9
"""Of shares: votes that are equal but for rounding are equal."""


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line along which furniture may fold, one way or the other."""

    direction: Array
    """(3,) unit; the way down where there is one, else towards -x, else -y. The other way is its opposite."""
    share: float
    """How much of the area of all parts' sides faces it."""
    part: str = ""
    """The part that faces it most, where it is no axis."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", frozen(self.direction, 3))


def lines(recipe: Recipe) -> tuple[Line, ...]:
    """The three axes, then other lines that parts face, strongest first, then that of the recipe's own direction.

    Only lines that differ from all others; a part of the area below `LEAST_SHARE` is no reason to try one.
    """
    found = [Line(np.array(AXES[name], dtype=np.float64), 0.0) for name in ("-z", "-x", "-y")]
    votes = [0.0, 0.0, 0.0]
    for vote, direction, part in _votes(recipe):
        place = next((i for i, line in enumerate(found) if is_same(line.direction, direction)), None)
        if place is None:
            found.append(Line(direction, 0.0, part))
            votes.append(vote)
        else:
            votes[place] += vote
    shares = np.round(np.array(votes) / sum(votes), _DIGITS).tolist()
    told = [Line(line.direction, share, line.part) for line, share in zip(found, shares, strict=True)]
    oblique = sorted((line for line in told[3:] if line.share >= LEAST_SHARE), key=lambda line: -line.share)
    kept = [*told[:3], *oblique[:MOST_OBLIQUE]]
    own = recipe.direction
    if own is not None and not any(is_same(line.direction, own) for line in kept):
        kept.append(Line(_downwards(own), 0.0))
    return tuple(kept)


def main_frame(of: tuple[Line, ...]) -> Array:
    """(3, 3) orthonormal rows along the lines that most area faces: the furniture's own axes, however it stands."""
    first, *rest = sorted(of, key=lambda line: -line.share)
    for line in rest:
        if is_across(line.direction, first.direction):
            second = line.direction - (line.direction @ first.direction) * first.direction
            second /= np.linalg.norm(second)
            return np.stack([first.direction, second, np.cross(first.direction, second)])
    return upright(first.direction)


def is_same(a: Array, b: Array) -> bool:
    """Whether two unit vectors lie along one line."""
    return bool(np.linalg.norm(np.cross(a, b)) < np.sin(SAME))


def is_across(a: Array, b: Array) -> bool:
    """Whether two unit vectors are at right angles."""
    return bool(abs(a @ b) < np.sin(SAME))


def title(direction: Array) -> str:
    """A direction as it is written in a recipe."""
    for index, axis in enumerate("xyz"):
        if abs(direction[index]) > 1 - 1e-12:
            return axis if direction[index] > 0 else f"-{axis}"
    return "[" + ", ".join(f"{entry:.3g}" for entry in direction) + "]"


def _votes(recipe: Recipe) -> list[tuple[float, Array, str]]:
    """Area, downward normal and part of each side of each part's box, largest area first."""
    found = []
    for part in sorted(recipe.parts, key=lambda part: part.name):
        areas = part.size.prod() / part.size
        found += [(float(area), _downwards(axis), part.name) for area, axis in zip(areas, part.axes, strict=True)]
    largest = max(area for area, _, _ in found)
    return sorted(found, key=lambda vote: -round(vote[0] / largest, _DIGITS))


def _downwards(direction: Array) -> Array:
    """(3,) the one of both ways that leads down, or towards -x, or -y; without noise."""
    settled = np.where(np.abs(direction) < _NOISE, 0.0, direction)
    settled /= np.linalg.norm(settled)
    lead = next(index for index in (2, 0, 1) if abs(settled[index]) > np.sin(SAME))
    down: Array = settled * -np.sign(settled[lead]) + 0.0
    return down
