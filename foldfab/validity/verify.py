"""The verb of this room: a FoldSolution becomes its violations, none where it is valid (section 4).

The solution is tried twice, with the thickness of its material and as the paper's sheets without any. It shares with
the search what a solution is and what angles a fold has; where things are and what meets is found here anew.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

import numpy as np

from foldfab.folding.model import FoldSolution
from foldfab.geometry.arrays import Array
from foldfab.validity import flat, thick
from foldfab.validity.claim import moments
from foldfab.validity.collisions import meetings
from foldfab.validity.configuration import Poses, Tree, arranged, breaks, spanning_tree
from foldfab.validity.model import Folding, Kind, Verdict, Violation
from foldfab.validity.statement import contradictions

CLOSES = 1e-3
"""How far a hinge may be from closing beyond its play, mm: the grid of places in print."""
BETWEEN = 0.05
"""How far either may be off halfway between two samples, mm: what a solution states is interpolated straight there,
while its hinges turn on circles."""
TURNS = 1e-6
"""How far directions and angles may be off, radians."""
PLAY_SHARE = 0.5
"""Share of its clearance that a printed hinge can give."""


def violations(solution: FoldSolution) -> tuple[Violation, ...]:
    """Why a solution is not valid, by kind and time; empty where it is."""
    return verdict(solution).violations


def verdict(solution: FoldSolution) -> Verdict:
    """What was looked at in a solution, and what is wrong with it.

    Where a solution contradicts itself, nothing is moved and only that is told.
    """
    found = list(contradictions(solution))
    if found:
        return Verdict(0, 0, tuple(found))
    found += _overstrained(solution)
    foldings = (thick.folding(solution), flat.folding(solution))
    for folding in foldings:
        found += judged(folding)
    if not found:
        found += _heights(foldings[1])
    found.sort(key=lambda v: (get_args(Kind).index(v.kind), v.time, v.model, v.parts))
    closing = len(spanning_tree(foldings[0].linkage).closing)
    return Verdict(sum(len(f.moments) for f in foldings), closing, tuple(found))


def judged(folding: Folding) -> list[Violation]:
    """All that is wrong with a folding transform: its hinges, what meets, its start and its end."""
    tree = spanning_tree(folding.linkage)
    times = np.unique(np.concatenate([folding.moments, (folding.moments[1:] + folding.moments[:-1]) / 2]))
    angles, slips = folding.angles(times), folding.slips(times)
    if not np.isfinite(angles).all():
        return list(_impossible(folding, times, angles))
    poses = arranged(folding.linkage, tree, angles, slips)
    found = [*_adrift(folding, tree), *_not_open(folding, angles[0]), *_not_flat(folding, poses)]
    found += [*_broken(folding, tree, times, angles, slips, poses), *_elsewhere(folding, tree, times, poses)]
    for m in meetings(folding, tree):
        told = f"{m.first} and {m.second} share up to {m.depth:.2f} mm"
        found.append(_violation(folding, "collision", m.time, (m.first, m.second), m.depth, told))
    return found


def _violation(
    folding: Folding, kind: Kind, time: float, parts: tuple[str, ...], amount: float, told: str
) -> Violation:
    text = f"{folding.model}, at t = {time:.3f}: {told}"
    return Violation(kind, folding.model, float(time), parts, float(amount), text)


def _impossible(folding: Folding, times: Array, angles: Array) -> Iterator[Violation]:
    """Hinges for which no angle exists at some moment: a linkage that cannot reach as far as it should."""
    for h, hinge in enumerate(folding.linkage.hinges):
        bad = np.nonzero(~np.isfinite(angles[:, h]))[0]
        if len(bad):
            told = f"no angle closes the hinge of {hinge.first} and {hinge.second}"
            yield _violation(folding, "hinge", times[bad[0]], (hinge.first, hinge.second), 0.0, told)


def _adrift(folding: Folding, tree: Tree) -> Iterator[Violation]:
    for name in tree.adrift:
        yield _violation(folding, "apart", 0.0, (name,), 0.0, f"{name} hangs together with nothing")


def _not_open(folding: Folding, angles: Array) -> Iterator[Violation]:
    """The fold starts at the initial configuration."""
    for hinge, angle in zip(folding.linkage.hinges, angles, strict=True):
        if abs(angle) > TURNS:
            told = f"the hinge of {hinge.first} and {hinge.second} is turned by {np.degrees(angle):.2f}° at the start"
            yield _violation(folding, "start", 0.0, (hinge.first, hinge.second), abs(angle), told)


def _not_flat(folding: Folding, poses: Poses) -> Iterator[Violation]:
    """At the end all is perpendicular to d, and bases are at every moment."""
    normals = np.array([body.normal for body in folding.linkage.bodies])
    up = np.einsum("tbij,bj->tbi", poses.turn, normals)
    tilt = np.arctan2(np.hypot(up[..., 0], up[..., 1]), np.abs(up[..., 2]))
    for b, body in enumerate(folding.linkage.bodies):
        worst = float(tilt[:, b].max() if body.is_base else tilt[-1, b])
        if worst > TURNS:
            told = f"{body.name} is {np.degrees(worst):.2f}° from lying flat"
            time = 1.0 if tilt[-1, b] > TURNS else 0.0
            yield _violation(folding, "flat", time, (body.name,), worst, told)


def _broken(
    folding: Folding, tree: Tree, times: Array, angles: Array, slips: Array, poses: Poses
) -> Iterator[Violation]:
    """Condition (ii): the hinges beyond the spanning tree are satisfied as well."""
    if not tree.closing:
        return
    found = breaks(folding.linkage, tree.closing, poses, angles, slips)
    turned = np.maximum(found.bend, found.twist)
    for i, h in enumerate(tree.closing):
        hinge = folding.linkage.hinges[h]
        bad = np.nonzero((found.distance[:, i] > _allowed(folding, times)) | (turned[:, i] > TURNS))[0]
        if not len(bad):
            continue
        distance, angle = float(found.distance[:, i].max()), float(turned[:, i].max())
        told = f"the hinge of {hinge.first} and {hinge.second} breaks, up to {distance:.3f} mm"
        told += f" and {np.degrees(angle):.3f}°" if angle > TURNS else ""
        amount = distance if distance > CLOSES else angle
        yield _violation(folding, "hinge", times[bad[0]], (hinge.first, hinge.second), amount, told)


def _allowed(folding: Folding, times: Array) -> Array:
    """How far a hinge may be from closing at times (k,), mm."""
    return np.where(np.isin(times, folding.moments), CLOSES, BETWEEN)


def _elsewhere(folding: Folding, tree: Tree, times: Array, poses: Poses) -> Iterator[Violation]:
    """Bodies are where they are said to be."""
    said = folding.places(times) if folding.places else {}
    for b, body in enumerate(folding.linkage.bodies):
        if body.name not in said or body.name in tree.adrift:
            continue
        off = np.linalg.norm(poses.place[:, b] - said[body.name], axis=1)
        bad = np.nonzero(off > _allowed(folding, times))[0]
        if len(bad):
            told = f"{body.name} is up to {off.max():.3f} mm from where its hinges put it"
            yield _violation(folding, "hinge", times[bad[0]], (body.name,), float(off.max()), told)


def _overstrained(solution: FoldSolution) -> Iterator[Violation]:
    """Hinges give no more than a share of their clearance."""
    times = moments(solution)
    limit = PLAY_SHARE * solution.thickness.gap
    for chain in solution.chains:
        play = np.abs(thick.slip_per_hinge(solution, chain, times))
        worst = float(play.max())
        if worst > limit:
            time = float(times[int(play.argmax())])
            told = f"with thickness, at t = {time:.3f}: each hinge of {chain.patch} has to give {worst:.3f} mm"
            yield Violation("hinge", "with thickness", time, (chain.patch,), worst, told)


def _heights(folding: Folding) -> Iterator[Violation]:
    """Without thickness all patches end in one plane."""
    tree = spanning_tree(folding.linkage)
    end = folding.moments[-1:]
    poses = arranged(folding.linkage, tree, folding.angles(end), folding.slips(end))
    own = [body.pieces.center @ poses.turn[0, b].T + poses.place[0, b] for b, body in enumerate(folding.linkage.bodies)]
    heights = np.concatenate([points[:, 2] for points in own])
    spread = float(np.ptp(heights))
    if spread > CLOSES:
        names = tuple(folding.linkage.bodies[int(i)].name for i in _extremes(own))
        yield _violation(folding, "flat", 1.0, names, spread, f"{names[1]} ends {spread:.2f} mm above {names[0]}")


def _extremes(own: list[Array]) -> tuple[int, int]:
    """The lowest and the highest of some points."""
    return (
        int(np.argmin([points[:, 2].min() for points in own])),
        int(np.argmax([points[:, 2].max() for points in own])),
    )
