"""The one place where the canonical frame (d = -Z) is left for the sheet frame, that of the recipe.

The scaffold turned the furniture by `rotation`, so sheet = rotationᵀ · canonical; both are in print millimetres.
"""

from __future__ import annotations

import numpy as np

from foldfab.export import quaternion
from foldfab.fabrication.model import Assembly
from foldfab.geometry.arrays import Array


def to_sheet(assembly: Assembly, vectors: Array) -> Array:
    """(n, 3) or (3,) points or directions, from the canonical frame to the sheet frame."""
    return np.asarray(vectors @ assembly.solution.scaffold.rotation + 0.0)


def sheet_poses(assembly: Assembly, name: str) -> Array:
    """(k, 4, 4) rigid motions of a body from the open posture at the assembly's key times, sheet frame, mm."""
    turn = assembly.solution.scaffold.rotation
    poses = np.array(assembly.poses[name])
    poses[:, :3, :3] = turn.T @ poses[:, :3, :3] @ turn
    poses[:, :3, 3] = poses[:, :3, 3] @ turn
    return poses


def pose_at(times: Array, poses: Array, time: float) -> Array:
    """(4, 4) rigid motion at a time between the keys: (k,) times, (k, 4, 4) poses."""
    upper = int(np.clip(np.searchsorted(times, time, side="right"), 1, len(times) - 1))
    lower = upper - 1
    share = float(np.clip((time - times[lower]) / (times[upper] - times[lower]), 0.0, 1.0))
    ends = quaternion.from_matrices(poses[[lower, upper], :3, :3])
    pose = np.eye(4)
    pose[:3, :3] = quaternion.to_matrix(quaternion.slerp(ends[0], ends[1], share))
    pose[:3, 3] = (1 - share) * poses[lower, :3, 3] + share * poses[upper, :3, 3]
    return pose


def moved(points: Array, pose: Array) -> Array:
    """(n, 3) points after a (4, 4) rigid motion."""
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])
