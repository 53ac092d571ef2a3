"""The furniture between two steps of the fold: every other unit open or folded, every base where it now is.

To fold one unit means to move the pieces that it holds together against each other: without the unit the furniture
falls into one *cluster* for each of the unit's bases, and each cluster only translates (section 5.2).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import networkx as nx
import numpy as np

from foldfab.folding import anatomy
from foldfab.folding.model import Chain, Thickness
from foldfab.folding.site import Site, slab
from foldfab.folding.units import Unit
from foldfab.geometry.arrays import Array
from foldfab.geometry.boxes import Boxes, moved, stacked
from foldfab.scaffold.model import BasePatch, Scaffold

State = Literal["base", "foot", "open", "folded"]


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """Something rigid that stands in the way."""

    owner: str
    """The base or the patch it belongs to."""
    state: State
    base: str
    """The base it moves with."""
    boxes: Boxes
    """(n,) where it is now."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Where everything is."""

    scaffold: Scaffold
    thickness: Thickness
    sites: Mapping[str, Site]
    """By patch."""
    units: tuple[Unit, ...]
    offset: Mapping[str, Array]
    """By base, (3,) how far it has moved since the open posture."""
    chains: Mapping[str, Chain]
    """The chains of folded units, by patch; a patch of a folded unit that is not here is deleted."""
    done: frozenset[str]
    """Names of the units that are folded."""
    planned: Mapping[str, Chain] | None = None
    """The chains of all units where they are known already, to show unfolded patches as they will be."""
    history: frozenset[object] = frozenset()
    """What was chosen for each folded unit: two scenes with the same history are the same."""
    shapes: dict[object, Boxes] = field(default_factory=dict)
    """Boxes that were made already, by what they show, where they stand in the open furniture."""


def open_scene(scaffold: Scaffold, thickness: Thickness, sites: Mapping[str, Site], units: tuple[Unit, ...]) -> Scene:
    """The furniture before the first step."""
    offset = {base.name: np.zeros(3) for base in scaffold.bases}
    return Scene(scaffold, thickness, sites, units, offset, {}, frozenset())


def advanced(scene: Scene, unit: Unit, chains: tuple[Chain, ...], travel: Mapping[str, Array], choice: object) -> Scene:
    """The scene after the unit has folded by a hashable `choice`; `travel` gives each base's (3,) translation."""
    return replace(
        scene,
        offset={base: scene.offset[base] + travel[base] for base in scene.offset},
        chains={**scene.chains, **{c.patch: c for c in chains}},
        done=scene.done | {unit.name},
        history=scene.history | {choice},
    )


def clusters(scene: Scene, unit: Unit) -> dict[str, str]:
    """By base, the base of `unit` that it moves with."""
    graph: nx.Graph[str] = nx.Graph()
    graph.add_nodes_from(scene.offset)
    for other in scene.units:
        if other.name != unit.name and not set(other.patches) & set(unit.patches):
            nx.add_path(graph, other.bases)
    found = {}
    for component in nx.connected_components(graph):
        lead = [base for base in unit.bases if base in component]
        for base in component:
            found[base] = lead[0] if lead else unit.bases[0]
    return found


def solids(scene: Scene, unit: Unit) -> list[Solid]:
    """Everything but the unit's own patches, where it is now."""
    found = [
        Solid(base.name, "base", base.name, moved(_plate(scene, base), scene.offset[base.name]))
        for base in scene.scaffold.bases
    ]
    for other in scene.units:
        if set(other.patches) & set(unit.patches):
            continue
        for patch in other.patches:
            found += _patch_solids(scene, patch, is_done=other.name in scene.done)
    return found


def _patch_solids(scene: Scene, patch: str, *, is_done: bool) -> list[Solid]:
    site = scene.sites[patch]
    if not is_done and scene.planned is None:
        return [Solid(patch, "open", site.anchor, moved(_open(scene, site), scene.offset[site.anchor]))]
    chain = (scene.chains if is_done or scene.planned is None else scene.planned).get(patch)
    if chain is None:
        return []
    near, far = _chain(scene, chain, progress=1.0 if is_done else 0.0)
    state: State = "folded" if is_done else "open"
    found = [Solid(patch, state, chain.anchor, moved(near, scene.offset[chain.anchor]))]
    if chain.far is not None:
        found.append(Solid(patch, state, chain.far, moved(far, scene.offset[chain.far])))
    return found


def _plate(scene: Scene, base: BasePatch) -> Boxes:
    if base not in scene.shapes:
        scene.shapes[base] = anatomy.base_boxes(base, scene.thickness)
    return scene.shapes[base]


def _open(scene: Scene, site: Site) -> Boxes:
    if site not in scene.shapes:
        scene.shapes[site] = slab(site, scene.thickness)
    return scene.shapes[site]


def _chain(scene: Scene, chain: Chain, progress: float) -> tuple[Boxes, Boxes]:
    """An open or folded chain with its foot on the anchor, and its foot on the far base."""
    near, far = (chain, progress), (chain, "far")
    if near not in scene.shapes:
        thick = scene.thickness
        flat = anatomy.moving_boxes(chain, thick, np.array([progress]))[0]
        scene.shapes[near] = stacked([flat, anatomy.anchor_feet(chain, thick)])
        scene.shapes[far] = anatomy.far_feet(chain, thick)
    return scene.shapes[near], scene.shapes[far]
