"""What stays the same while the units of a scaffold are folded one after another, and what is remembered about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from foldfab.folding import anatomy, basic
from foldfab.folding.basic import Variant
from foldfab.folding.model import Thickness
from foldfab.folding.site import Site
from foldfab.folding.tree import UnitTree
from foldfab.folding.units import Unit
from foldfab.folding.work import Work
from foldfab.geometry.arrays import Array, Bools
from foldfab.geometry.boxes import Boxes
from foldfab.recipe.model import FoldOptions, Part
from foldfab.scaffold.model import Scaffold


@dataclass(frozen=True, slots=True)
class Crossed:
    """What a way of folding crosses without thickness, as far as a rehearsal has shown."""

    pieces: tuple[bool, ...]
    """(N_s,) which pieces of the patch do."""
    by: tuple[str, ...]
    """The owners of what they cross, sorted."""
    is_always: bool = False
    """Whether they do in whatever order the units fold."""


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A scaffold with thickness, its units, and a memory that only ever grows."""

    scaffold: Scaffold
    options: FoldOptions
    thickness: Thickness
    sites: Mapping[str, Site]
    """By patch."""
    units: tuple[Unit, ...]
    tree: UnitTree
    """How the units hang together."""
    unit_of: Mapping[str, Unit]
    """By patch."""
    parts: Mapping[str, Part]
    """The recipe's parts, by name."""
    faces: Mapping[str, anatomy.Face]
    """By base, the faces of its plate."""
    plates: Mapping[str, tuple[Array, Array]]
    """By base, lower and upper corner (3,) of its plate, mm."""
    furniture: Boxes
    """(n,) the open furniture with thickness."""
    outline: tuple[Array, Array]
    """Lower and upper corner (3,) of the open furniture, mm."""
    twins: Mapping[str, Any] = field(default_factory=dict)
    """By patch that has one, its mirror image (`symmetry`), where the recipe asks for it."""
    banned: frozenset[tuple[str, Variant]] = frozenset()
    """Variants, without plinths, that a rehearsal of the whole fold has shown to be in the way."""
    crossed: Mapping[tuple[str, Variant], Crossed] = field(default_factory=dict)
    """By patch and plain variant, what a rehearsal of the whole fold as sheets has shown to cross."""
    repertoires: dict[Unit, Any] = field(default_factory=dict)
    """What the patches of each unit can do, by unit."""
    poses: dict[object, Any] = field(default_factory=dict)
    """The first unit of each kind, by what it looks like wherever it stands."""
    least: dict[Unit, Any] = field(default_factory=dict)
    """The cheapest choice of each unit, whatever stands around it."""
    solved: dict[tuple[Any, ...], Any] = field(default_factory=dict)
    """Solutions of units, by all that they depend on: first the key of the surroundings, which begins with the unit."""
    begun: dict[tuple[Any, ...], Any] = field(default_factory=dict)
    """Conflict graphs of units that were estimated but not folded yet, by the same."""
    hopeless: dict[Unit, str] = field(default_factory=dict)
    """Units that cannot fold wherever they stand, and why."""
    work: Work = field(default_factory=Work)
    """What may be done to solve it, and what has been done."""
    narrow: dict[str, Bools] = field(default_factory=dict)
    """By patch, which of its windows are too narrow for a hinge."""
    extents: dict[bytes, tuple[float, float]] = field(default_factory=dict)
    """By direction, between which coordinates the open furniture lies, mm."""

    def extent_along(self, direction: Array) -> tuple[float, float]:
        """Least and greatest coordinate of the open furniture along a unit direction (3,), mm."""
        key = direction.tobytes()
        if key not in self.extents:
            self.extents[key] = extent(self.furniture, direction)
        return self.extents[key]


def without(problem: Problem, banned: frozenset[tuple[str, Variant]]) -> Problem:
    """The problem with these variants banned, and nothing remembered that they could have been part of."""
    touched = {problem.unit_of[patch] for patch, _ in banned ^ problem.banned}
    kept = {unit: own for unit, own in problem.repertoires.items() if unit in set(problem.units) - touched}
    return replace(_forgetting(problem, touched), banned=banned, poses=dict(problem.poses), repertoires=kept)


