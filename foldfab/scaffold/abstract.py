"""The verb of this room: a Recipe becomes a Scaffold along a folding direction (section 5.1)."""

from __future__ import annotations

import math
from dataclasses import replace

from foldfab.errors import AbstractionError
from foldfab.geometry.arrays import Array
from foldfab.geometry.groups import Groups
from foldfab.recipe.model import Recipe
from foldfab.scaffold import segments as seg
from foldfab.scaffold.bases import Layout, find_bases
from foldfab.scaffold.contacts import Contacts, contacts_of, listed, require_connected
from foldfab.scaffold.frame import canonical
from foldfab.scaffold.model import BasePatch, Patch, Scaffold
from foldfab.scaffold.segments import Segment
from foldfab.scaffold.sheets import sheets
from foldfab.scaffold.split import cut

STEEP_THICKNESSES = 1.5
"""A base that slopes by more than this many panel thicknesses is printed level, and a note says so."""
RAIL_THICKNESSES = 5.0
"""A part that touches no base is a rail where it is no higher than this many panel thicknesses."""
MOST_OWN = 20.0
"""mm in print; what is thicker of its own is printed as thick as this."""
STUB_THICKNESSES = 2.5
"""A piece shorter than this many panel thicknesses is too short to carry a hinge at each end."""


def abstract(recipe: Recipe, direction: Array, scale: float) -> Scaffold:
    """The scaffold of a recipe along the unit `direction` (3,), at print `scale` (print size over true size).

    Raises:
        AbstractionError: the parts do not hang together, nothing is perpendicular to d, or a part that folds
            touches no base.
    """
    parts = seg.segments(recipe, direction, scale)
    thickness, gap = recipe.print.thickness, recipe.print.clearance
    contacts, told = contacts_of(recipe, parts, thickness + gap)
    require_connected(parts, contacts, scale)
    stub = STUB_THICKNESSES * thickness
    layout, patches, notes = _laid_out(parts, contacts, stub, thickness + gap)
    cornered: frozenset[str] = frozenset()
    # A rail that touches no base can be one: it lies level, and what it touches folds. A part that is as high as the
    # others belongs to the base of an end that it meets at a corner; where it meets none it is printed level as well.
    for most, has_corners in ((RAIL_THICKNESSES * thickness, False), (0.0, True), (math.inf, True)):
        loose = set(_loose(parts, layout, patches))
        level = {s.name for s in parts if s.name in loose and seg.is_level(s) and seg.slope(s) <= most}
        cornered |= frozenset(loose - level if has_corners else ())
        if level or (loose and has_corners):
            parts = tuple(seg.as_base(s) if s.name in level else s for s in parts)
            layout, patches, notes = _laid_out(parts, contacts, stub, thickness + gap, cornered)
    if not layout.bases:
        names = tuple(s.name for s in parts)
        raise AbstractionError(
            f"neither {listed(names)} nor a joint of parts is perpendicular to the folding direction: no base",
            names,
        )
    _require_attached(_loose(parts, layout, patches))
    _require_one_piece(patches, layout.bases)
    notes = (*told, *notes, *_tilted(parts, thickness))
    plates, panels = (_asked(recipe, scale, role) for role in (recipe.print.base_thickness, None))
    bases = tuple(replace(b, thickness=_thickest(plates, b.parts, recipe.print.base_thickness)) for b in layout.bases)
    patches = tuple(replace(p, thickness=_thickest(panels, p.parts, None)) for p in patches)
    return Scaffold(recipe, direction, canonical(recipe, direction), scale, bases, patches, notes)


def check_connected(recipe: Recipe) -> None:
    """Raises: AbstractionError: the parts do not hang together."""
    parts = seg.segments(recipe, -seg.VERTICAL, 1.0)
    contacts, _ = contacts_of(recipe, parts, 0.0)
    require_connected(parts, contacts, 1.0)


def _asked(recipe: Recipe, scale: float, role: float | None) -> dict[str, float]:
    """By part that has one of its own, its thickness in print; no furniture's own is less than its role's."""
    asked = {part.name: part.thickness for part in recipe.parts if part.thickness is not None}
    if not recipe.print.own_thickness:
        return asked
    least = role or recipe.print.thickness
    own = {part.name: round(min(scale * float(part.size.min()), MOST_OWN), 2) for part in recipe.parts}
    return {name: max(least, thick) for name, thick in own.items()} | asked


def _thickest(asked: dict[str, float], names: tuple[str, ...], role: float | None) -> float | None:
    """K of a plate or panel that stands for some parts: that of the thickest; None where it is the print's."""
    return max((asked[name] for name in names if name in asked), default=role)


def _laid_out(
    parts: tuple[Segment, ...],
    contacts: Contacts,
    stub: float,
    distance: float,
    cornered: frozenset[str] = frozenset(),
) -> tuple[Layout, tuple[Patch, ...], tuple[str, ...]]:
    leaves = sheets(tuple(s for s in parts if not s.is_base), distance)
    layout = find_bases(tuple(s for s in parts if s.is_base), leaves, contacts, stub, cornered)
    return layout, *cut(leaves, layout, stub)


def _tilted(parts: tuple[Segment, ...], thickness: float) -> list[str]:
    """What is printed level although it is not."""
    notes = []
    for part in parts:
        rise = seg.slope(part) if part.is_base else 0.0
        if rise > STEEP_THICKNESSES * thickness:
            notes.append(f"{part.name} slopes by {rise:.1f} mm at print scale and is printed level")
    return notes


def _loose(parts: tuple[Segment, ...], layout: Layout, patches: tuple[Patch, ...]) -> tuple[str, ...]:
    """Names of the parts that belong to no base and fold onto none."""
    held = {p for patch in patches if patch.bases for p in patch.parts} | {p for b in layout.bases for p in b.parts}
    held |= {p for b in layout.bases for o in b.outlines for p in (o.part,)}
    return tuple(s.name for s in parts if s.name not in held)


def _require_attached(loose: tuple[str, ...]) -> None:
    if loose:
        raise AbstractionError(f"{listed(loose)} would fold but touch{'es' if len(loose) == 1 else ''} no base", loose)


def _require_one_piece(patches: tuple[Patch, ...], bases: tuple[BasePatch, ...]) -> None:
    number = {base.name: n for n, base in enumerate(bases)}
    joints = [(number[p.lower], number[p.upper]) for p in patches if p.lower is not None and p.upper is not None]
    named = [sorted(bases[n].name for n in group) for group in Groups(len(bases), joints).all()]
    groups = sorted(named, key=lambda g: (-len(g), g))
    if len(groups) > 1:
        names = tuple(groups[1])
        raise AbstractionError(f"the base of {listed(names)} is held by nothing that folds", names)
