"""Shapes become parts: named, merged or left out as asked, each with its tight box and what is not said by it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

import numpy as np

from foldfab.geometry.arrays import Array
from foldfab.intake.contacts import heaps
from foldfab.intake.distance import off_box
from foldfab.intake.hardware import Sizes, sizes
from foldfab.intake.limits import check_bodies, fail
from foldfab.intake.meshes import joined, shells
from foldfab.intake.model import Body, Shapes, Wishes
from foldfab.intake.naming import NAMELESS, is_nameless, part_name, unique
from foldfab.intake.notes import listed, note
from foldfab.intake.outline import Outline, main_axes, outline
from foldfab.intake.scale import check, in_millimetres
from foldfab.intake.tight import fitted, settled
from foldfab.recipe.fields import FARTHEST, SMALLEST_SIZE
from foldfab.recipe.model import Mesh, Part
from foldfab.recipe.names import fits

THINNEST = 1.0
"""mm; a sheet without thickness gets this one."""
IS_BOX = 0.05
"""mm; a part that is no further off its box is one."""
WORTH_SAYING = 0.02
"""A part further off its box than this share of its longest side is spoken of."""
LOST = 3
"""Two parts in one place may have been drawn twice; so many have lost their places."""
_DIGITS = 4
"""Of places and sizes, mm: below the noise of single precision at a few metres."""


@dataclass(frozen=True, slots=True)
class Grouping:
    """What is asked of bodies by name before they become parts."""

    ignored: tuple[str, ...] = ()
    """Patterns such as `screw*`."""
    merged: tuple[tuple[str, str], ...] = ()
    """Pattern, and the name of the part that all that fit it become."""
    by_contact: frozenset[str] = frozenset()
    """Patterns of which only bodies that touch become one part; each heap is a part."""
    kept: tuple[str, ...] = ()
    """Patterns of what is no hardware, however small."""


@dataclass(frozen=True, slots=True, eq=False)
class Understood:
    """What was made of bodies."""

    parts: tuple[Part, ...]
    notes: tuple[str, ...]
    """What had to be supposed or left out."""
    hardware: tuple[Mesh, ...]
    """What was left out because it is small, mm."""
    made: Mapping[str, str] = field(default_factory=dict)
    """By name of a part that bodies were merged to, the name that was asked for."""


def named(path: Path | str, shapes: Shapes, wishes: Wishes) -> tuple[list[Body], tuple[str, ...]]:
    """The bodies in true mm, Z up, under safe and unique names, in the order of the file; and what had to be supposed.

    Raises:
        RecipeError: a wish cannot be fulfilled, or there are too many shells.
    """
    check(wishes)
    scaled = in_millimetres(shapes, wishes)
    return _named(path, scaled.bodies, wishes.split_shells), scaled.notes


def parts(path: Path | str, bodies: list[Body], wishes: Wishes, grouping: Grouping) -> Understood:
    """The parts that named bodies make.

    Raises:
        RecipeError: nothing is left, it is too large to be furniture, or many stand in one place.
    """
    notes: list[str] = []
    bodies, made = _merged(_without(bodies, grouping.ignored, notes), grouping)
    if not bodies:
        fail(path, "nothing is left of it; ignore less")
    measured = sizes(bodies, wishes.smallest)
    bodies, hardware = _without_hardware(bodies, measured, {*grouping.kept, *made}, notes)
    known = measured.outlines
    outlines = [found for b in bodies if (found := known[b.name] if b.name in known else outline(b)) is not None]
    note(notes, "without area, left out", {b.name for b in bodies} - {found.body.name for found in outlines})
    if not outlines:
        fail(path, "nothing in it has an area")
    return Understood(_boxed(path, outlines, notes), tuple(notes), tuple(body.mesh for body in hardware), made)


def _named(path: Path | str, bodies: tuple[Body, ...], split: bool) -> list[Body]:
    """Under safe, unique names, in pieces where shells are to be parts."""
    pieces = [(body, shells(body.mesh) if split else [body.mesh]) for body in bodies]
    check_bodies(path, sum(len(some) for _, some in pieces))
    names = unique([NAMELESS if is_nameless(body.name) and len(bodies) > 1 else body.name for body in bodies])
    named = [
        Body(name if len(some) == 1 else f"{name[:90]}-{number}", mesh)
        for name, (_, some) in zip(names, pieces, strict=True)
        for number, mesh in enumerate(some, 1)
    ]
    return [Body(name, body.mesh) for name, body in zip(unique([body.name for body in named]), named, strict=True)]


def _without(bodies: list[Body], ignored: tuple[str, ...], notes: list[str]) -> list[Body]:
    gone = {body.name for body in bodies if any(fits(body.name, pattern) for pattern in ignored)}
    note(notes, "ignored as asked", gone)
    return [body for body in bodies if body.name not in gone]


def _merged(bodies: list[Body], grouping: Grouping) -> tuple[list[Body], dict[str, str]]:
    """Those that fit a pattern as one, where the first of them stood; the first pattern that fits decides.

    With them, by its name what a merged part was asked to be called: heaps beyond the first get a number.
    """
    groups: dict[tuple[str, int], list[Body]] = {}
    asked: set[str] = set()
    heap = {(pattern, name): n for pattern in grouping.by_contact for n, name in _heaps(bodies, pattern)}
    for body in bodies:
        name, number = body.name, 0
        found = next((both for both in grouping.merged if fits(body.name, both[0])), None)
        if found is not None:
            name, number = part_name(found[1]), heap.get((found[0], body.name), 0)
            asked.add(name)
        groups.setdefault((name, number), []).append(body)
    fresh = dict(zip(groups, unique([name for name, _ in groups]), strict=True))
    made = {fresh[key]: key[0] for key in groups if key[0] in asked}
    return [Body(fresh[key], joined([body.mesh for body in some])) for key, some in groups.items()], made


def _heaps(bodies: list[Body], pattern: str) -> Iterator[tuple[int, str]]:
    """The number of the heap of touching bodies that each body that fits a pattern is in, and its name."""
    some = [body for body in bodies if fits(body.name, pattern)]
    for number, heap in enumerate(heaps([body.mesh for body in some])):
        yield from ((number, some[index].name) for index in heap)


def _without_hardware(
    bodies: list[Body], measured: Sizes, kept: set[str], notes: list[str]
) -> tuple[list[Body], list[Body]]:
    """What is left, and what is not."""
    gone = {name for name in measured.small if not any(fits(name, pattern) for pattern in kept)}
    note(notes, f"no longer than {measured.limit:.4g} mm, left out as hardware (--smallest)", gone)
    return [body for body in bodies if body.name not in gone], [body for body in bodies if body.name in gone]


def _boxed(path: Path | str, outlines: list[Outline], notes: list[str]) -> tuple[Part, ...]:
    main = main_axes(outlines)
    off: dict[str, float] = {}
    thin: list[str] = []
    found = []
    for one in outlines:
        axes = settled(one.corners, one.axes, main)
        center, size = fitted(one.corners, axes)
        if max(np.abs(center).max(), size.max()) > FARTHEST:
            fail(path, f"reaches further than {FARTHEST:.0f} mm; is the unit right? (--units)", one.body.name)
        distance = off_box(one.body.mesh, center, axes, size)
        if distance > WORTH_SAYING * size.max():
            off[one.body.name] = distance
        if size.min() < SMALLEST_SIZE:
            thin.append(one.body.name)
        found.append(_part(one.body.name, center, size, axes, one.body.mesh if distance > IS_BOX else None))
    note(notes, f"sheets without thickness, taken as {THINNEST:g} mm thick", thin)
    if off:
        told = [f"{name} {distance:.3g} mm" for name, distance in sorted(off.items(), key=lambda item: -item[1])]
        note(notes, "no boxes, taken as their boxes, which are off by", told, is_sorted=True)
    stacked = _stacked(found)
    if max(map(len, stacked), default=0) >= LOST:
        names = sorted({name for names in stacked for name in names})
        text = f"{listed(names)} stand in the very same place: the file has lost where they belong"
        fail(path, f"{text}; move them apart and export it again, or leave out all but one (--ignore NAME)")
    note(notes, "stand in the very same place, as if the file had lost where they belong", chain(*stacked))
    return tuple(found)


def _stacked(found: list[Part]) -> list[list[str]]:
    """The names of parts that have the same box."""
    places: dict[bytes, list[str]] = {}
    for part in found:
        key = np.round(np.concatenate([part.center, part.size, part.axes.reshape(-1)]), 3) + 0.0
        places.setdefault(key.tobytes(), []).append(part.name)
    return [names for names in places.values() if len(names) > 1]


def _part(name: str, center: Array, size: Array, axes: Array, shape: Mesh | None) -> Part:
    thick: Array = np.where(size < SMALLEST_SIZE, THINNEST, size)
    return Part(name, np.round(center, _DIGITS) + 0.0, np.round(thick, _DIGITS), axes, shape=shape)
