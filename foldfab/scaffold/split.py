"""Foldable patches: sheets cut at the bases they cross, so that they touch bases only at their ends (section 5.1)."""

from __future__ import annotations

import itertools

from foldfab.scaffold.bases import Layout
from foldfab.scaffold.model import Patch
from foldfab.scaffold.sheets import Sheet


def cut(leaves: tuple[Sheet, ...], layout: Layout, stub: float) -> tuple[tuple[Patch, ...], tuple[str, ...]]:
    """The foldable patches of the sheets, sorted by name, and notes on what was left out.

    A piece between two lines of the same base cannot move and belongs to that base; a piece that sticks out beyond
    a base by less than `stub` mm is trimmed.
    """
    patches: list[Patch] = []
    notes: list[str] = []
    taken = {p for leaf in leaves for p in leaf.parts} | {p for b in layout.bases for p in (b.name, *b.parts)}
    for index, leaf in enumerate(leaves):
        pieces = [p for p in _pieces(leaf, index, layout) if p[1] - p[0] >= stub or (p[2] and p[3])]
        movable = [p for p in pieces if p[2] != p[3]]
        if any(p[2] is not None and p[2] == p[3] for p in pieces):
            notes.append(f"{leaf.parts[0]} stays rigid where both its ends belong to the same base")
        for number, piece in enumerate(movable, 1):
            name = leaf.parts[0] if len(movable) == 1 else _new_name(f"{leaf.parts[0]}.{number}", taken)
            patches.append(_patch(name, leaf, *piece))
    return tuple(sorted(patches, key=lambda p: p.name)), tuple(notes)


def _new_name(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "'"
    taken.add(name)
    return name


def _pieces(leaf: Sheet, index: int, layout: Layout) -> list[tuple[float, float, str | None, str | None]]:
    """Bottom, top, lower base and upper base of each piece, lowest first."""
    owned = layout.lines[index]
    marks: list[tuple[float, str | None]] = [(line.height, base) for line, base in owned]
    if not owned or owned[0][0].end != -1:
        marks.insert(0, (leaf.bottom, None))
    if not owned or owned[-1][0].end != 1:
        marks.append((leaf.top, None))
    return [(a[0], b[0], a[1], b[1]) for a, b in itertools.pairwise(marks)]


def _patch(name: str, leaf: Sheet, bottom: float, top: float, lower: str | None, upper: str | None) -> Patch:
    center = (leaf.at(bottom) + leaf.at(top)) / 2
    length = (top - bottom) / float(leaf.up[2])
    return Patch(name, leaf.parts, center, leaf.along, leaf.up, leaf.width, length, lower, upper, leaf.hingeable)
