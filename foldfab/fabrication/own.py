"""The furniture's own shape: what a part looks like takes the place of its plate, as far as the fold lets it.

First the part's own solid is tried (`carved`), then the plate cut to its outline (`outlined`), and where neither holds
the plate stays plain. Whatever is taken stays apart from all else at every instant, as it is printed by the clearance,
leaves every stop, and fits the bed. A finding tells of every part that does not keep its solid, and why.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from foldfab.fabrication import solids
from foldfab.fabrication.carved import carved
from foldfab.fabrication.free import Motion
from foldfab.fabrication.furniture import is_own, own_solid, placed_mesh
from foldfab.fabrication.model import Assembly, Finding
from foldfab.fabrication.outlines import outlined
from foldfab.fabrication.places import Place, places, reaching, zone
from foldfab.fabrication.plates import recesses
from foldfab.fabrication.shapes import Shape, cut, union
from foldfab.fabrication.solids import Outline, Solid
from foldfab.fabrication.stopping import Stopped, reached
from foldfab.fabrication.trial import Change, Trial, changed
from foldfab.geometry.arrays import Array, Indices
from foldfab.recipe.model import Part
from foldfab.scaffold.model import Scaffold

SEAM, BRIDGE = 1.5, 4.0
"""How far from where parts touch the plate stays that holds them together; and from either side of a gap, mm."""
WORTH_SAYING = 0.5
"""A stack that is this much higher for it is spoken of, mm."""


def own_shapes(draft: Assembly, held: Stopped, ramps: Mapping[str, list[Shape]]) -> tuple[Stopped, list[Finding]]:
    """The bodies with the shapes of their parts, where these came with any, and what is to be told of it.

    Bodies have their stops already, and keep them; `draft` has what they were made of before. The largest body chooses
    its room first.
    """
    scaffold = draft.solution.scaffold
    wanted = [p for p in places(draft.solution) if any(is_own(scaffold, part) for part in _parts(scaffold, p))]
    if not wanted:
        return held, []
    trial, before = Trial(replace(draft, shapes=held.shapes), held.made, ramps, held.locks), _height(draft, held.made)
    findings = []
    for place in sorted(wanted, key=lambda p: (-round(held.made[p.name].volume(), 3), p.name)):
        findings += _dressed(trial, place, draft.shapes[place.name], held.changes[place.name])
    higher = _height(draft, trial.made) - before
    if higher > WORTH_SAYING:
        findings.append(
            Finding("own", f"folded it is {higher:.1f} mm higher than with plain plates, by its own shapes")
        )
    return replace(
        held, made=trial.made, shapes=trial.shapes, joints=reached(held.joints, trial.hinges.turns, trial.made)
    ), findings


def _dressed(trial: Trial, place: Place, plain: Shape, changes: list[Change]) -> list[Finding]:
    """Gives a body its own shape; what is told where that is not its solid."""
    reasons: dict[str, str] = {}
    for what, shape in _candidates(trial, place, plain):
        problem = shape if isinstance(shape, str) else trial.reshape(place.name, changed(shape, changes))
        if not problem:
            told = f"{place.name} keeps only the outline of its own shape: its own solid {reasons.get('solid')}"
            return [Finding("outline", told)] if what == "outline" else []
        reasons.setdefault(what, problem)
    told = "; ".join(f"its own {what} {problem}" for what, problem in reasons.items())
    return [Finding("plain", f"{place.name} stays a plain plate: {told}")]


def _candidates(trial: Trial, place: Place, plain: Shape) -> Iterator[tuple[Literal["solid", "outline"], Shape | str]]:
    """What a body may look like, best first, or why not."""
    scaffold = trial.assembly.solution.scaffold
    parts = _parts(scaffold, place)
    meshes = [placed_mesh(scaffold, part, place.normal) for part in parts]
    along = np.concatenate([place.plane.local(points)[:, 0] for points, _ in meshes])
    place = reaching(place, float(along.min()), float(along.max()))
    found = {part.name: own_solid(scaffold, part, place.normal) for part in parts}
    own = [shape for shape in found.values() if shape is not None]
    if len(own) < len(found):
        open_ = ", ".join(name for name, shape in found.items() if shape is None)
        yield "solid", f"is not to be had, because the mesh of {open_} is not closed"
    else:
        gap, panel = trial.assembly.solution.thickness.gap, trial.assembly.solution.thickness.panel
        motions = [_motion(trial, place, name) for name in sorted(trial.made) if name != place.name]
        whole = cut(union(own), _recesses(trial, place))
        for shape in carved(place, plain, whole, _stays(scaffold, place, parts, meshes), motions, gap, panel):
            yield "solid", shape
    yield "outline", outlined(place, plain, meshes)


def _recesses(trial: Trial, place: Place) -> list[Shape]:
    """What is cut from a base for the chains that sink into it; nothing from a panel."""
    solution = trial.assembly.solution
    bases = [b for b in solution.scaffold.bases if b.name == place.name]
    return [shape for base in bases for shape in recesses(base, solution.chains, solution.thickness)]


def _motion(trial: Trial, place: Place, name: str) -> Motion:
    into = np.eye(4)
    into[:3, :3], into[:3, 3] = place.plane.across, -place.plane.across @ place.plane.origin
    poses = into @ np.linalg.inv(trial.judge.poses[place.name]) @ trial.judge.poses[name]
    return Motion(trial.made[name], poses)


def _stays(scaffold: Scaffold, place: Place, parts: list[Part], meshes: list[tuple[Array, Indices]]) -> Outline:
    """Where the plain plate stays: boxes are plates, and what only touches or is near is held together by one."""
    seen = [place.plane.silhouette(points, faces) for points, faces in meshes]
    found = solids.nothing()
    for part, outline in zip(parts, seen, strict=True):
        found = found if is_own(scaffold, part) else found + outline
    found = found + _between(seen, SEAM)
    whole = found + zone(place.kept)
    for outline in seen:
        whole = whole + outline
    return found + _between(solids.islands(whole), BRIDGE)


def _between(outlines: list[Outline], within: float) -> Outline:
    """What is near to two of several outlines."""
    found = solids.nothing()
    for one, other in itertools.combinations([solids.grown(outline, within) for outline in outlines], 2):
        found = found + (one ^ other)
    return found


def _parts(scaffold: Scaffold, place: Place) -> list[Part]:
    return [part for part in scaffold.recipe.parts if part.name in place.parts]


def _height(draft: Assembly, made: dict[str, Solid]) -> float:
    """How high it stands folded, mm."""
    reach: list[Array] = [
        np.array(solids.bounds(solids.moved(solid, draft.poses[name][-1])))[:, 2] for name, solid in made.items()
    ]
    return float(np.max(reach) - np.min(reach))