def kept_clear(problem: Problem, crossed: Mapping[tuple[str, Variant], Crossed]) -> Problem:
    """The problem in which these pieces are ruled out as well, and nothing remembered of what their units can do."""
    merged = dict(problem.crossed)
    for key, more in crossed.items():
        known = merged.get(key, more)
        pieces = tuple(a or b for a, b in zip(known.pieces, more.pieces, strict=True))
        merged[key] = Crossed(pieces, tuple(sorted({*known.by, *more.by})), known.is_always and more.is_always)
    touched = {problem.unit_of[patch] for patch, _ in crossed}
    own = {u: replace(known, least={}) if u in touched else known for u, known in problem.repertoires.items()}
    return replace(_forgetting(problem, touched), crossed=merged, repertoires=own)


def as_sheet(variant: Variant) -> Variant:
    """A variant without what is made of it for the sake of thickness."""
    return replace(variant, pads=(0.0, 0.0), extra=0.0, hinged=basic.WHOLE)


def _forgetting(problem: Problem, touched: set[Unit]) -> Problem:
    """The problem with no solutions of some units in its memory."""
    # Units merged into one may hold any of them.
    kept = set(problem.units) - touched
    return replace(
        problem,
        solved={key: found for key, found in problem.solved.items() if key[0][0] in kept},
        begun={key: found for key, found in problem.begun.items() if key[0][0] in kept},
        least={unit: choice for unit, choice in problem.least.items() if unit in kept},
        hopeless={unit: why for unit, why in problem.hopeless.items() if unit in kept},
    )  # fmt: skip


def variants(problem: Problem, unit: Unit, patch: str) -> tuple[Variant, ...]:
    """The variants without plinths that a patch of the unit may fold by."""
    site = problem.sites[patch]
    found = basic.variants(site, problem.options, problem.thickness, may_slant=is_slantable(problem, unit))
    return tuple(v for v in found if (patch, v) not in problem.banned)


def demanding(problem: Problem, patch: str) -> tuple[Part, ...]:
    """The parts of a patch whose modification is pinned or restricted by the recipe."""
    parts = (problem.parts[name] for name in problem.sites[patch].patch.parts)
    return tuple(part for part in parts if part.pin is not None or part.forbid)


def is_slantable(problem: Problem, unit: Unit) -> bool:
    """Whether all basic scaffolds of the unit are H-scaffolds that share the same pair of bases."""
    return len(unit.bases) == 2 and all(problem.sites[p].far is not None for p in unit.patches)


def clearances(problem: Problem, unit: Unit) -> dict[tuple[str, str], float]:
    """By (anchor, far) of the unit's H-scaffolds, the clear height between the faces of the two bases, mm."""
    return {
        (a, b): problem.faces[b].bottom - problem.faces[a].top
        for a, b in sorted({_pair(s) for s in held(problem, unit)})
    }


def clear_height(problem: Problem, low: str, high: str) -> float:
    """The clear height between two bases of the open furniture, mm."""
    return problem.faces[high].bottom - problem.faces[low].top


def levels(problem: Problem, unit: Unit) -> dict[str, float]:
    """Heights of the unit's bases above its lowest one, mm."""
    return {b: problem.faces[b].top - problem.faces[unit.bases[0]].top for b in unit.bases}


def held(problem: Problem, unit: Unit) -> list[Site]:
    """The sites of the unit's H-scaffolds."""
    return [problem.sites[p] for p in unit.patches if problem.sites[p].far is not None]


def extent(boxes: Boxes, direction: Array) -> tuple[float, float]:
    """Least and greatest coordinate of the boxes along a unit direction (3,)."""
    middle = boxes.center @ direction
    reach = (boxes.half * np.abs(boxes.axes @ direction)).sum(-1)
    return float((middle - reach).min()), float((middle + reach).max())


def _pair(site: Site) -> tuple[str, str]:
    assert site.far is not None
    return site.anchor, site.far
