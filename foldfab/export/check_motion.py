"""Checks of the fold, from the GLB: rigid, free of collisions, held by its hinges, flat at the end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from foldfab.export.check_latches import check_latches
from foldfab.export.check_solids import OVERLAP_MM3, same_volume
from foldfab.export.frames import moved
from foldfab.export.read_glb import pose, read_glb
from foldfab.export.report import Row, listed
from foldfab.export.solid import Solid, close_pairs, solid
from foldfab.export.stated import Stated, StatedJoint, inside
from foldfab.geometry.arrays import Array

FRAMES = 60
"""Instants after the first at which the fold is looked at."""
SKEW = 1e-4
"""How far from a rigid motion a pose may be."""
AXIS_MM = 0.05
"""How far apart the two images of a hinge's axis may be, beyond half the clearance."""
RANGE_DEG = 2.0
"""By how much a hinge may exceed its range."""
FLAT_DEG = 0.5
"""How far from flat a part may lie at the end, and how far a base may turn."""
SAVING = 0.01
"""By how much the space saving may differ from the stated one."""
FIT_MM = 0.01
"""By how much the gap of a seam may be off."""
PULL_FITS = 3.0
"""Pieces must meet before they are pulled so many fits apart."""
STILL_MM = 2e-3
"""By how much two pieces of a part may seem to move against each other by rounding."""
AT_REST = 1e-6
"""Two parts whose relative pose changes by less need no second look."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """All parts in the sheet frame, open posture, and where they go."""

    solids: dict[str, Solid]
    poses: dict[str, Array]
    """By part, (FRAMES + 1, 4, 4) motions from the open posture, sheet frame, mm."""


def check_motion(folder: Path, stated: Stated) -> list[Row]:
    """Everything that the GLB shows."""
    fold = read_glb(inside(folder, f"{stated.name}.glb"))
    missing = [part.name for part in stated.parts if part.name not in fold.numbers]
    if missing:
        return [Row("motion", False, f"the GLB has no node for {listed(missing)}")]
    if stated.joints and fold.seconds <= 0:
        return [Row("motion", False, "the GLB has no animation")]
    solids, poses = {}, {}
    for part in stated.parts:
        track = np.array([pose(fold, part.name, k / FRAMES) for k in range(FRAMES + 1)])
        vertices, faces = fold.meshes[part.name]
        solids[part.name] = solid(part.name, moved(vertices, track[0]), faces)
        poses[part.name] = track @ np.linalg.inv(track[0])
    motion = Motion(solids, poses)
    checks = [_bodies, _rigid, _collide, _joints, _connected, _flat]
    checks += [_seams] if any(joint.seam for joint in stated.joints) else []
    rows = [check(motion, stated) for check in checks]
    is_latched = any(joint.latch for joint in stated.joints)
    return [*rows, check_latches(motion.solids, motion.poses, stated)] if is_latched else rows


def _bodies(motion: Motion, stated: Stated) -> Row:
    off = [p.name for p in stated.parts if not same_volume(motion.solids[p.name].manifold.volume(), p.volume)]
    text = f"not of the stated volume: {listed(off)}" if off else f"{len(stated.parts)} animated parts"
    return Row("motion", not off, text)


def _rigid(motion: Motion, stated: Stated) -> Row:
    skews = {}
    for name, poses in motion.poses.items():
        turn = poses[:, :3, :3]
        unit = np.abs(turn @ turn.transpose(0, 2, 1) - np.eye(3)).max()
        skews[name] = max(float(unit), float(np.abs(np.linalg.det(turn) - 1).max()))
    worst = max(skews, key=lambda name: skews[name])
    return Row("rigid", skews[worst] < SKEW, f"largest departure from a rigid motion {skews[worst]:.1e}, at {worst}")


def _collide(motion: Motion, stated: Stated) -> Row:
    """O(FRAMES · near pairs); a pair that moves as one since it was last looked at is passed over."""
    names = sorted(motion.solids)
    looked: dict[tuple[int, int], Array] = {}
    clashes: dict[tuple[int, int], tuple[float, int]] = {}
    for k in range(FRAMES + 1):
        points = [moved(motion.solids[name].vertices, motion.poses[name][k]) for name in names]
        for pair in close_pairs(points, 0.0):
            relative = np.linalg.inv(motion.poses[names[pair[0]]][k]) @ motion.poses[names[pair[1]]][k]
            if pair in looked and np.abs(relative - looked[pair]).max() < AT_REST:
                continue
            looked[pair] = relative
            a, b = (motion.solids[names[number]].manifold for number in pair)
            overlap = (a ^ b.transform(relative[:3])).volume()
            if overlap > max(OVERLAP_MM3, clashes.get(pair, (0.0, 0))[0]):
                clashes[pair] = overlap, k
    worst = sorted(clashes.items(), key=lambda item: -item[1][0])
    texts = [f"{names[i]} and {names[j]} by {v:.1f} mm³ at {100 * k / FRAMES:.0f} %" for (i, j), (v, k) in worst]
    return Row("collide", not texts, f"collide: {listed(texts)}" if texts else f"no collision at {FRAMES + 1} instants")


def _joints(motion: Motion, stated: Stated) -> Row:
    problems, worst = [], 0.0
    for joint in stated.joints:
        drift, turn = _drift(motion, joint), _turn(motion, joint)
        worst = max(worst, drift)
        if not drift <= stated.clearance / 2 + AXIS_MM:
            problems.append(f"{joint.name} leaves its axis by {drift:.2f} mm")
        if not turn <= joint.range_deg[1] - joint.range_deg[0] + RANGE_DEG:
            problems.append(f"{joint.name} turns {turn:.0f}°, beyond its range")
    count = sum(joint.seam is None for joint in stated.joints)
    return Row("joints", not problems, listed(problems) or f"{count} hinges, on axis within {worst:.3f} mm")


def _seams(motion: Motion, stated: Stated) -> Row:
    """Pieces of a part lie a fit apart, never move against each other, and meet when they are pulled apart."""
    problems, gaps = [], []
    for joint in stated.joints:
        if joint.seam is not None:
            a, b = (motion.solids[name].manifold for name in joint.parts)
            gaps.append(float(a.min_gap(b, 2 * joint.seam.fit)))
            if abs(gaps[-1] - joint.seam.fit) > FIT_MM:
                problems.append(f"{joint.name} has a gap of {gaps[-1]:.3f} mm, the sheet says {joint.seam.fit:g}")
            if (a ^ b.translate((PULL_FITS * joint.seam.fit * joint.seam.pull).tolist())).volume() <= OVERLAP_MM3:
                problems.append(f"{joint.name} can be pulled apart")
            relative = np.linalg.inv(motion.poses[joint.parts[0]]) @ motion.poses[joint.parts[1]]
            if np.abs(relative - np.eye(4)).max() > STILL_MM:
                problems.append(f"the pieces at {joint.name} move against each other")
    text = f"{len(gaps)} seams, {min(gaps):.3f} to {max(gaps):.3f} mm apart, hold"
    return Row("seams", not problems, listed(problems) or text)


def _drift(motion: Motion, joint: StatedJoint) -> float:
    images = [np.array([moved(joint.axis, pose) for pose in motion.poses[name]]) for name in joint.parts]
    return float(np.linalg.norm(images[0] - images[1], axis=2).max())


def _turn(motion: Motion, joint: StatedJoint) -> float:
    """The furthest that the two parts turn against each other, degrees."""
    a, b = (motion.poses[name][:, :3, :3] for name in joint.parts)
    return float(_angles(a.transpose(0, 2, 1) @ b).max())


def _angles(turns: Array) -> Array:
    """(k,) degrees of (k, 3, 3) rotations."""
    twist = turns - turns.transpose(0, 2, 1)
    sine = np.linalg.norm(np.stack([twist[:, 2, 1], twist[:, 0, 2], twist[:, 1, 0]], axis=1), axis=1) / 2
    return np.asarray(np.degrees(np.arctan2(sine, (np.trace(turns, axis1=1, axis2=2) - 1) / 2)))


def _connected(motion: Motion, stated: Stated) -> Row:
    pieces = [{part.name} for part in stated.parts]
    for joint in stated.joints:
        met = [piece for piece in pieces if piece & set(joint.parts)]
        pieces = [piece for piece in pieces if piece not in met] + [set().union(*met)]
    text = f"{len(pieces)} piece{'s' * (len(pieces) != 1)} of furniture, the sheet says {stated.components}"
    return Row("connected", len(pieces) == stated.components, text)


def _flat(motion: Motion, stated: Stated) -> Row:
    problems = []
    for part in stated.parts:
        end = motion.poses[part.name][-1, :3, :3] @ part.normal
        tilt = float(
            np.degrees(np.arctan2(np.linalg.norm(np.cross(end, stated.direction)), abs(end @ stated.direction)))
        )
        if not tilt <= FLAT_DEG:
            problems.append(f"{part.name} ends {tilt:.1f}° from flat")
        turn = float(_angles(motion.poses[part.name][:, :3, :3]).max())
        if part.kind == "base" and not turn <= FLAT_DEG:
            problems.append(f"{part.name} turns by {turn:.1f}°, though it is a base")
    saving = 1 - _room(motion, -1) / _room(motion, 0)
    if not abs(saving - stated.space_saving) <= SAVING:
        problems.append(f"saves {saving:.3f} of its space, the sheet says {stated.space_saving:.3f}")
    return Row(
        "flat", not problems, listed(problems) or f"every part ends flat; {100 * saving:.0f} % of the space saved"
    )


def _room(motion: Motion, frame: int) -> float:
    points = [moved(body.vertices, motion.poses[name][frame]) for name, body in motion.solids.items()]
    return float(np.ptp(np.vstack(points), axis=0).prod())
