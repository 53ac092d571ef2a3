"""The furniture between two steps of the fold: every unit open or folded, every base where it now is.

A scene is a list of rigid solids, each fixed to the base that it moves with, and how far each base has come. To fold a
unit replaces the solids of its patches and moves bases; everything else is shared with the scene before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from foldfab.folding import anatomy
from foldfab.folding.basic import Option
from foldfab.folding.model import Chain
from foldfab.folding.problem import Problem
from foldfab.folding.site import Site, plate_boxes, slab
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array, Indices
from foldfab.geometry.boxes import Boxes, bounds

State = Literal["base", "open", "folded"]


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """Something rigid that stands in the way."""

    owner: str
    """The base or the patch it belongs to."""
    state: State
    base: int
    """Number of the base it moves with."""
    boxes: Boxes
    """(n,) where it is in the open posture of that base."""
    low: Array
    """(3,) lower corner of its bounds."""
    high: Array
    """(3,) upper corner."""
    corners: tuple[Array, Array]
    """Lower and upper corners (n, 3) of its boxes."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Where everything is."""

    problem: Problem
    offset: Array
    """(b, 3) how far each base has moved since the open posture, mm."""
    solids: tuple[Solid, ...]
    """Plates first, then the patches' solids."""
    places: Mapping[str, tuple[int, ...]]
    """By patch, where its solids are in `solids`."""
    chosen: Mapping[str, Option]
    """What was chosen for the patches of folded units."""
    chains: Mapping[str, Chain]
    """The chains of folded units, by patch; a patch of a folded unit that is not here is deleted."""
    done: frozenset[str]
    """Names of the units that are folded."""
    gone: frozenset[str]
    """Patches of folded units that are deleted."""
    low: Array
    """(n, 3) lower corners of the solids' bounds, like the solids in the open posture of their bases."""
    high: Array
    """(n, 3) upper corners."""
    base: Indices
    """(n,) the base that each solid moves with, -1 where a place is empty."""
    shapes: dict[object, tuple[Solid, ...]] = field(default_factory=dict)
    """Solids that were made already."""
    looks: dict[object, Any] = field(default_factory=dict, init=False)
    """What units see of this very scene."""

    def moved(self, base: str) -> Array:
        """(3,) how far a base has come, mm."""
        shift: Array = self.offset[self.problem.tree.number[base]]
        return shift


def open_scene(problem: Problem) -> Scene:
    """The furniture before the first step."""
    number = problem.tree.number
    beside: dict[str | None, list[Site]] = {base.name: [] for base in problem.scaffold.bases}
    for site in (problem.sites[patch] for unit in problem.units for patch in unit.patches):
        for name in {site.anchor, site.far} & set(beside):
            beside[name].append(site)
    solids = [
        _solid(base.name, "base", number[base.name], plate_boxes(base, beside[base.name], problem.thickness))
        for base in problem.scaffold.bases
    ]
    places = {}
    for unit in problem.units:
        for patch in unit.patches:
            site = problem.sites[patch]
            places[patch] = (len(solids),)
            solids.append(_solid(patch, "open", number[site.anchor], slab(site, problem.thickness)))
    low, high = np.array([s.low for s in solids]), np.array([s.high for s in solids])
    base = np.array([s.base for s in solids])
    still = np.zeros((len(number), 3))
    return Scene(problem, still, tuple(solids), places, {}, {}, frozenset(), frozenset(), low, high, base)


def advanced(scene: Scene, unit: Unit, chosen: Mapping[str, Option], chains: Iterable[Chain], travel: Array) -> Scene:
    """The scene after the unit has folded as chosen, by the chains; `travel` (b, 3) is each base's translation, mm."""
    now = shown(scene, unit.patches, chains, is_folded=True)
    held = {**scene.chains, **{c.patch: c for c in chains}}
    gone = scene.gone | {p for p in unit.patches if p not in held}
    chosen = {**scene.chosen, **chosen}
    return replace(
        now, offset=scene.offset + travel, chosen=chosen, chains=held, done=scene.done | {unit.name}, gone=gone
    )


def shown(scene: Scene, patches: Iterable[str], chains: Iterable[Chain], *, is_folded: bool) -> Scene:
    """The scene with these patches as those chains, open or folded; the others of them are gone."""
    by_patch = {c.patch: c for c in chains}
    solids, places, base = list(scene.solids), dict(scene.places), scene.base.copy()
    fresh: dict[int, Solid] = {}
    for patch in patches:
        made = _chain_solids(scene, by_patch[patch], is_folded=is_folded) if patch in by_patch else ()
        free = list(places[patch])
        base[free] = -1
        # Places are used again, so that a scene does not grow with every step.
        more = len(made) - len(free)
        start = len(solids)
        solids += made[len(free) :] if more > 0 else ()
        slots = [*free, *range(start, start + max(more, 0))]
        places[patch] = tuple(slots[: len(made)])
        fresh.update(zip(places[patch], made, strict=True))
    grown = len(solids) - len(base)
    low, high = (np.concatenate([corner, np.zeros((grown, 3))]) for corner in (scene.low, scene.high))
    base = np.concatenate([base, np.full(grown, -1)])
    for place, solid in fresh.items():
        solids[place], low[place], high[place], base[place] = solid, solid.low, solid.high, solid.base
    return replace(scene, solids=tuple(solids), places=places, low=low, high=high, base=base)


def alone(scene: Scene, unit: Unit) -> Scene:
    """The scene in which the unit is all by itself: its patches and its bases."""
    keep = [i for patch in unit.patches for i in scene.places[patch]]
    keep += [scene.problem.tree.number[base] for base in unit.bases]
    base = np.full(len(scene.base), -1)
    base[keep] = scene.base[keep]
    return replace(scene, base=base)


def _chain_solids(scene: Scene, chain: Chain, *, is_folded: bool) -> tuple[Solid, ...]:
    """A chain with its foot on the anchor, and its foot on the far base."""
    key = (chain, is_folded)
    if key not in scene.shapes:
        thick, number = scene.problem.thickness, scene.problem.tree.number
        state: State = "folded" if is_folded else "open"
        near = anatomy.resting_boxes(chain, thick, 1.0 if is_folded else 0.0)
        made = [_solid(chain.patch, state, number[chain.anchor], near)]
        if chain.far is not None:
            made.append(_solid(chain.patch, state, number[chain.far], anatomy.far_feet(chain, thick)))
        scene.shapes[key] = tuple(made)
    return scene.shapes[key]


def _solid(owner: str, state: State, base: int, boxes: Boxes) -> Solid:
    low, high = bounds(boxes)
    return Solid(owner, state, base, boxes, low.min(0), high.max(0), (low, high))
