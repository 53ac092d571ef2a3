"""What touches in the scaffold: solid boxes that are close, but for the pairs of parts that the recipe knows better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from foldfab.errors import AbstractionError
from foldfab.geometry.boxes import Boxes, close_pairs, gaps, grown, overlaps
from foldfab.geometry.groups import Groups
from foldfab.recipe.contacts import pair, reach
from foldfab.recipe.model import Pair, Recipe
from foldfab.scaffold import segments as seg
from foldfab.scaffold.segments import Segment

Names = Sequence[tuple[str, ...]]
"""The parts that each box stands for."""


@dataclass(frozen=True, slots=True)
class Contacts:
    """When boxes touch."""

    tolerance: float
    """Boxes that are closer than this do, mm in print."""
    touching: frozenset[Pair] = frozenset()
    """So do these parts, however far apart their boxes are."""
    apart: frozenset[Pair] = frozenset()
    """These parts do not, however close their boxes are."""

    def between(self, a: Boxes, of_a: Names, b: Boxes, of_b: Names) -> list[tuple[int, int]]:
        """The pairs that touch, sorted; what stands for several parts touches where one of them does."""
        near = zip(*(found.tolist() for found in close_pairs(self._grown(a), self._grown(b))), strict=True)
        found = {(i, j) for i, j in near if not self.are_apart(of_a[i], of_b[j])}
        return sorted(found | self.stated(of_a, of_b))

    def stated(self, of_a: Names, of_b: Names) -> set[tuple[int, int]]:
        """The pairs that touch because the recipe says so."""
        if not self.touching:
            return set()
        first, second = _places(of_a), _places(of_b)
        ways = [way for one, other in self.touching for way in ((one, other), (other, one))]
        return {(i, j) for one, other in ways for i in first.get(one, ()) for j in second.get(other, ())}

    def are_apart(self, one: tuple[str, ...], other: tuple[str, ...]) -> bool:
        """Whether the recipe says of all parts of the one that they do not touch those of the other."""
        return bool(self.apart) and all(pair(a, b) in self.apart for a in one for b in other)

    def _grown(self, boxes: Boxes) -> Boxes:
        return grown(boxes, self.tolerance / 2)


def contacts_of(recipe: Recipe, parts: tuple[Segment, ...], thickness: float) -> tuple[Contacts, tuple[str, ...]]:
    """When the parts of a recipe touch, and notes on pairs that it says are apart but that no print could keep so.

    Those are parts whose medial sheets, `thickness` mm thick with their gap, meet: as plates they would be one lump.
    """
    apart = sorted(recipe.apart)
    if apart:
        place = {part.name: index for index, part in enumerate(parts)}
        thin = _thinned(seg.as_boxes(parts), thickness)
        one, other = np.array([[place[name] for name in names] for names in apart]).T
        is_lump = overlaps(thin[one], thin[other]).tolist()
    lumps = [names for names, lump in zip(apart, is_lump, strict=True) if lump] if apart else []
    notes = [f"{a} and {b} touch in print, where both are plates, although their shapes do not" for a, b in lumps]
    tolerance = reach(2 * np.array([part.half for part in parts]))
    notes += _stretched(recipe.touching, parts, tolerance)
    return Contacts(tolerance, frozenset(recipe.touching), frozenset(apart) - frozenset(lumps)), tuple(notes)


def require_connected(parts: tuple[Segment, ...], contacts: Contacts, scale: float) -> None:
    """Raises: AbstractionError: the parts do not hang together; it says how far apart they are at true size."""
    solids, names = seg.as_boxes(parts), [(part.name,) for part in parts]
    joints = [(i, j) for i, j in contacts.between(solids, names, solids, names) if i < j]
    volume = solids.half.prod(1)
    # What few and small parts make is what is loose.
    groups = sorted(Groups(len(parts), joints).all(), key=lambda g: (-len(g), -float(volume[g].sum()), min(g)))
    if len(groups) < 2:
        return
    loose = tuple(parts[i].name for i in groups[1])
    rest = [i for i in range(len(parts)) if i not in set(groups[1])]
    inner, outer = np.repeat(groups[1], len(rest)), np.tile(rest, len(groups[1]))
    away = gaps(solids[inner], solids[outer])
    nearest = int(away.argmin())
    one, other, most = parts[inner[nearest]].name, parts[outer[nearest]].name, contacts.tolerance / scale
    far = round(float(away[nearest]) / scale, 1)
    why = f"{one} is {far:g} mm from {other}, its nearest, and parts touch within {most:.2g} mm"
    if contacts.are_apart((one,), (other,)):
        why = f"the box of {one} meets that of {other}, but not its shape"
    raise AbstractionError(
        f"{listed(loose)} do{'es' if len(loose) == 1 else ''} not touch the rest: {why}; move them together, leave out "
        f'what is loose (--ignore "{one}"), or say in a recipe that they touch ("touching": [["{one}", "{other}"]])',
        loose,
    )


def listed(names: tuple[str, ...]) -> str:
    """The first of some names, and how many more there are."""
    shown = ", ".join(names[:5])
    return shown if len(names) <= 5 else f"{shown} and {len(names) - 5} more"


def _stretched(touching: tuple[Pair, ...], parts: tuple[Segment, ...], tolerance: float) -> list[str]:
    """A note on each pair that is further apart than what touches by itself."""
    if not touching:
        return []
    place = {part.name: index for index, part in enumerate(parts)}
    one, other = np.array([[place[name] for name in names] for names in touching]).T
    solids = seg.as_boxes(parts)
    away = gaps(solids[one], solids[other]).tolist()
    pairs = zip(touching, away, strict=True)
    return [f"{a} and {b} are stretched to meet, by {gap:.1f} mm in print" for (a, b), gap in pairs if gap > tolerance]


def _thinned(boxes: Boxes, thickness: float) -> Boxes:
    """With their smallest side that thick."""
    half = boxes.half.copy()
    half[np.arange(len(half)), half.argmin(1)] = thickness / 2
    return Boxes(boxes.center, boxes.axes, half)


def _places(names: Names) -> dict[str, list[int]]:
    found: dict[str, list[int]] = {}
    for index, some in enumerate(names):
        for name in some:
            found.setdefault(name, []).append(index)
    return found
