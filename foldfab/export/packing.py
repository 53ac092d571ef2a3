"""Rectangles on as few plates as a simple rule needs: rows of falling depth, each row and plate filled before the next.

Deterministic; O(n · rows).
"""

from __future__ import annotations

from dataclasses import dataclass, field

Size = tuple[float, float]
"""Width and depth, mm."""


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a rectangle lies."""

    plate: int
    corner: Size
    """Of its lower left corner, mm."""
    is_turned: bool
    """Whether it is turned by a quarter, so that its width runs along the plate's depth."""


@dataclass(slots=True)
class _Row:
    plate: int
    y: float
    depth: float
    end: float = 0.0


@dataclass(slots=True)
class _Rows:
    rows: list[_Row] = field(default_factory=list)
    tops: list[float] = field(default_factory=list)
    """By plate, how far it is filled."""


def fits(size: Size, plate: Size) -> bool:
    """Whether a rectangle fits a plate, one way round or the other."""
    return _width_first(size, plate) is not None


def packed(sizes: list[Size], plate: Size, space: float, rim: float = 0.0) -> list[Spot]:
    """A spot for each rectangle, `space` mm apart; only what stands alone in its row or column uses the plate's rim.

    Raises:
        ValueError: one of them is larger than a plate.
    """
    laid = [_width_first(size, plate) for size in sizes]
    if None in laid:
        raise ValueError(f"{sizes[laid.index(None)]} does not fit a plate of {plate}")
    known = [size for size in laid if size is not None]
    order = sorted(range(len(sizes)), key=lambda i: (-known[i][1], -known[i][0], i))
    state, spots = _Rows(), dict[int, Spot]()
    for i in order:
        row = _room(state, known[i], (plate[0] - 2 * rim, plate[1] - 2 * rim), space)
        x = row.end + space if row.end > 0 else 0.0
        row.end = x + known[i][0]
        spots[i] = Spot(row.plate, (x, row.y), known[i] != sizes[i])
    return [spots[i] for i in range(len(sizes))]


def _width_first(size: Size, plate: Size) -> Size | None:
    """The rectangle as wide and as shallow as the plate allows."""
    ways = sorted({size, (size[1], size[0])}, key=lambda s: s[1])
    return next((s for s in ways if s[0] <= plate[0] and s[1] <= plate[1]), None)


def _room(state: _Rows, size: Size, inner: Size, space: float) -> _Row:
    """The first row with room, or a new one on the first plate with room, or on a new plate."""
    for row in state.rows:
        if row.end + space + size[0] <= inner[0] and size[1] <= row.depth:
            return row
    for number, top in enumerate(state.tops):
        if top + space + size[1] <= inner[1]:
            return _new_row(state, number, top + space, size[1])
    state.tops.append(0.0)
    return _new_row(state, len(state.tops) - 1, 0.0, size[1])


def _new_row(state: _Rows, plate: int, y: float, depth: float) -> _Row:
    state.tops[plate] = y + depth
    state.rows.append(_Row(plate, y, depth))
    return state.rows[-1]
